/* Moduli of the objects of a run file, from the scene it holds. */
#ifndef SHV_CLI_ELASTICITY_H
#define SHV_CLI_ELASTICITY_H

#include "base/memory.h"
#include "shiver/export.h"

/* One an object, to be released with shv_release; NULL, which is no failure, where the scene cannot be read any more. */
ShvStatus shv_cli_elasticity(const ShvRunFile *file, ShvElasticity **elasticity, ShvError *error);

#endif
