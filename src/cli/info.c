#include "cli/command.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { JSON, FRAGMENTS, SCENE, VERIFY };

static void print_head(const ShvRunFile *file, uint32_t checksum)
{
    const ShvRunFileInfo *info = shv_run_file_info(file);
    const char *const head[] = {info->scene_name, ": ", info->status, info->message[0] ? ": " : "", info->message};
    for (size_t i = 0; i < sizeof head / sizeof head[0]; i++) shv_cli_print_plain(stdout, head[i]);
    putchar('\n');
    printf("  format %d, written by shiver %s on %s, %d threads, %.2f s of run time\n", (int)info->format,
           info->code_version, info->processor, (int)info->threads, info->wall_seconds);
    printf("  scene hash %016llx, checksum of all frames %08lx\n", (unsigned long long)info->scene_hash,
           (unsigned long)checksum);
    printf("  %lld frames from %.6g to %.6g s, %lld events\n", (long long)info->frame_count, info->first_time,
           info->last_time, (long long)info->event_count);
    printf("  %d objects, %d tets, %d nodes, %d fragments ever\n", (int)info->object_count, (int)info->element_count,
           (int)info->node_count, (int)info->fragment_count);
    if (info->probe_count == 0) return;
    printf("  %d probes with %lld rows of samples:", (int)info->probe_count, (long long)info->probe_row_count);
    for (int32_t i = 0; i < info->probe_count; i++) printf(" %s", shv_run_file_probe_name(file, i));
    printf("\n");
}

static void print_ledger(const ShvLedgerView *ledger)
{
    printf("  last ledger: kinetic %.6g J, strain %.4g J, fracture %.4g J, contact %.4g J, residual %.2e of %.4g J\n",
           ledger->kinetic, ledger->strain, ledger->fracture_dissipation, ledger->contact,
           ledger->largest > 0.0 ? ledger->residual / ledger->largest : 0.0, ledger->largest);
}

static void print_fragments(const ShvRunFile *file, const ShvFragmentView *fragments, int32_t count)
{
    printf("%6s %6s %-16s %12s %12s %8s %12s\n", "id", "parent", "object", "birth s", "death s", "tets", "mass kg");
    for (int32_t i = 0; i < count; i++)
        printf("%6d %6d %-16s %12.6g %12.6g %8d %12.6g\n", (int)fragments[i].id, (int)fragments[i].parent,
               shv_run_file_object_name(file, fragments[i].object), fragments[i].birth, fragments[i].death,
               (int)fragments[i].tets, fragments[i].mass);
}

static ShvMaterialView material_of(const void *file, int32_t index)
{
    return shv_run_file_material(file, index);
}

static ShvMaterialList materials_of(const ShvRunFile *file)
{
    return (ShvMaterialList){file, shv_run_file_material_count(file), material_of};
}

static void print_progress(const ShvProgressView *progress)
{
    printf("  last frame: %d fragments, %d facets inserted, %d failed\n", (int)progress->alive, (int)progress->inserted,
           (int)progress->failed);
    if (progress->inserted > 0) shv_cli_print_pieces(progress->pieces);
}

