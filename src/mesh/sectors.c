#include "mesh/sectors.h"

#include "base/deterministic.h"
#include "mesh/tet.h"

/* The icosahedron: vertices (0, ±1, ±φ) and cyclic shifts, before scaling to unit length. */
static const double golden = 1.6180339887498948482;
static const int8_t vertex_signs[12][3] = {{0, -1, -1}, {0, -1, 1}, {0, 1, -1},  {0, 1, 1},  {-1, -1, 0}, {-1, 1, 0},
                                           {1, -1, 0},  {1, 1, 0},  {-1, 0, -1}, {1, 0, -1}, {-1, 0, 1},  {1, 0, 1}};
/* Angle between neighbouring vertices, arctan 2. */
static const double vertex_angle = 1.1071487177940905030;

/* Edges (lower vertex first) and faces (increasing vertices) of the icosahedron, found from the vertices' distances. */
typedef struct Icosahedron {
    ShvVec3 vertices[12];
    int edges[30][2], edge_of[12][12];
    int faces[20][3];
} Icosahedron;

static bool are_neighbours(const Icosahedron *ico, int a, int b)
{
    /* Cosines between vertices are ±1 and ±1/√5. */
    const double cosine = shv_dot(ico->vertices[a], ico->vertices[b]);
    return cosine > 0.4 && cosine < 0.5;
}

static Icosahedron make_icosahedron(void)
{
    Icosahedron ico;
    for (int v = 0; v < 12; v++) {
        double x[3];
        for (int i = 0; i < 3; i++) {
            /* (0, ±1, ±φ), (±1, ±φ, 0), (±φ, 0, ±1): φ stands two places after the zero. */
            const bool long_axis = vertex_signs[v][(i + 1) % 3] == 0;
            x[i] = vertex_signs[v][i] * (long_axis ? golden : 1.0);
        }
        ico.vertices[v] = shv_unit(shv_load3(x));
    }
    int edge = 0, face = 0;
    for (int a = 0; a < 12; a++)
        for (int b = a + 1; b < 12; b++) {
            if (!are_neighbours(&ico, a, b)) continue;
            ico.edges[edge][0] = a;
            ico.edges[edge][1] = b;
            ico.edge_of[a][b] = edge++;
            for (int c = b + 1; c < 12; c++) {
                if (!are_neighbours(&ico, a, c) || !are_neighbours(&ico, b, c)) continue;
                ico.faces[face][0] = a;
                ico.faces[face][1] = b;
                ico.faces[face++][2] = c;
            }
        }
    return ico;
}

/* ---- numbering: layer after layer; in a layer the 12 vertices, then 30 edges of k − 1 nodes, then 20 faces ---- */

static int64_t nodes_below(int64_t layer)
{
    /* Σ (10 j² + 2) for 1 ≤ j < layer, and the centre. */
    return layer == 0 ? 0 : 1 + 10 * ((layer - 1) * layer * (2 * layer - 1) / 6) + 2 * (layer - 1);
}

/* Node of a face at whole weights w (sum k) of its three vertices. */
static int32_t node_at(const ShvSectors *s, const Icosahedron *ico, int face, const int32_t w[3])
{
    const int64_t k = (int64_t)w[0] + w[1] + w[2], base = nodes_below(k) - nodes_below(s->first);
    const int *v = ico->faces[face];
    if (k == 0) return (int32_t)base;
    for (int i = 0; i < 3; i++)
        if (w[i] == k) return (int32_t)(base + v[i]);
    for (int i = 0; i < 3; i++)
        if (w[i] == 0) {
            const int a = i == 0 ? 1 : 0, b = i == 2 ? 1 : 2;
            return (int32_t)(base + 12 + ico->edge_of[v[a]][v[b]] * (k - 1) + w[b] - 1);
        }
    /* Rows of equal w[2] have k − w[2] − 1 nodes. */
    const int64_t before = (int64_t)(w[2] - 1) * (k - 1) - (int64_t)w[2] * (w[2] - 1) / 2;
    return (int32_t)(base + 12 + 30 * (k - 1) + face * ((k - 1) * (k - 2) / 2) + before + w[1] - 1);
}

/* ---- positions ---- */

/* Direction at weights w of the vertices of a face: Σ sin(wᵢ θ / k) vᵢ. Along an edge that is the great circle at equal
   steps; inside, nodes are spread more evenly than by projecting the flat face. */
static ShvVec3 direction_at(const Icosahedron *ico, int face, const int32_t w[3], const double *sines)
{
    ShvVec3 sum = {0};
    for (int i = 0; i < 3; i++) sum = shv_madd(sum, sines[w[i]], ico->vertices[ico->faces[face][i]]);
    return shv_unit(sum);
}

