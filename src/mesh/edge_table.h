/* Directed edges of triangles, found by their two nodes. Half-edge 3 t + k runs from corner k of triangle t to its next
   corner. */
#ifndef SHV_MESH_EDGE_TABLE_H
#define SHV_MESH_EDGE_TABLE_H

#include "base/memory.h"

typedef struct ShvEdgeTable {
    const int32_t *triangles; /* of the caller, 3 a triangle */
    int32_t *slots;           /* half-edge + 1; 0: free */
    uint64_t mask;
} ShvEdgeTable;

/* An empty table with room for `half_edges` entries. On failure the table is zeroed and owns nothing. */
ShvStatus shv_edge_table_create(ShvEdgeTable *table, ShvMemory *memory, const int32_t *triangles, int64_t half_edges,
                                ShvError *error);
void shv_edge_table_release(ShvEdgeTable *table);
/* Enters a half-edge; when one of the same direction is there already, gives that one and enters nothing, else −1. */
int32_t shv_edge_table_insert(ShvEdgeTable *table, int32_t half_edge);
/* The half-edge from one node to another, or −1. */
int32_t shv_edge_table_find(const ShvEdgeTable *table, int32_t from, int32_t to);

static inline int32_t shv_half_edge_start(const int32_t *triangles, int32_t half_edge)
{
    return triangles[half_edge];
}
static inline int32_t shv_half_edge_next(int32_t half_edge)
{
    return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1;
}
static inline int32_t shv_half_edge_end(const int32_t *triangles, int32_t half_edge)
{
    return triangles[shv_half_edge_next(half_edge)];
}

#endif
