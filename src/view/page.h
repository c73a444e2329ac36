/* The page that data go into, built from src/view/web by esbuild; without it (no node) its size is 0. */
#ifndef SHV_VIEW_PAGE_H
#define SHV_VIEW_PAGE_H

#include <stddef.h>

/* Terminated. */
extern const char shv_view_page[];
extern const size_t shv_view_page_size;

#endif
