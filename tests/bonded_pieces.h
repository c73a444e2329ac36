/* Pieces by bonds, found from nothing but the reference mesh and the flags of its facets. */
#ifndef SHV_TESTS_BONDED_PIECES_H
#define SHV_TESTS_BONDED_PIECES_H

#include <stdlib.h>

#include "check.h"

#include "shiver/simulation.h"

typedef struct BondedFace {
    int32_t nodes[3], slot; /* element × 4 + face */
} BondedFace;

static inline int by_nodes_of_face(const void *a, const void *b)
{
    const BondedFace *x = a, *y = b;
    for (int i = 0; i < 3; i++)
        if (x->nodes[i] != y->nodes[i]) return x->nodes[i] < y->nodes[i] ? -1 : 1;
    return (x->slot > y->slot) - (x->slot < y->slot);
}

static inline BondedFace bonded_face(const ShvMeshView *mesh, int32_t slot)
{
    BondedFace face = {.slot = slot};
    for (int a = 0, k = 0; a < 4; a++)
        if (a != slot % 4) face.nodes[k++] = mesh->elements[4 * (slot / 4) + a];
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2; k++)
            if (face.nodes[k] > face.nodes[k + 1]) {
                const int32_t swapped = face.nodes[k];
                face.nodes[k] = face.nodes[k + 1];
                face.nodes[k + 1] = swapped;
            }
    return face;
}

static inline int32_t root_of_piece(int32_t *root, int32_t e)
{
    while (root[e] != e) e = root[e] = root[root[e]];
    return e;
}

/* Every fragment is one component, and no two share one; returns how many there are. */
static inline int32_t check_bonded_pieces(const ShvMeshView *mesh, const int32_t *fragment, const uint8_t *bonds)
{
    const int32_t count = mesh->element_count;
    BondedFace *faces = malloc(4 * (size_t)count * sizeof *faces);
    int32_t *root = malloc((size_t)count * sizeof *root), *name = malloc((size_t)count * sizeof *name), pieces = 0;
    assert_true(faces && root && name);
    for (int32_t slot = 0; slot < 4 * count; slot++) faces[slot] = bonded_face(mesh, slot);
    qsort(faces, 4 * (size_t)count, sizeof *faces, by_nodes_of_face);
    for (int32_t e = 0; e < count; e++) root[e] = e;
    for (int32_t k = 1; k < 4 * count; k++) {
        const BondedFace *a = &faces[k - 1], *b = &faces[k];
        if (memcmp(a->nodes, b->nodes, sizeof a->nodes) != 0) continue;
        assert_int_equal(bonds[a->slot], bonds[b->slot]);
        if (bonds[a->slot]) root[root_of_piece(root, a->slot / 4)] = root_of_piece(root, b->slot / 4);
    }
    for (int32_t e = 0; e < count; e++) name[e] = -1;
    for (int32_t e = 0; e < count; e++) {
        const int32_t r = root_of_piece(root, e);
        pieces += name[r] < 0;
        if (name[r] < 0) name[r] = fragment[e];
        assert_int_equal(name[r], fragment[e]);
    }
    free(faces);
    free(root);
    free(name);
    return pieces;
}

#endif
