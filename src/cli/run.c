#include "cli/command.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/deterministic.h"
#include "base/file.h"
#include "base/text.h"
#include "base/timer.h"
#include "cli/progress.h"
#include "cli/reserve.h"
#include "cli/resume.h"
#include "shiver/scene.h"

enum { OUTPUT, FORCE, JSON, AUDIT_WAKE, RESUME, UNTIL, CHECKPOINT };

static volatile sig_atomic_t interrupted;

static void on_signal(int number)
{
    (void)number;
    interrupted = 1;
}

static void catch_signals(void)
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_signal;
    /* The second Ctrl-C ends the program at once. */
    action.sa_flags = (int)SA_RESETHAND;
    sigemptyset(&action.sa_mask);
    /* Also where the terminal goes away, and where a batch system's time is up. */
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP, SIGXCPU};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) sigaction(numbers[i], &action, NULL);
}

/* Where the run file goes: --output, the scene's output.file, or the scene file's name with .h5, in the working folder. */
static ShvStatus output_path(const ShvArguments *arguments, const ShvSceneDefinition *scene, char path[SHV_CLI_PATH],
                             ShvError *error)
{
    const char *given = arguments->values[OUTPUT] ? arguments->values[OUTPUT] : scene->output.file;
    if (shv_resume_is_run_file(arguments->positional[0])) given = arguments->positional[0];
    return shv_cli_scene_output(path, arguments, given, scene, ".h5", error);
}

/* The files a mesh is read from, as far as they are one: TetGen's have a second one beside it. */
static ShvStatus keep_mesh(const char *output, const char *folder, const char *file, ShvError *error)
{
    static const char *const endings[] = {"", ".node", ".ele"};
    char path[SHV_CLI_PATH];
    for (size_t i = 0; file && i < sizeof endings / sizeof endings[0]; i++) {
        const bool inside = folder[0] && file[0] != '/';
        ShvStatus status =
            shv_cli_path(path, error, "%s%s%s%s", inside ? folder : "", inside ? "/" : "", file, endings[i]);
        if (status == SHV_OK) status = shv_cli_keep_input(output, path, error);
        if (status != SHV_OK) return status;
    }
    return SHV_OK;
}

/* The run file must not take the place of what the run was made from. */
static ShvStatus keep_inputs(const ShvArguments *arguments, const ShvScene *scene, const char *output, ShvError *error)
{
    const ShvSceneDefinition *definition = shv_scene_definition(scene);
    const char *folder = shv_scene_folder(scene);
    const bool goes_on = shv_resume_is_run_file(arguments->positional[0]);
    ShvStatus status = goes_on ? SHV_OK : shv_cli_keep_input(output, arguments->positional[0], error);
    for (int32_t i = 0; status == SHV_OK && i < definition->object_count; i++)
        status = keep_mesh(output, folder, definition->objects[i].mesh.file, error);
    for (int32_t i = 0; status == SHV_OK && i < definition->obstacle_count; i++)
        status = keep_mesh(output, folder, definition->obstacles[i].file, error);
    return status;
}

static double largest_mass_fraction(const ShvFrameView *frame)
{
    double largest = 0.0, total = 0.0;
    for (int32_t i = 0; i < frame->fragment_count; i++) {
        if (frame->fragments[i].mode == SHV_FRAGMENT_DEAD) continue;
        largest = fmax(largest, frame->fragments[i].mass);
        total += frame->fragments[i].mass;
    }
    return total > 0.0 ? largest / total : 0.0;
}

/* Of the largest energy: what springs of cracks lose by damping is told beyond. */
static const double damped_share = 0.01;

static double share(double part, double whole)
{
    return whole > 0.0 ? part / whole : 0.0;
}

static void print_costs(const ShvFrameView *frame, double wall)
{
    printf("  time by part:");
    for (int32_t i = 0; i < frame->cost_count; i++)
        if (frame->costs[i].seconds > 0.005 * wall)
            printf(" %s %.2f s%s", frame->costs[i].name, frame->costs[i].seconds, i + 1 < frame->cost_count ? "," : "");
    printf("\n");
}