static void print_json(const ShvRunFile *file, const ShvRunFileInfo *info, const ShvLedgerView *ledger,
                       const ShvProgressView *progress, uint32_t checksum)
{
    printf("{\"scene\": ");
    shv_cli_print_json_text(info->scene_name);
    printf(", \"status\": ");
    shv_cli_print_json_text(info->status);
    printf(", \"message\": ");
    shv_cli_print_json_text(info->message);
    printf(", \"code_version\": ");
    shv_cli_print_json_text(info->code_version);
    printf(", \"frames\": %lld, \"events\": %lld, \"fragments\": %d, \"tets\": %d, \"nodes\": %d, \"threads\": %d, "
           "\"probes\": %d, \"probe_rows\": %lld",
           (long long)info->frame_count, (long long)info->event_count, (int)info->fragment_count,
           (int)info->element_count, (int)info->node_count, (int)info->threads, (int)info->probe_count,
           (long long)info->probe_row_count);
    printf(", \"checksum\": \"%08lx\", \"first_time\": ", (unsigned long)checksum);
    shv_cli_print_json_number(info->first_time);
    printf(", \"last_time\": ");
    shv_cli_print_json_number(info->last_time);
    printf(", \"wall_seconds\": ");
    shv_cli_print_json_number(info->wall_seconds);
    printf(", \"residual\": ");
    shv_cli_print_json_number(ledger->residual);
    printf(", \"largest_energy\": ");
    shv_cli_print_json_number(ledger->largest);
    printf(", \"alive\": %d, \"inserted\": %d, \"failed\": %d, \"pieces_at_1_10_50_percent\": [%d, %d, %d]",
           (int)progress->alive, (int)progress->inserted, (int)progress->failed, (int)progress->pieces[0],
           (int)progress->pieces[1], (int)progress->pieces[2]);
    shv_cli_print_materials_json(materials_of(file));
    printf("}\n");
}

static ShvStatus show(ShvRunFile *file, const ShvArguments *arguments, ShvError *error)
{
    const ShvRunFileInfo *info = shv_run_file_info(file);
    if (arguments->values[SCENE]) {
        fputs(info->scene_text, stdout);
        return SHV_OK;
    }
    ShvLedgerView ledger = {.residual = (double)NAN, .largest = (double)NAN};
    ShvProgressView progress = {0};
    if (info->frame_count > 0) {
        ShvStatus status = shv_run_file_ledger(file, info->frame_count - 1, &ledger, error);
        if (status == SHV_OK) status = shv_run_file_progress(file, info->frame_count - 1, &progress, error);
        if (status != SHV_OK) return status;
    }
    uint32_t checksum = 0;
    const ShvStatus summed = shv_run_file_checksum(file, &checksum, error);
    if (summed != SHV_OK) return summed;
    if (arguments->values[VERIFY] && !arguments->values[JSON])
        printf("verified: all %lld frames agree with their checksums\n", (long long)info->frame_count);
    if (arguments->values[JSON]) {
        print_json(file, info, &ledger, &progress, checksum);
        return SHV_OK;
    }
    print_head(file, checksum);
    shv_cli_print_materials(materials_of(file));
    if (info->frame_count > 0) print_ledger(&ledger);
    if (info->frame_count > 0) print_progress(&progress);
    if (!arguments->values[FRAGMENTS]) return SHV_OK;
    ShvFragmentView *fragments = calloc((size_t)info->fragment_count + 1, sizeof *fragments);
    if (!fragments) return shv_fail(error, SHV_NO_MEMORY, "out of memory for %d fragments", (int)info->fragment_count);
    const ShvStatus status = shv_run_file_fragments(file, fragments, error);
    if (status == SHV_OK) print_fragments(file, fragments, info->fragment_count);
    free(fragments);
    return status;
}

static int run(const ShvArguments *arguments)
{
    ShvRunFile *file = NULL;
    ShvError error;
    ShvStatus status = shv_run_file_open(&file, arguments->positional[0], NULL, &error);
    if (status == SHV_OK && arguments->values[VERIFY]) status = shv_run_file_verify(file, &error);
    if (status == SHV_OK) status = show(file, arguments, &error);
    shv_run_file_close(file);
    return status == SHV_OK ? SHV_EXIT_DONE : shv_cli_failed(status, &error);
}

const ShvCommand shv_command_info = {
    .name = "info",
    .positional = "RUNFILE",
    .summary = "say what a run file holds",
    .details = "Prints what a run file holds and how the run ended.",
    .least_positional = 1,
    .most_positional = 1,
    .options = {{"--json", NULL, "print as JSON"},
                {"--fragments", NULL, "list all fragments that ever lived, with their parents"},
                {"--scene", NULL, "print the scene text the run was made from"},
                {"--verify", NULL, "read everything and compare it with its checksums"}},
    .run = run,
};
