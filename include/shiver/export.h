/* Run files to other formats: tables (CSV), ParaView (XDMF, VTK), Blender and others (glTF), Houdini and others (USD), and
   pictures (SVG). Metres, z up, right-handed; times in seconds. */
#ifndef SHIVER_EXPORT_H
#define SHIVER_EXPORT_H

#include "shiver/run_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Of an object's material: stresses are computed from it where the run recorded nodes. */
typedef struct ShvElasticity {
    double youngs_modulus, poissons_ratio; /* Pa */
} ShvElasticity;

typedef struct ShvExportOptions {
    uint32_t cookie;
    bool force;     /* replace existing files */
    bool animation; /* only frames on the animation grid, not those of the fracture phase between them */
    int32_t every;  /* of these (by their numbers in the run) every so many, and the last frame of the run; 1: all */
    const ShvElasticity *elasticity; /* one an object: VTK gets stresses; NULL: none */
    struct ShvMemory *memory;        /* may be NULL */
} ShvExportOptions;
ShvExportOptions shv_export_default(void);

/* Tables in the C locale, comma separated, with a row of names and units; numbers have as many digits as it takes to read them
   back exactly, what is not finite is left empty:
     PREFIX_trajectories.csv  time, fragment, P, orient (w, x, y, z), v, w: a row for each living fragment of each frame;
                              the names are Houdini's
     PREFIX_genealogy.csv     id, parent, line, object, birth, death (empty: alive), mass, volume, tets, pivot: where the centre of
                              mass is in the reference mesh
     PREFIX_ledger.csv        energies, works and momenta of each frame
     PREFIX_events.csv        all events
     PREFIX_obstacles.csv     time, name, shape, P, orient, v, w and dimensions: a row for each obstacle of each frame
     PREFIX_pieces.obj        the shape of every line of descent, about the centre of mass of its last fragment
     PREFIX_probes.csv        with probes: time, probe, displacement, velocity, stress, contact, reaction: a row for each known sample
   SHV_BAD_INPUT when one of them exists and `force` is false: then none is written. Each file takes its name when it is
   complete. */
ShvStatus shv_export_csv(ShvRunFile *file, const char *prefix, const ShvExportOptions *options, ShvError *error);

/* For ParaView's XDMF readers (all three):
     PREFIX_fragments.xmf  living fragments as points with id, object, mass, velocity, angular velocity and orientation
                           (a 4-component matrix: w, x, y, z)
     PREFIX_mesh.xmf       the tets with their fragment; with damage (the largest of a tet's facets) and deformed where the
                           run recorded nodes, else moved rigidly with their fragments
     PREFIX_obstacles.xmf  where there are obstacles: their triangles, a plane as a square
     PREFIX_xdmf.h5        the numbers of all: the files belong in one folder
   Each time step has data sets of its own, since hyperslabs are read by one of the three readers only. Errors as above. */
ShvStatus shv_export_xdmf(ShvRunFile *file, const char *prefix, const ShvExportOptions *options, ShvError *error);

/* For VTK and ParaView: PREFIX_NNNNNN.vtu, the tets of frame NNNNNN with piece, line, object and velocity, with nodes also damage
   and stress (largest principal, Pa) and deformed; PREFIX_obstacles_NNNNNN.vtu; and PREFIX.pvd, which names them all with their
   times and is written last. Errors as above. */
ShvStatus shv_export_vtk(ShvRunFile *file, const char *prefix, const ShvExportOptions *options, ShvError *error);

/* One file each, with a node for every line of descent and every obstacle and the same motion: a line has the shape of its last
   fragment and moves with its ancestors before that is born. Linear between frames; what is not there has scale 0.
     glTF: PREFIX.glb, below a node that turns z up to glTF's y up; rotations x, y, z, w; STEP scales; constants as `extras`
     USD: PREFIX.usda, z up, metres, time codes by the rate of the animation grid; quatf w, x, y, z; also visibility
   Errors as above; SHV_UNSUPPORTED beyond the 4 GB of a .glb file. */
ShvStatus shv_export_gltf(ShvRunFile *file, const char *prefix, const ShvExportOptions *options, ShvError *error);
ShvStatus shv_export_usd(ShvRunFile *file, const char *prefix, const ShvExportOptions *options, ShvError *error);

typedef struct ShvSvgOptions {
    uint32_t cookie;
    bool force;            /* replace an existing file */
    const int64_t *frames; /* which frames to draw, one panel each, at most 24 */
    int32_t frame_count;
    const double *times; /* s: the frames nearest to these instead; without both, four frames spread over the run */
    int32_t time_count;
    int32_t size;             /* width of the picture, pixels, 200…4000 */
    struct ShvMemory *memory; /* may be NULL */
} ShvSvgOptions;
/* 1200 pixels. */
ShvSvgOptions shv_svg_default(void);

/* Writes PREFIX.svg: frames side by side with their times, seen from front and above (z up) by one camera around all but small
   splinters, with obstacles and, on planes, shadows. Colours follow the lines of descent; the heaviest living fragment of a
   frame is of stone. Where the run recorded nodes, bodies are deformed as recorded and cracks that part no piece yet are dark
   brown; else they move rigidly. SHV_BAD_INPUT for frames, times or sizes that cannot be, and as above. */
ShvStatus shv_export_svg(ShvRunFile *file, const char *prefix, const ShvSvgOptions *options, ShvError *error);

#ifdef __cplusplus
}
#endif
#endif
