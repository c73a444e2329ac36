#include "mesh/draft.h"

#include <stdio.h>
#include <stdlib.h>

void shv_draft_release(ShvDraft *draft)
{
    shv_release(draft->tags);
    shv_release(draft->positions);
    shv_release(draft->tets);
    shv_release(draft->groups);
    *draft = (ShvDraft){0};
}

static int64_t larger(int64_t capacity)
{
    return capacity ? 2 * capacity : 64;
}

ShvStatus shv_draft_add_node(ShvDraft *draft, int64_t tag, ShvVec3 position, ShvError *error)
{
    if (draft->node_count == draft->node_capacity) {
        const int64_t capacity = larger(draft->node_capacity);
        int64_t *tags = shv_reallocate(draft->memory, SHV_PART_GENERAL, draft->tags, (size_t)capacity, sizeof *tags);
        if (tags) draft->tags = tags;
        double *positions =
            shv_reallocate(draft->memory, SHV_PART_GENERAL, draft->positions, (size_t)capacity, 3 * sizeof *positions);
        if (positions) draft->positions = positions;
        if (!tags || !positions) return shv_fail_memory(error, "the nodes of a mesh file", (size_t)capacity * 32);
        draft->node_capacity = capacity;
    }
    draft->tags[draft->node_count] = tag;
    shv_store3(draft->positions + 3 * draft->node_count, position);
    draft->node_count++;
    return SHV_OK;
}

ShvStatus shv_draft_add_tet(ShvDraft *draft, const ShvDraftTet *tet, ShvError *error)
{
    if (draft->tet_count == draft->tet_capacity) {
        const int64_t capacity = larger(draft->tet_capacity);
        ShvDraftTet *tets =
            shv_reallocate(draft->memory, SHV_PART_GENERAL, draft->tets, (size_t)capacity, sizeof *tets);
        if (!tets) return shv_fail_memory(error, "the tets of a mesh file", (size_t)capacity * sizeof *tets);
        draft->tets = tets;
        draft->tet_capacity = capacity;
    }
    draft->tets[draft->tet_count++] = *tet;
    return SHV_OK;
}

/* There are few: one more at a time. */
ShvStatus shv_draft_add_group(ShvDraft *draft, const ShvMeshGroup *group, ShvError *error)
{
    const size_t count = (size_t)draft->group_count + 1;
    ShvMeshGroup *groups = shv_reallocate(draft->memory, SHV_PART_MESH, draft->groups, count, sizeof *groups);
    if (!groups) return shv_fail_memory(error, "the groups of a mesh file", count * sizeof *groups);
    draft->groups = groups;
    draft->groups[draft->group_count++] = *group;
    return SHV_OK;
}

static ShvStatus fail_at_tet(const ShvDraft *draft, const ShvDraftTet *tet, const char *trouble, ShvError *error)
{
    if (draft->binary)
        return shv_fail(error, SHV_BAD_INPUT, "%s: at byte %lld: tet %lld %s", draft->path, (long long)tet->place,
                        (long long)tet->tag, trouble);
    return shv_fail(error, SHV_BAD_INPUT, "%s:%lld: tet %lld %s", draft->path, (long long)tet->place,
                    (long long)tet->tag, trouble);
}

/* Tag → position in the file. */
typedef struct Tagged {
    int64_t tag, node;
} Tagged;
typedef struct Lookup {
    Tagged *sorted; /* NULL where the tags are consecutive from `first` */
    int64_t first, count;
} Lookup;

static int by_tag(const void *a, const void *b)
{
    const int64_t p = ((const Tagged *)a)->tag, q = ((const Tagged *)b)->tag;
    return (p > q) - (p < q);
}

static ShvStatus make_lookup(Lookup *lookup, const ShvDraft *draft, ShvError *error)
{
    *lookup = (Lookup){.first = draft->node_count ? draft->tags[0] : 0, .count = draft->node_count};
    int64_t consecutive = 0;
    while (consecutive < lookup->count && draft->tags[consecutive] - consecutive == lookup->first) consecutive++;
    if (consecutive == lookup->count) return SHV_OK;
    lookup->sorted = shv_allocate(draft->memory, SHV_PART_GENERAL, (size_t)lookup->count, sizeof *lookup->sorted);
    if (!lookup->sorted)
        return shv_fail_memory(error, "the node tags of a mesh file", (size_t)lookup->count * sizeof *lookup->sorted);
    for (int64_t i = 0; i < lookup->count; i++) lookup->sorted[i] = (Tagged){draft->tags[i], i};
    qsort(lookup->sorted, (size_t)lookup->count, sizeof *lookup->sorted, by_tag);
    for (int64_t i = 1; i < lookup->count; i++)
        if (lookup->sorted[i].tag == lookup->sorted[i - 1].tag)
            return shv_fail(error, SHV_BAD_INPUT, "%s: node %lld is given twice; renumber the nodes", draft->path,
                            (long long)lookup->sorted[i].tag);
    return SHV_OK;
}

/* The node's position in the file, or −1. */
static int64_t look_up(const Lookup *lookup, int64_t tag)
{
    if (!lookup->sorted) return tag >= lookup->first && tag - lookup->first < lookup->count ? tag - lookup->first : -1;
    const Tagged key = {tag, 0};
    const Tagged *found = bsearch(&key, lookup->sorted, (size_t)lookup->count, sizeof key, by_tag);
    return found ? found->node : -1;
}

