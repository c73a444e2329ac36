#include "bullet_bridge/box_tree.hpp"

#include <algorithm>
#include <numeric>

namespace shiver
{

bool meet(const Box &a, const Box &b)
{
    for (int i = 0; i < 3; i++)
        if (a.low[i] > b.high[i] || b.low[i] > a.high[i]) return false;
    return true;
}

Box hull(const Box &a, const Box &b)
{
    Box both;
    for (int i = 0; i < 3; i++) {
        both.low[i] = std::min(a.low[i], b.low[i]);
        both.high[i] = std::max(a.high[i], b.high[i]);
    }
    return both;
}

void BoxTree::add(const std::vector<Box> &boxes, int32_t *first, int32_t *last)
{
    const size_t place = nodes_.size();
    Node node = {boxes[static_cast<size_t>(*first)], *first, 0};
    for (const int32_t *item = first; item < last; item++) node.box = hull(node.box, boxes[static_cast<size_t>(*item)]);
    nodes_.push_back(node);
    if (last - first > 1) {
        int axis = 0;
        const auto extent = [&](int i) { return node.box.high[i] - node.box.low[i]; };
        for (int i = 1; i < 3; i++)
            if (extent(i) > extent(axis)) axis = i;
        // Ties go by index, so that the order is a total one.
        const auto before = [&](int32_t a, int32_t b) {
            const Box &one = boxes[static_cast<size_t>(a)], &other = boxes[static_cast<size_t>(b)];
            const double left = one.low[axis] + one.high[axis], right = other.low[axis] + other.high[axis];
            return left < right || (left == right && a < b);
        };
        int32_t *middle = first + (last - first) / 2;
        std::nth_element(first, middle, last, before);
        nodes_[place].item = -1;
        add(boxes, first, middle);
        add(boxes, middle, last);
    }
    nodes_[place].beyond = static_cast<int32_t>(nodes_.size());
}

void BoxTree::build(const std::vector<Box> &boxes)
{
    nodes_.clear();
    if (boxes.empty()) return;
    std::vector<int32_t> order(boxes.size());
    std::iota(order.begin(), order.end(), 0);
    nodes_.reserve(2 * boxes.size());
    add(boxes, order.data(), order.data() + order.size());
}

void BoxTree::find(const Box &box, std::vector<int32_t> &found) const
{
    for (size_t i = 0; i < nodes_.size();) {
        const Node &node = nodes_[i];
        const bool meets = meet(node.box, box);
        if (meets && node.item >= 0) found.push_back(node.item);
        i = meets ? i + 1 : static_cast<size_t>(node.beyond);
    }
}

} // namespace shiver
