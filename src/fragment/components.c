#include "base/disjoint_sets.h"
#include "base/sorted.h"
#include "fragment/fragment.h"
#include "fragment/severed.h"
#include "mesh/facets.h"

#include <string.h>

/* Workspace of one search, all in proportion to the fragment. */
typedef struct Parts {
    int32_t count;
    int32_t *element_part; /* per element of the fragment */
    int32_t *nodes;        /* its nodes, increasing */
    int32_t *node_part;    /* of each */
    int32_t node_count;
    int32_t *sorted; /* elements or nodes grouped by part; also the spare half of the sort */
    int32_t *element_counts, *node_counts;
} Parts;

static void release_parts(Parts *parts)
{
    shv_release(parts->element_part);
    shv_release(parts->nodes);
    shv_release(parts->node_part);
    shv_release(parts->sorted);
    shv_release(parts->element_counts);
    *parts = (Parts){0};
}

/* Bottom-up merge sort: node lists are nearly sorted, and the C library's sort may allocate. */
static void sort_increasing(int32_t *values, int32_t *spare, int32_t count)
{
    for (int64_t width = 1; width < count; width *= 2) {
        for (int64_t begin = 0; begin < count; begin += 2 * width) {
            const int64_t middle = begin + width < count ? begin + width : count;
            const int64_t end = begin + 2 * width < count ? begin + 2 * width : count;
            if (middle == end || values[middle - 1] <= values[middle]) continue;
            int64_t a = begin, b = middle;
            for (int64_t k = begin; k < end; k++)
                spare[k] = b == end || (a < middle && values[a] <= values[b]) ? values[a++] : values[b++];
            for (int64_t k = begin; k < end; k++) values[k] = spare[k];
        }
    }
}

enum { UNSEEN = -2, NO_PART = -1 };

static void collect_nodes(Parts *parts, ShvFragments *fragments, const ShvState *state, const int32_t *elements,
                          int32_t count)
{
    for (int32_t i = 0; i < count; i++)
        for (int32_t a = 0; a < 4; a++) fragments->label[shv_state_node(state, elements[i], a)] = UNSEEN;
    for (int32_t i = 0; i < count; i++)
        for (int32_t a = 0; a < 4; a++) {
            const int32_t node = shv_state_node(state, elements[i], a);
            if (fragments->label[node] != UNSEEN) continue;
            fragments->label[node] = NO_PART;
            fragments->root[node] = node;
            parts->nodes[parts->node_count++] = node;
        }
    sort_increasing(parts->nodes, parts->sorted, parts->node_count);
}

static ShvStatus reserve_parts(Parts *parts, const ShvFragments *fragments, int32_t elements, int64_t nodes,
                               ShvError *error)
{
    const size_t sorted = (size_t)(nodes > elements ? nodes : elements);
    *parts = (Parts){0};
    parts->element_part = shv_allocate(fragments->memory, SHV_PART_RIGID, (size_t)elements, sizeof(int32_t));
    parts->nodes = shv_allocate(fragments->memory, SHV_PART_RIGID, (size_t)nodes, sizeof(int32_t));
    parts->node_part = shv_allocate(fragments->memory, SHV_PART_RIGID, (size_t)nodes, sizeof(int32_t));
    parts->sorted = shv_allocate(fragments->memory, SHV_PART_RIGID, sorted, sizeof(int32_t));
    if (parts->element_part && parts->nodes && parts->node_part && parts->sorted) return SHV_OK;
    release_parts(parts);
    return shv_fail_memory(error, "the components of a fragment",
                           ((size_t)elements + 2 * (size_t)nodes + sorted) * sizeof(int32_t));
}

/* Where the entries of one part end that begin at `begin`: parts that have come off are small, so runs are long. */
static int32_t run_end(const int32_t *part_of, int32_t begin, int32_t count)
{
    int32_t end = begin + 1;
    while (end < count && part_of[end] == part_of[begin]) end++;
    return end;
}

static void count_entries(const int32_t *part_of, int32_t count, int32_t *counts)
{
    for (int32_t begin = 0, end = 0; begin < count; begin = end) {
        end = run_end(part_of, begin, count);
        counts[part_of[begin]] += end - begin;
    }
}

