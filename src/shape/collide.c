#include "shape/collide.h"

enum { MOST_CONTACTS = 1024, MOST_SWEEPS = 200 };

/* ---- detection ---- */

/* Points of an obstacle that are tried against another's surface: the centre of a sphere (with its radius), corners of a
   box, vertices of a mesh. */
static int32_t sample_count(const ShvObstacle *obstacle)
{
    switch (obstacle->shape) {
    case SHV_OBSTACLE_PLANE:
        return 0;
    case SHV_OBSTACLE_SPHERE:
        return 1;
    case SHV_OBSTACLE_BOX:
        return 8;
    case SHV_OBSTACLE_MESH:
        break;
    }
    return obstacle->surface.node_count;
}

static ShvVec3 sample_position(const ShvObstacle *obstacle, int32_t index)
{
    if (obstacle->shape == SHV_OBSTACLE_SPHERE) return obstacle->position;
    ShvVec3 local;
    if (obstacle->shape == SHV_OBSTACLE_BOX) {
        const ShvVec3 half = obstacle->half;
        local = shv_vec3(index & 1 ? half.x : -half.x, index & 2 ? half.y : -half.y, index & 4 ? half.z : -half.z);
    } else {
        local = shv_surface_position(&obstacle->surface, index);
    }
    return shv_add(obstacle->position, shv_rotate(obstacle->orientation, local));
}

/* A sphere needs nothing but its own centre tried. */
static bool samples_matter(const ShvObstacle *sampled, const ShvObstacle *other)
{
    return sampled->shape == SHV_OBSTACLE_SPHERE || other->shape != SHV_OBSTACLE_SPHERE;
}

static bool pair_counts(const ShvObstacles *obstacles, int32_t i, int32_t j)
{
    return obstacles->items[i].motion == SHV_OBSTACLE_FREE || obstacles->items[j].motion == SHV_OBSTACLE_FREE;
}

int32_t shv_collide_capacity(const ShvObstacles *obstacles)
{
    int64_t total = 0;
    for (int32_t i = 0; i < obstacles->count; i++)
        for (int32_t j = i + 1; j < obstacles->count; j++)
            if (pair_counts(obstacles, i, j))
                total += sample_count(&obstacles->items[i]) + (int64_t)sample_count(&obstacles->items[j]);
    return total < MOST_CONTACTS ? (int32_t)total : MOST_CONTACTS;
}

static void keep(ShvObstacles *obstacles, int32_t *count, const ShvBodyContact *contact)
{
    if (*count < obstacles->contact_capacity) {
        obstacles->contacts[(*count)++] = *contact;
        return;
    }
    int32_t shallowest = 0;
    for (int32_t k = 1; k < *count; k++)
        if (obstacles->contacts[k].gap > obstacles->contacts[shallowest].gap) shallowest = k;
    if (contact->gap < obstacles->contacts[shallowest].gap) obstacles->contacts[shallowest] = *contact;
}

static void detect_samples(ShvObstacles *obstacles, int32_t sampled, int32_t other, double margin, int32_t *count)
{
    const ShvObstacle *a = &obstacles->items[sampled], *b = &obstacles->items[other];
    if (!samples_matter(a, b)) return;
    const int32_t samples = sample_count(a);
    const double radius = a->shape == SHV_OBSTACLE_SPHERE ? a->radius : 0.0;
    for (int32_t k = 0; k < samples; k++) {
        const ShvSurfacePoint at = shv_obstacle_closest(b, sample_position(a, k), margin + radius);
        if (at.gap - radius > margin) continue;
        const ShvBodyContact contact = {.first = sampled,
                                        .second = other,
                                        .point = at.point,
                                        .normal = at.normal,
                                        .gap = at.gap - radius,
                                        .friction = sqrt(a->friction * b->friction),
                                        .restitution = fmax(a->restitution, b->restitution)};
        keep(obstacles, count, &contact);
    }
}

static bool far_apart(const ShvObstacle *a, const ShvObstacle *b, double margin)
{
    if (a->shape == SHV_OBSTACLE_PLANE)
        return shv_dot(a->normal, b->position) - a->offset - b->bounding_radius > margin;
    if (b->shape == SHV_OBSTACLE_PLANE) return far_apart(b, a, margin);
    const ShvVec3 between = shv_sub(a->position, b->position);
    const double reach = a->bounding_radius + b->bounding_radius + margin;
    return shv_dot(between, between) > reach * reach;
}

