// A fixed tree of boxes, for finding those that meet a box.
#ifndef BULLET_BRIDGE_BOX_TREE_HPP
#define BULLET_BRIDGE_BOX_TREE_HPP

#include <cstdint>
#include <vector>

namespace shiver
{

struct Box {
    double low[3], high[3];
};

bool meet(const Box &a, const Box &b);
Box hull(const Box &a, const Box &b);

class BoxTree
{
  public:
    // Finite boxes only.
    void build(const std::vector<Box> &boxes);
    // Appends the indices of the boxes that meet `box`, in an order that depends on the boxes alone.
    void find(const Box &box, std::vector<int32_t> &found) const;

  private:
    struct Node {
        Box box;
        int32_t item;   // −1: an inner node, whose left child follows it
        int32_t beyond; // node after the whole subtree
    };
    void add(const std::vector<Box> &boxes, int32_t *first, int32_t *last);
    std::vector<Node> nodes_; // in preorder
};

} // namespace shiver

#endif
