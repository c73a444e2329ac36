#include "evaluate/figures.h"

#include <string.h>

#include "evaluate/trajectory.h"

#define COUNT(array)  ((int32_t)(sizeof(array) / sizeof *(array)))
#define NORM(x, y, z) "sqrt((" x ")^2 + (" y ")^2 + (" z ")^2)"
#define LENGTH(name)  NORM(name ".x", name ".y", name ".z")
/* |a − b| of a vector here and of the reference, over b's own scale. */
#define OF_REFERENCE(name) "runs.reference." name
#define APART(name)                                                                                                    \
    NORM(name ".x - runs.reference." name ".x", name ".y - runs.reference." name ".y",                                 \
         name ".z - runs.reference." name ".z")
#define CHANGE(name) NORM(name ".x - first(" name ".x)", name ".y - first(" name ".y)", name ".z - first(" name ".z)")
#define MOTION       "(ledger.kinetic + ledger.strain)"
#define ENERGY       "(ledger.kinetic + ledger.strain + ledger.gravity_potential)"

static const struct {
    const char *name, *formula;
} figures[] = {
    {"run.time", "last(frame.time)"},
    {"run.frames", "sum(frame.animation)"},
    {"run.steps", "last(frame.steps)"},
    {"run.step", "last(frame.step)"},
    {"run.courant", "max(frame.courant)"},
    {"run.inserted", "last(frame.inserted)"},
    {"run.failed", "last(frame.failed)"},
    {"run.finite", "min(frame.finite)"},
    {"run.wakes", "sum(frame.wakes)"},
    {"run.rests", "sum(frame.rests)"},
    {"run.inversions", "sum(frame.inversions)"},
    {"run.squeezes", "sum(frame.squeezes)"},
    {"run.residual", "max(0, max(abs(ledger.residual) / ledger.largest))"},
    {"run.gain", "max(0, max((" ENERGY " - first(" ENERGY ")) / ledger.largest))"},
    {"run.kept", "last(" MOTION ") / first(" MOTION ")"},
    {"run.momentum", "over(max(" CHANGE("ledger.momentum") "), max(frame.momentum_scale))"},
    {"run.angular", "over(max(" CHANGE("ledger.angular_momentum") "), max(" LENGTH("ledger.angular_momentum") "))"},
    {"run.lowest", "min(frame.lowest)"},
    {"run.highest", "max(frame.highest)"},
    {"run.swelling", "max(frame.radius) / first(frame.radius) - 1"},
    {"run.edge_strain", "max(0, max(frame.edge_strain))"},
    {"run.bar_work", "max(0, last(frame.bar_share))"},
    {"end.share", "end.largest_mass / end.mass"},
    {"end.wall_seconds", "run.setup + run.seconds"},
};

