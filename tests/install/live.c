/* A plate lies on two bars; in mid-run a steel ball is thrown at it, and its splits are told as events. Its tets come from memory.
   usage: live; status 0 when all went as it should. */
#include <math.h>
#include <shiver/shiver.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ACROSS = 8, THICK = 1, NODES = (ACROSS + 1) * (ACROSS + 1) * (THICK + 1), TETS = 5 * ACROSS * ACROSS * THICK };
static double positions[3 * NODES];
static int32_t tets[4 * TETS];

static int32_t node(int x, int y, int z)
{
    return (z * (ACROSS + 1) + y) * (ACROSS + 1) + x;
}

/* Bricks of five tets, mirrored from one to the next. */
static void make_plate(double side, double thickness)
{
    static const int even[5][4] = {{0, 1, 3, 5}, {0, 3, 2, 6}, {0, 5, 6, 4}, {3, 6, 5, 7}, {0, 3, 6, 5}};
    for (int z = 0; z <= THICK; z++)
        for (int y = 0; y <= ACROSS; y++)
            for (int x = 0; x <= ACROSS; x++) {
                double *at = positions + 3 * node(x, y, z);
                at[0] = side * ((double)x / ACROSS - 0.5);
                at[1] = side * ((double)y / ACROSS - 0.5);
                at[2] = thickness * z / THICK;
            }
    int32_t *next = tets;
    for (int y = 0; y < ACROSS; y++)
        for (int x = 0; x < ACROSS; x++)
            for (int t = 0; t < 5; t++) {
                const int mirrored = (x + y) % 2;
                for (int k = 0; k < 4; k++) {
                    const int corner = even[t][mirrored && k > 1 ? 5 - k : k] ^ mirrored;
                    *next++ = node(x + (corner & 1), y + (corner >> 1 & 1), corner >> 2);
                }
            }
}

static const char scene_text[] = "shiver: 1\n"
                                 "materials:\n"
                                 "  plaster: {library: plaster}\n"
                                 "objects:\n"
                                 "  plate: {mesh: {memory: {scale: 1}}, material: plaster, position: [0, 0, 0.02]}\n"
                                 "obstacles:\n"
                                 "  left: {box: {size: [0.02, 0.3, 0.02]}, position: [-0.08, 0, 0.01]}\n"
                                 "  right: {box: {size: [0.02, 0.3, 0.02]}, position: [0.08, 0, 0.01]}\n"
                                 "  floor: {plane: {normal: [0, 0, 1]}}\n"
                                 "  ball: {sphere: {radius: 0.02}, mass: 0.26, waits: true}\n"
                                 "duration: 1\n";

typedef struct Told {
    int wakes, splits;
} Told;

static void on_event(void *data, const ShvEventView *event)
{
    Told *told = data;
    told->wakes += event->kind == SHV_RUN_WAKE;
    told->splits += event->kind == SHV_RUN_SPLIT;
}

static int fail(const char *what, const ShvError *error)
{
    fprintf(stderr, "%s: %s\n", what, error->message);
    return 1;
}

/* What is refused is refused in words, and nothing has changed. */
static int refuse(ShvSimulation *simulation, ShvError *error)
{
    ShvPlacement inside = {.position = {0.0, 0.0, 0.025}};
    if (shv_simulation_enter(simulation, "ball", &inside, error) != SHV_BAD_INPUT || !strstr(error->message, "plate"))
        return fail("a ball inside the plate was let in", error);
    if (shv_simulation_enter(simulation, "bullet", &inside, error) != SHV_BAD_INPUT)
        return fail("something unknown was let in", error);
    if (shv_simulation_step(simulation, -1.0, error) != SHV_BAD_INPUT) return fail("a step into the past", error);
    return 0;
}

static int throw_ball(ShvSimulation *simulation, Told *told, ShvError *error)
{
    shv_simulation_listen(simulation, on_event, told);
    if (shv_simulation_step(simulation, 0.01, error) != SHV_OK) return fail("step", error);
    const double before = shv_simulation_frame(simulation)->ledger.residual;
    if (refuse(simulation, error)) return 1;
    const ShvPlacement above = {.position = {0.0, 0.0, 0.06}, .velocity = {0.0, 0.0, -6.0}};
    if (shv_simulation_enter(simulation, "ball", &above, error) != SHV_OK) return fail("enter", error);
    for (double time = 0.011; time < 0.0235 && told->splits == 0; time += 1e-3)
        if (shv_simulation_step(simulation, time, error) != SHV_OK) return fail("step", error);
    const ShvLedgerView ledger = shv_simulation_frame(simulation)->ledger;
    printf("at %.3f s: %d wakes, %d splits, %d pieces; residual %.2g of %.3g J\n", ledger.time, told->wakes,
           told->splits, shv_simulation_frame(simulation)->alive_count, ledger.residual - before, ledger.largest);
    if (told->splits == 0 || fabs(ledger.residual) > 0.01 * ledger.largest) return fail("no split", error);
    return 0;
}

static int run(ShvScene *scene, ShvError *error)
{
    ShvSimulation *simulation;
    Told told = {0, 0};
    if (shv_scene_give_mesh(scene, "plate", positions, NODES, tets, TETS, error) != SHV_OK) return fail("mesh", error);
    if (shv_simulation_create(&simulation, shv_scene_definition(scene), NULL, error) != SHV_OK)
        return fail("create", error);
    int failed = throw_ball(simulation, &told, error);
    if (!failed && shv_simulation_leave(simulation, "ball", error) != SHV_OK) failed = fail("leave", error);
    shv_simulation_destroy(simulation);
    return failed;
}

int main(void)
{
    ShvScene *scene;
    ShvError error = {SHV_OK, ""};
    make_plate(0.2, 0.01);
    if (shv_scene_parse(&scene, scene_text, strlen(scene_text), "live", NULL, NULL, 0, NULL, NULL, &error) != SHV_OK)
        return fail("scene", &error);
    const int failed = run(scene, &error);
    shv_scene_destroy(scene);
    return failed;
}
