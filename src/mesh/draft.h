/* Tets on their way from a file to a mesh: nodes and tets carry the file's own tags, in any order and with gaps. */
#ifndef SHV_MESH_DRAFT_H
#define SHV_MESH_DRAFT_H

#include "mesh/mesh.h"
#include "mesh/scan.h"

typedef struct ShvDraftTet {
    int64_t tag;
    int64_t nodes[4]; /* tags */
    int64_t place;    /* line, or byte of a binary file */
    int32_t group;    /* tag, 0: none */
} ShvDraftTet;

typedef struct ShvDraft {
    ShvMemory *memory;
    const char *path; /* of the tets, for messages */
    bool binary;
    int64_t node_count, node_capacity;
    int64_t *tags;
    double *positions;
    int64_t tet_count, tet_capacity;
    ShvDraftTet *tets;
    ShvMeshGroup *groups; /* those with a name */
    int32_t group_count;
} ShvDraft;

void shv_draft_release(ShvDraft *draft);
/* Arrays grow with what is really read, never with what a file announces. */
ShvStatus shv_draft_add_node(ShvDraft *draft, int64_t tag, ShvVec3 position, ShvError *error);
ShvStatus shv_draft_add_tet(ShvDraft *draft, const ShvDraftTet *tet, ShvError *error);
ShvStatus shv_draft_add_group(ShvDraft *draft, const ShvMeshGroup *group, ShvError *error);

/* Makes the mesh: nodes of the tets only, in the order of the file. Refuses, and names the tet by its tag and place:
   repeated node tags, unknown nodes, repeated corners, tets without volume and inverted tets; no tets at all. The
   draft is used up either way, but not released. */
ShvStatus shv_draft_finish(ShvDraft *draft, ShvMesh *mesh, ShvError *error);

#endif
