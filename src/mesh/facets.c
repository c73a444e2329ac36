#include "mesh/facets.h"

/* One face of one element: its two larger nodes (the smallest one is the bucket's) and the slot 4 e + k. */
typedef struct Face {
    int32_t middle, largest, slot;
} Face;

static void sort3(int32_t nodes[3])
{
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < 2; i++)
            if (nodes[i] > nodes[i + 1]) {
                const int32_t swap = nodes[i];
                nodes[i] = nodes[i + 1];
                nodes[i + 1] = swap;
            }
}

static void face_nodes(const ShvMesh *mesh, int32_t slot, int32_t nodes[3])
{
    const int32_t *corners = mesh->elements + 4 * (int64_t)(slot / 4);
    for (int i = 0; i < 3; i++) nodes[i] = corners[shv_face_corners[slot % 4][i]];
}

/* 1 when the face runs through its nodes in a cyclic shift of increasing order, 0 when in decreasing order. */
static int face_parity(const ShvMesh *mesh, int32_t slot)
{
    int32_t n[3];
    face_nodes(mesh, slot, n);
    return (n[0] < n[1]) + (n[1] < n[2]) + (n[2] < n[0]) == 2;
}

/* Faces into buckets of equal smallest node, in increasing order of slot within a bucket: start[n] … start[n + 1] − 1. */
static void fill_buckets(const ShvMesh *mesh, int32_t *start, Face *faces)
{
    const int32_t slots = 4 * mesh->element_count;
    int32_t n[3];
    for (int32_t slot = 0; slot < slots; slot++) {
        face_nodes(mesh, slot, n);
        const int32_t low = n[0] < n[1] ? n[0] : n[1];
        start[(low < n[2] ? low : n[2]) + 2]++;
    }
    for (int32_t i = 2; i < mesh->node_count + 2; i++) start[i] += start[i - 1];
    for (int32_t slot = 0; slot < slots; slot++) {
        face_nodes(mesh, slot, n);
        sort3(n);
        faces[start[n[0] + 1]++] = (Face){n[1], n[2], slot};
    }
}

static int face_after(Face a, Face b)
{
    if (a.middle != b.middle) return a.middle > b.middle;
    if (a.largest != b.largest) return a.largest > b.largest;
    return a.slot > b.slot;
}

static void sift_down(Face *faces, int32_t root, int32_t count)
{
    for (int32_t child; (child = 2 * root + 1) < count; root = child) {
        if (child + 1 < count && face_after(faces[child + 1], faces[child])) child++;
        if (!face_after(faces[child], faces[root])) return;
        const Face swap = faces[root];
        faces[root] = faces[child];
        faces[child] = swap;
    }
}

/* Buckets are short (a few dozen faces) save in hostile meshes, where a node may hold all of them. */
static void sort_bucket(Face *faces, int32_t count)
{
    if (count > 256) {
        for (int32_t root = count / 2; root-- > 0;) sift_down(faces, root, count);
        for (int32_t last = count - 1; last > 0; last--) {
            const Face swap = faces[0];
            faces[0] = faces[last];
            faces[last] = swap;
            sift_down(faces, 0, last);
        }
        return;
    }
    for (int32_t i = 1; i < count; i++) {
        const Face face = faces[i];
        int32_t j = i;
        for (; j > 0 && face_after(faces[j - 1], face); j--) faces[j] = faces[j - 1];
        faces[j] = face;
    }
}

static void note(ShvFacetFinding *finding, ShvFacetFault fault, int32_t smallest, const Face *face, const Face *other)
{
    const int32_t element = face->slot / 4;
    if (finding->fault != SHV_FACET_SOUND && finding->element <= element) return;
    *finding = (ShvFacetFinding){fault, element, other->slot / 4, {smallest, face->middle, face->largest}};
}

/* Judges `count` faces of equal nodes, in increasing order of element. */
static void judge(const ShvMesh *mesh, const Face *faces, int32_t count, int32_t smallest, ShvFacetFinding *finding)
{
    for (int32_t i = 1; i < count; i++) {
        const int32_t *apex = mesh->elements;
        if (apex[faces[i].slot] == apex[faces[i - 1].slot])
            note(finding, SHV_FACET_DUPLICATE_ELEMENT, smallest, &faces[i], &faces[i - 1]);
        else if (apex[faces[i].slot] == apex[faces[0].slot])
            note(finding, SHV_FACET_DUPLICATE_ELEMENT, smallest, &faces[i], &faces[0]);
        else if (i >= 2)
            note(finding, SHV_FACET_CROWDED, smallest, &faces[i], &faces[0]);
        else if (face_parity(mesh, faces[i].slot) == face_parity(mesh, faces[0].slot))
            note(finding, SHV_FACET_OVERLAP, smallest, &faces[i], &faces[0]);
    }
}

static void match_bucket(const ShvMesh *mesh, Face *faces, int32_t count, int32_t smallest, int32_t *mates,
                         ShvFacetFinding *finding)
{
    sort_bucket(faces, count);
    for (int32_t first = 0, next; first < count; first = next) {
        for (next = first + 1;
             next < count && faces[next].middle == faces[first].middle && faces[next].largest == faces[first].largest;)
            next++;
        if (next - first < 2) continue;
        mates[faces[first].slot] = faces[first + 1].slot;
        mates[faces[first + 1].slot] = faces[first].slot;
        if (finding) judge(mesh, faces + first, next - first, smallest, finding);
    }
}

ShvStatus shv_facet_mates(const ShvMesh *mesh, int32_t **mates, ShvFacetFinding *finding, ShvError *error)
{
    const size_t slots = 4 * (size_t)mesh->element_count, nodes = (size_t)mesh->node_count;
    if (finding) *finding = (ShvFacetFinding){0};
    *mates = shv_allocate(mesh->memory, SHV_PART_GENERAL, slots, sizeof **mates);
    int32_t *start = shv_allocate(mesh->memory, SHV_PART_GENERAL, nodes + 2, sizeof *start);
    Face *faces = shv_allocate(mesh->memory, SHV_PART_GENERAL, slots, sizeof *faces);
    const int complete = *mates && start && faces;
    if (complete) {
        fill_buckets(mesh, start, faces);
        for (size_t slot = 0; slot < slots; slot++) (*mates)[slot] = -1;
        for (int32_t n = 0; n < mesh->node_count; n++)
            match_bucket(mesh, faces + start[n], start[n + 1] - start[n], n, *mates, finding);
    } else {
        shv_release(*mates);
        *mates = NULL;
    }
    shv_release(start);
    shv_release(faces);
    return complete ? SHV_OK : shv_fail_memory(error, "the facets of a mesh", slots * (sizeof **mates + sizeof *faces));
}

ShvStatus shv_boundary_faces(const ShvMesh *mesh, ShvMemory *memory, ShvPart part, int32_t **faces, int32_t *count,
                             ShvError *error)
{
    int32_t *mates;
    *faces = NULL;
    *count = 0;
    SHV_TRY(shv_facet_mates(mesh, &mates, NULL, error));
    const int32_t slots = 4 * mesh->element_count;
    for (int32_t k = 0; k < slots; k++) *count += mates[k] < 0;
    *faces = shv_allocate(memory, part, (size_t)*count, sizeof **faces);
    int32_t end = 0;
    for (int32_t k = 0; *faces && k < slots; k++)
        if (mates[k] < 0) (*faces)[end++] = k;
    shv_release(mates);
    return *faces ? SHV_OK : shv_fail_memory(error, "the boundary of a mesh", (size_t)*count * sizeof **faces);
}