static void print_materials(const ShvSimulation *simulation)
{
    for (int32_t i = 0; i < shv_simulation_material_count(simulation); i++) {
        const ShvMaterialView material = shv_simulation_material(simulation, i);
        if (material.mesh_edge > material.resolved_edge) shv_cli_print_cohesion(&material);
    }
}

static void print_summary(const ShvFrameView *frame, const char *path, double wall, ShvStatus status)
{
    const ShvLedgerView *ledger = &frame->ledger;
    printf("%s: t = %.6g s in %.2f s of run time; %s\n",
           status == SHV_OK            ? "finished"
           : status == SHV_INTERRUPTED ? "interrupted"
                                       : "failed",
           frame->time, wall, path);
    printf("  %d fragments (largest %.1f %% of the mass), %d facets inserted, %d failed, %.4g m² failed, %d softened "
           "without dissipation\n",
           (int)frame->alive_count, 100.0 * largest_mass_fraction(frame), (int)frame->inserted, (int)frame->failed,
           ledger->failed_area, (int)frame->softened);
    if (frame->inserted > 0) shv_cli_print_pieces(frame->pieces);
    printf("  %lld steps of fracture mode, last of %.3g s, Courant number %.3g\n", (long long)frame->steps, frame->step,
           frame->courant);
    if (frame->cohesive_share > 0.0)
        printf(
            "  cohesive zones as explicit springs would need steps of %.3g of the tets' stable step (dt_coh/dt_bulk); "
            "their impulses here need none\n",
            frame->cohesive_share);
    printf("  energy, J: kinetic %.4g, strain %.4g, fracture %.4g, contact %.4g, friction %.4g, closing cracks %.4g, "
           "dropped at mode switches %.4g\n",
           ledger->kinetic, ledger->strain, ledger->fracture_dissipation, ledger->contact, ledger->friction,
           ledger->closure, -ledger->handover);
    printf("  ledger residual %.2e of the largest energy (%.4g J); changes of the step's length gave %.2e of it\n",
           share(ledger->residual, ledger->largest), ledger->largest, share(ledger->step_change, ledger->largest));
    if (frame->bar_work_share >= 0.0)
        printf("  bars did %.1f %% of the work that bars and elastic forces did together; largest edge strain %.3g\n",
               100.0 * frame->bar_work_share, frame->edge_strain);
    if (frame->inserted > 0)
        printf("  cohesive tractions took %.4g J; the cohesive law says %.4g J for their openings%s; failed area × G: "
               "%.4g J\n",
               -ledger->cohesive,
               ledger->fracture_dissipation + ledger->cohesive_recoverable + ledger->cohesive_released,
               share(-ledger->cohesive_defect, ledger->largest) > damped_share
                   ? ", and the step damped their springs by the rest: a smaller fracture.safety resolves them better"
                   : "",
               ledger->fracture_energy_area);
    if (frame->worst_overshoot > 0.0)
        printf("  stress at insertion at most %.3f of the strength%s\n", frame->worst_overshoot,
               frame->worst_overshoot > 1.1 ? ": more than 10 % above it; see docs/scene.md, fracture.check_every"
                                            : "");
    if (frame->audited > 0)
        printf("  wake audit: %d impacts that the wake rule takes for harmless were solved in fracture mode; %d broke "
               "something: missed-fracture rate %.3g\n",
               (int)frame->audited, (int)frame->missed, (double)frame->missed / frame->audited);
    print_costs(frame, wall);
}

/* What is gathered from frame to frame. */
typedef struct History {
    bool met;                                            /* a contact has done work or a fragment is awake */
    double edge_strain_flight, edge_strain_after_impact; /* largest of recorded frames before and since */
    double courant;                                      /* largest of recorded frames */
    ShvCrackView crack;
    /* bodies that were squeezed: how many times, and the first time */
    int32_t squeezes;
    ShvEventView squeeze;
    int32_t between[2]; /* obstacles */
    /* tets that were turned inside out: how often more than ever before were, and the first time */
    int32_t inversions;
    ShvEventView inversion;
} History;

