/* Speed of rigid flight: bench_rigid [SECONDS [CASE]]. Each case flies for that long (1 s) in steps of 1 ms, with the Bullet
   backend and, with the same hulls, masses, friction and step, in a plain btDiscreteDynamicsWorld (bullet_plain). One line of CSV each:

     flight     200 convex pieces that tumble, and meet nothing
     pile       200 convex pieces that fall into a bin of 0.5 m
     splinters  a ball cut into 2,500 splinters, pushed outward over a floor
     heap       a ball cut into 60 pieces of many hulls, falling apart on a floor

   bodies, hulls, mean milliseconds (of the processor) a step of the backend and of plain Bullet, their ratio, the same over the last tenth of the
   time, and the kinetic energy that is left in each, J. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/random.h"
#include "base/text.h"
#include "broken_ball.h"
#include "rigid/backend.h"

enum { PIECES = 200, PLANES = 5 };
static const double step = 1e-3, friction = 0.5, bin = 0.5;
static const double plain_margin = 0.04; /* Bullet's own, of the mean radius */
static const double earth[3] = {0.0, 0.0, -9.81};

typedef struct Case {
    const char *name;
    double gravity[3];
    int32_t planes;
    BrokenBall bodies;
    ShvObstacles obstacles;
    ShvObstacleDefinition definitions[PLANES];
    ShvFragments plain_fragments;
    ShvRigidBackend *backend, *plain;
    int32_t hulls;
} Case;

typedef struct Times {
    double all, end; /* s: of all steps, of the last tenth */
} Times;

/* ---- bodies ---- */

/* Boxes and coarse balls, of 4 to 8 cm. */
static ShvStatus make_pieces(BrokenBall *bodies, ShvError *error)
{
    static ShvObjectDefinition objects[PIECES];
    static char names[PIECES][16];
    ShvMaterialDefinition material = shv_material_default();
    material.name = "glass";
    material.density = 2500.0;
    material.youngs_modulus = 70e9;
    material.poissons_ratio = 0.22;
    material.breakable = false;
    for (int i = 0; i < PIECES; i++) {
        ShvObjectDefinition *object = &objects[i];
        *object = shv_object_default();
        snprintf(names[i], sizeof names[i], "piece%d", i);
        object->name = names[i];
        object->material = "glass";
        object->mesh.kind = i % 2 ? SHV_MESH_BALL : SHV_MESH_BOX;
        object->mesh.radius = object->mesh.edge = 0.03;
        for (int k = 0; k < 3; k++)
            object->mesh.size[k] = 0.04 + 0.04 * shv_random_uniform(3, 3 * (uint64_t)i + (uint64_t)k);
        object->mesh.edge = i % 2 ? 0.03 : 0.08;
        object->placement.position[0] = 0.1 * (i % 5 - 2);
        object->placement.position[1] = 0.1 * (i / 5 % 5 - 2);
        object->placement.position[2] = 0.06 + 0.1 * (double)(i / 25);
    }
    ShvSceneDefinition scene = shv_scene_default();
    scene.materials = &material;
    scene.objects = objects;
    scene.material_count = 1;
    scene.object_count = PIECES;
    scene.threads = 1;
    *bodies = (BrokenBall){0};
    SHV_TRY(shv_model_build(&bodies->model, NULL, &scene, NULL, error));
    SHV_TRY(shv_state_create(&bodies->state, &bodies->model, &scene, error));
    return shv_fragments_create(&bodies->fragments, &bodies->model, &bodies->state, error);
}