int32_t shv_collide_detect(ShvObstacles *obstacles, double margin)
{
    int32_t count = 0;
    for (int32_t i = 0; i < obstacles->count; i++)
        for (int32_t j = i + 1; j < obstacles->count; j++) {
            if (!pair_counts(obstacles, i, j) || far_apart(&obstacles->items[i], &obstacles->items[j], margin))
                continue;
            detect_samples(obstacles, i, j, margin, &count);
            /* Two spheres are tried once. */
            if (obstacles->items[i].shape != SHV_OBSTACLE_SPHERE || obstacles->items[j].shape != SHV_OBSTACLE_SPHERE)
                detect_samples(obstacles, j, i, margin, &count);
        }
    return count;
}

bool shv_collide_overlap(const ShvObstacles *all, const ShvObstacle *first, const ShvObstacle *second, double least,
                         ShvBodyContact *deepest)
{
    ShvObstacle items[2] = {*first, *second};
    ShvObstacles both = {
        .items = items, .count = 2, .contacts = all->contacts, .contact_capacity = all->contact_capacity};
    const int32_t count = shv_collide_detect(&both, -least);
    for (int32_t k = 0; k < count; k++)
        if (k == 0 || both.contacts[k].gap < deepest->gap) *deepest = both.contacts[k];
    return count > 0;
}

/* ---- response ---- */

ShvVec3 shv_collide_velocity(const ShvObstacles *obstacles, const ShvBodyContact *contact)
{
    return shv_sub(shv_obstacle_velocity(&obstacles->items[contact->first], contact->point),
                   shv_obstacle_velocity(&obstacles->items[contact->second], contact->point));
}

static void apply_impulse(ShvObstacles *obstacles, const ShvBodyContact *contact, ShvVec3 impulse)
{
    shv_obstacle_impulse(&obstacles->items[contact->first], contact->point, impulse);
    shv_obstacle_impulse(&obstacles->items[contact->second], contact->point, shv_scale(impulse, -1.0));
}

static double inverse_mass(const ShvObstacles *obstacles, const ShvBodyContact *contact, ShvVec3 direction)
{
    return shv_obstacle_inverse_mass(&obstacles->items[contact->first], contact->point, direction) +
           shv_obstacle_inverse_mass(&obstacles->items[contact->second], contact->point, direction);
}

/* One visit: exact in the normal direction, then friction within its circle. Returns the change of velocity. */
static double relax(ShvObstacles *obstacles, ShvBodyContact *contact)
{
    const double closing = contact->target - shv_dot(shv_collide_velocity(obstacles, contact), contact->normal);
    const double inverse = inverse_mass(obstacles, contact, contact->normal);
    const double wanted = fmax(0.0, contact->normal_impulse + closing / inverse);
    const double change = wanted - contact->normal_impulse;
    contact->normal_impulse = wanted;
    apply_impulse(obstacles, contact, shv_scale(contact->normal, change));
    const double most = contact->friction * wanted;
    const ShvVec3 relative = shv_collide_velocity(obstacles, contact);
    const ShvVec3 slip = shv_madd(relative, -shv_dot(relative, contact->normal), contact->normal);
    const double speed = shv_norm(slip);
    ShvVec3 tangential = contact->tangential;
    if (speed > 0.0 && most > 0.0) {
        const ShvVec3 along = shv_scale(slip, 1.0 / speed);
        tangential = shv_madd(tangential, -speed / inverse_mass(obstacles, contact, along), along);
    }
    const double size = shv_norm(tangential);
    if (size > most) tangential = shv_scale(tangential, most / size);
    const ShvVec3 difference = shv_sub(tangential, contact->tangential);
    contact->tangential = tangential;
    apply_impulse(obstacles, contact, difference);
    return fmax(fabs(change), shv_norm(difference)) * inverse;
}

/* Impulse · velocity before and after, over active contacts: of the first against the second, and on free obstacles
   alone. */
