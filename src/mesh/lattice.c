#include "mesh/lattice.h"

#include "mesh/node_table.h"

/* A leaf or a place where one may be: edges are 2^(levels − level) smallest cells. */
typedef struct Cell {
    int32_t level;
    int64_t at[3]; /* in cells of its level */
} Cell;

/* A point of the lattice in halves of smallest cells; odd coordinates are centres of smallest cells. */
typedef struct Point {
    int64_t at[3];
} Point;

/* Where tets go. A first pass without a table counts them, a second one fills the mesh. */
typedef struct Sink {
    const ShvLattice *lattice;
    ShvNodeTable *nodes;
    int32_t *elements;
    int64_t count;
    bool right; /* the present cell lies to the right of the slit */
    ShvStatus status;
    ShvError *error;
} Sink;

static int64_t cells_along(const ShvLattice *lattice, int axis, int32_t level)
{
    return (int64_t)lattice->roots[axis] << level;
}

/* Whether a cell is halved: it lies within reach of the slit, in the larger of the distances along x and z, counted in
   smallest cells. A cell that touches a halved one of level l lies nearer than reach[l] + 2^(levels − l), which is no
   more than reach[l − 1]: it is no leaf of level l − 1. So touching leaves differ by one level at most, and whether a
   place is a leaf follows from the place alone: no tree need be kept. */
static bool is_halved(const ShvLattice *lattice, Cell cell)
{
    if (!lattice->slit || cell.level >= lattice->levels) return false;
    const int32_t shift = lattice->levels - cell.level;
    const int64_t low_x = cell.at[0] << shift, high_x = (cell.at[0] + 1) << shift, low_z = cell.at[2] << shift;
    const int64_t plane = lattice->knot[0], tip = lattice->knot[2];
    const int64_t dx = low_x > plane ? low_x - plane : high_x < plane ? plane - high_x : 0;
    const int64_t dz = low_z > tip ? low_z - tip : 0;
    return (dx > dz ? dx : dz) < lattice->reach[cell.level];
}

static bool is_inside(const ShvLattice *lattice, Cell cell)
{
    for (int axis = 0; axis < 3; axis++)
        if (cell.at[axis] < 0 || cell.at[axis] >= cells_along(lattice, axis, cell.level)) return false;
    return true;
}

static Cell neighbour(Cell cell, int axis, int side)
{
    cell.at[axis] += side ? 1 : -1;
    return cell;
}

static Cell parent_of(Cell cell)
{
    return (Cell){cell.level - 1, {cell.at[0] >> 1, cell.at[1] >> 1, cell.at[2] >> 1}};
}

/* ---- points and tets ---- */

static int64_t half_length(const ShvLattice *lattice, Cell cell)
{
    return (int64_t)1 << (lattice->levels - cell.level);
}

static Point centre_of(const ShvLattice *lattice, Cell cell)
{
    const int64_t half = half_length(lattice, cell);
    return (Point){{(2 * cell.at[0] + 1) * half, (2 * cell.at[1] + 1) * half, (2 * cell.at[2] + 1) * half}};
}

static Point middle(Point a, Point b)
{
    return (Point){{(a.at[0] + b.at[0]) / 2, (a.at[1] + b.at[1]) / 2, (a.at[2] + b.at[2]) / 2}};
}

/* Corners of a face in cyclic order: corner i lies at (i = 1, 2; i = 2, 3) of the two axes that follow `axis`. */
static void face_corners(const ShvLattice *lattice, Cell cell, int axis, int side, Point corners[4])
{
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const int64_t length = 2 * half_length(lattice, cell);
    for (int i = 0; i < 4; i++) {
        corners[i].at[axis] = (cell.at[axis] + side) * length;
        corners[i].at[u] = (cell.at[u] + (i == 1 || i == 2)) * length;
        corners[i].at[v] = (cell.at[v] + (i == 2 || i == 3)) * length;
    }
}

/* Planes on either side of the knot are equally spaced; the ends and the knot itself are met exactly. */
static double coordinate(const ShvLattice *lattice, int axis, int64_t at)
{
    const int64_t knot = 2 * (int64_t)lattice->knot[axis], end = 2 * cells_along(lattice, axis, lattice->levels);
    const double middle_value = lattice->knot_value[axis];
    if (at == 0) return lattice->low[axis];
    if (at == knot) return middle_value;
    if (at == end) return lattice->high[axis];
    if (at < knot) return (lattice->low[axis] * (double)(knot - at) + middle_value * (double)at) / (double)knot;
    return (middle_value * (double)(end - at) + lattice->high[axis] * (double)(at - knot)) / (double)(end - knot);
}

