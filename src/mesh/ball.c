#include "mesh/generate.h"
#include "mesh/parameters.h"
#include "mesh/sectors.h"

ShvStatus shv_mesh_ball(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error)
{
    *mesh = (ShvMesh){0};
    const double radius = definition->radius, edge = definition->edge;
    SHV_TRY(shv_require_length(radius, "ball", "radius", error));
    SHV_TRY(shv_require_edge(edge, radius, "ball", "radius", error));
    const double layers = fmax(1.0, floor(SHV_SECTORS_EDGE * radius / edge + 0.5));
    SHV_TRY(shv_require_count(20.0 * layers * layers * layers, edge, "ball", error));
    const ShvSectors sectors = {0, (int32_t)layers, 0.0, radius};
    return shv_sectors_mesh(mesh, memory, &sectors, error);
}