/* How many elements and nodes each part has. */
static ShvStatus count_parts(Parts *parts, const ShvFragments *fragments, int32_t elements, ShvError *error)
{
    parts->element_counts = shv_allocate(fragments->memory, SHV_PART_RIGID, 2 * (size_t)parts->count, sizeof(int32_t));
    if (!parts->element_counts) {
        const size_t bytes = 2 * (size_t)parts->count * sizeof(int32_t);
        release_parts(parts);
        return shv_fail_memory(error, "the components of a fragment", bytes);
    }
    parts->node_counts = parts->element_counts + parts->count;
    count_entries(parts->element_part, elements, parts->element_counts);
    count_entries(parts->node_part, parts->node_count, parts->node_counts);
    return SHV_OK;
}

int32_t shv_fragments_bonded_neighbour(const ShvFragments *fragments, int32_t element, int32_t face)
{
    const ShvCohesive *cohesive = fragments->bonds;
    if (!cohesive) return -1;
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    const int64_t facet = adjacency->element_facets[4 * (int64_t)element + face];
    if (facet >= adjacency->interior_count) return -1;
    const int32_t index = cohesive->facet_cohesive[facet];
    if (index < 0 || !cohesive->bonded[index]) return -1;
    const int32_t *sides = adjacency->facet_elements + 2 * facet;
    return sides[0] == element ? sides[1] : sides[0];
}

/* Joins all tets of a fragment through shared nodes and bonds. */
static void join_all(int32_t *root, const ShvFragments *fragments, const ShvState *state, const int32_t *elements,
                     int32_t count)
{
    for (int32_t i = 0; i < count; i++) {
        const int32_t first = shv_state_node(state, elements[i], 0);
        for (int32_t a = 1; a < 4; a++) shv_set_join(root, first, shv_state_node(state, elements[i], a));
        for (int32_t face = 0; face < 4; face++) {
            const int32_t other = shv_fragments_bonded_neighbour(fragments, elements[i], face);
            if (other > elements[i]) shv_set_join(root, first, shv_state_node(state, other, 0));
        }
    }
}

ShvStatus shv_fragments_count_at(ShvFragments *fragments, const ShvCohesive *cohesive, const ShvState *state,
                                 double limit, int32_t *count, ShvError *error)
{
    int32_t *root = shv_allocate(fragments->memory, SHV_PART_RIGID, (size_t)state->element_count, sizeof *root);
    if (!root) return shv_fail_memory(error, "the pieces of a time", (size_t)state->element_count * sizeof *root);
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    for (int32_t e = 0; e < state->element_count; e++) root[e] = e;
    for (int64_t facet = 0; facet < adjacency->interior_count; facet++) {
        const int32_t index = cohesive->facet_cohesive[facet], *sides = adjacency->facet_elements + 2 * facet;
        const bool bonds = index < 0 || cohesive->bonded[index];
        if (bonds && (index < 0 || limit <= SHV_BOND_SHARE || shv_cohesive_residual(cohesive, index) > limit))
            shv_set_join(root, sides[0], sides[1]);
    }
    *count = 0;
    for (int32_t e = 0; e < state->element_count; e++) *count += root[e] == e;
    shv_release(root);
    return SHV_OK;
}

/* Components, numbered by their lowest element. */
static ShvStatus find_parts(Parts *parts, ShvFragments *fragments, const ShvState *state, const int32_t *elements,
                            int32_t count, ShvError *error)
{
    SHV_TRY(reserve_parts(parts, fragments, count, 4 * (int64_t)count, error));
    collect_nodes(parts, fragments, state, elements, count);
    join_all(fragments->root, fragments, state, elements, count);
    for (int32_t i = 0; i < count; i++) {
        const int32_t root = shv_set_root(fragments->root, shv_state_node(state, elements[i], 0));
        if (fragments->label[root] == NO_PART) fragments->label[root] = parts->count++;
        parts->element_part[i] = fragments->label[root];
    }
    for (int32_t i = 0; i < parts->node_count; i++)
        parts->node_part[i] = fragments->label[shv_set_root(fragments->root, parts->nodes[i])];
    return count_parts(parts, fragments, count, error);
}

