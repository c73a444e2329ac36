#include "shiver/view.h"

#include <string.h>

#include "export/output.h"
#include "view/data.h"
#include "view/page.h"

static const char TITLE[] = "SHIVER_TITLE", DATA[] = "SHIVER_DATA";

ShvViewOptions shv_view_default(void)
{
    return (ShvViewOptions){.cookie = SHV_DEFINITION_COOKIE, .every = 1};
}

bool shv_view_is_built(void)
{
    return shv_view_page_size > 0;
}

static ShvStatus check(const ShvViewOptions *options, int32_t run_count, ShvError *error)
{
    if (options->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "the view's options did not start from shv_view_default()");
    if (options->every < 1)
        return shv_fail(error, SHV_BAD_INPUT, "every 1st, 2nd, … frame is shown; %d was given", (int)options->every);
    if (run_count < 1 || run_count > 2)
        return shv_fail(error, SHV_BAD_INPUT, "a page shows one or two runs; %d were given", (int)run_count);
    if (!options->page && !shv_view_is_built())
        return shv_fail(error, SHV_UNSUPPORTED,
                        "this program was built without the viewer's page, which takes node and npm: "
                        "`./bootstrap view` in the source folder installs what is missing and builds it in");
    return SHV_OK;
}

/* One element with the numbers of a run: base64 has no letter that HTML minds. */
static ShvStatus put_run(const ShvViewRun *run, const ShvViewOptions *options, FILE *stream, ShvError *error)
{
    ShvViewData data;
    ShvPack *pack = shv_allocate(options->memory, SHV_PART_RECORD, 1, sizeof *pack);
    if (!pack) return shv_fail_memory(error, "compression", sizeof *pack);
    ShvStatus status = shv_view_data_create(&data, run, options, error);
    if (status == SHV_OK) status = shv_pack_begin(pack, stream, error);
    if (status == SHV_OK) {
        data.pack = pack;
        fputs("<script type=\"application/octet-stream\" class=\"run\">", stream);
        status = shv_view_put_head(&data, error);
        if (status == SHV_OK) status = shv_view_put_frames(&data, error);
        shv_pack_end(pack);
        fputs("</script>\n", stream);
    }
    shv_view_data_release(&data);
    shv_release(pack);
    return status;
}

static ShvStatus put_title(const ShvViewRun *runs, int32_t run_count, const ShvExportOptions *output, FILE *stream,
                           ShvError *error)
{
    for (int32_t i = 0; i < run_count; i++) {
        char *name = shv_output_escaped(output, shv_run_file_info(runs[i].file)->scene_name);
        if (!name) return shv_fail_memory(error, "a title", 1);
        fprintf(stream, "%s%s", i > 0 ? " | " : "", name);
        shv_release(name);
    }
    return SHV_OK;
}

static ShvStatus put_page(const ShvViewRun *runs, int32_t run_count, const ShvViewOptions *options,
                          const ShvExportOptions *output, FILE *stream, ShvError *error)
{
    const char *page = options->page ? options->page : shv_view_page;
    const char *title = strstr(page, TITLE), *data = title ? strstr(title, DATA) : NULL;
    if (!data) return shv_fail(error, SHV_BAD_INPUT, "the viewer's page lacks %s or, after it, %s", TITLE, DATA);
    fwrite(page, 1, (size_t)(title - page), stream);
    SHV_TRY(put_title(runs, run_count, output, stream, error));
    title += strlen(TITLE);
    fwrite(title, 1, (size_t)(data - title), stream);
    for (int32_t i = 0; i < run_count; i++) SHV_TRY(put_run(&runs[i], options, stream, error));
    fputs(data + strlen(DATA), stream);
    return SHV_OK;
}

ShvStatus shv_view_write(const ShvViewRun *runs, int32_t run_count, const char *path, const ShvViewOptions *given,
                         ShvError *error)
{
    static const char *const suffix[] = {""};
    const ShvViewOptions options = given ? *given : shv_view_default();
    SHV_TRY(check(&options, run_count, error));
    ShvExportOptions output = shv_export_default();
    output.force = options.force;
    output.memory = options.memory;
    SHV_TRY(shv_output_check(&output, path, suffix, 1, error));
    ShvOutput written;
    SHV_TRY(shv_output_open(&written, &output, path, suffix[0], error));
    const ShvStatus status = put_page(runs, run_count, &options, &output, written.stream, error);
    return shv_output_close(&written, &output, status, error);
}
