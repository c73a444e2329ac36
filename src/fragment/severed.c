#include "fragment/severed.h"

/* A node from which the search starts. Floods that meet become one, named by the root of its seeds. */
typedef struct Seed {
    int32_t node;
    int32_t parent; /* towards the root of the flood */
    int32_t
        knot; /* towards the root of the knot: seeds that hung together before, and still do if the floods of it that can go on
                       are one */
    int32_t head, tail; /* of a flood: nodes whose neighbours it has not looked at yet, −1: none is left */
    bool ended;         /* of a flood: it is all of a part that has come off */
    bool open;          /* of a flood: it has something to find yet */
} Seed;

typedef struct Search {
    ShvFragments *fragments;
    const ShvState *state;
    Seed *seeds;
    int32_t count;
    int32_t visited; /* nodes, in fragments->label */
    bool changed;    /* floods have met or ended: who is open must be found again */
} Search;

static int32_t flood_of(Seed *seeds, int32_t seed)
{
    while (seeds[seed].parent != seed) seed = seeds[seed].parent = seeds[seeds[seed].parent].parent;
    return seed;
}

static int32_t knot_of(Seed *seeds, int32_t seed)
{
    while (seeds[seed].knot != seed) seed = seeds[seed].knot = seeds[seeds[seed].knot].knot;
    return seed;
}

static void tie(Seed *seeds, int32_t a, int32_t b)
{
    seeds[knot_of(seeds, a)].knot = knot_of(seeds, b);
}

/* ---- floods ---- */

/* `root` of the scratch arrays links the nodes that wait. */
static void reach(Search *search, int32_t flood, int32_t node)
{
    Seed *seed = &search->seeds[flood];
    search->fragments->found[node] = flood + 1;
    search->fragments->label[search->visited++] = node;
    search->fragments->root[node] = -1;
    if (seed->tail >= 0)
        search->fragments->root[seed->tail] = node;
    else
        seed->head = node;
    seed->tail = node;
}

static int32_t meet(Search *search, int32_t flood, int32_t other)
{
    Seed *into = &search->seeds[flood], *from = &search->seeds[other];
    from->parent = flood;
    if (from->head >= 0) {
        if (into->tail >= 0)
            search->fragments->root[into->tail] = from->head;
        else
            into->head = from->head;
        into->tail = from->tail;
    }
    search->changed = true;
    return flood;
}

static void spread_to(Search *search, int32_t flood, int32_t next)
{
    const int32_t found = search->fragments->found[next];
    if (found == 0)
        reach(search, flood, next);
    else if (found != flood + 1 && flood_of(search->seeds, found - 1) != flood)
        meet(search, flood, flood_of(search->seeds, found - 1));
}

/* The neighbours of one node that waits: in its tets, and across the bonded facets at it. */
static void spread(Search *search, int32_t flood)
{
    const ShvState *state = search->state;
    Seed *seed = &search->seeds[flood];
    const int32_t node = seed->head;
    seed->head = search->fragments->root[node];
    if (seed->head < 0) seed->tail = -1;
    const int32_t *corners = state->corners + state->corner_start[node];
    for (int32_t i = 0; i < state->corner_count[node]; i++) {
        const int32_t element = corners[i] / 4, corner = corners[i] % 4;
        for (int32_t a = 0; a < 4; a++) {
            spread_to(search, flood, shv_state_node(state, element, a));
            const int32_t other = a == corner ? -1 : shv_fragments_bonded_neighbour(search->fragments, element, a);
            if (other >= 0) spread_to(search, flood, shv_state_node(state, other, 0));
        }
    }
}

/* What hung together through a part that has come off must find each other without it. */
static void end(Search *search, int32_t flood)
{
    Seed *seeds = search->seeds;
    int32_t first = -1;
    seeds[flood].ended = search->changed = true;
    for (int32_t i = 0; i < search->count; i++) {
        if (flood_of(seeds, i) != flood) continue;
        if (first < 0)
            first = i;
        else
            tie(seeds, i, first);
    }
}

/* A flood is open while another of one of its knots can go on. Seeds are few: this is done again whenever floods meet or
   end. `work`: per seed the flood that was met first in its knot; then the open floods, whose number is returned. */