/* The part of each element: all are of the rest but those at the nodes that have come off. */
static void mark_severed(Parts *parts, const ShvFragments *fragments, const ShvState *state,
                         const ShvFragment *fragment, const ShvSevered *severed)
{
    const int32_t *elements = fragments->elements + fragment->element_begin;
    memset(parts->element_part, 0, (size_t)fragment->element_count * sizeof *parts->element_part);
    for (int32_t k = 0; k < severed->node_count; k++) {
        const int32_t node = fragments->label[k], *corners = state->corners + state->corner_start[node];
        for (int32_t i = 0; i < state->corner_count[node]; i++)
            parts->element_part[shv_sorted_place(elements, fragment->element_count, corners[i] / 4)] =
                fragments->found[node];
    }
}

/* The same from what has come off: `found` says for each node of it which part it is of, 0 the rest. The node list goes on,
   copies have the highest numbers. */
static ShvStatus name_parts(Parts *parts, const ShvFragments *fragments, const ShvState *state,
                            const ShvFragment *fragment, const ShvSevered *severed, int32_t first_copy, int32_t *number,
                            ShvError *error)
{
    SHV_TRY(reserve_parts(parts, fragments, fragment->element_count, (int64_t)fragment->node_count + severed->copies,
                          error));
    mark_severed(parts, fragments, state, fragment, severed);
    for (int32_t k = 0; k <= severed->count; k++) number[k] = NO_PART;
    for (int32_t begin = 0, end = 0; begin < fragment->element_count; begin = end) {
        end = run_end(parts->element_part, begin, fragment->element_count);
        const int32_t found = parts->element_part[begin];
        if (number[found] == NO_PART) number[found] = parts->count++;
        for (int32_t i = begin; i < end; i++) parts->element_part[i] = number[found];
    }
    parts->node_count = fragment->node_count;
    memcpy(parts->nodes, fragments->nodes + fragment->node_begin, (size_t)parts->node_count * sizeof *parts->nodes);
    for (int32_t node = first_copy; parts->node_count < fragment->node_count + severed->copies; node++)
        if (state->element_fragment[state->corners[state->corner_start[node]] / 4] == fragment->id)
            parts->nodes[parts->node_count++] = node;
    for (int32_t i = 0; i < parts->node_count; i++) parts->node_part[i] = number[fragments->found[parts->nodes[i]]];
    return count_parts(parts, fragments, fragment->element_count, error);
}

static ShvStatus find_severed_parts(Parts *parts, const ShvFragments *fragments, const ShvState *state,
                                    const ShvFragment *fragment, const ShvSevered *severed, int32_t first_copy,
                                    ShvError *error)
{
    int32_t *number = shv_allocate(fragments->memory, SHV_PART_RIGID, (size_t)severed->count + 1, sizeof *number);
    if (!number) return shv_fail_memory(error, "the components of a fragment", 4 * ((size_t)severed->count + 1));
    const ShvStatus status = name_parts(parts, fragments, state, fragment, severed, first_copy, number, error);
    shv_release(number);
    return status;
}

static ShvStatus reserve_scratch(ShvFragments *fragments, const ShvState *state, ShvError *error)
{
    if (state->node_count <= fragments->scratch_capacity) return SHV_OK;
    const int32_t capacity = state->node_capacity > state->node_count ? state->node_capacity : state->node_count;
    const size_t count = (size_t)capacity, bytes = count * sizeof(int32_t);
    SHV_RESIZE(fragments->memory, SHV_PART_RIGID, fragments->root, count, "the node labels of fragments", bytes, error);
    SHV_RESIZE(fragments->memory, SHV_PART_RIGID, fragments->label, count, "the node labels of fragments", bytes,
               error);
    SHV_RESIZE(fragments->memory, SHV_PART_RIGID, fragments->found, count, "the node labels of fragments", bytes,
               error);
    fragments->scratch_capacity = capacity;
    return SHV_OK;
}

static ShvStatus reserve_items(ShvFragments *fragments, int32_t more, ShvError *error)
{
    const int64_t wanted = (int64_t)fragments->count + more;
    if (wanted <= fragments->capacity) return SHV_OK;
    if (wanted > INT32_MAX / 2)
        return shv_fail(error, SHV_UNSUPPORTED, "More than %d fragments: use a coarser mesh or a stronger material.",
                        INT32_MAX / 2);
    const int64_t capacity = wanted + wanted / 2;
    SHV_RESIZE(fragments->memory, SHV_PART_RIGID, fragments->items, (size_t)capacity, "the fragments",
               (size_t)capacity * sizeof *fragments->items, error);
    fragments->capacity = (int32_t)capacity;
    return SHV_OK;
}

