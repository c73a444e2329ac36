#include "mesh/parameters.h"

#include <math.h>

#include "mesh/mesh.h"

ShvStatus shv_require_length(double value, const char *what, const char *name, ShvError *error)
{
    if (isfinite(value) && value > 0.0) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "%s: %s is %g m, but must be a positive finite length", what, name, value);
}

ShvStatus shv_require_edge(double edge, double thickness, const char *what, const char *part, ShvError *error)
{
    SHV_TRY(shv_require_length(edge, what, "edge", error));
    if (edge <= 2.0 * thickness) return SHV_OK;
    return shv_fail(
        error, SHV_BAD_INPUT,
        "%s: edge %g m is more than twice the %s (%g m), which would give flat elements; choose at most %g m", what,
        edge, part, thickness, 2.0 * thickness);
}

ShvStatus shv_require_count(double elements, double edge, const char *what, ShvError *error)
{
    if (elements <= (double)SHV_MESH_LARGEST) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT,
                    "%s: edge %g m would make about %.2g elements, but a mesh can hold %.3g; choose a longer edge",
                    what, edge, elements, (double)SHV_MESH_LARGEST);
}
