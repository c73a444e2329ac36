/* Version of this header; shv_version gives that of the library. */
#ifndef SHIVER_VERSION_H
#define SHIVER_VERSION_H

#ifdef __cplusplus
extern "C" {
#endif

#define SHV_VERSION_MAJOR 0
#define SHV_VERSION_MINOR 1
#define SHV_VERSION_PATCH 0

/* "0.1.0" */
const char *shv_version(void);

#ifdef __cplusplus
}
#endif
#endif