/* One event for each of the two obstacles, one after the other. */
static void remember_squeezes(History *history, const ShvFrameView *frame)
{
    for (int32_t i = 0; i + 1 < frame->event_count; i++) {
        if (frame->events[i].kind != SHV_RUN_SQUEEZE) continue;
        if (history->squeezes++ == 0) {
            history->squeeze = frame->events[i];
            history->between[0] = frame->events[i].obstacle;
            history->between[1] = frame->events[i + 1].obstacle;
        }
        i++;
    }
}

static void print_squeezes(const History *history, const ShvFrameView *frame, const ShvSimulation *simulation)
{
    if (history->squeezes == 0) return;
    const ShvMeshView mesh = shv_simulation_mesh(simulation);
    const ShvFragmentView *fragment = &frame->fragments[history->squeeze.fragment];
    printf("  warning: obstacles left bodies no room, %d time%s; first at %.6g s: fragment %d of '%s' between '%s' and "
           "'%s', %.3g m too little (events 'squeeze'); such contacts have no answer, and the motion there means "
           "nothing\n",
           (int)history->squeezes, history->squeezes > 1 ? "s" : "", history->squeeze.time, (int)fragment->id,
           mesh.objects[fragment->object].name, frame->obstacles[history->between[0]].name,
           frame->obstacles[history->between[1]].name, history->squeeze.value);
}

static void remember_inversions(History *history, const ShvFrameView *frame)
{
    for (int32_t i = 0; i < frame->event_count; i++)
        if (frame->events[i].kind == SHV_RUN_INVERSION && history->inversions++ == 0)
            history->inversion = frame->events[i];
}

static void print_inversions(const History *history, const ShvFrameView *frame, const ShvSimulation *simulation)
{
    if (history->inversions == 0) return;
    const ShvMeshView mesh = shv_simulation_mesh(simulation);
    const ShvFragmentView *fragment = &frame->fragments[history->inversion.fragment];
    printf(
        "  warning: tets were turned inside out, first at %.6g s tet %.0f of '%s' (events 'inversion'); no law holds "
        "there. A finer mesh or a milder impact may bear it; where a body is to be soft, kinematics: corotational "
        "resists more than green when squeezed\n",
        history->inversion.time, history->inversion.value, mesh.objects[fragment->object].name);
}

static void remember(History *history, const ShvFrameView *frame)
{
    if (frame->fracture || frame->ledger.contact < 0.0 || frame->ledger.contact > 0.0) history->met = true;
    double *strain = history->met ? &history->edge_strain_after_impact : &history->edge_strain_flight;
    *strain = fmax(*strain, frame->edge_strain);
    history->courant = fmax(history->courant, frame->courant);
    remember_squeezes(history, frame);
    remember_inversions(history, frame);
}

/* ---- checkpoints ---- */

/* What the run asks from time to time: to be shown, saved and stopped. */
typedef struct Watch {
    ShvProgress progress;
    ShvSimulation *simulation;
    ShvRecord *record; /* NULL: nothing to save beside yet */
    History history;
    double interval, due; /* s of run time between checkpoints, 0: none are made; shv_now of the next */
    double began, spent;  /* shv_now of the first step; s that checkpoints have taken */
    double last;          /* s: the last one */
    bool saved, failed;   /* there are some; the last one failed, and that has been told */
} Watch;

/* Of the run time, at most one part in so many goes to checkpoints. */
static const double SAVE_SHARE = 100.0;

