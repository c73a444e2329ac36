#include "evaluate/measures.h"

#include <string.h>

static const ShvStudyMeasure measures[SHV_MEASURE_COUNT] = {
    [SHV_MEASURE_POSITION] = {"position", NULL, "m", true, false, "largest distance of a body's centre over the run"},
    [SHV_MEASURE_ORIENTATION] = {"orientation", NULL, "rad", true, false, "largest angle of a body over the run"},
    [SHV_MEASURE_VELOCITY] = {"velocity", NULL, "m/s", true, false,
                              "largest difference of a body's velocity over the run"},
    [SHV_MEASURE_SURFACE] = {"surface", NULL, "m", true, false,
                             "largest of distance + radius × angle: of a point of the body's surface"},
    [SHV_MEASURE_ENERGY] = {"energy", NULL, "", true, false,
                            "largest difference of kinetic and potential energy, over the largest of the reference"},
    [SHV_MEASURE_ENERGY_GAIN] = {"energy_gain", NULL, "", true, false,
                                 "largest rise of that energy above an earlier value, over the same"},
    [SHV_MEASURE_LINEAR_MOMENTUM] = {"linear_momentum", NULL, "", true, false,
                                     "largest |P - P_ref| of all bodies, over the largest |P_ref|"},
    [SHV_MEASURE_ANGULAR_MOMENTUM] = {"angular_momentum", NULL, "", true, false,
                                      "largest difference of a body's own angular momentum, over the largest"},
    [SHV_MEASURE_MOMENT] = {"moment", NULL, "s", true, false,
                            "largest error of the times of impacts (bounce) or flips (flight); all must be found"},
    [SHV_MEASURE_APEX] = {"apex", NULL, "", true, false, "largest relative error of the heights between impacts"},
    [SHV_MEASURE_FAILED_OVERLAP] = {"failed_overlap", NULL, "", false, false,
                                    "1 - area failed in both / area failed in either, facet by facet (Jaccard)"},
    [SHV_MEASURE_CRACK_DISTANCE] = {"crack_distance", NULL, "m", false, false,
                                    "Hausdorff distance of the failed surfaces, in the reference mesh"},
    [SHV_MEASURE_CRACK_MEAN_DISTANCE] = {"crack_mean_distance", NULL, "m", false, false,
                                         "the same with the mean over the area in place of the largest distance"},
    [SHV_MEASURE_FAILED_AREA] = {"failed_area", "m2", "", false, false, "relative difference of the failed area"},
    [SHV_MEASURE_DISSIPATED] = {"dissipated", "J", "", false, false,
                                "relative difference of the energy that the cohesive law dissipated"},
    [SHV_MEASURE_FRAGMENTS] = {"fragments", "", "", false, false, "relative difference of the number of fragments"},
    [SHV_MEASURE_LARGEST_MASS] = {"largest_mass", "", "", false, false,
                                  "difference of the largest fragment's share of all mass"},
    [SHV_MEASURE_MASSES] = {"masses", NULL, "", false, false,
                            "Kolmogorov-Smirnov distance of the distributions of fragment masses"},
    [SHV_MEASURE_MOMENTUM] = {"momentum", "kg m/s", "", false, false,
                              "|P - P_ref| of all fragments at the end, over the impulse of the reference's impacts"},
    [SHV_MEASURE_CENTRE_VELOCITY] = {"centre_velocity", "m/s", "m/s", false, false,
                                     "difference of the velocity of the common centre of mass at the end"},
    [SHV_MEASURE_IMPULSE] = {"impulse", "N s", "", false, false,
                             "|J - J_ref| / |J_ref| of the impulse by obstacles in fracture mode"},
    [SHV_MEASURE_CONTACT_TIME] = {"contact_time", "s", "", false, false,
                                  "relative difference of the time with obstacle contact in fracture mode"},
    [SHV_MEASURE_IMPACT_TIME] = {"impact_time", "s", "s", false, false,
                                 "difference of the time of the first obstacle contact in fracture mode"},
    [SHV_MEASURE_BARS_GIVEN] = {"bars_given", "J", "", false, true,
                                "work of bars where they gave energy, over the largest energy of the run"},
    [SHV_MEASURE_BARS_TAKEN] = {"bars_taken", "J", "", false, true,
                                "work of bars where they took energy, over the largest energy of the run"},
    [SHV_MEASURE_BAR_SHARE] = {"bar_share", "", "", false, true,
                               "share of bars in all work of bars and elastic forces"},
    [SHV_MEASURE_RESIDUAL] = {"residual", "J", "", false, true,
                              "largest residual of the energy ledger, over the largest energy of the run"},
    [SHV_MEASURE_MISSED_FRACTURE] =
        {"missed_fracture", "", "", false, true,
         "of the impacts that the wake rule took for harmless and that were run in fracture "
         "mode all the same, the share that broke something"},
};