static uint64_t key_of(const Sink *sink, Point p)
{
    const ShvLattice *lattice = sink->lattice;
    const bool lip =
        lattice->slit && p.at[0] == 2 * (int64_t)lattice->knot[0] && p.at[2] < 2 * (int64_t)lattice->knot[2];
    uint64_t key = 0;
    for (int axis = 2; axis >= 0; axis--)
        key = key * (uint64_t)(2 * cells_along(lattice, axis, lattice->levels) + 1) + (uint64_t)p.at[axis];
    return 2 * key + (lip && sink->right);
}

static int32_t node_of(Sink *sink, Point p)
{
    int32_t node = 0;
    bool added = false;
    if (sink->status == SHV_OK)
        sink->status = shv_node_table_find(sink->nodes, key_of(sink, p), &node, &added, sink->error);
    if (added && sink->status == SHV_OK)
        for (int axis = 0; axis < 3; axis++)
            sink->nodes->positions[3 * (int64_t)node + axis] = coordinate(sink->lattice, axis, p.at[axis]);
    return node;
}

static int64_t orientation(Point a, Point b, Point c, Point d)
{
    int64_t m[3][3];
    for (int i = 0; i < 3; i++) {
        m[0][i] = b.at[i] - a.at[i];
        m[1][i] = c.at[i] - a.at[i];
        m[2][i] = d.at[i] - a.at[i];
    }
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

static void add_tet(Sink *sink, Point a, Point b, Point c, Point d)
{
    if (sink->nodes) {
        const bool right_handed = orientation(a, b, c, d) > 0;
        int32_t *n = sink->elements + 4 * sink->count;
        n[0] = node_of(sink, a);
        n[1] = node_of(sink, b);
        n[2] = node_of(sink, right_handed ? c : d);
        n[3] = node_of(sink, right_handed ? d : c);
    }
    sink->count++;
}

/* ---- faces ---- */

/* Whether a leaf of half the size touches edge i (corner i to corner i + 1) of a face between `cell` and its equal
   neighbour beyond `axis`, or of a face on the surface. */
static bool edge_is_halved(const ShvLattice *lattice, Cell cell, int axis, int side, int edge)
{
    const int across = edge % 2 == 0 ? (axis + 2) % 3 : (axis + 1) % 3;
    const Cell beside = neighbour(cell, across, edge == 1 || edge == 2);
    const Cell beyond = neighbour(beside, axis, side);
    return (is_inside(lattice, beside) && is_halved(lattice, beside)) ||
           (is_inside(lattice, beyond) && is_halved(lattice, beyond));
}

/* A pyramid over a square, cut along the diagonal of corners 0 and 2 or of 1 and 3. */
static void add_pyramid(Sink *sink, const Point corners[4], int diagonal, Point apex)
{
    add_tet(sink, corners[diagonal], corners[diagonal + 1], corners[diagonal + 2], apex);
    add_tet(sink, corners[diagonal], corners[diagonal + 2], corners[(diagonal + 3) % 4], apex);
}

/* The tets around the line from `apex` to `beyond`, one for each edge of the face or each half of it. */
static void add_ring(Sink *sink, const Point corners[4], const bool halved[4], Point apex, Point beyond)
{
    for (int i = 0; i < 4; i++) {
        const Point from = corners[i], to = corners[(i + 1) % 4];
        if (halved[i]) {
            add_tet(sink, apex, beyond, from, middle(from, to));
            add_tet(sink, apex, beyond, middle(from, to), to);
        } else {
            add_tet(sink, apex, beyond, from, to);
        }
    }
}

/* The diagonal that alternates from face to face; of the four quarters of a larger face, the one through its middle. */
static int diagonal_of(Cell cell, int axis)
{
    return (int)((cell.at[(axis + 1) % 3] + cell.at[(axis + 2) % 3]) & 1);
}

static bool is_on_slit(const ShvLattice *lattice, Cell cell, int axis, int side)
{
    if (!lattice->slit || axis != 0 || cell.level != lattice->levels) return false;
    return cell.at[0] + side == lattice->knot[0] && cell.at[2] < lattice->knot[2];
}

static void add_face(Sink *sink, Cell cell, int axis, int side)
{
    const ShvLattice *lattice = sink->lattice;
    const Cell next = neighbour(cell, axis, side);
    const bool surface = !is_inside(lattice, next) || is_on_slit(lattice, cell, axis, side);
    const bool larger = !surface && cell.level > 0 && !is_halved(lattice, parent_of(next));
    /* An equal neighbour's face is made once, from the low side; a larger neighbour's from this side. */
    if (!surface && !larger && (side == 0 || is_halved(lattice, next))) return;
    const Point centre = centre_of(lattice, cell);
    Point corners[4];
    face_corners(lattice, cell, axis, side, corners);
    if (larger) {
        add_pyramid(sink, corners, diagonal_of(cell, axis), centre);
        add_pyramid(sink, corners, diagonal_of(cell, axis), centre_of(lattice, parent_of(next)));
        return;
    }
    bool halved[4];
    for (int i = 0; i < 4; i++) halved[i] = edge_is_halved(lattice, cell, axis, side, i);
    if (!surface)
        add_ring(sink, corners, halved, centre, centre_of(lattice, next));
    else if (halved[0] || halved[1] || halved[2] || halved[3])
        add_ring(sink, corners, halved, centre, middle(corners[0], corners[2]));
    else
        add_pyramid(sink, corners, diagonal_of(cell, axis), centre);
}

static void add_cell(Sink *sink, Cell cell)
{
    if (is_halved(sink->lattice, cell)) {
        for (int child = 0; child < 8; child++)
            add_cell(sink, (Cell){cell.level + 1,
                                  {2 * cell.at[0] + (child & 1), 2 * cell.at[1] + (child >> 1 & 1),
                                   2 * cell.at[2] + (child >> 2)}});
        return;
    }
    sink->right = cell.at[0] << (sink->lattice->levels - cell.level) >= sink->lattice->knot[0];
    for (int axis = 0; axis < 3; axis++)
        for (int side = 0; side < 2; side++) add_face(sink, cell, axis, side);
}

static void add_cells(Sink *sink)
{
    const int32_t *roots = sink->lattice->roots;
    for (int32_t z = 0; z < roots[2]; z++)
        for (int32_t y = 0; y < roots[1]; y++)
            for (int32_t x = 0; x < roots[0] && sink->status == SHV_OK; x++) add_cell(sink, (Cell){0, {x, y, z}});
}

ShvLattice shv_lattice_box(const double size[3], double cell)
{
    ShvLattice lattice = {0};
    for (int axis = 0; axis < 3; axis++) {
        const double count = floor(size[axis] / cell + 0.5);
        lattice.roots[axis] = count < 1.0 ? 1 : count > (double)SHV_MESH_LARGEST ? SHV_MESH_LARGEST : (int32_t)count;
        lattice.low[axis] = -0.5 * size[axis];
        lattice.high[axis] = lattice.knot_value[axis] = 0.5 * size[axis];
        lattice.knot[axis] = lattice.roots[axis];
    }
    return lattice;
}

double shv_lattice_estimate(const ShvLattice *lattice)
{
    double cells = (double)lattice->roots[0] * (double)lattice->roots[1] * (double)lattice->roots[2];
    for (int32_t l = 0; lattice->slit && l < lattice->levels; l++) {
        const double half = ldexp(1.0, lattice->levels - l - 1), reach = (double)lattice->reach[l];
        const double length = fmin(2.0 * reach / half, (double)cells_along(lattice, 0, l + 1));
        const double height = fmin(((double)lattice->knot[2] + reach) / half, (double)cells_along(lattice, 2, l + 1));
        cells += length * height * (double)cells_along(lattice, 1, l + 1);
    }
    return 12.0 * cells;
}

ShvStatus shv_lattice_mesh(ShvMesh *mesh, ShvMemory *memory, const ShvLattice *lattice, ShvError *error)
{
    *mesh = (ShvMesh){0};
    double places = 2.0;
    for (int axis = 0; axis < 3; axis++) places *= 2.0 * (double)cells_along(lattice, axis, lattice->levels) + 1.0;
    if (places > 0x1p63)
        return shv_fail(
            error, SHV_BAD_INPUT,
            "the smallest elements are too small for a body of this size; choose a longer edge at the notch");
    Sink counter = {.lattice = lattice, .error = error};
    add_cells(&counter);
    ShvNodeTable nodes;
    SHV_TRY(shv_node_table_create(&nodes, memory, error));
    ShvMesh made;
    ShvStatus status = shv_mesh_allocate(&made, memory, 0, counter.count, error);
    if (status == SHV_OK) {
        Sink sink = {.lattice = lattice, .nodes = &nodes, .elements = made.elements, .error = error};
        add_cells(&sink);
        status = sink.status;
    }
    if (status == SHV_OK) status = shv_node_table_take(&nodes, &made, error);
    shv_node_table_release(&nodes);
    if (status != SHV_OK) {
        shv_mesh_release(&made);
        return status;
    }
    *mesh = made;
    return SHV_OK;
}
