#include "cli/command.h"

#include <math.h>
#include <stdio.h>

#include "base/text.h"

enum { JSON, TRIAL };

/* Processor time of a trial where none is asked for, s. */
static const double usual_trial = 2.0;

static void print_plan(const ShvPlan *plan)
{
    for (int32_t i = 0; i < plan->part_count; i++)
        printf("%-3s %-16s %12zu bytes  %s\n", plan->parts[i].on ? "on" : "off", plan->parts[i].name,
               plan->parts[i].bytes, plan->parts[i].reason);
    printf("    %-16s %12zu bytes before the first crack\n", "all", plan->bytes);
    printf("\nfracture mode: step %.4g s, %.3g steps and about %.3g s of run time for each awake millisecond of a body "
           "without cracks\n  (measured now)\n",
           plan->step, plan->steps_per_millisecond, plan->steps_per_millisecond * plan->seconds_per_step);
    if (isfinite(plan->first_contact))
        printf("first contact at %.4g s at the earliest (of bounding spheres); ", plan->first_contact);
    else
        printf("no contact on the free paths; ");
    printf("awake at least %.4g s or to the end: %.4g steps, about %.3g s of run time; more if it cracks or pieces "
           "wake again\n",
           plan->awake_time, plan->predicted_steps, plan->predicted_seconds);
    if (plan->longest_window > 0.0)
        printf(
            "what cracks may stay awake for %.3g s after its last crack, longer where a crack holds: about %.3g s of "
            "run time while\n  all is awake; fracture.longest shortens that\n",
            plan->longest_window, plan->longest_window / plan->step * plan->seconds_per_step);
    printf("%d animation frames\n", (int)plan->frames);
}

/* Of a body that broke: what the trial saw of it. */
static void print_course(const ShvTrial *trial)
{
    if (isnan(trial->first_wake)) {
        printf("nothing woke\n");
        return;
    }
    printf("first awake at %.6g s, ", trial->first_wake);
    if (isnan(trial->first_crack))
        printf("no crack; ");
    else
        printf("first crack at %.6g s, %d facets inserted; ", trial->first_crack, (int)trial->inserted);
    printf("%lld steps in %.4g awake s, %d fragments\n", (long long)trial->steps, trial->awake, (int)trial->fragments);
}

static void print_bounds(const ShvTrial *trial)
{
    printf("run time of the scene: cannot tell: cracking decides; at least %.3g s of processor time, hardly more than "
           "%.3g s",
           trial->low, trial->high);
    if (trial->untouched > 0)
        printf(" unless what has not woken yet breaks too (%d of the bodies)", (int)trial->untouched);
}

/* Bounds far apart say no more than that it depends on what breaks. A scene that may break and has not yet tells nothing at all. */
static void print_range(const ShvTrial *trial, bool may_break)
{
    const double decisive = 10.0; /* times the low bound */
    if (may_break && isnan(trial->first_crack))
        printf("run time of the scene: %.3g to %.3g s of processor time if nothing cracks; else cannot tell: cracking "
               "decides",
               trial->low, trial->high);
    else if (trial->high > decisive * trial->low)
        print_bounds(trial);
    else
        printf("run time of the scene: about %.3g s of processor time, %.3g to %.3g s", trial->predicted, trial->low,
               trial->high);
    printf("; a longer --trial tells it better\n");
}

/* Where others use the machine too, the run takes longer than its processor time, as the trial did. */
static void print_trial(const ShvTrial *trial, bool may_break)
{
    if (!(trial->seconds > 0.0)) return;
    printf("\ntrial: %.3g s of run time (%.3g s of processor time) for %.6g s of the scene%s: ", trial->seconds,
           trial->processor, trial->time, trial->finished ? ", all of it" : "");
    print_course(trial);
    if (trial->finished)
        printf("run time of the scene: %.3g s of processor time\n", trial->predicted);
    else
        print_range(trial, may_break);
    const double share = trial->processor / trial->seconds;
    if (share < 0.8)
        printf("  others use this machine too: at that rate the run takes %.2g times as long as its processor time\n",
               1.0 / share);
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
    printf("], \"bytes\": %zu, \"frames\": %d, \"trial_finished\": %s", plan->bytes, (int)plan->frames,
           plan->trial.finished ? "true" : "false");
    const struct {
        const char *name;
        double value;
    } numbers[] = {{"step", plan->step},
                   {"seconds_per_step", plan->seconds_per_step},
                   {"first_contact", plan->first_contact},
                   {"awake_time", plan->awake_time},
                   {"longest_window", plan->longest_window},
                   {"predicted_steps", plan->predicted_steps},
                   {"predicted_seconds", plan->predicted_seconds},
                   {"trial_seconds", plan->trial.seconds},
                   {"trial_processor_seconds", plan->trial.processor},
                   {"trial_time", plan->trial.time},
                   {"first_wake", plan->trial.first_wake},
                   {"first_crack", plan->trial.first_crack},
                   {"untouched", (double)plan->trial.untouched},
                   {"run_seconds_low", plan->trial.low},
                   {"run_seconds", plan->trial.predicted},
                   {"run_seconds_high", plan->trial.high}};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        printf(", \"%s\": ", numbers[i].name);
        shv_cli_print_json_number(numbers[i].value);
    }
    shv_cli_print_materials_json(materials_of(simulation));
    printf("}\n");
}

