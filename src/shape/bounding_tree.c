#include "shape/bounding_tree.h"

#include "base/deterministic.h"
#include "mesh/edge_table.h"
#include "shape/triangle.h"

enum { LEAF_TRIANGLES = 4, STACK_NODES = 96 };

typedef struct TreeNode {
    double low[3], high[3];
    int32_t first; /* leaf: into order; else the right child (the left one follows its parent) */
    int32_t count; /* triangles of a leaf; 0: not a leaf */
} TreeNode;

struct ShvBoundingTree {
    const ShvSurface *surface;
    TreeNode *nodes;
    int32_t node_count;
    int32_t *order;         /* triangles, leaf by leaf */
    double *face_normals;   /* 3 per triangle, unit */
    double *edge_normals;   /* 9 per triangle: edges 01, 12, 20; sums of two unit normals */
    double *vertex_normals; /* 3 per node, weighted by angle */
};

/* ---- building ---- */

typedef struct SplitItem {
    double key;
    int32_t triangle;
} SplitItem;

static bool item_before(SplitItem a, SplitItem b)
{
    return a.key < b.key || (a.key == b.key && a.triangle < b.triangle);
}

/* Hoare's selection: afterwards the items before `middle` are not after it in the order. */
static void select_middle(SplitItem *items, int32_t count, int32_t middle)
{
    int32_t low = 0, high = count - 1;
    while (low < high) {
        const SplitItem pivot = items[low + (high - low) / 2];
        int32_t i = low, j = high;
        while (i <= j) {
            while (item_before(items[i], pivot)) i++;
            while (item_before(pivot, items[j])) j--;
            if (i > j) break;
            const SplitItem kept = items[i];
            items[i++] = items[j];
            items[j--] = kept;
        }
        if (middle <= j)
            high = j;
        else if (middle >= i)
            low = i;
        else
            return;
    }
}

static ShvVec3 triangle_corner(const ShvSurface *surface, int32_t triangle, int corner)
{
    return shv_surface_position(surface, surface->triangles[3 * (int64_t)triangle + corner]);
}

static void bound(const ShvSurface *surface, const int32_t *order, int32_t count, TreeNode *node)
{
    for (int k = 0; k < 3; k++) {
        node->low[k] = (double)INFINITY;
        node->high[k] = -(double)INFINITY;
    }
    for (int32_t i = 0; i < count; i++)
        for (int corner = 0; corner < 3; corner++) {
            double p[3];
            shv_store3(p, triangle_corner(surface, order[i], corner));
            for (int k = 0; k < 3; k++) {
                node->low[k] = fmin(node->low[k], p[k]);
                node->high[k] = fmax(node->high[k], p[k]);
            }
        }
}

static double centroid_sum(const ShvSurface *surface, int32_t triangle, int axis)
{
    double sum = 0.0;
    for (int corner = 0; corner < 3; corner++) {
        double p[3];
        shv_store3(p, triangle_corner(surface, triangle, corner));
        sum += p[axis];
    }
    return sum;
}

/* Halves the triangles at the median of their centroids along the longest axis: depth stays below log2(count) + 1. */
static void split(ShvBoundingTree *tree, SplitItem *items, int32_t first, int32_t count)
{
    TreeNode *node = &tree->nodes[tree->node_count++];
    bound(tree->surface, tree->order + first, count, node);
    node->first = first;
    node->count = count;
    if (count <= LEAF_TRIANGLES) return;
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (node->high[k] - node->low[k] > node->high[axis] - node->low[axis]) axis = k;
    for (int32_t i = 0; i < count; i++)
        items[i] = (SplitItem){centroid_sum(tree->surface, tree->order[first + i], axis), tree->order[first + i]};
    const int32_t half = count / 2;
    select_middle(items, count, half);
    for (int32_t i = 0; i < count; i++) tree->order[first + i] = items[i].triangle;
    node->count = 0;
    split(tree, items, first, half);
    node->first = tree->node_count;
    split(tree, items, first + half, count - half);
}

