#include "view/hulls.h"

#include <string.h>

#include "base/memory.h"

/* Tets whose pieces are made in all: some four seconds. What is left out lived between an object and its last pieces. */
static const int64_t MOST_TETS = 1500000;

typedef struct Maker {
    ShvHulls *hulls;
    const ShvPieces *mesh;
    int32_t fragment_count, element_count, node_count;
    uint8_t *within; /* of each fragment: it is the one that is made, or comes from it */
    int32_t *label;  /* of each node: its number in the fragment, −1: none */
    int32_t *tets;   /* of the fragment */
    int64_t budget;
} Maker;

/* Lists the tets of a fragment and labels their nodes; returns how many tets, and *node_count nodes. */
static int32_t list_tets(Maker *maker, int32_t fragment, int32_t *node_count)
{
    const ShvPieces *mesh = maker->mesh;
    int32_t tets = 0, nodes = 0;
    memset(maker->label, -1, (size_t)maker->node_count * sizeof *maker->label);
    for (int32_t i = 0; i < maker->fragment_count; i++) {
        const int32_t parent = mesh->fragments[i].parent;
        maker->within[i] = i == fragment || (parent >= 0 && parent < i && maker->within[parent]);
    }
    for (int32_t t = 0; t < maker->element_count; t++) {
        if (!maker->within[mesh->owner[t]]) continue;
        maker->tets[tets++] = t;
        for (int k = 0; k < 4; k++) {
            int32_t *label = &maker->label[mesh->elements[4 * (int64_t)t + k]];
            if (*label < 0) *label = nodes++;
        }
    }
    *node_count = nodes;
    return tets;
}

static void fill(const Maker *maker, const double *centre, ShvFragmentTets *tets)
{
    const ShvPieces *mesh = maker->mesh;
    for (int32_t t = 0; t < tets->tet_count; t++)
        for (int k = 0; k < 4; k++) {
            const int32_t node = mesh->elements[4 * (int64_t)maker->tets[t] + k], label = maker->label[node];
            tets->tets[4 * (int64_t)t + k] = label;
            for (int c = 0; c < 3; c++)
                tets->positions[3 * (int64_t)label + c] = mesh->reference[3 * (int64_t)node + c] - centre[c];
        }
    shv_fragment_tets_measure(tets);
}

static ShvStatus add(Maker *maker, int32_t fragment, ShvError *error)
{
    ShvHulls *hulls = maker->hulls;
    ShvFragmentHulls *item = &hulls->items[hulls->count];
    ShvFragmentTets tets;
    int32_t nodes;
    const int32_t count = list_tets(maker, fragment, &nodes);
    maker->budget -= count;
    if (count == 0 || maker->budget < 0) return SHV_OK;
    SHV_TRY(shv_fragment_tets_allocate(&tets, nodes, count, hulls->memory, error));
    fill(maker, maker->mesh->fragments[fragment].reference_centre, &tets);
    item->fragment = fragment;
    const ShvStatus status = shv_convex_pieces_of_tets(&item->pieces, &tets, hulls->memory, error);
    shv_fragment_tets_release(&tets);
    hulls->count += status == SHV_OK;
    return status;
}

/* First what is seen longest: what there was at the start, and what is left at the end. */
static ShvStatus add_all(Maker *maker, const ShvLines *lines, ShvError *error)
{
    for (int pass = 0; pass < 2; pass++)
        for (int32_t i = 0; i < maker->fragment_count && maker->budget > 0; i++) {
            const bool first = maker->mesh->fragments[i].parent < 0 || lines->index[i] >= 0;
            if (first == (pass == 0)) SHV_TRY(add(maker, i, error));
        }
    return SHV_OK;
}

ShvStatus shv_hulls_create(ShvHulls *hulls, const ShvLines *lines, struct ShvMemory *memory, ShvError *error)
{
    const ShvRunFileInfo *info = shv_run_file_info(lines->pieces.file);
    const size_t fragments = (size_t)info->fragment_count, tets = (size_t)info->element_count;
    *hulls = (ShvHulls){.memory = memory};
    Maker maker = {hulls, &lines->pieces, info->fragment_count, info->element_count, info->node_count, NULL, NULL,
                   NULL,  MOST_TETS};
    hulls->items = shv_allocate(memory, SHV_PART_RECORD, fragments, sizeof *hulls->items);
    maker.within = shv_allocate(memory, SHV_PART_RECORD, fragments, 1);
    maker.label = shv_allocate(memory, SHV_PART_RECORD, (size_t)info->node_count, sizeof(int32_t));
    maker.tets = shv_allocate(memory, SHV_PART_RECORD, tets, sizeof(int32_t));
    const bool room = hulls->items && maker.within && maker.label && maker.tets;
    const ShvStatus status = room ? add_all(&maker, lines, error) : shv_fail_memory(error, "convex pieces", 8 * tets);
    shv_release(maker.within);
    shv_release(maker.label);
    shv_release(maker.tets);
    return status;
}

void shv_hulls_release(ShvHulls *hulls)
{
    for (int32_t i = 0; i < hulls->count; i++) shv_convex_pieces_release(&hulls->items[i].pieces);
    shv_release(hulls->items);
    *hulls = (ShvHulls){.memory = NULL};
}
