/* The processor that a run or a study was made on. */
#ifndef SHV_RECORD_PROCESSOR_H
#define SHV_RECORD_PROCESSOR_H

#include <stddef.h>

/* "model name : …" of Linux; elsewhere the name of the machine type. */
void shv_processor_name(char *name, size_t size);

#endif