/* Room for `more` list entries: the lists of the living are copied to a new block with as much free room as they take,
   so that the copying costs a constant share of what is appended. */
static ShvStatus reserve_nodes(ShvFragments *fragments, int32_t more, ShvError *error)
{
    if ((int64_t)fragments->node_end + more <= fragments->node_capacity) return SHV_OK;
    int64_t living = 0;
    for (int32_t f = 0; f < fragments->count; f++)
        if (fragments->items[f].mode != SHV_MODE_DEAD) living += fragments->items[f].node_count;
    const int64_t capacity = 2 * (living + more);
    if (capacity > INT32_MAX)
        return shv_fail(error, SHV_UNSUPPORTED, "The fragments have too many nodes: use a coarser mesh.");
    int32_t *nodes = shv_allocate(fragments->memory, SHV_PART_RIGID, (size_t)capacity, sizeof(int32_t));
    if (!nodes) return shv_fail_memory(error, "the node lists of fragments", (size_t)capacity * sizeof(int32_t));
    int32_t end = 0;
    for (int32_t f = 0; f < fragments->count; f++) {
        ShvFragment *fragment = &fragments->items[f];
        if (fragment->mode == SHV_MODE_DEAD) continue;
        for (int32_t i = 0; i < fragment->node_count; i++) nodes[end + i] = fragments->nodes[fragment->node_begin + i];
        fragment->node_begin = end;
        end += fragment->node_count;
    }
    shv_release(fragments->nodes);
    fragments->nodes = nodes;
    fragments->node_capacity = (int32_t)capacity;
    fragments->node_end = end;
    return SHV_OK;
}

/* Entries grouped by part, in their order within a part; `counts` becomes the begins. */
static void group(const int32_t *values, int32_t count, int32_t *counts, int32_t parts, const int32_t *part_of,
                  int32_t *sorted)
{
    int32_t begin = 0;
    for (int32_t p = 0; p < parts; p++) {
        const int32_t size = counts[p];
        counts[p] = begin;
        begin += size;
    }
    for (int32_t from = 0, end = 0; from < count; from = end) {
        end = run_end(part_of, from, count);
        memcpy(sorted + counts[part_of[from]], values + from, (size_t)(end - from) * sizeof *values);
        counts[part_of[from]] += end - from;
    }
    for (int32_t p = parts - 1; p > 0; p--) counts[p] = counts[p - 1];
    if (parts > 0) counts[0] = 0;
}

static int32_t group_size(const int32_t *begins, int32_t part, int32_t parts, int32_t total)
{
    return (part + 1 < parts ? begins[part + 1] : total) - begins[part];
}

/* Rearranges the fragment's own range of elements and appends its node lists, by part. Room has been reserved. */
static void write_lists(ShvFragments *fragments, Parts *parts, int32_t element_begin, int32_t count)
{
    int32_t *elements = fragments->elements + element_begin;
    group(elements, count, parts->element_counts, parts->count, parts->element_part, parts->sorted);
    memcpy(elements, parts->sorted, (size_t)count * sizeof *elements);
    group(parts->nodes, parts->node_count, parts->node_counts, parts->count, parts->node_part,
          fragments->nodes + fragments->node_end);
}

/* Starts one fragment a part, from the template `like`. */
static void start_fragments(ShvFragments *fragments, const Parts *parts, const ShvModel *model, ShvState *state,
                            const ShvFragment *like, int32_t count)
{
    for (int32_t p = 0; p < parts->count; p++) {
        const int32_t id = fragments->count++;
        ShvFragment *fragment = &fragments->items[id];
        *fragment = *like;
        fragment->id = id;
        fragment->element_begin = like->element_begin + parts->element_counts[p];
        fragment->element_count = group_size(parts->element_counts, p, parts->count, count);
        fragment->node_begin = fragments->node_end + parts->node_counts[p];
        fragment->node_count = group_size(parts->node_counts, p, parts->count, parts->node_count);
        const int32_t *elements = fragments->elements + fragment->element_begin;
        for (int32_t i = 0; i < fragment->element_count; i++) state->element_fragment[elements[i]] = id;
        shv_fragment_measure(fragment, fragments, model, state);
        shv_fragment_fit(fragment, fragments, state);
        fragment->orientation = like->orientation;
        const ShvVec3 way = shv_sub(like->reference_centre, fragment->reference_centre);
        fragment->contact_arm = shv_add(like->contact_arm, way);
    }
    fragments->node_end += parts->node_count;
    fragments->alive += parts->count;
}

