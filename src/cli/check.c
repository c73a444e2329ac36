#include "cli/command.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { JSON };

/* `tip_strength` is made for meshes like that; what it does is told with the material. */
static void warn_mesh(const ShvPreflight *p)
{
    if (!p->breakable || p->cohesion.unresolved == SHV_UNRESOLVED_TIP_STRENGTH) return;
    if (p->breaking_longest_edge > p->snap_back)
        printf(
            "  warning: edges up to %.3g m are longer than the snap-back length %.3g m: a facet that opens beside such "
            "a\n"
            "           tet releases more energy than G; cracks cost too much or run unstably. Use a finer mesh or a\n"
            "           larger fracture_energy\n",
            p->breaking_longest_edge, p->snap_back);
    if (p->breaking_mean_edge > p->cohesive_zone / 5.0)
        printf("  warning: the cohesive zone (%.3g m) spans %.2g mean edges; 5 to 10 resolve it: the strength of crack "
               "tips\n"
               "           depends on the mesh\n",
               p->cohesive_zone, p->cohesive_zone / p->breaking_mean_edge);
}

/* Steps go with the flattest tet: half an edge is the altitude of a good one, generators get within a tenth of an edge. */
static void warn_sliver(const ShvPreflight *p)
{
    const double good = 0.5, poor = 0.3, flat = 0.05; /* mean edges */
    const double height = p->smallest_altitude / p->mean_edge;
    if (!(height < (p->improvable ? poor : flat))) return;
    printf("  %s: the flattest tet is %.3g m high, %.2g of the mean edge, and sets the step: a mesh without "
           "such\n           takes about %.*f times fewer steps; try %s\n",
           height < flat ? "warning" : "note", p->smallest_altitude, height, height < flat ? 0 : 1, good / height,
           p->improvable ? "'improve: true' in the object's mesh" : "another edge length, or another mesher");
}

/* Where most of a body is wall. On edges as long as it is thick, linear tets are 2.3 times too stiff. */
static void warn_wall(const ShvPreflight *p)
{
    const double noted = 1.5, too_stiff = 2.5;
    if (!p->breakable || !(p->wall_share > 0.5 && p->wall_stiffness > noted)) return;
    printf("  %s: its walls, %.2g m thick on edges of %.2g m, are about %.1f times too stiff in bending",
           p->wall_stiffness > too_stiff ? "warning" : "note", p->wall_thickness, p->wall_edge, p->wall_stiffness);
    if (p->wall_stiffness > too_stiff)
        printf(": they break late under a\n           blow, and into too many pieces; take edges of %.2g m at most, or "
               "'smoothing: edges' (docs/walls.md)",
               p->wall_thickness);
    else
        printf(": 'smoothing: edges' lets them bend (docs/walls.md)");
    printf("\n");
}

static void warn_order(const ShvPreflight *p)
{
    const ShvMaterialView *m = &p->cohesion;
    if (!p->breakable) return;
    if (p->ordered)
        printf("  note: its nodes stand in rank and file: cracks follow their planes%s;\n"
               "        'pattern: unstructured' has no such planes (docs/glass.md)\n",
               m->unresolved == SHV_UNRESOLVED_TIP_STRENGTH ? "" : ", and begin at up to 1.4 times the strength");
}

static void warn_bonds(const ShvPreflight *p)
{
    if (!p->never_parts) return;
    printf("  warning: a facet fails only when it is open by %.3g m, more than its edge of %.3g m: its bonds hold for "
           "all\n"
           "           that happens, and nothing comes apart. Give a smaller fracture_energy or a larger "
           "cohesive_strength,\n"
           "           or 'fracture: {connectivity: nodes}', under which a crack cuts as soon as it is inserted\n",
           p->final_opening, p->breaking_mean_edge);
}

static void warn_step(const ShvPreflight *p)
{
    if (!p->breakable) return;
    if (p->steps_to_open < 5.0)
        printf("  note: a facet opens in %.2g steps; the cohesive impulse takes the exact work G from it at any step, "
               "but the\n"
               "        opening itself is not resolved in time\n",
               p->steps_to_open);
    if (p->overshoot_each_step > 0.1)
        printf("  warning: at the first impact stress grows by up to %.2f of the strength a step: insertion may "
               "overshoot by\n"
               "           more than 10 %%; a smaller fracture.safety resolves it, and the run reports the worst "
               "overshoot\n",
               p->overshoot_each_step);
    if (p->courant > 1.0) printf("  warning: Courant number above 1\n");
}

/* An interval ten times as long as a body may vibrate costs flight little, and one several times that fracture mode much. */
static void warn_interval(const ShvPreflight *p)
{
    const double enough = 10.0 * p->vibration_time;
    if (!(p->flight_interval > 3.0 * enough)) return;
    printf("  note: what an impact wakes stays in fracture mode until the interval of flight ends, up to %.3g s = %.3g "
           "steps;\n"
           "        its vibration needs %.2g s: 'rigid: {time_step: %.1g}' spares most of them\n",
           p->flight_interval, p->flight_interval / p->step, p->vibration_time, enough);
}

