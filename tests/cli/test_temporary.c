/* What is made for another program goes with the program that called it, whatever ends that, and so do the other program and its
   helpers. In the place of gmsh and Chromium stands a script that never ends, so that neither is needed. */
#include <signal.h>
#include <time.h>

#include "cli/shell.h"
#include "shiver/view.h"

enum { PATIENCE = 2000, MOST_SECONDS = 120 }; /* looks, 10 ms apart */

static const char cube[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n"
                           "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
static const char scene[] = "shiver: 1\n"
                            "materials: {stuff: {library: plaster}}\n"
                            "objects: {body: {mesh: {stl: {file: cube.obj, edge: 0.5}}, material: stuff}}\n"
                            "duration: 1e-3\n";
static const char stands_in[] = "#!/bin/sh\n"
                                "sleep 300 &\n"
                                "touch $TMPDIR/more\n"
                                "echo $$ $! >processes.part\n"
                                "mv processes.part processes\n"
                                "wait\n";

static void nap(void)
{
    const struct timespec length = {0, 10 * 1000 * 1000};
    nanosleep(&length, NULL);
}

static int enter(void **state)
{
    alarm(MOST_SECONDS); /* a test that is stuck ends */
    if (shell_enter(state) != 0) return -1;
    shell_write("cube.obj", cube);
    shell_write("scene.yaml", scene);
    shell_write("gmsh", stands_in);
    return shell("chmod +x gmsh; cp gmsh chromium; mkdir made; $shiver run $scenes/hybrid/bar.yaml --quiet "
                 "--set duration=1e-4 --output run.h5");
}

/* A process of its own for the program; its temporary folders are made in ./made. */
static pid_t start(const char *const *arguments)
{
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child > 0) return child;
    char path[4096], folder[4096], *copies[8] = {NULL};
    if (!getcwd(folder, sizeof folder) || !freopen("stdout.txt", "w", stdout) || !freopen("stderr.txt", "w", stderr))
        _exit(99);
    snprintf(path, sizeof path, "%.2000s:%.2000s", folder, getenv("PATH"));
    setenv("PATH", path, 1);
    snprintf(path, sizeof path, "%.4000s/made", folder);
    setenv("TMPDIR", path, 1);
    signal(SIGINT, SIG_DFL);
    signal(SIGHUP, SIG_DFL);
    for (int i = 0; i < 7 && arguments[i]; i++) copies[i] = strdup(arguments[i]);
    execv(SHIVER_PROGRAM, copies);
    _exit(99);
}

static bool is_running(pid_t process)
{
    char path[64], text[256] = "";
    snprintf(path, sizeof path, "/proc/%ld/stat", (long)process);
    FILE *file = fopen(path, "r");
    if (!file) return false;
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    const char *state = strrchr(text, ')');
    return state && state[1] && state[2] != 'Z';
}

/* The script and what it has started. */
static void read_processes(pid_t processes[2])
{
    long numbers[2] = {0, 0};
    FILE *file = NULL;
    for (int i = 0; i < PATIENCE && !file; i++) {
        nap();
        file = fopen("processes", "r");
    }
    if (!file) shell("cat stdout.txt stderr.txt");
    if (!file) fail_msg("the other program was not called");
    assert_int_equal(fscanf(file, "%ld %ld", &numbers[0], &numbers[1]), 2);
    fclose(file);
    for (int i = 0; i < 2; i++) processes[i] = (pid_t)numbers[i];
}

static void nothing_stays(const char *const *arguments, int number)
{
    pid_t processes[2];
    assert_int_equal(shell("rm -f processes; touch after; ls >before"), 0);
    const pid_t program = start(arguments);
    read_processes(processes);
    assert_true(is_running(processes[0]) && is_running(processes[1]));
    assert_int_equal(kill(program, number), 0);
    assert_int_equal(waitpid(program, NULL, 0), program);
    bool left = true;
    for (int i = 0; i < PATIENCE && left; i++) {
        nap();
        left = is_running(processes[0]) || is_running(processes[1]) || shell("test -z \"$(ls made)\"") != 0;
    }
    if (left) fail_msg("after signal %d of %s something is left", number, arguments[1]);
    /* Nor an output that was begun. */
    shell_works("rm processes; ls >after; diff before after | wc -l", "0");
}

static void each_signal(const char *const *arguments)
{
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP, SIGKILL};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) nothing_stays(arguments, numbers[i]);
}

static void nothing_stays_of_mesh(void **state)
{
    (void)state;
    each_signal((const char *const[]){"shiver", "mesh", "cube.obj", "--edge", "0.5", NULL});
}

static void nothing_stays_of_a_scene_that_names_a_surface(void **state)
{
    (void)state;
    each_signal((const char *const[]){"shiver", "check", "scene.yaml", NULL});
    each_signal((const char *const[]){"shiver", "run", "scene.yaml", "--quiet", NULL});
}

static void nothing_stays_of_pictures(void **state)
{
    (void)state;
    if (!shv_view_is_built()) skip();
    each_signal((const char *const[]){"shiver", "export", "png", "run.h5", "--output", "there", NULL});
}

/* Also where it ends by itself. */
static void nothing_stays_of_what_fails(void **state)
{
    (void)state;
    shell_fails("printf '#!/bin/sh\\nsleep 300 & exit 1' >gmsh; TMPDIR=$PWD/made PATH=$PWD:$PATH "
                "timeout 20 $shiver mesh cube.obj --edge 0.5",
                1, "gmsh could not mesh");
    shell_works("ls made *.part 2>/dev/null | wc -l", "1");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_stays_of_mesh), cmocka_unit_test(nothing_stays_of_a_scene_that_names_a_surface),
        cmocka_unit_test(nothing_stays_of_pictures), cmocka_unit_test(nothing_stays_of_what_fails)};
    return cmocka_run_group_tests(tests, enter, shell_leave);
}