static int32_t find_open(Search *search, int32_t *work)
{
    Seed *seeds = search->seeds;
    for (int32_t i = 0; i < search->count; i++) {
        work[i] = -1;
        seeds[i].open = false;
    }
    for (int32_t i = 0; i < search->count; i++) {
        const int32_t flood = flood_of(seeds, i), knot = knot_of(seeds, i);
        if (seeds[flood].ended) continue;
        if (work[knot] < 0) work[knot] = flood;
        if (work[knot] != flood) seeds[flood].open = seeds[work[knot]].open = true;
    }
    int32_t count = 0;
    for (int32_t i = 0; i < search->count; i++)
        if (seeds[i].open) work[count++] = i;
    search->changed = false;
    return count;
}

/* All open floods in turn, a node each: none goes much farther than the smallest that ends. */
static void flood_all(Search *search, int32_t *work)
{
    int32_t open = find_open(search, work);
    while (open > 0) {
        for (int32_t k = 0; k < open; k++) {
            const Seed *seed = &search->seeds[work[k]];
            if (seed->parent != work[k]) continue; /* it has met another */
            if (seed->head >= 0)
                spread(search, work[k]);
            else
                end(search, work[k]);
        }
        if (search->changed) open = find_open(search, work);
    }
}

/* ---- the whole ---- */

static int32_t seed_of(Search *search, int32_t node)
{
    if (search->fragments->found[node] > 0) return search->fragments->found[node] - 1;
    const int32_t index = search->count++;
    search->seeds[index] = (Seed){.node = node, .parent = index, .knot = index, .head = -1, .tail = -1};
    reach(search, index, node);
    return index;
}

static bool belongs(const ShvState *state, int32_t node, int32_t fragment)
{
    return state->element_fragment[state->corners[state->corner_start[node]] / 4] == fragment;
}

static int32_t plant(Search *search, int32_t fragment, int32_t first_copy)
{
    int32_t copies = 0;
    for (int32_t node = first_copy; node < search->state->node_count; node++) {
        if (!belongs(search->state, node, fragment)) continue;
        const int32_t from = seed_of(search, shv_state_split_from(search->state, node));
        tie(search->seeds, seed_of(search, node), from);
        copies++;
    }
    return copies;
}

/* Both sides of a facet that bonds no more hung together through it. */
static void plant_failed(Search *search, int32_t fragment, const ShvConnectivityChange *change)
{
    const ShvCohesive *cohesive = search->fragments->bonds;
    for (int32_t i = 0; i < change->failed_count; i++) {
        const int32_t *elements = cohesive->sides[change->failed[i]].elements;
        if (search->state->element_fragment[elements[0]] != fragment) continue;
        const int32_t first = seed_of(search, shv_state_node(search->state, elements[0], 0));
        tie(search->seeds, seed_of(search, shv_state_node(search->state, elements[1], 0)), first);
    }
}

/* Floods that ended get their numbers, the others are forgotten. */
static void number(Search *search, int32_t *number_of, ShvSevered *severed)
{
    ShvFragments *fragments = search->fragments;
    for (int32_t i = 0; i < search->count; i++)
        number_of[i] = search->seeds[i].parent == i && search->seeds[i].ended ? ++severed->count : 0;
    for (int32_t k = 0; k < search->visited; k++) {
        const int32_t node = fragments->label[k];
        const int32_t part = number_of[flood_of(search->seeds, fragments->found[node] - 1)];
        fragments->found[node] = part;
        if (part > 0) fragments->label[severed->node_count++] = node;
    }
}

ShvStatus shv_severed_find(ShvFragments *fragments, const ShvState *state, int32_t fragment,
                           const ShvConnectivityChange *change, ShvSevered *severed, ShvError *error)
{
    const size_t most = 2 * ((size_t)(state->node_count - change->first_copy) + (size_t)change->failed_count);
    Search search = {.fragments = fragments, .state = state};
    *severed = (ShvSevered){0};
    search.seeds = shv_allocate(fragments->memory, SHV_PART_RIGID, most, sizeof *search.seeds);
    int32_t *of_seed = shv_allocate(fragments->memory, SHV_PART_RIGID, most, sizeof *of_seed);
    const bool room = search.seeds && of_seed;
    if (room) {
        severed->copies = plant(&search, fragment, change->first_copy);
        plant_failed(&search, fragment, change);
        flood_all(&search, of_seed);
        number(&search, of_seed, severed);
    }
    shv_release(search.seeds);
    shv_release(of_seed);
    return room ? SHV_OK : shv_fail_memory(error, "the parts of a fragment", most * (sizeof(Seed) + sizeof(int32_t)));
}

void shv_severed_clear(ShvFragments *fragments, const ShvSevered *severed)
{
    for (int32_t k = 0; k < severed->node_count; k++) fragments->found[fragments->label[k]] = 0;
}
