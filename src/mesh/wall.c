#include "mesh/wall.h"

#include <math.h>

#include "mesh/tet.h"

/* A wall is thinner than so many edges: with more it is too stiff by less than a sixth. */
static const double most_edges = 3.0;
/* Cosine between its two surfaces: they are parallel but for 30°. */
static const double parallel = 0.866;
/* Of (L/t)², fitted to strips of four meshes within 20 %. */
static const double excess = 1.3;
/* Of (L/t)⁴ with smoothed edges, fitted to panes on five meshes within 12 %. */
static const double smoothed_excess = 0.055;
/* Where a ray starts on a face, by its corners: not in the middle, where it would meet the node in the middle of a prism. */
static const double start_share[3] = {0.5, 0.3, 0.2};
/* Tets on the way through a wall; one that takes more is none. */
enum { MOST_TETS = 64 };

/* A line from a face of the surface straight into the body. */
typedef struct Ray {
    const ShvMesh *mesh;
    const ShvAdjacency *adjacency;
    ShvVec3 start, direction; /* of unit length */
} Ray;

static ShvTet tet_of(const ShvMesh *mesh, int32_t element)
{
    return shv_tet_of_nodes(mesh, mesh->elements + 4 * (int64_t)element);
}

/* The face by which it leaves a tet, and how far from its start. */
static int leave(const Ray *ray, int32_t element, double *distance)
{
    const ShvTet tet = tet_of(ray->mesh, element);
    int through = 0;
    *distance = (double)INFINITY;
    for (int face = 0; face < 4; face++) {
        const double along = shv_dot(tet.normals[face], ray->direction);
        if (!(along > 0.0)) continue;
        const ShvVec3 on_face = tet.corners[shv_face_corners[face][0]];
        const double here = shv_dot(tet.normals[face], shv_sub(on_face, ray->start)) / along;
        if (here >= *distance) continue;
        *distance = here;
        through = face;
    }
    return through;
}

/* The facet of the surface where it comes out, −1 where that is too far away. */
static int32_t follow(const Ray *ray, int32_t element, double farthest, double *distance)
{
    for (int count = 0; count < MOST_TETS; count++) {
        const int face = leave(ray, element, distance);
        const int32_t facet = ray->adjacency->element_facets[4 * (int64_t)element + face];
        if (!(*distance < farthest)) return -1;
        if (facet >= ray->adjacency->interior_count) return facet;
        const int32_t *sides = ray->adjacency->facet_elements + 2 * (int64_t)facet;
        element = sides[0] == element ? sides[1] : sides[0];
    }
    return -1;
}

/* Thickness below a facet of the surface, a face of a tet; 0 where no wall is. */
static double thickness_at(const ShvMesh *mesh, const ShvAdjacency *adjacency, int32_t facet, const ShvTet *tet,
                           double edge)
{
    const int face = adjacency->facet_faces[2 * (int64_t)facet];
    Ray ray = {mesh, adjacency, shv_vec3(0.0, 0.0, 0.0), shv_scale(tet->normals[face], -1.0 / tet->areas[face])};
    double thickness;
    for (int i = 0; i < 3; i++)
        ray.start = shv_madd(ray.start, start_share[i], tet->corners[shv_face_corners[face][i]]);
    const int32_t exit = follow(&ray, adjacency->facet_elements[2 * (int64_t)facet], most_edges * edge, &thickness);
    if (exit < 0) return 0.0;
    const ShvTet far = tet_of(mesh, adjacency->facet_elements[2 * (int64_t)exit]);
    const int other = adjacency->facet_faces[2 * (int64_t)exit];
    return shv_dot(far.normals[other], ray.direction) > parallel * far.areas[other] ? thickness : 0.0;
}

ShvWall shv_mesh_wall(const ShvMesh *mesh, const ShvAdjacency *adjacency, int32_t begin, int32_t end)
{
    double surface = 0.0, walls = 0.0, thickness = 0.0, edges = 0.0;
    for (int32_t facet = adjacency->interior_count; facet < adjacency->facet_count; facet++) {
        const int32_t element = adjacency->facet_elements[2 * (int64_t)facet];
        if (element < begin || element >= end) continue;
        const ShvTet tet = tet_of(mesh, element);
        const double area = tet.areas[adjacency->facet_faces[2 * (int64_t)facet]];
        const double edge = sqrt(4.0 / sqrt(3.0) * area), here = thickness_at(mesh, adjacency, facet, &tet, edge);
        surface += area;
        if (!(here > 0.0)) continue;
        walls += area;
        thickness += area * here;
        edges += area * edge;
    }
    if (!(walls > 0.0)) return (ShvWall){0};
    return (ShvWall){.share = walls / surface, .thickness = thickness / walls, .edge = edges / walls};
}

double shv_wall_stiffness(const ShvWall *wall, bool smoothed)
{
    const double ratio = wall->thickness > 0.0 ? wall->edge / wall->thickness : 0.0, square = ratio * ratio;
    return 1.0 + (smoothed ? smoothed_excess * square : excess) * square;
}