static void save(Watch *watch)
{
    ShvError error;
    if (!watch->record || !(watch->interval > 0.0) || !shv_simulation_has_checkpoints(watch->simulation)) return;
    const double start = shv_now();
    const ShvStatus status =
        shv_record_checkpoint(watch->record, watch->simulation, &watch->history, sizeof watch->history, &error);
    const double end = shv_now();
    watch->last = end - start;
    watch->spent += watch->last;
    watch->due = end + fmax(watch->interval, SAVE_SHARE * watch->last);
    watch->saved = watch->saved || status == SHV_OK;
    if (status != SHV_OK && !watch->failed) {
        fprintf(stderr, "warning: ");
        shv_cli_print_plain(stderr, error.message);
        fprintf(stderr, "; the run goes on, and can be resumed from where it was before at best\n");
    }
    watch->failed = status != SHV_OK;
}

/* To make the run longer one day: where all checkpoints together, with this one, stay under three hundredths of the run time, or one
   takes so little that nobody minds. */
static void save_end(Watch *watch)
{
    const double most_share = 0.03, unminded = 0.1; /* of the run time; s */
    if (!watch->saved) return;
    if (watch->last <= unminded || watch->spent + watch->last <= most_share * (shv_now() - watch->began)) save(watch);
}

static bool asked_to_stop(void *data)
{
    Watch *watch = data;
    shv_progress_tick(&watch->progress);
    const bool stops = interrupted != 0 || shv_reserve_used();
    if (watch->record && (stops || shv_now() >= watch->due)) save(watch);
    return stops;
}

/* Of the plane of the first crack against the vertical, degrees. */
static double crack_angle(const ShvCrackView *crack)
{
    if (isnan(crack->normal[2])) return (double)NAN;
    return asin(fmin(1.0, fabs(crack->normal[2]))) * 180.0 / SHV_PI;
}

static void print_json(const ShvFrameView *frame, const History *history, const char *path, double wall,
                       ShvStatus status)
{
    const ShvLedgerView *ledger = &frame->ledger;
    const struct {
        const char *name;
        double value;
    } numbers[] = {{"time", frame->time},
                   {"wall_seconds", wall},
                   {"largest_mass_fraction", largest_mass_fraction(frame)},
                   {"step", frame->step},
                   {"courant", history->courant},
                   {"cohesive_share", frame->cohesive_share},
                   {"worst_overshoot", frame->worst_overshoot},
#define NUMBER(member, unit) {#member, ledger->member},
#define VECTOR(member, unit)                                                                                           \
    {#member "_x", ledger->member[0]}, {#member "_y", ledger->member[1]}, {#member "_z", ledger->member[2]},
                   SHV_LEDGER_COLUMNS(NUMBER, NUMBER, VECTOR)
#undef NUMBER
#undef VECTOR
                       {"residual", ledger->residual},
                   {"largest_energy", ledger->largest},
                   {"edge_strain_flight", history->edge_strain_flight},
                   {"edge_strain_after_impact", history->edge_strain_after_impact},
                   {"edge_strain_end", frame->edge_strain},
                   {"bar_work_share", frame->bar_work_share},
                   {"crack_origin_x", history->crack.origin[0]},
                   {"crack_origin_y", history->crack.origin[1]},
                   {"crack_origin_z", history->crack.origin[2]},
                   {"crack_angle", crack_angle(&history->crack)}};
    printf("{\"file\": ");
    shv_cli_print_json_text(path);
    printf(", \"status\": \"%s\", \"fragments\": %d, \"fragments_ever\": %d, \"inserted\": %d, \"failed\": %d, "
           "\"softened\": %d, "
           "\"pieces_at_1_10_50_percent\": [%d, %d, %d], "
           "\"steps\": %lld, \"audited_wakes\": %d, \"missed_fractures\": %d, \"squeezes\": %d",
           status == SHV_OK            ? "finished"
           : status == SHV_INTERRUPTED ? "interrupted"
                                       : "failed",
           (int)frame->alive_count, (int)frame->fragment_count, (int)frame->inserted, (int)frame->failed,
           (int)frame->softened, (int)frame->pieces[0], (int)frame->pieces[1], (int)frame->pieces[2],
           (long long)frame->steps, (int)frame->audited, (int)frame->missed, (int)history->squeezes);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        printf(", \"%s\": ", numbers[i].name);
        shv_cli_print_json_number(numbers[i].value);
    }
    printf("}\n");
}

