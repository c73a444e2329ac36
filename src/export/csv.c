#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "export/output.h"
#include "export/vertices.h"

static const char *const SUFFIXES[] = {"_trajectories.csv", "_genealogy.csv", "_ledger.csv", "_events.csv",
                                       "_obstacles.csv",    "_pieces.obj",    "_probes.csv"};

typedef ShvStatus (*WriteTable)(ShvRunFile *file, const ShvExportOptions *options, FILE *stream, ShvError *error);

/* ---- fields ---- */

static void put_numbers(FILE *stream, const double *values, int count)
{
    for (int i = 0; i < count; i++) shv_output_number(stream, values[i]);
}

/* A text in quotes, its own quotes doubled (RFC 4180). */
static void put_text(FILE *stream, const char *text)
{
    shv_print(stream, ",\"");
    for (; *text; text++) shv_print(stream, *text == '"' ? "\"\"" : "%c", *text);
    shv_print(stream, "\"");
}

/* ---- tables ---- */

typedef struct Poses {
    double *position, *orientation, *velocity, *angular;
    uint8_t *alive;
} Poses;

static ShvStatus put_poses(ShvRunFile *file, const ShvExportOptions *options, FILE *stream, const Poses *poses,
                           ShvError *error)
{
    const ShvRunFileInfo *info = shv_run_file_info(file);
    for (int64_t frame = 0; frame < info->frame_count; frame++) {
        if (!shv_output_takes(options, file, frame)) continue;
        double time;
        SHV_TRY(shv_run_file_frame(file, frame, &time, NULL, poses->alive, poses->position, poses->orientation,
                                   poses->velocity, poses->angular, error));
        char start[SHV_OUTPUT_NUMBER];
        shv_output_format(start, time);
        for (int64_t i = 0; i < info->fragment_count; i++) {
            if (!poses->alive[i]) continue;
            shv_print(stream, "%s,%lld", start, (long long)i);
            put_numbers(stream, poses->position + 3 * i, 3);
            put_numbers(stream, poses->orientation + 4 * i, 4);
            put_numbers(stream, poses->velocity + 3 * i, 3);
            put_numbers(stream, poses->angular + 3 * i, 3);
            shv_print(stream, "\n");
        }
    }
    return SHV_OK;
}

static ShvStatus put_trajectories(ShvRunFile *file, const ShvExportOptions *options, FILE *stream, ShvError *error)
{
    const size_t count = (size_t)shv_run_file_info(file)->fragment_count;
    shv_print(stream,
              "time [s],fragment,P.x [m],P.y [m],P.z [m],orient.w,orient.x,orient.y,orient.z,v.x [m/s],v.y [m/s],"
              "v.z [m/s],w.x [rad/s],w.y [rad/s],w.z [rad/s]\n");
    double *values = shv_allocate(options->memory, SHV_PART_RECORD, 13 * count, sizeof *values);
    uint8_t *alive = shv_allocate(options->memory, SHV_PART_RECORD, count, 1);
    ShvStatus status = SHV_OK;
    if (values && alive) {
        const Poses poses = {values, values + 3 * count, values + 7 * count, values + 10 * count, alive};
        status = put_poses(file, options, stream, &poses, error);
    } else {
        status = shv_fail_memory(error, "a frame", 105 * count);
    }
    shv_release(values);
    shv_release(alive);
    return status;
}