static void warn_obstacle(const ShvPreflight *p)
{
    if (!p->small_obstacle) return;
    printf(
        "  warning: the obstacle '%s' (%.3g m) is smaller than an edge (%.3g m): it meets facets between their "
        "nodes,\n"
        "           which share its force; what happens within an edge of it is not resolved. Use a finer mesh where "
        "that matters\n",
        p->small_obstacle, p->small_obstacle_size, p->mean_edge);
}

static void print_breaking(const ShvPreflight *p)
{
    if (p->breaking == SHV_BREAKING_PLANE)
        printf("  cracks keep to a plane: %d tets beside it, edges %.3g … %.3g m (mean, longest)\n",
               (int)p->breaking_tets, p->breaking_mean_edge, p->breaking_longest_edge);
    if (p->breaking == SHV_BREAKING_TIPS)
        printf("  tips of notches and cracks: %d tets, edges %.3g m on the mean\n", (int)p->breaking_tets,
               p->breaking_mean_edge);
}

static void print_nearest(const ShvPreflight *p)
{
    const char *kind = p->nearest_is_obstacle ? "obstacle" : "object";
    if (p->nearest && p->clearance > 0.0)
        printf("  nearest: the %s '%s', %.3g m away\n", kind, p->nearest, p->clearance);
    else if (p->nearest)
        printf("  touches the %s '%s'\n", kind, p->nearest);
    if (!isnan(p->impact_speed))
        printf(
            "  first impact at %.3g m/s or less: stress behind the wave grows by about %.3g of the strength a step\n",
            p->impact_speed, p->overshoot_each_step);
    else if (p->clearance > 0.0)
        printf("  note: it moves towards nothing as the scene begins\n");
    if (p->wakes_by_spin)
        printf(
            "  note: its rotation stresses it by up to %.3g of the strength, and by twice that at first, as it is not\n"
            "        stretched yet: it wakes by itself, and may burst\n",
            p->centrifugal_stress / p->cohesion.strength);
}

/* Objects one after another of the same mesh, wherever they stand: told once. */
typedef struct Alike {
    const char *first, *last;
    int32_t count;
    ShvPreflight hardest; /* the one with the hardest first impact */
} Alike;

static bool nearly_equal(double a, double b)
{
    return fabs(a - b) <= 1e-9 * fabs(a); /* the same, but for another place and turn */
}

static bool are_alike(const ShvPreflight *a, const ShvPreflight *b)
{
    return strcmp(a->material, b->material) == 0 && a->tets == b->tets && a->nodes == b->nodes &&
           nearly_equal(a->mass, b->mass) && nearly_equal(a->mean_edge, b->mean_edge) &&
           nearly_equal(a->smallest_altitude, b->smallest_altitude) &&
           nearly_equal(a->smallest_dihedral, b->smallest_dihedral);
}

static void add(Alike *alike, const ShvPreflight *p)
{
    if (alike->count++ == 0) alike->first = p->object;
    alike->last = p->object;
    if (alike->count == 1 || p->overshoot_each_step > alike->hardest.overshoot_each_step) alike->hardest = *p;
}

static void print_name(const Alike *alike)
{
    const ShvPreflight *p = &alike->hardest;
    if (alike->count > 1)
        printf("%s to %s (%s), %d alike, each: ", alike->first, alike->last, p->material, (int)alike->count);
    else
        printf("%s (%s): ", p->object, p->material);
    printf("%d tets, %d nodes, %.4g kg%s\n", (int)p->tets, (int)p->nodes, p->mass,
           p->smoothed ? "; strain smoothed over edges" : "");
}

static void print_objects(const Alike *alike)
{
    const ShvPreflight *p = &alike->hardest;
    print_name(alike);
    printf("  edges %.3g … %.3g … %.3g m (shortest, mean, longest), smallest altitude %.3g m, worst aspect %.3f, least "
           "dihedral angle %.0f degrees\n",
           p->shortest_edge, p->mean_edge, p->longest_edge, p->smallest_altitude, p->worst_aspect,
           p->smallest_dihedral);
    print_breaking(p);
    printf("  stable step %.4g s, set by tet %d at (%.4g, %.4g, %.4g); step %.4g s, Courant number %.3f\n",
           p->stable_step, (int)p->stable_element, p->stable_centroid[0], p->stable_centroid[1], p->stable_centroid[2],
           p->step, p->courant);
    printf("  wave speeds %.4g m/s (bar), %.4g m/s (dilatational); bar transit %.3g s, bending period %.3g s\n",
           p->bar_speed, p->dilatational_speed, p->bar_transit, p->bending_period);
    if (p->breakable)
        printf("  cohesive zone %.3g m, snap-back length %.3g m, final opening %.3g m; a free face opens it in %.3g s "
               "= %.3g "
               "steps\n",
               p->cohesive_zone, p->snap_back, p->final_opening, p->cohesive_step, p->steps_to_open);
    else
        printf("  cannot break\n");
    if (alike->count > 1) printf("  of these %s has the hardest first impact:\n", p->object);
    print_nearest(p);
    shv_cli_print_cohesion(&p->cohesion);
    warn_mesh(p);
    warn_sliver(p);
    warn_wall(p);
    warn_order(p);
    warn_bonds(p);
    warn_step(p);
    warn_interval(p);
    warn_obstacle(p);
}