/* ---- the run ---- */

/* Pulls frames until the end; the record never lags behind. */
static ShvStatus pull_frames(Watch *watch, ShvError *error)
{
    ShvStatus status = SHV_OK;
    ShvSimulation *simulation = watch->simulation;
    while (status == SHV_OK && !shv_simulation_finished(simulation)) {
        status = shv_simulation_advance(simulation, error);
        ShvError ignored;
        const ShvStatus written = shv_record_frame(watch->record, simulation, status == SHV_OK ? error : &ignored);
        if (status == SHV_OK) status = written;
        remember(&watch->history, shv_simulation_frame(simulation));
        shv_progress_tick(&watch->progress);
    }
    return status;
}

static ShvRecordDefinition define_record(const ShvArguments *arguments, const ShvScene *scene, const char *path,
                                         const ShvSimulation *simulation)
{
    const ShvSceneDefinition *definition = shv_scene_definition(scene);
    ShvRecordDefinition recording = shv_record_default();
    recording.path = path;
    recording.force = arguments->values[FORCE] != NULL;
    recording.scene_text = shv_scene_text(scene);
    recording.scene_name = definition->name;
    recording.scene_hash = shv_scene_hash(scene);
    recording.resume_hash = shv_resume_hash(scene);
    recording.threads = shv_simulation_threads(simulation);
    recording.nodes = definition->output.nodes;
    return recording;
}

/* From a checkpoint on where there is one. The record stays NULL where the run has to begin anew. */
static ShvStatus resume(const ShvArguments *arguments, const ShvScene *scene, ShvRecordDefinition *recording,
                        Watch *watch, ShvError *error)
{
    if (!arguments->values[RESUME]) return SHV_OK;
    ShvStatus status = SHV_OK;
    if (shv_simulation_has_checkpoints(watch->simulation))
        status = shv_record_resume(&watch->record, recording, watch->simulation, &watch->history, sizeof watch->history,
                                   error);
    if (status != SHV_OK) return status;
    if (watch->record) {
        const double time = shv_simulation_summary(watch->simulation).time;
        watch->saved = true;
        if (!arguments->quiet) fprintf(stderr, "shiver: goes on from %.9g s\n", time);
        if (time <= shv_scene_definition(scene)->duration) return SHV_OK;
        return shv_fail(error, SHV_BAD_INPUT, "the run has come to %.9g s already; give a later --until", time);
    }
    /* A run that was killed before its first checkpoint begins anew, and gives the same bits. */
    double time;
    if (shv_resume_inspect(recording->path, scene, &time) == SHV_LEFTOVER_PARTIAL) recording->force = true;
    if (!arguments->quiet) fprintf(stderr, "shiver: there is no checkpoint; the run begins at 0 s\n");
    return SHV_OK;
}

static ShvStatus make_record(const ShvArguments *arguments, const ShvScene *scene, const char *path, Watch *watch,
                             ShvError *error)
{
    ShvRecordDefinition recording = define_record(arguments, scene, path, watch->simulation);
    const char *overrides[2 * SHV_MOST_OVERRIDES];
    const int32_t room = (int32_t)(sizeof overrides / sizeof overrides[0]);
    while (recording.override_count < shv_scene_override_count(scene) && recording.override_count < room) {
        overrides[recording.override_count] = shv_scene_override(scene, recording.override_count);
        recording.override_count++;
    }
    recording.overrides = overrides;
    const ShvStatus status = resume(arguments, scene, &recording, watch, error);
    if (status != SHV_OK || watch->record) return status;
    return shv_record_create(&watch->record, &recording, watch->simulation, error);
}

