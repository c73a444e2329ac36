/* No room: the run stops with a message and the file keeps all frames before. */
#include "check.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "crash.h"
#include "fake_simulation.h"
#include "files.h"
#include "shiver/run_file.h"

/* Records until it fails; the exit status is the number of frames written, or 200 + … where something is wrong. */
static void record_until_full(const char *path, rlim_t limit)
{
    ShvError error;
    ShvRecord *record;
    ShvRecordDefinition definition = shv_record_default();
    definition.path = path;
    signal(SIGXFSZ, SIG_DFL); /* would end the process: the library must not let it come to that */
    setrlimit(RLIMIT_FSIZE, &(struct rlimit){limit, limit});
    ShvSimulation *simulation = fake_create(&CRASH_SETUP);
    if (shv_record_create(&record, &definition, simulation, &error) != SHV_OK)
        _exit(error.status == SHV_FILE_ERROR && !record ? 0 : 200);
    for (int frames = 0; frames < 190; frames++) {
        fake_advance(simulation);
        const ShvStatus status = shv_record_frame(record, simulation, &error);
        if (status == SHV_OK) continue;
        if (status != SHV_FILE_ERROR || !strstr(error.message, "no space for frame")) _exit(201);
        if (shv_record_frame(record, simulation, &error) != SHV_FILE_ERROR) _exit(202);
        if (shv_record_close(record, SHV_FILE_ERROR, "full", &error) != SHV_OK) _exit(203);
        fake_destroy(simulation);
        _exit(frames);
    }
    _exit(204);
}

static int run_child(const char *path, rlim_t limit)
{
    int status = 0;
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) record_until_full(path, limit);
    waitpid(child, &status, 0);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static void test_full_at_any_size(void **state)
{
    int with_frames = 0, without = 0;
    for (rlim_t limit = 1000; limit < 700000; limit += 54321) {
        const char *path = file_in(*state, "run.h5");
        unlink(path);
        const int frames = run_child(path, limit);
        assert_true(frames < 190);
        without += frames == 0;
        with_frames += frames > 0;
        if (frames == 0) {
            assert_int_equal(files_in(*state), 0);
            continue;
        }
        ShvError error;
        ShvRunFile *file;
        crash_expect(frames);
        assert_true(file_size(path) <= (long)limit);
        check_ok(shv_run_file_open(&file, path, NULL, &error), error);
        assert_int_equal(shv_run_file_info(file)->frame_count, frames);
        assert_string_equal(shv_run_file_info(file)->status, "failed");
        assert_string_equal(shv_run_file_info(file)->message, "full");
        shv_run_file_close(file);
        const char *wrong = crash_check(path, &CRASH_SETUP);
        if (wrong) fail_msg("limit %lu: %s", (unsigned long)limit, wrong);
    }
    assert_true(without > 1 && with_frames > 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_full_at_any_size, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