static int32_t object_of(const ShvModel *model, int32_t element)
{
    int32_t object = 0;
    while (object + 1 < model->object_count && element >= model->objects[object].element_end) object++;
    return object;
}

/* The surface of the whole mesh: where nothing breaks, it never changes. */
static ShvStatus mark_boundary(ShvFragments *fragments, const ShvModel *model, ShvError *error)
{
    int32_t *faces = NULL, count = 0;
    const size_t elements = (size_t)model->mesh.element_count;
    SHV_TRY(shv_boundary_faces(&model->mesh, fragments->memory, SHV_PART_RIGID, &faces, &count, error));
    fragments->boundary = shv_allocate(fragments->memory, SHV_PART_RIGID, elements, 1);
    for (int32_t i = 0; fragments->boundary && i < count; i++)
        fragments->boundary[faces[i] / 4] |= (uint8_t)(1u << (faces[i] % 4));
    shv_release(faces);
    return fragments->boundary ? SHV_OK : shv_fail_memory(error, "the surface of the mesh", elements);
}

static ShvStatus fill(ShvFragments *fragments, const ShvModel *model, ShvState *state, Parts *parts, ShvError *error)
{
    const int32_t count = state->element_count;
    fragments->elements = shv_allocate(fragments->memory, SHV_PART_RIGID, (size_t)count, sizeof(int32_t));
    if (!fragments->elements) return shv_fail_memory(error, "the fragments", (size_t)count * sizeof(int32_t));
    for (int32_t e = 0; e < count; e++) fragments->elements[e] = e;
    if (!model->can_break) SHV_TRY(mark_boundary(fragments, model, error));
    SHV_TRY(reserve_scratch(fragments, state, error));
    SHV_TRY(find_parts(parts, fragments, state, fragments->elements, count, error));
    SHV_TRY(reserve_items(fragments, parts->count, error));
    SHV_TRY(reserve_nodes(fragments, parts->node_count, error));
    write_lists(fragments, parts, 0, count);
    const ShvFragment like = {.parent = -1,
                              .birth = state->time,
                              .death = (double)NAN,
                              .mode = SHV_MODE_FLIGHT,
                              .orientation = shv_quat_identity(),
                              .last_insertion = state->time,
                              .strength = (double)INFINITY};
    start_fragments(fragments, parts, model, state, &like, count);
    for (int32_t f = 0; f < fragments->count; f++)
        fragments->items[f].object = object_of(model, fragments->elements[fragments->items[f].element_begin]);
    return SHV_OK;
}

ShvStatus shv_fragments_create(ShvFragments *fragments, const ShvModel *model, ShvState *state, ShvError *error)
{
    *fragments = (ShvFragments){.memory = model->memory};
    Parts parts = {0};
    const ShvStatus status = fill(fragments, model, state, &parts, error);
    release_parts(&parts);
    if (status != SHV_OK) shv_fragments_release(fragments);
    return status;
}

void shv_fragments_release(ShvFragments *fragments)
{
    shv_release(fragments->items);
    shv_release(fragments->elements);
    shv_release(fragments->nodes);
    shv_release(fragments->boundary);
    shv_release(fragments->root);
    shv_release(fragments->label);
    shv_release(fragments->found);
    *fragments = (ShvFragments){0};
}

static void refresh(ShvFragments *fragments, const Parts *parts, const ShvModel *model, const ShvState *state,
                    int32_t index)
{
    ShvFragment *fragment = &fragments->items[index];
    for (int32_t i = 0; i < parts->node_count; i++) fragments->nodes[fragments->node_end + i] = parts->nodes[i];
    fragment->node_begin = fragments->node_end;
    fragment->node_count = parts->node_count;
    fragments->node_end += parts->node_count;
    shv_fragment_measure(fragment, fragments, model, state);
}