static void print_object_json(const ShvPreflight *p)
{
    const struct {
        const char *name;
        double value;
    } numbers[] = {{"mass", p->mass},
                   {"volume", p->volume},
                   {"shortest_edge", p->shortest_edge},
                   {"mean_edge", p->mean_edge},
                   {"longest_edge", p->longest_edge},
                   {"smallest_altitude", p->smallest_altitude},
                   {"worst_aspect", p->worst_aspect},
                   {"stable_step", p->stable_step},
                   {"step", p->step},
                   {"courant", p->courant},
                   {"bar_speed", p->bar_speed},
                   {"dilatational_speed", p->dilatational_speed},
                   {"cohesive_zone", p->cohesive_zone},
                   {"snap_back", p->snap_back},
                   {"breaking_mean_edge", p->breaking_mean_edge},
                   {"breaking_longest_edge", p->breaking_longest_edge},
                   {"final_opening", p->final_opening},
                   {"opening_speed", p->opening_speed},
                   {"cohesive_step", p->cohesive_step},
                   {"steps_to_open", p->steps_to_open},
                   {"clearance", p->clearance},
                   {"impact_speed", p->impact_speed},
                   {"overshoot_each_step", p->overshoot_each_step},
                   {"wall_thickness", p->wall_thickness},
                   {"wall_edge", p->wall_edge},
                   {"wall_stiffness", p->wall_stiffness},
                   {"centrifugal_stress", p->centrifugal_stress},
                   {"bar_transit", p->bar_transit},
                   {"bending_period", p->bending_period},
                   {"vibration_time", p->vibration_time},
                   {"flight_interval", p->flight_interval}};
    printf("{\"object\": ");
    shv_cli_print_json_text(p->object);
    printf(", \"material\": ");
    shv_cli_print_json_text(p->material);
    printf(", \"tets\": %d, \"nodes\": %d, \"stable_tet\": %d, \"breakable\": %s, \"smoothed\": %s, "
           "\"breaking\": \"%s\"",
           (int)p->tets, (int)p->nodes, (int)p->stable_element, p->breakable ? "true" : "false",
           p->smoothed ? "true" : "false", shv_breaking_name(p->breaking));
    if (p->nearest) {
        printf(", \"nearest\": ");
        shv_cli_print_json_text(p->nearest);
    }
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        printf(", \"%s\": ", numbers[i].name);
        shv_cli_print_json_number(numbers[i].value);
    }
    printf(", ");
    shv_cli_print_cohesion_json(&p->cohesion);
    printf("}");
}

static ShvStatus print_all(ShvSimulation *simulation, const ShvArguments *arguments, ShvError *error)
{
    const bool json = arguments->values[JSON] != NULL;
    Alike alike = {0};
    if (json) printf("[");
    for (int32_t i = 0; i < shv_simulation_object_count(simulation); i++) {
        ShvPreflight preflight;
        const ShvStatus status = shv_simulation_preflight(simulation, i, &preflight, error);
        if (status != SHV_OK) return status;
        if (json) {
            if (i > 0) printf(",\n ");
            print_object_json(&preflight);
            continue;
        }
        if (alike.count > 0 && !are_alike(&alike.hardest, &preflight)) {
            print_objects(&alike);
            alike.count = 0;
        }
        add(&alike, &preflight);
    }
    if (alike.count > 0) print_objects(&alike);
    if (json) printf("]\n");
    return shv_cli_warn_overlaps(simulation, error);
}

static int run(const ShvArguments *arguments)
{
    return shv_cli_inspect(arguments, print_all);
}

const ShvCommand shv_command_check = {
    .name = "check",
    .positional = "SCENE",
    .summary = "validate a scene and print its physics before anything runs",
    .details =
        "Reads a scene, makes its meshes and prints for each object what the physics asks for: stable step and the\n"
        "tet that sets it, Courant number, cohesive zone and snap-back length against the mesh, steps to open a\n"
        "facet, characteristic times, what is nearest, how far away and how fast it is met. Objects of one mesh, one\n"
        "after another, are told once (with --json each by itself). Warns where the mesh or the step does not resolve\n"
        "them: at the tips of notches and cracks, on the plane that cracks are to keep to, or on the mean of an\n"
        "object without either. Objects that overlap each other or obstacles at the start, and free obstacles that\n"
        "overlap others, are refused, as by every command that runs a scene: which, how deep, and what parts them.\n"
        "With 'overlaps: keep' in the scene they are warned of: what the run does about it.",
    .least_positional = 1,
    .most_positional = 1,
    .takes_scene = true,
    .takes_stream = true,
    .options = {{"--json", NULL, "print as JSON"}},
    .run = run,
};