static ShvStatus put_genealogy(ShvRunFile *file, const ShvExportOptions *options, FILE *stream, ShvError *error)
{
    const int32_t count = shv_run_file_info(file)->fragment_count;
    shv_print(stream, "id,parent,line,object,birth [s],death [s],mass [kg],volume [m3],tets,pivot.x [m],"
                      "pivot.y [m],pivot.z [m]\n");
    ShvFragmentView *fragments = shv_allocate(options->memory, SHV_PART_RECORD, (size_t)count, sizeof *fragments);
    int32_t *lines = shv_allocate(options->memory, SHV_PART_RECORD, (size_t)count, sizeof *lines);
    ShvStatus status =
        fragments && lines ? SHV_OK : shv_fail_memory(error, "fragments", (size_t)count * sizeof *fragments);
    if (status == SHV_OK) status = shv_run_file_fragments(file, fragments, error);
    if (status == SHV_OK) status = shv_run_file_lineages(file, lines, error);
    for (int32_t i = 0; i < count && status == SHV_OK; i++) {
        const ShvFragmentView *fragment = &fragments[i];
        shv_print(stream, "%d,%d,%d", (int)fragment->id, (int)fragment->parent, (int)lines[i]);
        put_text(stream, shv_run_file_object_name(file, fragment->object));
        shv_output_number(stream, fragment->birth);
        shv_output_number(stream, fragment->death);
        shv_output_number(stream, fragment->mass);
        shv_output_number(stream, fragment->volume);
        shv_print(stream, ",%d", (int)fragment->tets);
        put_numbers(stream, fragment->reference_centre, 3);
        shv_print(stream, "\n");
    }
    shv_release(fragments);
    shv_release(lines);
    return status;
}

static ShvStatus put_ledger(ShvRunFile *file, const ShvExportOptions *options, FILE *stream, ShvError *error)
{
#define NUMBER(member, unit) "," #member " [" unit "]"
#define WORK(member, name)   "," #member " [J]"
#define VECTOR(member, unit) "," #member ".x [" unit "]," #member ".y [" unit "]," #member ".z [" unit "]"
    shv_print(stream, "frame,time [s]" SHV_LEDGER_COLUMNS(NUMBER, WORK, VECTOR) ",residual [J],largest [J]\n");
#undef NUMBER
#undef WORK
#undef VECTOR
    for (int64_t frame = 0; frame < shv_run_file_info(file)->frame_count; frame++) {
        if (!shv_output_takes(options, file, frame)) continue;
        ShvLedgerView row;
        SHV_TRY(shv_run_file_ledger(file, frame, &row, error));
        shv_print(stream, "%lld", (long long)frame);
        shv_output_number(stream, row.time);
#define NUMBER(member, unit) shv_output_number(stream, row.member);
#define VECTOR(member, unit) put_numbers(stream, row.member, 3);
        SHV_LEDGER_COLUMNS(NUMBER, NUMBER, VECTOR)
#undef NUMBER
#undef VECTOR
        shv_output_number(stream, row.residual);
        shv_output_number(stream, row.largest);
        shv_print(stream, "\n");
    }
    return SHV_OK;
}

static void put_switch(FILE *stream, const ShvEventView *event)
{
    shv_print(stream, ",%s,%d", event->reason == SHV_REASON_NONE ? "" : shv_switch_reason_name(event->reason),
              (int)event->hulls);
    const double figures[] = {
        event->mass,           event->momentum_scale,    event->angular_scale,  event->cohesive_before,
        event->cohesive_after, event->dropped_vibration, event->dropped_strain, event->dropped_cohesive,
        event->hull_outside,   event->hull_missing};
    put_numbers(stream, figures, (int)(sizeof figures / sizeof figures[0]));
}

static ShvStatus put_events(ShvRunFile *file, const ShvExportOptions *options, FILE *stream, ShvError *error)
{
    (void)options;
    shv_print(
        stream,
        "time [s],kind,fragment,obstacle,value,kinetic_before [J],kinetic_after [J],strain_before [J],strain_after [J],"
        "momentum_before.x [kg m/s],momentum_before.y [kg m/s],momentum_before.z [kg m/s],momentum_after.x [kg m/s],"
        "momentum_after.y [kg m/s],momentum_after.z [kg m/s],angular_before.x [kg m2/s],angular_before.y [kg m2/s],"
        "angular_before.z [kg m2/s],angular_after.x [kg m2/s],angular_after.y [kg m2/s],angular_after.z [kg m2/s],"
        "reason,hulls,mass [kg],momentum_scale [kg m/s],angular_scale [kg m2/s],cohesive_before [J],cohesive_after [J],"
        "dropped_vibration [J],dropped_strain [J],dropped_cohesive [J],hull_outside [1],hull_missing [1]\n");
    for (int64_t i = 0; i < shv_run_file_info(file)->event_count; i++) {
        ShvEventView event;
        SHV_TRY(shv_run_file_event(file, i, &event, error));
        char start[SHV_OUTPUT_NUMBER];
        shv_output_format(start, event.time);
        shv_print(stream, "%s,%s,%d,%d", start, shv_run_event_name(event.kind), (int)event.fragment,
                  (int)event.obstacle);
        const double energies[] = {event.value, event.kinetic_before, event.kinetic_after, event.strain_before,
                                   event.strain_after};
        put_numbers(stream, energies, 5);
        put_numbers(stream, event.momentum_before, 3);
        put_numbers(stream, event.momentum_after, 3);
        put_numbers(stream, event.angular_before, 3);
        put_numbers(stream, event.angular_after, 3);
        put_switch(stream, &event);
        shv_print(stream, "\n");
    }
    return SHV_OK;
}