static void make_face_normals(ShvBoundingTree *tree)
{
    const ShvSurface *surface = tree->surface;
    for (int32_t t = 0; t < surface->triangle_count; t++) {
        const ShvVec3 a = triangle_corner(surface, t, 0);
        const ShvVec3 normal =
            shv_unit(shv_cross(shv_sub(triangle_corner(surface, t, 1), a), shv_sub(triangle_corner(surface, t, 2), a)));
        shv_store3(tree->face_normals + 3 * (int64_t)t, normal);
        for (int corner = 0; corner < 3; corner++) {
            const ShvVec3 here = triangle_corner(surface, t, corner);
            const ShvVec3 left = shv_unit(shv_sub(triangle_corner(surface, t, (corner + 1) % 3), here));
            const ShvVec3 right = shv_unit(shv_sub(triangle_corner(surface, t, (corner + 2) % 3), here));
            const double angle = shv_acos(fmin(1.0, fmax(-1.0, shv_dot(left, right))));
            shv_add_to3(tree->vertex_normals + 3 * (int64_t)surface->triangles[3 * (int64_t)t + corner],
                        shv_scale(normal, angle));
        }
    }
}

static ShvStatus make_edge_normals(ShvBoundingTree *tree)
{
    const ShvSurface *surface = tree->surface;
    const int32_t half_edges = 3 * surface->triangle_count;
    ShvEdgeTable table;
    SHV_TRY(shv_edge_table_create(&table, surface->memory, surface->triangles, half_edges, NULL));
    for (int32_t h = 0; h < half_edges; h++) shv_edge_table_insert(&table, h);
    for (int32_t h = 0; h < half_edges; h++) {
        const int32_t twin = shv_edge_table_find(&table, shv_half_edge_end(surface->triangles, h),
                                                 shv_half_edge_start(surface->triangles, h));
        const int32_t neighbour = twin < 0 ? h / 3 : twin / 3;
        shv_store3(tree->edge_normals + 3 * (int64_t)h,
                   shv_add(shv_load3(tree->face_normals + 3 * (int64_t)(h / 3)),
                           shv_load3(tree->face_normals + 3 * (int64_t)neighbour)));
    }
    shv_edge_table_release(&table);
    return SHV_OK;
}

static bool build(ShvBoundingTree *tree, ShvMemory *memory)
{
    const size_t triangles = (size_t)tree->surface->triangle_count, nodes = (size_t)tree->surface->node_count;
    tree->nodes = shv_allocate(memory, SHV_PART_SHAPE, 2 * triangles, sizeof *tree->nodes);
    tree->order = shv_allocate(memory, SHV_PART_SHAPE, triangles, sizeof *tree->order);
    tree->face_normals = shv_allocate(memory, SHV_PART_SHAPE, 3 * triangles, sizeof(double));
    tree->edge_normals = shv_allocate(memory, SHV_PART_SHAPE, 9 * triangles, sizeof(double));
    tree->vertex_normals = shv_allocate(memory, SHV_PART_SHAPE, 3 * nodes, sizeof(double));
    if (!tree->nodes || !tree->order || !tree->face_normals || !tree->edge_normals || !tree->vertex_normals)
        return false;
    SplitItem *items = shv_allocate(memory, SHV_PART_SHAPE, triangles, sizeof *items);
    if (!items) return false;
    for (int32_t t = 0; t < tree->surface->triangle_count; t++) tree->order[t] = t;
    split(tree, items, 0, tree->surface->triangle_count);
    shv_release(items);
    make_face_normals(tree);
    return make_edge_normals(tree) == SHV_OK;
}

ShvBoundingTree *shv_bounding_tree_create(ShvMemory *memory, const ShvSurface *surface)
{
    ShvBoundingTree *tree = shv_allocate(memory, SHV_PART_SHAPE, 1, sizeof *tree);
    if (!tree) return NULL;
    tree->surface = surface;
    if (build(tree, memory)) return tree;
    shv_bounding_tree_release(tree);
    return NULL;
}