/* Those that follow bodies come first, in the order of ShvTrajectoryMeasure. */
static const ShvMeasure measures[] = {
    {"position", NULL, "m", NULL, "position(reference)", "largest distance of a body's centre over the run"},
    {"orientation", NULL, "rad", NULL, "orientation(reference)", "largest angle of a body over the run"},
    {"velocity", NULL, "m/s", NULL, "velocity(reference)", "largest difference of a body's velocity over the run"},
    {"surface", NULL, "m", NULL, "surface(reference)",
     "largest of distance + radius × angle: of a point of the body's surface"},
    {"energy", NULL, "", NULL, "energy(reference)",
     "largest difference of kinetic and potential energy, over the largest of the reference"},
    {"energy_gain", NULL, "", NULL, "energy_gain(reference)",
     "largest rise of that energy above an earlier value, over the same"},
    {"linear_momentum", NULL, "", NULL, "linear_momentum(reference)",
     "largest |P - P_ref| of all bodies, over the largest |P_ref|"},
    {"angular_momentum", NULL, "", NULL, "angular_momentum(reference)",
     "largest difference of a body's own angular momentum, over the largest"},
    {"event_time", NULL, "s", NULL, "event_time(reference)",
     "largest error of the times of impacts (bounce) or flips (flight); all must be found"},
    {"apex", NULL, "", NULL, "apex(reference)", "largest relative error of the heights between impacts"},
    {"missed_events", NULL, "", NULL, "missed_events(reference)",
     "impacts or flips that were not found, or that are too many"},
    {"failed_overlap", NULL, "", NULL, "1 - crack_overlap(reference)",
     "1 - area failed in both / area failed in either, facet by facet (Jaccard)"},
    {"crack_distance", NULL, "m", NULL, "crack_distance(reference)",
     "Hausdorff distance of the failed surfaces, in the reference mesh"},
    {"crack_mean_distance", NULL, "m", NULL, "crack_mean_distance(reference)",
     "the same with the mean over the area in place of the largest distance"},
    {"failed_area", "m2", "", "last(ledger.failed_area)", "share(failed_area, runs.reference.failed_area)",
     "relative difference of the failed area"},
    {"dissipated", "J", "", "last(ledger.fracture_dissipation)", "share(dissipated, runs.reference.dissipated)",
     "relative difference of the energy that the cohesive law dissipated"},
    {"fragments", "", "", "end.fragments", "share(fragments, runs.reference.fragments)",
     "relative difference of the number of fragments"},
    {"largest_mass", "", "", "end.largest_mass / end.mass", "abs(largest_mass - runs.reference.largest_mass)",
     "difference of the largest fragment's share of all mass"},
    {"masses", NULL, "", NULL, "masses(reference)",
     "Kolmogorov-Smirnov distance of the distributions of fragment masses"},
    {"momentum", "kg m/s", "", LENGTH("end.momentum"),
     "over(" APART("end.momentum") ", nonzero(runs.reference.impulse, runs.reference.momentum))",
     "|P - P_ref| of all fragments at the end, over the impulse of the reference's impacts"},
    {"centre_velocity", "m/s", "m/s", LENGTH("end.momentum") " / end.mass",
     NORM("end.momentum.x / end.mass - runs.reference.end.momentum.x / runs.reference.end.mass",
          "end.momentum.y / end.mass - runs.reference.end.momentum.y / runs.reference.end.mass",
          "end.momentum.z / end.mass - runs.reference.end.momentum.z / runs.reference.end.mass"),
     "difference of the velocity of the common centre of mass at the end"},
    {"impulse", "N s", "", LENGTH("run.impulse"), "over(" APART("run.impulse") ", runs.reference.impulse)",
     "|J - J_ref| / |J_ref| of the impulse by obstacles in fracture mode"},
    {"contact_time", "s", "", "run.contact_time", "share(contact_time, runs.reference.contact_time)",
     "relative difference of the time with obstacle contact in fracture mode"},
    {"impact_time", "s", "s", "run.first_contact", "abs(impact_time - runs.reference.impact_time)",
     "difference of the time of the first obstacle contact in fracture mode"},
    {"bars_given", "J", "", "rise(ledger.bars)", "over(bars_given, last(ledger.largest))",
     "work of bars where they gave energy, over the largest energy of the run"},
    {"bars_taken", "J", "", "fall(ledger.bars)", "over(bars_taken, last(ledger.largest))",
     "work of bars where they took energy, over the largest energy of the run"},
    {"bar_share", "", "", "last(frame.bar_share)", "run.bar_work",
     "share of bars in all work of bars and elastic forces"},
    {"residual", "J", "", "max(abs(ledger.residual))", "over(residual, last(ledger.largest))",
     "largest residual of the energy ledger, over the largest energy of the run"},
    {"missed_fracture", "", "", "run.missed", "run.missed / run.audited",
     "of the impacts that the wake rule took for harmless and that were run in fracture mode all the same, the share "
     "that broke something"},
};

const char *shv_figure_formula(const char *name)
{
    for (int32_t i = 0; i < COUNT(figures); i++)
        if (strcmp(figures[i].name, name) == 0) return figures[i].formula;
    const ShvMeasure *measure = shv_measure_named(name);
    return measure ? measure->value : NULL;
}

int32_t shv_measure_count(void)
{
    return COUNT(measures);
}

const ShvMeasure *shv_measure_at(int32_t index)
{
    return &measures[index];
}

const ShvMeasure *shv_measure_named(const char *name)
{
    for (int32_t i = 0; i < COUNT(measures); i++)
        if (strcmp(measures[i].name, name) == 0) return &measures[i];
    return NULL;
}

int shv_trajectory_measure_index(const char *name)
{
    for (int i = 0; i < SHV_TRAJECTORY_MEASURES; i++)
        if (strcmp(measures[i].name, name) == 0) return i;
    return -1;
}

bool shv_measure_tracks(const ShvMeasure *measure)
{
    const size_t length = strcspn(measure->error, "(");
    char name[64] = "";
    if (length < sizeof name) memcpy(name, measure->error, length);
    return shv_trajectory_measure_index(name) >= 0;
}

bool shv_measure_is_own(const ShvMeasure *measure)
{
    return !strstr(measure->error, "reference");
}