/* The fragment dies and its parts start. */
static ShvStatus replace(ShvFragments *fragments, const ShvModel *model, ShvState *state, int32_t index, Parts *parts,
                         ShvError *error)
{
    const int32_t begin = fragments->items[index].element_begin, count = fragments->items[index].element_count;
    SHV_TRY(reserve_items(fragments, parts->count, error));
    SHV_TRY(reserve_nodes(fragments, parts->node_count, error));
    ShvFragment like = fragments->items[index];
    like.parent = index;
    like.birth = state->time;
    like.death = (double)NAN;
    like.last_approach = like.approach_severity = 0.0;
    like.load = like.borne = 0.0; /* what the whole has borne says nothing of its parts */
    fragments->items[index].mode = SHV_MODE_DEAD;
    fragments->items[index].death = state->time;
    fragments->items[index].node_count = 0;
    fragments->alive--;
    write_lists(fragments, parts, begin, count);
    start_fragments(fragments, parts, model, state, &like, count);
    return SHV_OK;
}

static ShvStatus split(ShvFragments *fragments, const ShvModel *model, ShvState *state, int32_t index, Parts *parts,
                       ShvError *error)
{
    const int32_t begin = fragments->items[index].element_begin, count = fragments->items[index].element_count;
    SHV_TRY(reserve_scratch(fragments, state, error));
    SHV_TRY(find_parts(parts, fragments, state, fragments->elements + begin, count, error));
    if (parts->count > 1) return replace(fragments, model, state, index, parts, error);
    SHV_TRY(reserve_nodes(fragments, parts->node_count, error));
    refresh(fragments, parts, model, state, index);
    return SHV_OK;
}

ShvStatus shv_fragments_split(ShvFragments *fragments, const ShvModel *model, ShvState *state, int32_t fragment,
                              int32_t *parts, ShvError *error)
{
    Parts found = {0};
    const ShvStatus status = split(fragments, model, state, fragment, &found, error);
    *parts = found.count;
    release_parts(&found);
    return status;
}

/* Nothing has come off: the fragment's list goes on with its copies. Masses of copies sum to their original's, in its
   place: centre and inertia stay. */
static ShvStatus extend(ShvFragments *fragments, const ShvState *state, int32_t index, int32_t first_copy,
                        int32_t copies, ShvError *error)
{
    ShvFragment *fragment = &fragments->items[index];
    if (copies == 0) return SHV_OK;
    const bool last = fragment->node_begin + fragment->node_count == fragments->node_end;
    SHV_TRY(reserve_nodes(fragments, copies + (last ? 0 : fragment->node_count), error));
    if (fragment->node_begin + fragment->node_count != fragments->node_end) {
        for (int32_t i = 0; i < fragment->node_count; i++)
            fragments->nodes[fragments->node_end + i] = fragments->nodes[fragment->node_begin + i];
        fragment->node_begin = fragments->node_end;
        fragments->node_end += fragment->node_count;
    }
    for (int32_t node = first_copy; node < state->node_count; node++) {
        if (state->element_fragment[state->corners[state->corner_start[node]] / 4] != index) continue;
        fragments->nodes[fragments->node_end++] = node;
        fragment->node_count++;
    }
    return SHV_OK;
}

ShvStatus shv_fragments_split_by(ShvFragments *fragments, const ShvModel *model, ShvState *state, int32_t fragment,
                                 const ShvConnectivityChange *change, int32_t *parts, ShvError *error)
{
    ShvSevered severed;
    Parts found = {0};
    *parts = 1;
    SHV_TRY(reserve_scratch(fragments, state, error));
    SHV_TRY(shv_severed_find(fragments, state, fragment, change, &severed, error));
    if (severed.count == 0) return extend(fragments, state, fragment, change->first_copy, severed.copies, error);
    ShvStatus status =
        find_severed_parts(&found, fragments, state, &fragments->items[fragment], &severed, change->first_copy, error);
    shv_severed_clear(fragments, &severed);
    if (status == SHV_OK) status = replace(fragments, model, state, fragment, &found, error);
    *parts = found.count;
    release_parts(&found);
    return status;
}