static void place_layer(ShvMesh *mesh, const ShvSectors *s, const Icosahedron *ico, int32_t k, double *sines)
{
    for (int32_t t = 0; t <= k; t++) sines[t] = k > 0 ? shv_sin(vertex_angle * (double)t / (double)k) : 0.0;
    const double share = (double)(k - s->first) / (double)(s->last - s->first);
    const double radius = s->inner_radius * (1.0 - share) + s->outer_radius * share;
    int32_t w[3];
    for (int face = 0; face < 20; face++)
        for (w[0] = 0; w[0] <= k; w[0]++)
            for (w[1] = 0; w[0] + w[1] <= k; w[1]++) {
                w[2] = k - w[0] - w[1];
                const int64_t node = node_at(s, ico, face, w);
                shv_store3(mesh->positions + 3 * node, shv_scale(direction_at(ico, face, w, sines), radius));
            }
}

/* ---- elements ---- */

/* What the planes of constant sum cut from the cube of weights w … w + 1: a tet at the low corner, an octahedron, a tet
   at the high corner. Each by its corners' bits (1: first weight + 1, …); of the octahedron, i + 3 is opposite i. */
typedef struct Piece {
    int corners[6];
    bool octahedron;
    int32_t sum; /* of the corner nearest to the centre of the ball, above that of w */
} Piece;
static const Piece pieces[3] = {{{0, 1, 2, 4}, false, 0}, {{1, 2, 4, 6, 5, 3}, true, 1}, {{7, 3, 5, 6}, false, 2}};

/* Four tets around the diagonal whose worst tet is best. */
static void add_octahedron(ShvMesh *mesh, int64_t *count, const int32_t n[6])
{
    static const uint8_t rings[3][4] = {{1, 2, 4, 5}, {2, 0, 5, 3}, {0, 1, 3, 4}};
    int best = 0;
    double best_aspect = -1.0;
    for (int d = 0; d < 3; d++) {
        double worst = 2.0;
        for (int i = 0; i < 4; i++) {
            const ShvTet tet =
                shv_tet_of_nodes(mesh, (const int32_t[4]){n[d], n[d + 3], n[rings[d][i]], n[rings[d][(i + 1) % 4]]});
            worst = fmin(worst, fabs(shv_tet_aspect(&tet)));
        }
        if (worst <= best_aspect) continue;
        best_aspect = worst;
        best = d;
    }
    for (int i = 0; i < 4; i++)
        shv_tet_write(mesh, (*count)++,
                      (const int32_t[4]){n[best], n[best + 3], n[rings[best][i]], n[rings[best][(i + 1) % 4]]});
}

static void add_piece(ShvMesh *mesh, int64_t *count, const ShvSectors *s, const Icosahedron *ico, int face,
                      const int32_t w[3], const Piece *piece)
{
    int32_t n[6];
    for (int i = 0; i < (piece->octahedron ? 6 : 4); i++) {
        const int bits = piece->corners[i];
        n[i] = node_at(s, ico, face, (const int32_t[3]){w[0] + (bits & 1), w[1] + (bits >> 1 & 1), w[2] + (bits >> 2)});
    }
    if (piece->octahedron)
        add_octahedron(mesh, count, n);
    else
        shv_tet_write(mesh, (*count)++, n);
}

/* Everything of one face between layers k and k + 1. */
static void add_pieces(ShvMesh *mesh, int64_t *count, const ShvSectors *s, const Icosahedron *ico, int face, int32_t k)
{
    for (int p = 0; p < 3; p++) {
        const int32_t sum = k - pieces[p].sum;
        for (int32_t a = 0; a <= sum; a++)
            for (int32_t b = 0; a + b <= sum; b++)
                add_piece(mesh, count, s, ico, face, (const int32_t[3]){a, b, sum - a - b}, &pieces[p]);
    }
}

static double tets_below(double layer)
{
    return 20.0 * layer * layer * layer;
}

double shv_sectors_count(const ShvSectors *sectors)
{
    return tets_below((double)sectors->last) - tets_below((double)sectors->first);
}

ShvStatus shv_sectors_mesh(ShvMesh *mesh, ShvMemory *memory, const ShvSectors *sectors, ShvError *error)
{
    const int64_t nodes = nodes_below((int64_t)sectors->last + 1) - nodes_below(sectors->first);
    *mesh = (ShvMesh){0};
    double *sines = shv_allocate(memory, SHV_PART_GENERAL, (size_t)sectors->last + 1, sizeof *sines);
    if (!sines) return shv_fail_memory(error, "a mesh", ((size_t)sectors->last + 1) * sizeof *sines);
    const ShvStatus status = shv_mesh_allocate(mesh, memory, nodes, (int64_t)shv_sectors_count(sectors), error);
    if (status == SHV_OK) {
        const Icosahedron ico = make_icosahedron();
        for (int32_t k = sectors->first; k <= sectors->last; k++) place_layer(mesh, sectors, &ico, k, sines);
        int64_t count = 0;
        for (int32_t k = sectors->first; k < sectors->last; k++)
            for (int face = 0; face < 20; face++) add_pieces(mesh, &count, sectors, &ico, face, k);
    }
    shv_release(sines);
    return status;
}
