#include "cli/command.h"

#include <math.h>
#include <stdio.h>

enum { JSON };

static void print_plan(const ShvPlan *plan)
{
    for (int32_t i = 0; i < plan->part_count; i++)
        printf("%-3s %-16s %12zu bytes  %s\n", plan->parts[i].on ? "on" : "off", plan->parts[i].name,
               plan->parts[i].bytes, plan->parts[i].reason);
    printf("    %-16s %12zu bytes before the first crack\n", "all", plan->bytes);
    printf("\nfracture mode: step %.4g s, %.3g steps and about %.3g s of run time for each awake millisecond (measured "
           "now)\n",
           plan->step, plan->steps_per_millisecond, plan->steps_per_millisecond * plan->seconds_per_step);
    if (isfinite(plan->first_contact))
        printf("first contact at about %.4g s; ", plan->first_contact);
    else
        printf("no contact on the free paths; ");
    printf("awake at least %.4g s: %.4g steps, about %.3g s of run time; more if pieces wake again\n", plan->awake_time,
           plan->predicted_steps, plan->predicted_seconds);
    printf("%d animation frames\n", (int)plan->frames);
}

static ShvMaterialView material_of(const void *simulation, int32_t index)
{
    return shv_simulation_material(simulation, index);
}

static ShvMaterialList materials_of(const ShvSimulation *simulation)
{
    return (ShvMaterialList){simulation, shv_simulation_material_count(simulation), material_of};
}

static void print_json(const ShvPlan *plan, const ShvSimulation *simulation)
{
    printf("{\"parts\": [");
    for (int32_t i = 0; i < plan->part_count; i++) {
        printf("%s{\"name\": ", i ? ", " : "");
        shv_cli_print_json_text(plan->parts[i].name);
        printf(", \"on\": %s, \"bytes\": %zu, \"reason\": ", plan->parts[i].on ? "true" : "false",
               plan->parts[i].bytes);
        shv_cli_print_json_text(plan->parts[i].reason);
        printf("}");
    }
    printf("], \"bytes\": %zu, \"frames\": %d", plan->bytes, (int)plan->frames);
    const struct {
        const char *name;
        double value;
    } numbers[] = {{"step", plan->step},
                   {"seconds_per_step", plan->seconds_per_step},
                   {"first_contact", plan->first_contact},
                   {"awake_time", plan->awake_time},
                   {"predicted_steps", plan->predicted_steps},
                   {"predicted_seconds", plan->predicted_seconds}};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        printf(", \"%s\": ", numbers[i].name);
        shv_cli_print_json_number(numbers[i].value);
    }
    shv_cli_print_materials_json(materials_of(simulation));
    printf("}\n");
}

static ShvStatus print_any(ShvSimulation *simulation, const ShvArguments *arguments, ShvError *error)
{
    ShvPlan plan;
    const ShvStatus status = shv_simulation_plan(simulation, &plan, error);
    if (status != SHV_OK) return status;
    if (arguments->values[JSON]) {
        print_json(&plan, simulation);
    } else {
        print_plan(&plan);
        printf("\n");
        shv_cli_print_materials(materials_of(simulation));
    }
    return SHV_OK;
}

static int run(const ShvArguments *arguments)
{
    return shv_cli_inspect(arguments, print_any);
}

const ShvCommand shv_command_plan = {
    .name = "plan",
    .positional = "SCENE",
    .summary = "print what a scene needs: parts on or off, bytes, predicted steps and run time",
    .details =
        "Prints every part of the program as on or off for this scene, why, and the bytes it takes before the first\n"
        "crack; the time of the first contact, and the steps and run time of the shortest fracture phase after it,\n"
        "from a few steps timed on this machine.",
    .least_positional = 1,
    .most_positional = 1,
    .takes_scene = true,
    .options = {{"--json", NULL, "print as JSON"}},
    .run = run,
};
