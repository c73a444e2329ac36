#include "mesh/generate.h"
#include "mesh/parameters.h"
#include "mesh/sectors.h"

static ShvStatus check_radii(const ShvMeshDefinition *d, ShvError *error)
{
    SHV_TRY(shv_require_length(d->radius, "hollow ball", "radius", error));
    SHV_TRY(shv_require_length(d->inner_radius, "hollow ball", "inner_radius", error));
    if (d->inner_radius >= d->radius)
        return shv_fail(error, SHV_BAD_INPUT, "hollow ball: inner_radius %g m must be less than radius %g m",
                        d->inner_radius, d->radius);
    SHV_TRY(shv_require_edge(d->edge, d->radius - d->inner_radius, "hollow ball", "wall's thickness", error));
    return shv_require_edge(d->edge, d->inner_radius, "hollow ball", "inner radius", error);
}

ShvStatus shv_mesh_hollow_ball(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error)
{
    *mesh = (ShvMesh){0};
    SHV_TRY(check_radii(definition, error));
    const double radius = definition->radius, wall = radius - definition->inner_radius;
    const double last = fmax(2.0, floor(SHV_SECTORS_EDGE * radius / definition->edge + 0.5));
    const double wall_layers = fmin(fmax(1.0, floor(last * wall / radius + 0.5)), last - 1.0);
    /* Before the layers become integers: those of a solid ball bound them. */
    SHV_TRY(shv_require_count(last, definition->edge, "hollow ball", error));
    const ShvSectors sectors = {(int32_t)(last - wall_layers), (int32_t)last, definition->inner_radius, radius};
    SHV_TRY(shv_require_count(shv_sectors_count(&sectors), definition->edge, "hollow ball", error));
    return shv_sectors_mesh(mesh, memory, &sectors, error);
}
