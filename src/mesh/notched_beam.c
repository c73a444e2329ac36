#include "mesh/bricks.h"
#include "mesh/generate.h"
#include "mesh/lattice.h"
#include "mesh/parameters.h"

/* A cell is halved when it is longer than asked for by more than this. */
static const double tolerance = 1.2;
/* Growth per distance of the edge length asked for: less than 1 / tolerance for balance. */
static const double largest_growth = 0.8;

static ShvStatus check_notch(const ShvMeshDefinition *d, ShvError *error)
{
    SHV_TRY(shv_require_length(d->notch_depth, "notched beam", "notch_depth", error));
    if (d->notch_depth >= d->size[2])
        return shv_fail(error, SHV_BAD_INPUT,
                        "notched beam: notch_depth %g m must be less than the beam's height of %g m", d->notch_depth,
                        d->size[2]);
    if (!(fabs(d->notch_offset) < 0.5 * d->size[0]))
        return shv_fail(error, SHV_BAD_INPUT,
                        "notched beam: notch_offset %g m puts the notch outside the beam, which reaches %g m to either "
                        "side of midspan",
                        d->notch_offset, 0.5 * d->size[0]);
    if (!(isfinite(d->notch_edge) && d->notch_edge >= 0.0))
        return shv_fail(error, SHV_BAD_INPUT, "notched beam: notch_edge is %g m, but must be 0 (as edge) or positive",
                        d->notch_edge);
    if (!(d->notch_growth > 0.0 && d->notch_growth <= largest_growth))
        return shv_fail(error, SHV_BAD_INPUT, "notched beam: notch_growth is %g, but must be positive and at most %g",
                        d->notch_growth, largest_growth);
    return SHV_OK;
}

static ShvStatus check_parameters(const ShvMeshDefinition *d, ShvError *error)
{
    static const char *const names[3] = {"length (size along x)", "depth (size along y)", "height (size along z)"};
    double thinnest = HUGE_VAL;
    for (int axis = 0; axis < 3; axis++) {
        SHV_TRY(shv_require_length(d->size[axis], "notched beam", names[axis], error));
        thinnest = fmin(thinnest, d->size[axis]);
    }
    SHV_TRY(shv_require_edge(d->edge, thinnest, "notched beam", "thinnest side", error));
    return check_notch(d, error);
}

/* Halves cells until those at the notch are short enough, and others as far as the growing edge length asks for it. */
static ShvStatus grade(ShvLattice *lattice, const ShvMeshDefinition *d, ShvError *error)
{
    if (d->notch_edge == 0.0) return SHV_OK;
    int32_t *levels = &lattice->levels;
    double smallest = d->edge;
    for (; smallest > tolerance * d->notch_edge && *levels < SHV_LATTICE_LEVELS; smallest *= 0.5) ++*levels;
    bool fits = smallest <= tolerance * d->notch_edge;
    for (int axis = 0; axis < 3; axis++) fits = fits && ((int64_t)lattice->roots[axis] << *levels) <= SHV_MESH_LARGEST;
    if (!fits)
        return shv_fail(error, SHV_BAD_INPUT,
                        "notched beam: notch_edge %g m is too short for a beam of this size; choose a longer one",
                        d->notch_edge);
    for (int32_t l = *levels - 1; l >= 0; l--) {
        const double length = ldexp(1.0, *levels - l);
        const double reach = (length / tolerance - d->notch_edge / smallest) / d->notch_growth;
        const int32_t least = l + 1 < *levels ? lattice->reach[l + 1] + (1 << (*levels - l - 1)) : 1;
        lattice->reach[l] = reach > (double)least ? (int32_t)reach : least;
    }
    return SHV_OK;
}

/* Moves the plane between smallest cells that is nearest to `value` exactly there. */
static ShvStatus place_knot(ShvLattice *lattice, int axis, double value, const char *what, ShvError *error)
{
    const int32_t cells = lattice->roots[axis] << lattice->levels;
    const double low = lattice->low[axis], high = lattice->high[axis], cell = (high - low) / (double)cells;
    /* With less than half a cell on one side, no plane but the surface is near. */
    if (value - low < 0.5 * cell || high - value < 0.5 * cell)
        return shv_fail(error, SHV_BAD_INPUT,
                        "notched beam: the %s is only %g m from the beam's surface, less than half an element; choose "
                        "notch_edge (or edge) of at most %g m",
                        what, fmin(value - low, high - value),
                        2.0 * SHV_LATTICE_EDGE * fmin(value - low, high - value));
    const int32_t nearest = (int32_t)floor((value - low) / cell + 0.5);
    lattice->knot[axis] = nearest < 1 ? 1 : nearest > cells - 1 ? cells - 1 : nearest;
    lattice->knot_value[axis] = value;
    return SHV_OK;
}

ShvStatus shv_mesh_notched_beam(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error)
{
    *mesh = (ShvMesh){0};
    SHV_TRY(check_parameters(definition, error));
    if (definition->pattern == SHV_PATTERN_BRICKS) return shv_mesh_brick_beam(mesh, memory, definition, error);
    ShvLattice lattice = shv_lattice_box(definition->size, definition->edge / SHV_LATTICE_EDGE);
    SHV_TRY(shv_require_count(shv_lattice_estimate(&lattice), definition->edge, "notched beam", error));
    SHV_TRY(grade(&lattice, definition, error));
    lattice.knot[1] = lattice.roots[1] << lattice.levels;
    SHV_TRY(place_knot(&lattice, 0, definition->notch_offset, "notch", error));
    SHV_TRY(place_knot(&lattice, 2, lattice.low[2] + definition->notch_depth, "notch tip or its bottom", error));
    lattice.slit = true;
    const double shortest = definition->notch_edge > 0.0 ? definition->notch_edge : definition->edge;
    SHV_TRY(shv_require_count(shv_lattice_estimate(&lattice), shortest, "notched beam", error));
    return shv_lattice_mesh(mesh, memory, &lattice, error);
}