static void print_end(const ShvArguments *arguments, Watch *watch, const char *path, double wall, ShvStatus status)
{
    const ShvFrameView *frame = shv_simulation_frame(watch->simulation);
    ShvError ignored;
    if (shv_simulation_crack(watch->simulation, &watch->history.crack, &ignored) != SHV_OK)
        watch->history.crack.normal[2] = (double)NAN;
    if (arguments->values[JSON]) {
        print_json(frame, &watch->history, path, wall, status);
        return;
    }
    print_summary(frame, path, wall, status);
    print_squeezes(&watch->history, frame, watch->simulation);
    print_inversions(&watch->history, frame, watch->simulation);
    print_materials(watch->simulation);
    if (status == SHV_INTERRUPTED && watch->saved && !watch->failed) printf("  --resume goes on from here\n");
}

static int run_recorded(const ShvArguments *arguments, const ShvScene *scene, const char *path, Watch *watch,
                        double start)
{
    ShvError error;
    catch_signals(); /* until now there was nothing to lose, and a signal ended the program */
    ShvStatus status = make_record(arguments, scene, path, watch, &error);
    if (status != SHV_OK) {
        shv_record_abandon(watch->record);
        return shv_cli_failed(status, &error);
    }
    watch->began = shv_now();
    watch->due = watch->began + watch->interval;
    status = pull_frames(watch, &error);
    if (status == SHV_OK) save_end(watch);
    if (status == SHV_INTERRUPTED) status = shv_cli_why_stopped(&error);
    ShvError closing;
    const ShvStatus closed = shv_record_close(watch->record, status, status == SHV_OK ? "" : error.message, &closing);
    shv_progress_end(&watch->progress);
    print_end(arguments, watch, path, shv_now() - start, status);
    const int exit_status = status == SHV_OK ? (int)SHV_EXIT_DONE : shv_cli_failed(status, &error);
    /* Who stops a run must be told, too, that its file has gone. */
    const bool went_well = status == SHV_OK || status == SHV_INTERRUPTED;
    return closed == SHV_OK || !went_well ? exit_status : shv_cli_failed(closed, &closing);
}

/* The number of --audit-wake, 0 without it, −1 where it is none. */
static int32_t audit_wakes(const ShvArguments *arguments)
{
    const char *text = arguments->values[AUDIT_WAKE];
    if (!text) return 0;
    int32_t number = 0;
    for (; *text >= '0' && *text <= '9' && number < 100000000; text++) number = 10 * number + (*text - '0');
    return *text == '\0' && number > 0 ? number : -1;
}

/* Seconds of an option, `missing` without it, −1 where it is none. */
static double seconds_of(const char *text, double missing)
{
    double value;
    ShvError ignored;
    if (!text) return missing;
    return shv_parse_double(text, strlen(text), false, &value, &ignored) == SHV_OK && value >= 0.0 ? value : -1.0;
}

static int refuse(const char *option, const char *what, const char *text)
{
    fprintf(stderr, "shiver: %s takes %s, not '%s'\n", option, what, text);
    return SHV_EXIT_INPUT;
}

/* A run that has come to its end needs nothing. */
static bool is_done(const ShvArguments *arguments, const ShvScene *scene, const char *path)
{
    double time;
    if (!arguments->values[RESUME] || shv_resume_inspect(path, scene, &time) != SHV_LEFTOVER_WHOLE) return false;
    if (arguments->values[JSON]) {
        printf("{\"file\": ");
        shv_cli_print_json_text(path);
        printf(", \"status\": \"finished\", \"time\": ");
        shv_cli_print_json_number(time);
        printf("}\n");
    } else {
        printf("finished before: t = %.6g s; %s; --until goes on\n", time, path);
    }
    return true;
}

