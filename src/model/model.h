/* The immutable side of a simulation: the placed reference mesh of all objects together, what they are made of, and,
   where something can break, who touches whom. Nothing here changes after it is built, but how many threads work on it. */
#ifndef SHV_MODEL_MODEL_H
#define SHV_MODEL_MODEL_H

#include "mesh/adjacency.h"
#include "mesh/mesh.h"
#include "model/material.h"

/* The first component of a node's vector is numbered 3 × node in 32 bits. */
enum { SHV_NODE_LIMIT = INT32_MAX / 3 };

typedef struct ShvObject {
    const char *name;
    int32_t material;                   /* of all of it but the groups that are of another */
    char *materials;                    /* names of all of them, "glass + steel"; NULL where there is one */
    int32_t element_begin, element_end; /* half-open ranges of the joint mesh */
    int32_t node_begin, node_end;
} ShvObject;

typedef struct ShvModel {
    ShvMemory *memory;
    ShvMesh mesh; /* world coordinates of the start: displacement zero means exactly at rest */
    ShvMaterial *materials;
    int32_t material_count;
    ShvObject *objects;
    int32_t object_count;
    uint16_t *element_material; /* element_count */
    bool can_break;             /* fracture enabled and some material breakable: adjacency is built */
    ShvAdjacency adjacency;
    uint64_t seed;                 /* of facet strengths */
    int32_t threads, most_threads; /* of loops as they run now; of all */
} ShvModel;

/* Generates, places and joins the meshes of a scene. `folder` is what relative files start from. */
ShvStatus shv_model_build(ShvModel *model, ShvMemory *memory, const ShvSceneDefinition *scene, const char *folder,
                          ShvError *error);
void shv_model_release(ShvModel *model);

/* As many threads as there are processors, but not more than have work on so many tets. */
int32_t shv_threads_worth(int32_t tets);

static inline const ShvMaterial *shv_model_material(const ShvModel *model, int32_t element)
{
    return &model->materials[model->element_material[element]];
}

#endif
