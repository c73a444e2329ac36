#include "evaluate/crack_surface.h"

#include <stdbool.h>
#include <stdlib.h>

#include "base/deterministic.h"
#include "base/hash.h"
#include "shape/triangle.h"

/* ---- which facets ---- */

/* The face opposite to a corner. */
static const int faces[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};

static int compare_nodes(const double a[3], const double b[3])
{
    for (int i = 0; i < 3; i++)
        if (a[i] != b[i]) return a[i] < b[i] ? -1 : 1;
    return 0;
}

static int compare_facets(const void *first, const void *second)
{
    const ShvCrackFacet *a = first, *b = second;
    return compare_nodes(a->nodes, b->nodes);
}

static void swap_descending(int32_t *a, int32_t *b)
{
    const int32_t low = *a < *b ? *a : *b;
    *b = *a < *b ? *b : *a;
    *a = low;
}

static ShvCrackFacet facet_of(const ShvMeshView *mesh, int64_t element, int face)
{
    ShvCrackFacet facet;
    int32_t nodes[3];
    for (int i = 0; i < 3; i++) nodes[i] = mesh->elements[4 * element + faces[face][i]];
    for (int i = 0; i < 3; i++) swap_descending(&nodes[i % 2], &nodes[i % 2 + 1]);
    for (int i = 0; i < 3; i++) {
        facet.nodes[i] = nodes[i];
        facet.corners[i] = shv_load3(mesh->positions + 3 * (int64_t)nodes[i]);
    }
    return facet;
}

/* Both sides of a failed facet show it, and one stays; the outside of the mesh has one side. Returns how many stay. */
static int32_t keep_one_of_two(ShvCrackFacet *facets, int32_t count)
{
    int32_t kept = 0;
    for (int32_t i = 1; i < count; i++)
        if (compare_nodes(facets[i].nodes, facets[i - 1].nodes) == 0) facets[kept++] = facets[i];
    return kept;
}

static uint64_t hash_of(const ShvMeshView *mesh)
{
    const uint64_t hash = shv_hash_bytes(SHV_HASH_START, mesh->positions, 24 * (size_t)mesh->node_count);
    return shv_hash_bytes(hash, mesh->elements, 16 * (size_t)mesh->element_count);
}

ShvCrackSurface shv_crack_surface(const ShvMeshView *mesh, const uint8_t *bonds, ShvPool *pool)
{
    const int64_t slots = 4 * (int64_t)mesh->element_count;
    size_t most = 1;
    int32_t count = 0;
    for (int64_t i = 0; i < slots; i++) most += !bonds[i];
    ShvCrackFacet *facets = shv_pool_take(pool, most, sizeof *facets);
    for (int64_t i = 0; i < slots && facets; i++)
        if (!bonds[i]) facets[count++] = facet_of(mesh, i / 4, (int)(i % 4));
    if (count > 1) qsort(facets, (size_t)count, sizeof *facets, compare_facets);
    return (ShvCrackSurface){hash_of(mesh), facets, facets ? keep_one_of_two(facets, count) : 0};
}

/* ---- overlap ---- */

static double area_of(const ShvCrackFacet *facet)
{
    return 0.5 * shv_norm(shv_cross(shv_sub(facet->corners[1], facet->corners[0]),
                                    shv_sub(facet->corners[2], facet->corners[0])));
}

double shv_crack_overlap(const ShvCrackSurface *a, const ShvCrackSurface *b)
{
    double both = 0.0, any = 0.0;
    int32_t i = 0, k = 0;
    if (a->mesh != b->mesh || a->mesh == 0) return (double)NAN;
    while (i < a->count || k < b->count) {
        const int order = i == a->count   ? 1
                          : k == b->count ? -1
                                          : compare_nodes(a->facets[i].nodes, b->facets[k].nodes);
        const double area = area_of(order <= 0 ? &a->facets[i] : &b->facets[k]);
        any += area;
        if (order == 0) both += area;
        i += order <= 0;
        k += order >= 0;
    }
    return any > 0.0 ? both / any : 1.0;
}

/* ---- distance ---- */

static ShvVec3 centroid(const ShvCrackFacet *facet)
{
    return shv_scale(shv_add(shv_add(facet->corners[0], facet->corners[1]), facet->corners[2]), 1.0 / 3.0);
}

