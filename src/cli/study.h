/* A study from its opening to its table. */
#ifndef SHV_CLI_STUDY_H
#define SHV_CLI_STUDY_H

#include "cli/command.h"

/* Runs the study of options->plan with the scene named first, writes its folder and prints its table. */
ShvStatus shv_cli_study(const ShvArguments *arguments, ShvStudyOptions *options, bool json, ShvError *error);

#endif
