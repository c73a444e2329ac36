/* Inside of an XDMF export, for the files of this folder. */
#ifndef SHV_EXPORT_XDMF_H
#define SHV_EXPORT_XDMF_H

#include <hdf5.h>

#include "export/output.h"
#include "record/stage.h"

typedef struct ShvXdmf {
    ShvRunFile *file;
    const ShvRunFileInfo *info;
    ShvExportOptions options;
    int descriptor;     /* of the HDF5 file beside the XML */
    ShvStage *stage;    /* over it */
    hid_t numbers;      /* the file itself */
    int32_t *lineage;   /* of every fragment */
    char *numbers_name; /* its name without folder, escaped for XML */
    FILE *stream;       /* the XML file being written */
    const char *path;   /* of the HDF5 file, for messages */
} ShvXdmf;

/* Type of a data set in the file; in memory they are double, double, int32_t. */
typedef enum ShvXdmfType { SHV_XDMF_DOUBLE, SHV_XDMF_SINGLE, SHV_XDMF_INT } ShvXdmfType;

/* Writes a data set of (rows, columns); columns 0: (rows). */
ShvStatus shv_xdmf_put(const ShvXdmf *xdmf, const char *path, ShvXdmfType type, int64_t rows, int64_t columns,
                       const void *data, ShvError *error);
/* <DataItem> that refers to it. */
void shv_xdmf_item(const ShvXdmf *xdmf, const char *path, ShvXdmfType type, int64_t rows, int64_t columns);
/* <Attribute> that refers to it; kind "Scalar", "Vector" or "Matrix", centre "Node" or "Cell". */
void shv_xdmf_attribute(const ShvXdmf *xdmf, const char *name, const char *kind, const char *centre, const char *path,
                        ShvXdmfType type, int64_t rows, int64_t columns);

/* <Grid>s of all frames, and their numbers. */
ShvStatus shv_xdmf_fragments(const ShvXdmf *xdmf, ShvError *error);
ShvStatus shv_xdmf_mesh(const ShvXdmf *xdmf, ShvError *error);
ShvStatus shv_xdmf_deformed_mesh(const ShvXdmf *xdmf, ShvError *error);
ShvStatus shv_xdmf_obstacles(const ShvXdmf *xdmf, ShvError *error);

#endif