static int run_scene(const ShvArguments *arguments, const ShvScene *scene, Watch *watch, int32_t audits, double start)
{
    ShvError error;
    char path[SHV_CLI_PATH];
    const ShvSceneDefinition *definition = shv_scene_definition(scene);
    ShvSimulationOptions options = shv_simulation_options_default();
    options.folder = shv_scene_folder(scene);
    options.audit_wakes = audits;
    options.stop = asked_to_stop;
    options.stop_data = watch;
    watch->progress = shv_progress_start(definition->duration, arguments->quiet);
    ShvStatus status = output_path(arguments, definition, path, &error);
    if (status == SHV_OK) status = keep_inputs(arguments, scene, path, &error);
    if (status == SHV_OK && is_done(arguments, scene, path)) return SHV_EXIT_DONE;
    if (status == SHV_OK) status = shv_simulation_create(&watch->simulation, definition, &options, &error);
    if (status == SHV_OK) status = shv_cli_warn_overlaps(watch->simulation, &error);
    watch->progress.simulation = watch->simulation;
    const int exit_status =
        status == SHV_OK ? run_recorded(arguments, scene, path, watch, start) : shv_cli_failed(status, &error);
    shv_simulation_destroy(watch->simulation);
    return exit_status;
}

static int run(const ShvArguments *arguments)
{
    const double start = shv_now(), until = seconds_of(arguments->values[UNTIL], 0.0);
    const int32_t audits = audit_wakes(arguments);
    Watch watch = {.interval = seconds_of(arguments->values[CHECKPOINT], 30.0),
                   .history = {.edge_strain_flight = (double)NAN, .edge_strain_after_impact = (double)NAN}};
    if (audits < 0) return refuse("--audit-wake", "a whole number of impacts from 1 on", arguments->values[AUDIT_WAKE]);
    if (until < 0.0) return refuse("--until", "a time in seconds", arguments->values[UNTIL]);
    if (watch.interval < 0.0)
        return refuse("--checkpoint", "seconds of run time, 0 for none", arguments->values[CHECKPOINT]);
    if (!arguments->values[RESUME] && shv_resume_is_run_file(arguments->positional[0])) {
        fprintf(stderr, "shiver: '%s' is a run file; give its scene, or --resume to go on with it\n",
                arguments->positional[0]);
        return SHV_EXIT_INPUT;
    }
    ShvArguments own = *arguments;
    char duration[64];
    if (arguments->values[UNTIL]) {
        if (own.override_count == SHV_MOST_OVERRIDES) {
            fprintf(stderr, "shiver: too many --set beside --until\n");
            return SHV_EXIT_INPUT;
        }
        shv_format(duration, sizeof duration, "duration=%.17g", until);
        own.overrides[own.override_count++] = duration;
    }
    ShvScene *scene;
    const int loaded = shv_resume_load_scene(&scene, &own);
    if (!scene) return loaded;
    const int exit_status = run_scene(&own, scene, &watch, audits, start);
    shv_scene_destroy(scene);
    return exit_status;
}

const ShvCommand shv_command_run = {
    .name = "run",
    .positional = "SCENE",
    .summary = "run a scene and write its run file",
    .details =
        "Runs a scene and writes a run file (HDF5): trajectories, fragments, ledger, events. An existing file is\n"
        "replaced only with --force, and only once the new run has its first frame. Ctrl-C stops at a consistent\n"
        "state and leaves a readable file, with a checkpoint beside it from which --resume goes on; there the\n"
        "run file may stand in place of the scene.",
    .least_positional = 1,
    .most_positional = 1,
    .takes_scene = true,
    .takes_stream = true,
    .options = {{"--output", "FILE", "the run file; unless given, output.file of the scene, or its name with .h5 here"},
                {"--force", NULL, "replace an existing run file"},
                {"--json", NULL, "print the summary as JSON"},
                {"--audit-wake", "N",
                 "also solve in fracture mode the first N impacts taken for harmless; reports how many of them broke "
                 "something"},
                {"--resume", NULL, "go on from the last checkpoint of the run file, or begin where there is none"},
                {"--until", "T",
                 "run to T seconds in place of the scene's duration; with --resume also a run that had ended"},
                {"--checkpoint", "SECONDS",
                 "of run time between checkpoints; 30 unless given, 0: none; longer where one costs over 1 % of it"}},
    .run = run,
};
