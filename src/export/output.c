#include "export/output.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "base/publish.h"
#include "base/text.h"

ShvExportOptions shv_export_default(void)
{
    return (ShvExportOptions){.cookie = SHV_DEFINITION_COOKIE, .every = 1};
}

ShvStatus shv_export_options(const ShvExportOptions *given, ShvExportOptions *options, ShvError *error)
{
    *options = given ? *given : shv_export_default();
    if (options->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "the export options did not start from shv_export_default()");
    if (options->every < 1)
        return shv_fail(error, SHV_BAD_INPUT, "every 1st, 2nd, … frame is written; %d was given", (int)options->every);
    return SHV_OK;
}

bool shv_output_takes(const ShvExportOptions *options, const ShvRunFile *file, int64_t frame)
{
    const bool thinned = frame % options->every != 0 && frame + 1 < shv_run_file_info(file)->frame_count;
    return !thinned && (!options->animation || shv_run_file_animation(file)[frame]);
}

char *shv_output_path(const ShvExportOptions *options, const char *prefix, const char *suffix)
{
    const size_t size = strlen(prefix) + strlen(suffix) + 1;
    char *path = shv_allocate(options->memory, SHV_PART_RECORD, size, 1);
    if (path) shv_format(path, size, "%s%s", prefix, suffix);
    return path;
}

char *shv_output_escaped(const ShvExportOptions *options, const char *text)
{
    const size_t size = 6 * strlen(text) + 1;
    char *escaped = shv_allocate(options->memory, SHV_PART_RECORD, size, 1);
    for (char *end = escaped; end && *text; text++) {
        const char *form = *text == '&' ? "&amp;" : *text == '<' ? "&lt;" : *text == '>' ? "&gt;" : NULL;
        const bool control = (unsigned char)*text < 0x20 || *text == 0x7f;
        end += form ? shv_format(end, 7, "%s", form) : shv_format(end, 7, "%c", control ? ' ' : *text);
    }
    return escaped;
}

ShvStatus shv_output_check(const ShvExportOptions *options, const char *prefix, const char *const *suffixes, int count,
                           ShvError *error)
{
    ShvStatus status = SHV_OK;
    for (int i = 0; i < count && status == SHV_OK; i++) {
        char *path = shv_output_path(options, prefix, suffixes[i]);
        status = path ? shv_publish_check(path, options->force, error)
                      : shv_fail_memory(error, "a file name", strlen(prefix));
        shv_release(path);
    }
    return status;
}

ShvStatus shv_output_open(ShvOutput *output, const ShvExportOptions *options, const char *prefix, const char *suffix,
                          ShvError *error)
{
    *output = (ShvOutput){shv_output_path(options, prefix, suffix), NULL, NULL};
    if (!output->path) return shv_fail_memory(error, "a file name", strlen(prefix));
    int descriptor;
    ShvStatus status = shv_publish_begin(options->memory, output->path, &output->temporary, &descriptor, error);
    if (status == SHV_OK) {
        output->stream = fdopen(descriptor, "w");
        if (!output->stream) {
            close(descriptor);
            status = shv_fail_memory(error, "a stream", sizeof(FILE));
        }
    }
    return status == SHV_OK ? SHV_OK : shv_output_close(output, options, status, error);
}

ShvStatus shv_output_close(ShvOutput *output, const ShvExportOptions *options, ShvStatus status, ShvError *error)
{
    if (output->stream) {
        if (status == SHV_OK && (fflush(output->stream) != 0 || ferror(output->stream) != 0))
            status = shv_fail(error, SHV_FILE_ERROR, "cannot write '%s'; make room on the disk", output->path);
        if (status == SHV_OK)
            status = shv_publish_end(output->temporary, fileno(output->stream), output->path, options->force, error);
        fclose(output->stream);
    }
    if (status != SHV_OK && output->temporary) unlink(output->temporary);
    shv_release(output->temporary);
    shv_release(output->path);
    *output = (ShvOutput){NULL, NULL, NULL};
    return status;
}

ShvStatus shv_output_write(const ShvExportOptions *options, const char *path,
                           void (*put)(const void *data, FILE *stream), const void *data, ShvError *error)
{
    ShvOutput output;
    SHV_TRY(shv_publish_check(path, options->force, error));
    SHV_TRY(shv_output_open(&output, options, path, "", error));
    put(data, output.stream);
    return shv_output_close(&output, options, SHV_OK, error);
}

ShvStatus shv_output_write_all(const ShvExportOptions *options, const char *prefix, const char *const *names, int count,
                               void (*put)(const void *data, int index, FILE *stream), const void *data,
                               ShvError *error)
{
    for (int i = 0; i < count; i++) {
        ShvOutput output;
        SHV_TRY(shv_output_open(&output, options, prefix, names[i], error));
        put(data, i, output.stream);
        SHV_TRY(shv_output_close(&output, options, SHV_OK, error));
    }
    return SHV_OK;
}

void shv_output_withdraw(const char *prefix, const char *suffix)
{
    const ShvExportOptions plain = {.memory = NULL}; /* what failed may have been memory with a limit */
    char *path = shv_output_path(&plain, prefix, suffix);
    if (path) unlink(path);
    shv_release(path);
}

void shv_output_format(char text[SHV_OUTPUT_NUMBER], double value)
{
    for (int digits = 15; digits <= 17; digits++) {
        shv_format(text, SHV_OUTPUT_NUMBER, "%.*g", digits, value);
        if (shv_text_to_double(text, NULL) == value) break;
    }
}

void shv_output_number(FILE *stream, double value)
{
    char text[SHV_OUTPUT_NUMBER] = "";
    if (isfinite(value)) shv_output_format(text, value);
    shv_print(stream, ",%s", text);
}

void shv_output_field(FILE *stream, const char *text)
{
    const char *quote = strpbrk(text, ",\"\n") ? "\"" : "";
    shv_print(stream, "%s", quote);
    for (; *text; text++) shv_print(stream, *text == '"' ? "\"\"" : "%c", *text);
    shv_print(stream, "%s", quote);
}

void shv_member_key(ShvMembers *members, const char *name)
{
    if (members->any) shv_print(members->stream, ", ");
    members->any = true;
    shv_print_json_text(members->stream, name);
    shv_print(members->stream, ": ");
}

void shv_member_text(ShvMembers *members, const char *name, const char *text)
{
    shv_member_key(members, name);
    shv_print_json_text(members->stream, text);
}

void shv_member_number(ShvMembers *members, const char *name, double value)
{
    char text[SHV_OUTPUT_NUMBER] = "null";
    if (isfinite(value)) shv_output_format(text, value);
    shv_member_key(members, name);
    shv_print(members->stream, "%s", text);
}

void shv_member_flag(ShvMembers *members, const char *name, bool flag)
{
    shv_member_key(members, name);
    shv_print(members->stream, flag ? "true" : "false");
}

double shv_number_of(const void *item, const ShvNumberField *field)
{
    double value;
    memcpy(&value, (const char *)item + field->offset, sizeof value);
    return value;
}

void shv_member_fields(ShvMembers *members, const void *item, const ShvNumberField *fields, int count)
{
    for (int i = 0; i < count; i++) shv_member_number(members, fields[i].name, shv_number_of(item, &fields[i]));
}
