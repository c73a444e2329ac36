#include "base/deterministic.h"
#include "mesh/tet.h"

static void add_edges(ShvMeshQuality *q, const ShvTet *t)
{
    for (int i = 0; i < 4; i++)
        for (int j = i + 1; j < 4; j++) {
            const double length = shv_norm(shv_sub(t->corners[i], t->corners[j]));
            q->mean_edge += length;
            q->shortest_edge = fmin(q->shortest_edge, length);
            q->longest_edge = fmax(q->longest_edge, length);
        }
}

/* The dihedral angle between two faces is π minus the angle between their outward normals. */
static void add_cosines(double *smallest, double *largest, const ShvTet *t)
{
    for (int i = 0; i < 4; i++)
        for (int j = i + 1; j < 4; j++) {
            const double cosine = -shv_dot(t->normals[i], t->normals[j]) / (t->areas[i] * t->areas[j]);
            *smallest = fmin(*smallest, cosine);
            *largest = fmax(*largest, cosine);
        }
}

static void add_altitudes(ShvMeshQuality *q, const ShvTet *t, int32_t element)
{
    for (int k = 0; k < 4; k++) {
        const double altitude = 3.0 * t->volume / t->areas[k];
        if (altitude >= q->smallest_altitude) continue;
        q->smallest_altitude = altitude;
        q->smallest_altitude_element = element;
    }
}

static void add_aspect(ShvMeshQuality *q, const ShvTet *t, int32_t element)
{
    const double aspect = shv_tet_aspect(t);
    q->mean_aspect += aspect;
    if (aspect >= q->worst_aspect) return;
    q->worst_aspect = aspect;
    q->worst_element = element;
}

ShvMeshQuality shv_mesh_quality(const ShvMesh *mesh)
{
    ShvMeshQuality q = {.node_count = mesh->node_count, .element_count = mesh->element_count};
    if (mesh->element_count == 0) return q;
    q.shortest_edge = q.smallest_altitude = q.worst_aspect = HUGE_VAL;
    double smallest_cosine = 1.0, largest_cosine = -1.0;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        const ShvTet t = shv_tet_of_nodes(mesh, mesh->elements + 4 * (int64_t)e);
        q.volume += t.volume;
        add_aspect(&q, &t, e);
        add_edges(&q, &t);
        add_cosines(&smallest_cosine, &largest_cosine, &t);
        add_altitudes(&q, &t, e);
    }
    q.mean_edge /= 6.0 * (double)mesh->element_count;
    q.mean_aspect /= (double)mesh->element_count;
    q.smallest_dihedral = 180.0 / SHV_PI * shv_acos(fmin(largest_cosine, 1.0));
    q.largest_dihedral = 180.0 / SHV_PI * shv_acos(fmax(smallest_cosine, -1.0));
    return q;
}