void shv_bounding_tree_release(ShvBoundingTree *tree)
{
    if (!tree) return;
    shv_release(tree->nodes);
    shv_release(tree->order);
    shv_release(tree->face_normals);
    shv_release(tree->edge_normals);
    shv_release(tree->vertex_normals);
    shv_release(tree);
}

/* ---- closest point ---- */

static double box_distance_squared(const TreeNode *node, const double point[3])
{
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
        const double d = fmax(fmax(node->low[k] - point[k], point[k] - node->high[k]), 0.0);
        sum += d * d;
    }
    return sum;
}

static ShvVec3 pseudonormal(const ShvBoundingTree *tree, int32_t triangle, int feature)
{
    const int64_t t = triangle;
    if (feature == SHV_TRIANGLE_FACE) return shv_load3(tree->face_normals + 3 * t);
    if (feature >= SHV_TRIANGLE_EDGES)
        return shv_load3(tree->edge_normals + 9 * t + 3 * (feature - SHV_TRIANGLE_EDGES));
    return shv_load3(tree->vertex_normals + 3 * (int64_t)tree->surface->triangles[3 * t + feature]);
}

typedef struct Nearest {
    double squared; /* of the distance, the best so far */
    int32_t triangle;
    ShvTrianglePoint at;
} Nearest;

static void try_leaf(const ShvBoundingTree *tree, const TreeNode *leaf, ShvVec3 point, Nearest *nearest)
{
    for (int32_t i = leaf->first; i < leaf->first + leaf->count; i++) {
        const int32_t t = tree->order[i];
        const ShvVec3 corners[3] = {triangle_corner(tree->surface, t, 0), triangle_corner(tree->surface, t, 1),
                                    triangle_corner(tree->surface, t, 2)};
        const ShvTrianglePoint at = shv_triangle_closest(point, corners);
        const ShvVec3 to = shv_sub(point, at.point);
        const double squared = shv_dot(to, to);
        if (squared < nearest->squared) *nearest = (Nearest){squared, t, at};
    }
}

static void search(const ShvBoundingTree *tree, ShvVec3 point, Nearest *nearest)
{
    struct {
        int32_t node;
        double squared;
    } stack[STACK_NODES];
    double p[3];
    shv_store3(p, point);
    int depth = 0;
    stack[depth].node = 0;
    stack[depth++].squared = box_distance_squared(&tree->nodes[0], p);
    while (depth > 0) {
        depth--;
        if (stack[depth].squared >= nearest->squared) continue;
        const int32_t index = stack[depth].node;
        const TreeNode *node = &tree->nodes[index];
        if (node->count > 0) {
            try_leaf(tree, node, point, nearest);
            continue;
        }
        const double left = box_distance_squared(&tree->nodes[index + 1], p);
        const double right = box_distance_squared(&tree->nodes[node->first], p);
        const bool left_first = left <= right; /* pushed last */
        stack[depth].node = left_first ? node->first : index + 1;
        stack[depth++].squared = left_first ? right : left;
        stack[depth].node = left_first ? index + 1 : node->first;
        stack[depth++].squared = left_first ? left : right;
    }
}

ShvTreePoint shv_bounding_tree_closest(const ShvBoundingTree *tree, ShvVec3 point, double limit)
{
    double p[3];
    shv_store3(p, point);
    const double outside = box_distance_squared(&tree->nodes[0], p);
    Nearest nearest = {
        outside > 0.0 ? limit * limit : (double)INFINITY, -1, {.point = point, .feature = SHV_TRIANGLE_FACE}};
    search(tree, point, &nearest);
    if (nearest.triangle < 0) return (ShvTreePoint){limit, point, shv_vec3(0.0, 0.0, 1.0), -1};
    const ShvVec3 pseudo = pseudonormal(tree, nearest.triangle, nearest.at.feature);
    const ShvVec3 away = shv_sub(point, nearest.at.point);
    const double distance = sqrt(nearest.squared);
    const double sign = shv_dot(away, pseudo) < 0.0 ? -1.0 : 1.0;
    /* On the surface the direction to the closest point is rounding. */
    const TreeNode *root = &tree->nodes[0];
    const double size =
        fmax(root->high[0] - root->low[0], fmax(root->high[1] - root->low[1], root->high[2] - root->low[2]));
    const ShvVec3 normal = nearest.at.feature < SHV_TRIANGLE_FACE && distance > 1e-12 * size
                               ? shv_scale(away, sign / distance)
                               : shv_unit(pseudo);
    return (ShvTreePoint){sign * distance, nearest.at.point, normal, nearest.triangle};
}

