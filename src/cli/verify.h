/* All cases of a folder. */
#ifndef SHV_CLI_VERIFY_H
#define SHV_CLI_VERIFY_H

#include "cli/command.h"

/* As `shiver verify --folder`; `markdown` may be NULL. Returns the exit status. */
int shv_cli_verify_folder(const ShvArguments *arguments, const char *folder, bool full, const char *markdown);

#endif