/* Seconds of --trial, as usual without it; negative where it is no number. */
static double trial_seconds(const ShvArguments *arguments)
{
    const char *text = arguments->values[TRIAL];
    if (!text) return usual_trial;
    if ((*text < '0' || *text > '9') && *text != '.') return -1.0;
    char *end = NULL;
    const double seconds = shv_text_to_double(text, &end);
    return end != text && *end == '\0' && seconds >= 0.0 && isfinite(seconds) ? seconds : -1.0;
}

/* A scene that fails in the trial will fail in the run: the plan says so, and is a plan all the same. */
static ShvStatus print_any(ShvSimulation *simulation, const ShvArguments *arguments, ShvError *error)
{
    ShvPlan plan;
    const ShvStatus status = shv_simulation_plan(simulation, &plan, error);
    if (status != SHV_OK) return status;
    const ShvStatus tried = shv_simulation_try(simulation, trial_seconds(arguments), &plan, error);
    if (tried != SHV_OK && tried != SHV_DIVERGED) return tried;
    if (tried == SHV_DIVERGED)
        fprintf(stderr, "shiver: the trial failed at t = %.6g s: %s\n", plan.trial.time, error->message);
    if (arguments->values[JSON]) {
        print_json(&plan, simulation);
        return SHV_OK;
    }
    print_plan(&plan);
    print_trial(&plan.trial, shv_cli_can_break(simulation));
    printf("\n");
    shv_cli_print_materials(materials_of(simulation));
    return SHV_OK;
}

static int run(const ShvArguments *arguments)
{
    if (!(trial_seconds(arguments) >= 0.0)) {
        fprintf(stderr, "shiver: --trial takes seconds of processor time, 0 or more, not '%s'\n",
                arguments->values[TRIAL]);
        return SHV_EXIT_INPUT;
    }
    return shv_cli_inspect(arguments, print_any);
}

const ShvCommand shv_command_plan = {
    .name = "plan",
    .positional = "SCENE",
    .summary = "print what a scene needs: parts on or off, bytes, predicted steps and run time",
    .details =
        "Prints every part of the program as on or off for this scene, why, and the bytes it takes before the first\n"
        "crack; the time of the first contact, and the steps and run time of the shortest fracture phase after it,\n"
        "from a few steps timed on this machine, if nothing cracks.\n"
        "What cracks costs more, how much depends on how much breaks. So the scene is tried: it runs in memory for\n"
        "a while (--trial), to the end if that comes first. The bytes are then those held at the last time before\n"
        "the first crack, and the run time of the scene follows from what the trial took: all of it where it got to\n"
        "the end; else awake time goes on to cost what it did on the whole, until what is awake rests. Bodies that\n"
        "carry too much vibration to rest stay for the longest time that the quiet rule grants, others for the\n"
        "geometric mean of that and the shortest. Low bound: no step gets dearer, and all rests once waves have\n"
        "crossed it twice. High bound: steps get dearer until the end, and all stays awake for the longest time;\n"
        "five times that where something has cracked, since pieces wake again. Bounds ten times apart or more are\n"
        "told as `cannot tell: cracking decides`; a longer trial narrows them. The writing of the run file is in\n"
        "none of them.",
    .least_positional = 1,
    .most_positional = 1,
    .takes_scene = true,
    .takes_stream = true,
    .options = {{"--json", NULL, "print as JSON"},
                {"--trial", "SECONDS",
                 "processor time of the trial; 2 unless given, 0: none, bytes are those of the start"}},
    .run = run,
};