/* ---- crossing ---- */

static bool segment_meets_box(const TreeNode *node, const double from[3], const double inverse[3], double reach)
{
    double enter = 0.0, leave = reach;
    for (int k = 0; k < 3; k++) {
        if (isinf(inverse[k])) {
            if (from[k] < node->low[k] || from[k] > node->high[k]) return false;
            continue;
        }
        const double a = (node->low[k] - from[k]) * inverse[k], b = (node->high[k] - from[k]) * inverse[k];
        enter = fmax(enter, fmin(a, b));
        leave = fmin(leave, fmax(a, b));
    }
    /* Flat boxes: rounding must not part entry and exit. */
    return enter <= leave + 1e-12 * (1.0 + reach);
}

/* Crossing of the plane from its outer side within the triangle, whose edges are widened by 1e-9 of its size so that
   nothing slips between neighbours. */
static bool segment_meets_triangle(const ShvBoundingTree *tree, int32_t triangle, ShvVec3 from, ShvVec3 path,
                                   double *fraction)
{
    const ShvVec3 normal = shv_load3(tree->face_normals + 3 * (int64_t)triangle);
    const ShvVec3 corner[3] = {triangle_corner(tree->surface, triangle, 0), triangle_corner(tree->surface, triangle, 1),
                               triangle_corner(tree->surface, triangle, 2)};
    const double fall = -shv_dot(path, normal), height = shv_dot(shv_sub(from, corner[0]), normal);
    if (!(fall > 0.0) || height < 0.0 || height > fall) return false;
    const double t = height / fall;
    const ShvVec3 at = shv_madd(from, t, path);
    for (int k = 0; k < 3; k++) {
        const ShvVec3 edge = shv_sub(corner[(k + 1) % 3], corner[k]);
        const double side = shv_dot(shv_cross(edge, shv_sub(at, corner[k])), normal);
        if (side < -1e-9 * shv_dot(edge, edge)) return false;
    }
    *fraction = t;
    return true;
}

bool shv_bounding_tree_sweep(const ShvBoundingTree *tree, ShvVec3 from, ShvVec3 to, double *fraction, ShvVec3 *normal)
{
    const ShvVec3 path = shv_sub(to, from);
    const double start[3] = {from.x, from.y, from.z}, inverse[3] = {1.0 / path.x, 1.0 / path.y, 1.0 / path.z};
    int32_t stack[STACK_NODES], best = -1;
    int depth = 0;
    double reach = 1.0;
    stack[depth++] = 0;
    while (depth > 0) {
        const int32_t index = stack[--depth];
        const TreeNode *node = &tree->nodes[index];
        if (!segment_meets_box(node, start, inverse, reach)) continue;
        for (int32_t i = node->first; i < node->first + node->count; i++) {
            double t = 0.0;
            if (segment_meets_triangle(tree, tree->order[i], from, path, &t) && (t < reach || best < 0)) {
                reach = t;
                best = tree->order[i];
            }
        }
        if (node->count > 0) continue;
        stack[depth++] = node->first;
        stack[depth++] = index + 1;
    }
    if (best < 0) return false;
    *fraction = reach;
    *normal = shv_load3(tree->face_normals + 3 * (int64_t)best);
    return true;
}
