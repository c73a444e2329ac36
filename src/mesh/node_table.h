/* Nodes that are found by a 64-bit key and numbered in the order in which they are first asked for. */
#ifndef SHV_MESH_NODE_TABLE_H
#define SHV_MESH_NODE_TABLE_H

#include <stdbool.h>

#include "mesh/mesh.h"

typedef struct ShvNodeTable {
    ShvMemory *memory;
    int32_t count;
    double *positions; /* 3 a node, with room for capacity / 2 nodes; zero for a new node, set by the caller */
    uint64_t *keys;    /* open addressing with linear probing */
    int32_t *nodes;    /* node + 1; 0: free */
    int64_t capacity;  /* of keys: a power of two, at most half full */
} ShvNodeTable;

/* On failure the table is zeroed and owns nothing. */
ShvStatus shv_node_table_create(ShvNodeTable *table, ShvMemory *memory, ShvError *error);
void shv_node_table_release(ShvNodeTable *table);
/* The node of a key; *added tells whether it is new (then its position is still zero). */
ShvStatus shv_node_table_find(ShvNodeTable *table, uint64_t key, int32_t *node, bool *added, ShvError *error);
/* Moves the positions into a mesh that has none yet. */
ShvStatus shv_node_table_take(ShvNodeTable *table, ShvMesh *mesh, ShvError *error);

#endif
