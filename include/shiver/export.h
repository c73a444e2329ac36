/* Run files to other formats: tables (CSV) and ParaView (XDMF). */
#ifndef SHIVER_EXPORT_H
#define SHIVER_EXPORT_H

#include "shiver/run_file.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ShvExportOptions {
    uint32_t cookie;
    bool force;     /* replace existing files */
    bool animation; /* only frames on the animation grid, not those of the fracture phase between them */
    struct ShvMemory *memory; /* may be NULL */
} ShvExportOptions;
ShvExportOptions shv_export_default(void);

/* Four tables in the C locale, comma separated, with a row of names and units; numbers have as many digits as it takes to read
   them back exactly, what is not finite is left empty:
     PREFIX_trajectories.csv  time, fragment, P, orient (w, x, y, z), v, w: a row for each living fragment of each frame;
                              the names are Houdini's
     PREFIX_genealogy.csv     id, parent, object, birth, death (empty: alive), mass, volume, tets
     PREFIX_ledger.csv        energies, works and momenta of each frame
     PREFIX_events.csv        all events
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

#ifdef __cplusplus
}
#endif
#endif