const ShvStudyMeasure *shv_study_measure_of(ShvMeasureKind kind)
{
    return &measures[kind];
}

ShvMeasureKind shv_study_measure_find(const char *name)
{
    int kind = 0;
    while (kind < SHV_MEASURE_COUNT && strcmp(measures[kind].name, name) != 0) kind++;
    return (ShvMeasureKind)kind;
}

/* ---- figures ---- */

double shv_masses_distance(const double *a, int32_t a_count, const double *b, int32_t b_count)
{
    double a_mass = 0.0, b_mass = 0.0, largest = 0.0;
    if (a_count == 0 || b_count == 0) return a_count == b_count ? 0.0 : 1.0;
    for (int32_t i = 0; i < a_count; i++) a_mass += a[i];
    for (int32_t i = 0; i < b_count; i++) b_mass += b[i];
    /* Equal pieces of equal bodies differ by rounding. */
    const double rounding = 1.0 + 1e-9;
    for (int32_t i = 0, k = 0; i < a_count || k < b_count;) {
        const double m = fmin(i < a_count ? a[i] / a_mass : HUGE_VAL, k < b_count ? b[k] / b_mass : HUGE_VAL);
        while (i < a_count && a[i] / a_mass <= m * rounding) i++;
        while (k < b_count && b[k] / b_mass <= m * rounding) k++;
        largest = fmax(largest, fabs((double)i / a_count - (double)k / b_count));
    }
    return largest;
}

static ShvVec3 momentum_of(const ShvDigest *digest)
{
    return shv_load3(digest->numbers + SHV_DIGEST_MOMENTUM_X);
}

static ShvVec3 impulse_of(const ShvDigest *digest)
{
    return shv_load3(digest->numbers + SHV_DIGEST_IMPULSE_X);
}

static ShvVec3 centre_velocity(const ShvDigest *digest)
{
    return shv_scale(momentum_of(digest), 1.0 / digest->numbers[SHV_DIGEST_MASS]);
}

static double ratio(double part, double whole)
{
    return part == 0.0 ? 0.0 : whole > 0.0 ? part / whole : (double)NAN;
}

double shv_study_measure_value(ShvMeasureKind kind, const ShvDigest *digest)
{
    const double *n = digest->numbers;
    switch (kind) {
    case SHV_MEASURE_FAILED_AREA:
        return n[SHV_DIGEST_FAILED_AREA];
    case SHV_MEASURE_DISSIPATED:
        return n[SHV_DIGEST_DISSIPATED];
    case SHV_MEASURE_FRAGMENTS:
        return n[SHV_DIGEST_FRAGMENTS];
    case SHV_MEASURE_LARGEST_MASS:
        return n[SHV_DIGEST_LARGEST_MASS];
    case SHV_MEASURE_MOMENTUM:
        return shv_norm(momentum_of(digest));
    case SHV_MEASURE_CENTRE_VELOCITY:
        return shv_norm(centre_velocity(digest));
    case SHV_MEASURE_IMPULSE:
        return shv_norm(impulse_of(digest));
    case SHV_MEASURE_CONTACT_TIME:
        return n[SHV_DIGEST_CONTACT_TIME];
    case SHV_MEASURE_IMPACT_TIME:
        return n[SHV_DIGEST_FIRST_CONTACT];
    case SHV_MEASURE_BARS_GIVEN:
        return n[SHV_DIGEST_BARS_GIVEN];
    case SHV_MEASURE_BARS_TAKEN:
        return n[SHV_DIGEST_BARS_TAKEN];
    case SHV_MEASURE_BAR_SHARE:
        return n[SHV_DIGEST_BAR_SHARE];
    case SHV_MEASURE_RESIDUAL:
        return n[SHV_DIGEST_RESIDUAL];
    case SHV_MEASURE_MISSED_FRACTURE:
        return n[SHV_DIGEST_MISSED];
    default:
        return (double)NAN;
    }
}

/* ---- errors at the end ---- */

static double own_error(ShvMeasureKind kind, const ShvDigest *digest)
{
    const double *n = digest->numbers;
    if (kind == SHV_MEASURE_BAR_SHARE) return isnan(n[SHV_DIGEST_BAR_SHARE]) ? 0.0 : n[SHV_DIGEST_BAR_SHARE];
    if (kind == SHV_MEASURE_MISSED_FRACTURE)
        return n[SHV_DIGEST_AUDITED] > 0.0 ? n[SHV_DIGEST_MISSED] / n[SHV_DIGEST_AUDITED] : (double)NAN;
    return ratio(shv_study_measure_value(kind, digest), n[SHV_DIGEST_LARGEST]);
}

