#include "shiver/version.h"

const char *shv_version(void)
{
    return SHIVER_VERSION;
}
