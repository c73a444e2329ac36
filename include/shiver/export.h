/* Run files to other formats: tables (CSV), ParaView (XDMF), and pictures (SVG). */
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
    bool force;               /* replace existing files */
    bool animation;           /* only frames on the animation grid, not those of the fracture phase between them */
    struct ShvMemory *memory; /* may be NULL */
} ShvExportOptions;
ShvExportOptions shv_export_default(void);

/* Four tables, five with probes, in the C locale, comma separated, with a row of names and units; numbers have as many digits as it takes to read
   them back exactly, what is not finite is left empty:
     PREFIX_trajectories.csv  time, fragment, P, orient (w, x, y, z), v, w: a row for each living fragment of each frame;
                              the names are Houdini's
     PREFIX_genealogy.csv     id, parent, object, birth, death (empty: alive), mass, volume, tets
     PREFIX_ledger.csv        energies, works and momenta of each frame
     PREFIX_events.csv        all events
     PREFIX_probes.csv        time, probe, displacement, velocity, stress, contact, reaction: a row for each known sample
   SHV_BAD_INPUT when one of them exists and `force` is false: then none is written. Each file takes its name when it is
   complete. */
ShvStatus shv_export_csv(ShvRunFile *file, const char *prefix, const ShvExportOptions *options, ShvError *error);

/* For ParaView's XDMF readers (all three):
     PREFIX_fragments.xmf  living fragments as points with id, object, mass, velocity, angular velocity and orientation
                           (a 4-component matrix: w, x, y, z)
     PREFIX_mesh.xmf       the tets with their fragment; with damage (the largest of a tet's facets) and deformed where the
                           run recorded nodes, else moved rigidly with their fragments
     PREFIX_xdmf.h5        the numbers of both: the three files belong in one folder
   Each time step has data sets of its own, since hyperslabs are read by one of the three readers only. Errors as above. */
ShvStatus shv_export_xdmf(ShvRunFile *file, const char *prefix, const ShvExportOptions *options, ShvError *error);

typedef struct ShvSvgOptions {
    uint32_t cookie;
    bool force;            /* replace an existing file */
    const int64_t *frames; /* which frames to draw, one panel each, at most 24 */
    int32_t frame_count;
    const double *times; /* s: the frames nearest to these instead; without both, four frames spread over the run */
    int32_t time_count;
    int32_t size;        /* width of the picture, pixels, 200…4000 */
    double mass_in_view; /* 0…1: the frame is drawn around the fragments nearest to the middle that have this share of
                              the mass; the farthest splinters may be outside. 1: all are inside */
    bool floor;          /* draw a floor with shadows: n·x = offset */
    double floor_normal[3], floor_offset;
    struct ShvMemory *memory; /* may be NULL */
} ShvSvgOptions;
/* 1200 pixels, 0.98 of the mass, no floor. */
ShvSvgOptions shv_svg_default(void);

/* Writes PREFIX.svg: frames side by side with their times, seen from front and above (z up) by one camera. Each fragment
   has a colour that follows from its number; the largest living one of a frame is of stone. Deformed as recorded where the
   run recorded nodes, else moved rigidly. What hides behind other faces or between two samples (half a pixel apart) is
   left out. SHV_BAD_INPUT for frames, times or sizes that cannot be, and as above. */
ShvStatus shv_export_svg(ShvRunFile *file, const char *prefix, const ShvSvgOptions *options, ShvError *error);

#ifdef __cplusplus
}
#endif
#endif
