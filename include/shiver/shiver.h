/* Shiver: a hybrid rigid and fracture engine for brittle bodies. This header brings in the whole public interface. */
#ifndef SHIVER_SHIVER_H
#define SHIVER_SHIVER_H

#include "shiver/definition.h"
#include "shiver/export.h"
#include "shiver/library.h"
#include "shiver/live.h"
#include "shiver/plan.h"
#include "shiver/run_file.h"
#include "shiver/scene.h"
#include "shiver/simulation.h"
#include "shiver/stability.h"
#include "shiver/status.h"
#include "shiver/study.h"
#include "shiver/survive.h"
#include "shiver/verify.h"
#include "shiver/version.h"
#include "shiver/view.h"

#endif