/* |a − b| / |b|. */
static double relative(ShvMeasureKind kind, const ShvDigest *a, const ShvDigest *b)
{
    const double x = shv_study_measure_value(kind, a), y = shv_study_measure_value(kind, b);
    return ratio(fabs(x - y), fabs(y));
}

static double vector_error(ShvVec3 a, ShvVec3 b, double scale)
{
    return ratio(shv_norm(shv_sub(a, b)), scale);
}

/* Without impacts in fracture mode there is no impulse: then the momentum itself is the scale. */
static double momentum_error(const ShvDigest *a, const ShvDigest *b)
{
    const double impulse = shv_norm(impulse_of(b));
    return vector_error(momentum_of(a), momentum_of(b), impulse > 0.0 ? impulse : shv_norm(momentum_of(b)));
}

double shv_study_measure_error(ShvMeasureKind kind, const ShvDigest *a, const ShvDigest *b)
{
    if (measures[kind].own) return own_error(kind, a);
    if (!b || measures[kind].track) return (double)NAN;
    switch (kind) {
    case SHV_MEASURE_FAILED_OVERLAP:
        return 1.0 - shv_crack_overlap(&a->crack, &b->crack);
    case SHV_MEASURE_CRACK_DISTANCE:
        return shv_crack_distance(&a->crack, &b->crack).largest;
    case SHV_MEASURE_CRACK_MEAN_DISTANCE:
        return shv_crack_distance(&a->crack, &b->crack).mean;
    case SHV_MEASURE_MASSES:
        return shv_masses_distance(a->masses, a->mass_count, b->masses, b->mass_count);
    case SHV_MEASURE_MOMENTUM:
        return momentum_error(a, b);
    case SHV_MEASURE_CENTRE_VELOCITY:
        return shv_norm(shv_sub(centre_velocity(a), centre_velocity(b)));
    case SHV_MEASURE_IMPULSE:
        return vector_error(impulse_of(a), impulse_of(b), shv_norm(impulse_of(b)));
    case SHV_MEASURE_LARGEST_MASS:
    case SHV_MEASURE_IMPACT_TIME:
        return fabs(shv_study_measure_value(kind, a) - shv_study_measure_value(kind, b));
    default:
        return relative(kind, a, b);
    }
}

/* ---- errors of the way ---- */

static double way_of_momentum(const ShvTrack *track)
{
    double error = 0.0, scale = 0.0;
    for (int32_t i = 0; i < track->count; i++) {
        const ShvTrackRow *row = &track->rows[i];
        error = fmax(error, shv_norm(shv_sub(row->momentum, row->reference_momentum)));
        scale = fmax(scale, shv_norm(row->reference_momentum));
    }
    return ratio(error, scale);
}

static void fill_errors(double errors[SHV_MEASURE_COUNT], const ShvComparedTrack *run)
{
    const ShvComparedRun *view = &run->view;
    errors[SHV_MEASURE_POSITION] = view->position;
    errors[SHV_MEASURE_ORIENTATION] = view->orientation;
    errors[SHV_MEASURE_VELOCITY] = view->velocity;
    errors[SHV_MEASURE_SURFACE] = view->surface;
    errors[SHV_MEASURE_ENERGY] = view->energy;
    errors[SHV_MEASURE_ENERGY_GAIN] = view->energy_gain;
    errors[SHV_MEASURE_LINEAR_MOMENTUM] = way_of_momentum(&run->track);
    errors[SHV_MEASURE_ANGULAR_MOMENTUM] = view->angular_momentum;
    errors[SHV_MEASURE_MOMENT] = view->moments == view->reference_moments ? view->moment : (double)NAN;
    errors[SHV_MEASURE_APEX] = view->moments == view->reference_moments ? view->apex : (double)NAN;
}

ShvStatus shv_study_measure_way(double errors[SHV_MEASURE_COUNT], ShvComparison *comparison, const ShvDigest *digest,
                                ShvError *error)
{
    ShvComparedTrack run = {.track = {NULL, 0, 0}};
    ShvStatus status = SHV_OK;
    if (digest->body_count != comparison->bodies.count)
        return shv_fail(error, SHV_BAD_INPUT, "the runs of this study do not have the same bodies; do not vary them");
    shv_compare_rewind(comparison);
    for (int32_t i = 0; i < digest->frame_count && status == SHV_OK; i++) {
        ShvTrackRow row;
        shv_compare_states(comparison, digest->states + (int64_t)i * digest->body_count, digest->times[i], i, &row);
        status = shv_track_add(&run.track, comparison->memory, &row, error);
    }
    if (status == SHV_OK) {
        shv_compare_summarise(comparison, &run);
        fill_errors(errors, &run);
    }
    shv_track_release(&run.track);
    return status;
}