static void put_obstacle(FILE *stream, const char *time, const ShvObstacleView *pose, const ShvObstacleBody *body)
{
    static const char *const shapes[] = {"plane", "sphere", "box", "mesh"};
    shv_print(stream, "%s", time);
    put_text(stream, pose->name);
    shv_print(stream, ",%s", shapes[body->shape]);
    put_numbers(stream, pose->position, 3);
    put_numbers(stream, pose->orientation, 4);
    put_numbers(stream, pose->velocity, 3);
    put_numbers(stream, pose->angular_velocity, 3);
    put_numbers(stream, body->normal, 3);
    shv_output_number(stream, body->offset);
    shv_output_number(stream, body->radius);
    put_numbers(stream, body->size, 3);
    shv_print(stream, "\n");
}

static ShvStatus put_obstacle_rows(ShvRunFile *file, const ShvExportOptions *options, FILE *stream,
                                   ShvObstacleView *poses, ShvError *error)
{
    const ShvRunFileInfo *info = shv_run_file_info(file);
    for (int64_t frame = 0; frame < info->frame_count; frame++) {
        char time[SHV_OUTPUT_NUMBER];
        if (!shv_output_takes(options, file, frame)) continue;
        shv_output_format(time, shv_run_file_times(file)[frame]);
        SHV_TRY(shv_run_file_obstacles(file, frame, poses, error));
        for (int32_t i = 0; i < info->obstacle_count; i++) {
            ShvObstacleBody body;
            SHV_TRY(shv_run_file_obstacle(file, i, &body, error));
            put_obstacle(stream, time, &poses[i], &body);
        }
    }
    return SHV_OK;
}

static ShvStatus put_obstacles(ShvRunFile *file, const ShvExportOptions *options, FILE *stream, ShvError *error)
{
    const size_t count = (size_t)shv_run_file_info(file)->obstacle_count;
    shv_print(stream, "time [s],name,shape,P.x [m],P.y [m],P.z [m],orient.w,orient.x,orient.y,orient.z,v.x [m/s],"
                      "v.y [m/s],v.z [m/s],w.x [rad/s],w.y [rad/s],w.z [rad/s],normal.x,normal.y,normal.z,offset [m],"
                      "radius [m],size.x [m],size.y [m],size.z [m]\n");
    ShvObstacleView *poses = shv_allocate(options->memory, SHV_PART_RECORD, count, sizeof *poses);
    if (!poses) return shv_fail_memory(error, "obstacles", count * sizeof *poses);
    const ShvStatus status = put_obstacle_rows(file, options, stream, poses, error);
    shv_release(poses);
    return status;
}