/* Replaces the tags of every tet by positions in the file. */
static ShvStatus resolve_tags(ShvDraft *draft, const Lookup *lookup, ShvError *error)
{
    for (int64_t e = 0; e < draft->tet_count; e++) {
        ShvDraftTet *tet = &draft->tets[e];
        for (int k = 0; k < 4; k++) {
            char trouble[80];
            const int64_t tag = tet->nodes[k];
            tet->nodes[k] = look_up(lookup, tag);
            if (tet->nodes[k] < 0) {
                snprintf(trouble, sizeof trouble, "uses node %lld, which the file does not give", (long long)tag);
                return fail_at_tet(draft, tet, trouble, error);
            }
            for (int j = 0; j < k; j++)
                if (tet->nodes[j] == tet->nodes[k]) {
                    snprintf(trouble, sizeof trouble, "uses node %lld twice", (long long)tag);
                    return fail_at_tet(draft, tet, trouble, error);
                }
        }
    }
    return SHV_OK;
}

static ShvStatus refuse_bad_volume(const ShvDraft *draft, ShvError *error)
{
    for (int64_t e = 0; e < draft->tet_count; e++) {
        const ShvDraftTet *tet = &draft->tets[e];
        ShvVec3 x[4];
        for (int k = 0; k < 4; k++) x[k] = shv_load3(draft->positions + 3 * tet->nodes[k]);
        double longest = 0.0;
        for (int k = 1; k < 4; k++)
            for (int j = 0; j < k; j++) longest = fmax(longest, shv_norm(shv_sub(x[k], x[j])));
        const double volume = shv_dot(shv_cross(shv_sub(x[1], x[0]), shv_sub(x[2], x[0])), shv_sub(x[3], x[0])) / 6.0;
        if (volume < -1e-15 * longest * longest * longest)
            return fail_at_tet(draft, tet, "is inverted (negative volume): swap two of its nodes", error);
        if (!(volume > 1e-15 * longest * longest * longest))
            return fail_at_tet(draft, tet, "has no volume: its nodes lie in one plane", error);
    }
    return SHV_OK;
}

/* `numbers` (zeroed, a file position each) becomes the new number + 1 of every node a tet uses. */
static int64_t number_used(const ShvDraft *draft, int32_t *numbers)
{
    for (int64_t e = 0; e < draft->tet_count; e++)
        for (int k = 0; k < 4; k++) numbers[draft->tets[e].nodes[k]] = 1;
    int32_t used = 0;
    for (int64_t i = 0; i < draft->node_count; i++)
        if (numbers[i]) numbers[i] = ++used;
    return used;
}

static ShvStatus fill_mesh(const ShvDraft *draft, ShvMesh *mesh, ShvError *error)
{
    int32_t *numbers = shv_allocate(draft->memory, SHV_PART_GENERAL, (size_t)draft->node_count, sizeof *numbers);
    if (!numbers)
        return shv_fail_memory(error, "the nodes of a mesh file", (size_t)draft->node_count * sizeof *numbers);
    const ShvStatus status =
        shv_mesh_allocate(mesh, draft->memory, number_used(draft, numbers), draft->tet_count, error);
    if (status == SHV_OK) {
        for (int64_t i = 0; i < draft->node_count; i++)
            if (numbers[i])
                shv_store3(mesh->positions + 3 * (int64_t)(numbers[i] - 1), shv_load3(draft->positions + 3 * i));
        for (int64_t e = 0; e < draft->tet_count; e++)
            for (int k = 0; k < 4; k++) mesh->elements[4 * e + k] = numbers[draft->tets[e].nodes[k]] - 1;
    }
    shv_release(numbers);
    return status;
}

/* The mesh takes the draft's groups over where any of its tets is in one. */
static ShvStatus fill_groups(ShvDraft *draft, ShvMesh *mesh, ShvError *error)
{
    bool any = false;
    for (int64_t e = 0; e < draft->tet_count && !any; e++) any = draft->tets[e].group != 0;
    if (!any) return SHV_OK;
    SHV_TRY(shv_mesh_add_groups(mesh, error));
    for (int64_t e = 0; e < draft->tet_count; e++) mesh->element_groups[e] = draft->tets[e].group;
    mesh->groups = draft->groups;
    mesh->group_count = draft->group_count;
    draft->groups = NULL;
    return SHV_OK;
}

ShvStatus shv_draft_finish(ShvDraft *draft, ShvMesh *mesh, ShvError *error)
{
    *mesh = (ShvMesh){0};
    if (draft->tet_count == 0)
        return shv_fail(error, SHV_BAD_INPUT,
                        "%s: there are no tets in the file; mesh the volume, not only its surface", draft->path);
    if (draft->node_count > INT32_MAX)
        return shv_fail(error, SHV_BAD_INPUT, "%s: more than %d nodes; use a coarser mesh", draft->path, INT32_MAX);
    Lookup lookup;
    ShvStatus status = make_lookup(&lookup, draft, error);
    if (status == SHV_OK) status = resolve_tags(draft, &lookup, error);
    shv_release(lookup.sorted);
    if (status == SHV_OK) status = refuse_bad_volume(draft, error);
    if (status == SHV_OK) status = fill_mesh(draft, mesh, error);
    if (status == SHV_OK) status = fill_groups(draft, mesh, error);
    if (status != SHV_OK) shv_mesh_release(mesh);
    return status;
}
