/* Other programs. */
#ifndef SHV_CLI_PROGRAMS_H
#define SHV_CLI_PROGRAMS_H

#include <stdbool.h>

#include "base/temporary.h"

/* Whether a program of this name is on the PATH. */
bool shv_on_path(const char *program);
/* Runs a program that is given its arguments, the last one NULL, and ends with this process; true when it ended well. */
bool shv_run_program(const ShvTemporary *place, const char *const *arguments);
/* From now on SIGINT, SIGTERM and SIGHUP call `handler` and end a wait for another program (no SA_RESTART). */
void shv_interrupt_waiting(void (*handler)(int));

#endif