/* Of every line of descent, about the centre of mass of its last fragment. */
static ShvStatus put_shapes(ShvRunFile *file, const ShvExportOptions *options, FILE *stream, ShvError *error)
{
    ShvLines lines;
    ShvVertices vertices;
    SHV_TRY(shv_lines_create(&lines, file, options->memory, NULL, error));
    const ShvStatus status = shv_vertices_create(&vertices, &lines, error);
    if (status != SHV_OK) {
        shv_lines_release(&lines);
        return status;
    }
    shv_print(stream, "# m, z up; about the centre of mass of the fragment that a line ends with\n");
    for (int32_t line = 0; line < lines.count; line++) {
        shv_print(stream, "o line_%d\ng fragment_%d\n", (int)lines.pieces.lineage[lines.leaf[line]],
                  (int)lines.leaf[line]);
        for (int64_t i = 0; i < shv_vertices_count(&vertices, line); i++) {
            const ShvVec3 x = shv_vertices_place(&vertices, &lines, line, i);
            shv_print(stream, "v %.9g %.9g %.9g\n", x.x, x.y, x.z);
        }
        const int64_t first = vertices.begin[line] + 1; /* .obj counts from 1, and through the whole file */
        for (int64_t f = lines.begin[line]; f < lines.begin[line + 1]; f++) {
            const int32_t *corners = vertices.corners + 3 * f;
            shv_print(stream, "f %lld %lld %lld\n", (long long)(first + corners[0]), (long long)(first + corners[1]),
                      (long long)(first + corners[2]));
        }
    }
    shv_vertices_release(&vertices);
    shv_lines_release(&lines);
    return SHV_OK;
}

static ShvStatus put_probe_rows(ShvRunFile *file, FILE *stream, ShvProbeSample *row, ShvError *error)
{
    const ShvRunFileInfo *info = shv_run_file_info(file);
    for (int64_t i = 0; i < info->probe_row_count; i++) {
        double time;
        char start[SHV_OUTPUT_NUMBER];
        SHV_TRY(shv_run_file_probes(file, i, 1, &time, row, error));
        shv_output_format(start, time);
        for (int32_t k = 0; k < info->probe_count; k++) {
            if (isnan(row[k].displacement[0])) continue;
            shv_print(stream, "%s,%s", start, shv_run_file_probe_name(file, k));
            put_numbers(stream, row[k].displacement, 3);
            put_numbers(stream, row[k].velocity, 3);
            put_numbers(stream, row[k].stress, 6);
            put_numbers(stream, row[k].contact, 3);
            put_numbers(stream, row[k].reaction, 3);
            shv_print(stream, "\n");
        }
    }
    return SHV_OK;
}

static ShvStatus put_probes(ShvRunFile *file, const ShvExportOptions *options, FILE *stream, ShvError *error)
{
    const size_t count = (size_t)shv_run_file_info(file)->probe_count;
    shv_print(
        stream,
        "time [s],probe,displacement.x [m],displacement.y [m],displacement.z [m],velocity.x [m/s],velocity.y [m/s],"
        "velocity.z [m/s],stress.xx [Pa],stress.yy [Pa],stress.zz [Pa],stress.yz [Pa],stress.xz [Pa],stress.xy [Pa],"
        "contact.x [N],contact.y [N],contact.z [N],reaction.x [N],reaction.y [N],reaction.z [N]\n");
    ShvProbeSample *row = shv_allocate(options->memory, SHV_PART_RECORD, count, sizeof *row);
    if (!row) return shv_fail_memory(error, "a row of probes", count * sizeof *row);
    const ShvStatus status = put_probe_rows(file, stream, row, error);
    shv_release(row);
    return status;
}

static ShvStatus write_table(ShvRunFile *file, const char *prefix, const ShvExportOptions *options, int table,
                             ShvError *error)
{
    static const WriteTable tables[] = {put_trajectories, put_genealogy, put_ledger, put_events,
                                        put_obstacles,    put_shapes,    put_probes};
    ShvOutput output;
    SHV_TRY(shv_output_open(&output, options, prefix, SUFFIXES[table], error));
    const ShvStatus status = tables[table](file, options, output.stream, error);
    return shv_output_close(&output, options, status, error);
}

ShvStatus shv_export_csv(ShvRunFile *file, const char *prefix, const ShvExportOptions *given, ShvError *error)
{
    const int count = shv_run_file_info(file)->probe_count > 0 ? 7 : 6;
    ShvExportOptions options;
    SHV_TRY(shv_export_options(given, &options, error));
    SHV_TRY(shv_output_check(&options, prefix, SUFFIXES, count, error));
    for (int i = 0; i < count; i++) {
        const ShvStatus status = write_table(file, prefix, &options, i, error);
        if (status == SHV_OK) continue;
        while (i-- > 0) shv_output_withdraw(prefix, SUFFIXES[i]);
        return status;
    }
    return SHV_OK;
}