/* Largest distance of a corner from the centroid: the facet lies in this ball. */
static double reach(const ShvCrackFacet *facet)
{
    const ShvVec3 middle = centroid(facet);
    double largest = 0.0;
    for (int i = 0; i < 3; i++) largest = fmax(largest, shv_norm(shv_sub(facet->corners[i], middle)));
    return largest;
}

/* Brute force but for a check of the balls around the facets. */
static double distance_to_surface(ShvVec3 point, const ShvCrackSurface *surface)
{
    double nearest = HUGE_VAL;
    for (int32_t i = 0; i < surface->count; i++) {
        const ShvCrackFacet *facet = &surface->facets[i];
        if (shv_norm(shv_sub(point, centroid(facet))) - reach(facet) >= nearest) continue;
        const ShvVec3 corners[3] = {facet->corners[0], facet->corners[1], facet->corners[2]};
        nearest = fmin(nearest, shv_norm(shv_sub(point, shv_triangle_closest(point, corners).point)));
    }
    return nearest;
}

/* The mean gives each of a facet's seven points the weight by which a quadratic is integrated exactly or better: 3/60 corners,
   8/60 midpoints, 27/60 centroid (Zienkiewicz and Taylor, The Finite Element Method, table of triangles, cubic order). */
static ShvCrackDistance one_way(const ShvCrackSurface *from, const ShvCrackSurface *to)
{
    ShvCrackDistance distance = {0.0, 0.0};
    double whole = 0.0;
    for (int32_t i = 0; i < from->count; i++) {
        const ShvCrackFacet *facet = &from->facets[i];
        double sum = 0.0;
        for (int k = 0; k < 7; k++) {
            const ShvVec3 corner = facet->corners[k % 3], next = facet->corners[(k + 1) % 3];
            const ShvVec3 point = k < 3 ? corner : k < 6 ? shv_scale(shv_add(corner, next), 0.5) : centroid(facet);
            const double nearest = distance_to_surface(point, to);
            distance.largest = fmax(distance.largest, nearest);
            sum += nearest * (k < 3 ? 3.0 : k < 6 ? 8.0 : 27.0) / 60.0;
        }
        distance.mean += sum * area_of(facet);
        whole += area_of(facet);
    }
    distance.mean /= whole;
    return distance;
}

ShvCrackDistance shv_crack_distance(const ShvCrackSurface *a, const ShvCrackSurface *b)
{
    const bool known = a->mesh != 0 && b->mesh != 0;
    if (known && a->count == 0 && b->count == 0) return (ShvCrackDistance){0.0, 0.0};
    if (!known || a->count == 0 || b->count == 0) return (ShvCrackDistance){(double)NAN, (double)NAN};
    const ShvCrackDistance there = one_way(a, b), back = one_way(b, a);
    return (ShvCrackDistance){fmax(there.largest, back.largest), fmax(there.mean, back.mean)};
}

/* ---- arms of a star ---- */

enum { DIRECTIONS = 3600 }; /* a tenth of a degree, a fortieth of an edge at ten edges from the axis */

static void mark_crossing(ShvVec3 a, ShvVec3 b, double radius, bool *crossed)
{
    if ((hypot(a.x, a.y) < radius) == (hypot(b.x, b.y) < radius)) return;
    const double turn = atan2(a.y + b.y, a.x + b.x) / (2.0 * SHV_PI) + 0.5;
    crossed[(int)(turn * DIRECTIONS) % DIRECTIONS] = true;
}

/* How far it is to the next direction that is crossed. */
static int next_crossing(const bool *crossed, int from)
{
    int way = 1;
    while (!crossed[(from + way) % DIRECTIONS]) way++;
    return way;
}

int32_t shv_crack_arms(const ShvVec3 *corners, int64_t count, double radius, double gap)
{
    bool crossed[DIRECTIONS] = {false};
    int32_t arms = 0;
    for (int64_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) mark_crossing(corners[3 * i + k], corners[3 * i + (k + 1) % 3], radius, crossed);
    for (int i = 0; i < DIRECTIONS; i++)
        arms += crossed[i] && next_crossing(crossed, i) * 2.0 * SHV_PI * radius > gap * DIRECTIONS;
    return arms;
}