static void set_motions(const Case *bench)
{
    for (int32_t f = 0; f < bench->bodies.fragments.count; f++) {
        ShvFragment *fragment = &bench->bodies.fragments.items[f];
        if (fragment->mode == SHV_MODE_DEAD) continue;
        shv_fragment_fit(fragment, &bench->bodies.fragments, &bench->bodies.state);
        const bool flight = !strcmp(bench->name, "flight"), pile = !strcmp(bench->name, "pile");
        double random[3];
        for (int k = 0; k < 3; k++) random[k] = 2.0 * shv_random_uniform(5, 3 * (uint64_t)f + (uint64_t)k) - 1.0;
        if (flight || pile) fragment->angular_velocity = shv_scale(shv_load3(random), 5.0);
        if (flight) fragment->position = shv_scale(fragment->position, 2.0);
        if (flight || pile) continue;
        fragment->velocity = shv_scale(fragment->position, strcmp(bench->name, "heap") ? 30.0 : 1.0);
        fragment->position.z += 1.05 * BROKEN_BALL_RADIUS;
    }
}

/* ---- worlds ---- */

static const double normals[PLANES][3] = {{0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};

static ShvStatus make_obstacles(Case *bench, ShvError *error)
{
    static const char *const names[PLANES] = {"floor", "left", "right", "front", "back"};
    for (int i = 0; i < bench->planes; i++) {
        ShvObstacleDefinition *plane = &bench->definitions[i];
        *plane = shv_obstacle_default();
        plane->name = names[i];
        plane->shape = SHV_OBSTACLE_PLANE;
        plane->motion = SHV_OBSTACLE_FIXED;
        memcpy(plane->plane_normal, normals[i], sizeof plane->plane_normal);
        plane->plane_offset = i ? -0.5 * bin : 0.0;
        plane->friction = friction;
        plane->restitution = 0.0;
    }
    ShvSceneDefinition scene = shv_scene_default();
    scene.obstacles = bench->definitions;
    scene.obstacle_count = bench->planes;
    return shv_obstacles_create(&bench->obstacles, NULL, &scene, NULL, error);
}

/* Records of plain Bullet's own; the lists are shared. */
static ShvStatus copy_fragments(Case *bench, ShvError *error)
{
    const ShvFragments *fragments = &bench->bodies.fragments;
    const size_t count = (size_t)fragments->count;
    bench->plain_fragments = *fragments;
    bench->plain_fragments.items = shv_allocate(NULL, SHV_PART_GENERAL, count, sizeof *fragments->items);
    if (!bench->plain_fragments.items) return shv_fail_memory(error, "plain Bullet", count * sizeof *fragments->items);
    memcpy(bench->plain_fragments.items, fragments->items, count * sizeof *fragments->items);
    return SHV_OK;
}

static ShvStatus make_worlds(Case *bench, ShvError *error)
{
    double length = 0.0;
    BrokenBall *bodies = &bench->bodies;
    SHV_TRY(make_obstacles(bench, error));
    for (int32_t f = 0; f < bodies->fragments.count; f++)
        if (bodies->fragments.items[f].mode != SHV_MODE_DEAD) length += bodies->fragments.items[f].radius;
    const ShvBulletPlainDefinition settings = {.unit = length / bodies->fragments.alive, .margin = plain_margin};
    SHV_TRY(copy_fragments(bench, error));
    ShvRigidDefinition rigid = shv_scene_default().rigid;
    rigid.friction = friction;
    const ShvRigidWorld world = {&bodies->model, &bodies->state, &bodies->fragments, &bench->obstacles, &rigid};
    ShvRigidWorld plain_world = world;
    plain_world.fragments = &bench->plain_fragments;
    SHV_TRY(shv_bullet_create(&bench->backend, &world, error));
    SHV_TRY(shv_bullet_plain_create(&bench->plain, &plain_world, &settings, error));
    for (int32_t f = 0; f < bodies->fragments.count; f++) {
        if (bodies->fragments.items[f].mode == SHV_MODE_DEAD) continue;
        SHV_TRY(bench->backend->functions->add(bench->backend, f, error));
        SHV_TRY(bench->plain->functions->add(bench->plain, f, error));
        bench->hulls += bodies->fragments.items[f].hulls;
    }
    return SHV_OK;
}

/* ---- runs ---- */

/* Seconds of processor time, in one thread: other work on the machine counts less than in those of the clock. */
static double now(void)
{
    return (double)clock() / CLOCKS_PER_SEC;
}

static void count(Times *times, double start, bool last)
{
    const double taken = now() - start;
    times->all += taken;
    if (last) times->end += taken;
}

/* Step by step in turn, so that both see the same machine. */
static ShvStatus run_both(Case *bench, int32_t steps, Times *own, Times *plain, ShvError *error)
{
    int32_t wake_count = 0; /* nobody wakes */
    for (int32_t i = 0; i < steps; i++) {
        const bool last = i >= steps - steps / 10;
        double start = now();
        SHV_TRY(bench->backend->functions->advance(bench->backend, i * step, step, bench->gravity, NULL, NULL, NULL,
                                                   &wake_count, error));
        count(own, start, last);
        start = now();
        SHV_TRY(bench->plain->functions->advance(bench->plain, i * step, step, bench->gravity, NULL, NULL, NULL,
                                                 &wake_count, error));
        count(plain, start, last);
    }
    return SHV_OK;
}

static double kinetic(const ShvFragments *fragments)
{
    double sum = 0.0;
    for (int32_t f = 0; f < fragments->count; f++)
        if (fragments->items[f].mode != SHV_MODE_DEAD) sum += shv_fragment_kinetic(&fragments->items[f]);
    return sum;
}

static void report(const Case *bench, int32_t steps, const Times *own, const Times *plain)
{
    const double all = 1e3 / steps, end = 1e3 / (steps / 10);
    shv_print(stdout, "%s,%d,%d,%.4f,%.4f,%.3f,%.4f,%.4f,%.3f,%.3g,%.3g\n", bench->name,
              (int)bench->bodies.fragments.alive, (int)bench->hulls, all * own->all, all * plain->all,
              own->all / plain->all, end * own->end, end * plain->end, own->end / plain->end,
              kinetic(&bench->bodies.fragments), kinetic(&bench->plain_fragments));
    fflush(stdout);
}

static ShvStatus run(Case *bench, int32_t steps, ShvError *error)
{
    set_motions(bench);
    SHV_TRY(make_worlds(bench, error));
    Times own = {0}, plain = {0};
    SHV_TRY(run_both(bench, steps, &own, &plain, error));
    report(bench, steps, &own, &plain);
    return SHV_OK;
}

static ShvStatus measure(const char *name, int32_t steps, ShvError *error)
{
    Case bench = {.name = name};
    ShvStatus status;
    if (!strcmp(name, "splinters"))
        status = broken_ball_make(&bench.bodies, NULL, 0.015, 2500, error);
    else if (!strcmp(name, "heap"))
        status = broken_ball_make(&bench.bodies, NULL, 0.01, 60, error);
    else
        status = make_pieces(&bench.bodies, error);
    if (strcmp(name, "flight")) memcpy(bench.gravity, earth, sizeof earth);
    bench.planes = !strcmp(name, "flight") ? 0 : !strcmp(name, "pile") ? PLANES : 1;
    if (status == SHV_OK) status = run(&bench, steps, error);
    if (bench.backend) bench.backend->functions->destroy(bench.backend);
    if (bench.plain) bench.plain->functions->destroy(bench.plain);
    shv_release(bench.plain_fragments.items);
    shv_obstacles_release(&bench.obstacles);
    broken_ball_release(&bench.bodies);
    return status;
}

int main(int argc, char **argv)
{
    static const char *const names[] = {"flight", "pile", "splinters", "heap"};
    const int32_t steps = (int32_t)((argc > 1 ? strtod(argv[1], NULL) : 1.0) / step);
    ShvError error;
    if (steps < 10) {
        fputs("bench_rigid [SECONDS [CASE]]: at least 0.01 s\n", stderr);
        return 2;
    }
    puts("case,bodies,hulls,milliseconds,plain_milliseconds,ratio,end_milliseconds,plain_end_milliseconds,end_ratio,"
         "kinetic,plain_kinetic");
    for (int i = 0; i < 4; i++)
        if ((argc < 3 || !strcmp(argv[2], names[i])) && measure(names[i], steps, &error) != SHV_OK) {
            fprintf(stderr, "%s\n", error.message);
            return 1;
        }
    return 0;
}