typedef struct ContactPower {
    double relative_before, relative_after, free_before, free_after;
} ContactPower;

static ContactPower power_of(const ShvObstacles *obstacles, int32_t count)
{
    ContactPower power = {0.0, 0.0, 0.0, 0.0};
    for (int32_t k = 0; k < count; k++) {
        const ShvBodyContact *contact = &obstacles->contacts[k];
        if (!contact->active) continue;
        const ShvVec3 impulse = shv_madd(contact->tangential, contact->normal_impulse, contact->normal);
        for (int side = 0; side < 2; side++) {
            const ShvObstacle *obstacle = &obstacles->items[side ? contact->second : contact->first];
            const double sign = side ? -1.0 : 1.0;
            const double before = sign * shv_dot(impulse, contact->velocity[side]);
            const double after = sign * shv_dot(impulse, shv_obstacle_velocity(obstacle, contact->point));
            power.relative_before += before;
            power.relative_after += after;
            if (obstacle->motion != SHV_OBSTACLE_FREE) continue;
            power.free_before += before;
            power.free_after += after;
        }
    }
    return power;
}

/* Applies `share` of all impulses of the active contacts. */
static void apply_share(ShvObstacles *obstacles, int32_t count, double share)
{
    for (int32_t k = 0; k < count; k++) {
        const ShvBodyContact *contact = &obstacles->contacts[k];
        if (!contact->active) continue;
        const ShvVec3 impulse = shv_madd(contact->tangential, contact->normal_impulse, contact->normal);
        apply_impulse(obstacles, contact, shv_scale(impulse, share));
    }
}

static ShvVec3 total_on_free(const ShvObstacles *obstacles, int32_t count)
{
    ShvVec3 total = {0.0, 0.0, 0.0};
    for (int32_t k = 0; k < count; k++) {
        const ShvBodyContact *contact = &obstacles->contacts[k];
        if (!contact->active) continue;
        const ShvVec3 impulse = shv_madd(contact->tangential, contact->normal_impulse, contact->normal);
        if (obstacles->items[contact->first].motion == SHV_OBSTACLE_FREE) total = shv_add(total, impulse);
        if (obstacles->items[contact->second].motion == SHV_OBSTACLE_FREE) total = shv_sub(total, impulse);
    }
    return total;
}

static void sweep_contacts(ShvObstacles *obstacles, int32_t count)
{
    double scale = 0.0;
    for (int32_t k = 0; k < count; k++) {
        ShvBodyContact *contact = &obstacles->contacts[k];
        contact->normal_impulse = 0.0;
        contact->tangential = shv_vec3(0.0, 0.0, 0.0);
        contact->velocity[0] = shv_obstacle_velocity(&obstacles->items[contact->first], contact->point);
        contact->velocity[1] = shv_obstacle_velocity(&obstacles->items[contact->second], contact->point);
        if (contact->active) scale = fmax(scale, shv_norm(shv_sub(contact->velocity[0], contact->velocity[1])));
    }
    for (int sweep = 0; sweep < MOST_SWEEPS; sweep++) {
        double largest = 0.0;
        for (int32_t k = 0; k < count; k++)
            if (obstacles->contacts[k].active) largest = fmax(largest, relax(obstacles, &obstacles->contacts[k]));
        if (largest <= 1e-11 * scale) return; /* rounding of gaps, over a step, is some 1e-12 of it */
    }
}

double shv_collide_solve(ShvObstacles *obstacles, int32_t count, ShvVec3 *impulse)
{
    sweep_contacts(obstacles, count);
    ContactPower power = power_of(obstacles, count);
    double share = 1.0;
    if (power.relative_before + power.relative_after > 0.0) {
        /* Work of simultaneous impulses is J·(w₀ + w₁)/2; with the share s of all: s J·w₀ + ½ s² J·(w₁ − w₀). */
        const double growth = power.relative_after - power.relative_before;
        share = power.relative_before < 0.0 ? -2.0 * power.relative_before / growth : 0.0;
        apply_share(obstacles, count, share - 1.0);
        power.free_after = power.free_before + share * (power.free_after - power.free_before);
    }
    *impulse = shv_scale(total_on_free(obstacles, count), share);
    return 0.5 * share * (power.free_before + power.free_after);
}
