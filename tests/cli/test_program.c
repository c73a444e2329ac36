/* The program as its users meet it: what it prints, where, and how it ends. */
#include "cli/json.h"
#include "cli/shell.h"
#include "shiver/view.h"

static const char tiny_scene[] =
    "shiver: 1\n"
    "name: tiny\n"
    "materials:\n"
    "  chalk: {density: 1200, youngs_modulus: 50e6, poissons_ratio: 0.2, fracture_energy: 0.5, cohesive_strength: "
    "50e3}\n"
    "objects:\n"
    "  bar: {mesh: {box: {size: [0.02, 0.02, 0.06], edge: 0.02}}, material: chalk, position: [0, 0, 0.031],\n"
    "        velocity: [0, 0, -0.3]}\n"
    "obstacles:\n"
    "  floor: {plane: {normal: [0, 0, 1], offset: 0}, friction: 0.3}\n"
    "duration: 0.005\n"
    "output: {rate: 1000}\n"
    "threads: 1\n";

static int enter(void **state)
{
    if (shell_enter(state) != 0) return -1;
    shell_write("tiny.yaml", tiny_scene);
    return 0;
}

/* An obstacle smaller than an edge. */
static void test_small_obstacle(void **state)
{
    (void)state;
    const char *pin = " --set 'obstacles.pin={sphere: {radius: 2 mm}, position: [1, 0, 0]}'";
    char line[160];
    snprintf(line, sizeof line, "$shiver check tiny.yaml%s", pin);
    shell_works(line, "the obstacle 'pin' (0.004 m) is smaller than an edge");
    shell_works("$shiver check tiny.yaml", "bar (chalk)");
    assert_null(strstr(output.out, "smaller than an edge"));
}

/* Copies are told once, with the one that falls deepest; as JSON each by itself, and another mesh by itself in any case. */
static void test_alike_objects(void **state)
{
    (void)state;
    const char *copies = " --set 'objects.bar.repeat={count: 3, offset: [0.5, 0, 0.05]}'";
    char line[200];
    snprintf(line, sizeof line, "$shiver check tiny.yaml%s", copies);
    shell_works(line, "bar_1 to bar_3 (chalk), 3 alike, each: ");
    assert_non_null(
        strstr(output.out, "of these bar_3 has the hardest first impact:\n  nearest: the obstacle 'floor'"));
    assert_null(strstr(output.out, "bar_2"));
    snprintf(line, sizeof line, "$shiver check tiny.yaml --json%s", copies);
    shell_works(line, "\"object\": \"bar_2\"");
    const char *longer = " --set 'objects.more={mesh: {box: {size: [0.02, 0.02, 0.08], edge: 0.02}}, material: chalk, "
                         "position: [1, 0, 0.05]}'";
    snprintf(line, sizeof line, "$shiver check tiny.yaml%s", longer);
    shell_works(line, "bar (chalk): ");
    assert_non_null(strstr(output.out, "\nmore (chalk): "));
}

/* Two tets on one triangle: what is flat of them sets the step, and is told; what is as high as half an edge is not. */
static void test_sliver(void **state)
{
    (void)state;
    static const struct {
        const char *height, *improve, *told;
    } cases[] = {
        {"0.0004", "false",
         "warning: the flattest tet is 0.0004 m high, 0.019 of the mean edge, and sets the step: a mesh without "
         "such\n           takes about 26 times fewer steps; try 'improve: true' in the object's mesh"},
        {"0.0004", "true", "warning: the flattest tet is 0.0004 m high"},
        {"0.005", "false", "note: the flattest tet is 0.005 m high"},
        {"0.005", "true", NULL},
        {"0.014", "false", NULL}};
    shell_write("pair.ele", "2 4 0\n0 0 2 1 3\n1 0 1 2 4\n");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char nodes[160], command[160];
        snprintf(nodes, sizeof nodes, "5 3 0 0\n0 0 0 0\n1 0.02 0 0\n2 0 0.02 0\n3 0 0 -0.02\n4 0.006 0.006 %s\n",
                 cases[i].height);
        shell_write("pair.node", nodes);
        snprintf(command, sizeof command,
                 "$shiver check tiny.yaml --set 'objects.bar.mesh={tetgen: {file: pair.node, improve: %s}}'",
                 cases[i].improve);
        shell_works(command, "stable step");
        if (cases[i].told) assert_non_null(strstr(output.out, cases[i].told));
        assert_int_equal(strstr(output.out, "flattest") != NULL, cases[i].told != NULL);
    }
}

static void test_usage(void **state)
{
    (void)state;
    shell_fails("$shiver", 2, "usage: shiver COMMAND");
    assert_string_equal(output.out, "");
    shell_works("$shiver --help", "usage: shiver COMMAND");
    shell_works("$shiver --version", "shiver 0.");
    const char *commands[] = {"run", "check", "plan", "mesh", "info", "view", "export", "compare", "study"};
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        char line[64], usage[64];
        snprintf(line, sizeof line, "$shiver %s --help", commands[i]);
        snprintf(usage, sizeof usage, "usage: shiver %s ", commands[i]);
        shell_works(line, usage);
        assert_non_null(strstr(output.out, "--help"));
        assert_string_equal(output.err, "");
        snprintf(line, sizeof line, "$shiver %s", commands[i]);
        shell_fails(line, 2, usage);
        snprintf(line, sizeof line, "$shiver %s --taste sweet", commands[i]);
        shell_fails(line, 2, "unknown option --taste");
    }
}

static void test_wrong_words(void **state)
{
    (void)state;
    shell_fails("$shiver rum tiny.yaml", 2, "did you mean run?");
    shell_fails("$shiver run tiny.yaml --forse", 2, "did you mean --force?");
    shell_fails("$shiver run tiny.yaml other.yaml", 2, "one argument too many: other.yaml");
    shell_fails("$shiver run tiny.yaml --output", 2, "--output needs a value");
    shell_fails("$shiver run tiny.yaml --audit-wake 1.5", 2, "--audit-wake takes a whole number");
    shell_fails("$shiver run tiny.yaml --set", 2, "--set needs a value: KEY=VAL");
    shell_fails("$shiver info tiny.yaml --set duration=1", 2, "unknown option --set");
    shell_fails("$shiver materials glass", 2, "usage: shiver materials [options]; --help");
    /* Columns are of characters, not of bytes. */
    shell_works("$shiver export --help", "--frames     A,B,…    svg");
    shell_works("$shiver export --help", "--every      N        all");
}

static void test_check_and_plan(void **state)
{
    (void)state;
    shell_works("$shiver check tiny.yaml", "stable step");
    shell_works("$shiver check tiny.yaml --set materials.chalk.fracture_energy=1e9", "fracture: {connectivity: nodes}");
    shell_works(
        "! $shiver check tiny.yaml --set materials.chalk.fracture_energy=1e9 --set fracture.connectivity=nodes | "
        "grep connectivity",
        "");
    shell_fails("$shiver check tiny.yaml --set fracture.connectivity=bond", 2, "fracture.connectivity");
    shell_works("$shiver check tiny.yaml", "cohesive zone");
    shell_works("$shiver check tiny.yaml", "snap-back length");
    shell_works("$shiver check tiny.yaml --json", "\"stable_step\"");
    assert_true(json_valid(output.out));
    shell_works("$shiver plan tiny.yaml", "on  reference mesh");
    shell_works("$shiver plan tiny.yaml", "6 animation frames");
    shell_works("$shiver plan tiny.yaml --json", "\"seconds_per_step\"");
    assert_true(json_valid(output.out));
    /* Infinite and missing numbers are null. */
    shell_works("$shiver check tiny.yaml --json --set materials.chalk.cohesive_strength=.inf", "null");
    assert_true(json_valid(output.out));
    shell_works("$shiver plan tiny.yaml --json --set objects.bar.position.2=0.2 --set objects.bar.velocity.2=1 --set "
                "'gravity=[0, 0, 0]'",
                "\"first_contact\": null");
    assert_true(json_valid(output.out));
    shell_works("$shiver plan tiny.yaml --set fracture.enabled=false", "fracture.enabled is false");
    shell_works("$shiver plan tiny.yaml", "all of it");
    shell_works("$shiver plan tiny.yaml --trial 0.001", "run time of the scene");
    shell_works("$shiver plan tiny.yaml --trial 0 --json", "\"trial_seconds\": 0");
    assert_true(json_valid(output.out));
    const char *wrong[] = {"x", "-1", "1s", "", "nan"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        char line[128];
        snprintf(line, sizeof line, "$shiver plan tiny.yaml --trial '%s'", wrong[i]);
        shell_fails(line, 2, "--trial takes seconds");
    }
    assert_false(json_valid("{\"a\": nan}") || json_valid("[1,]") || json_valid("{} x") || json_valid(""));
}

/* What overlaps at the start is refused by everything that runs a scene, before anything is written. */
static void test_refused_overlaps(void **state)
{
    (void)state;
    static const char *const commands[] = {"check",
                                           "check --json",
                                           "plan",
                                           "plan --trial 0 --json",
                                           "run --output begun.h5 --force",
                                           "compare --steps 1e-3",
                                           "stability"};
    static const char *const low = "--set objects.bar.position.2=0.0295 --set materials.chalk.breakable=false";
    char line[256];
    shell_write("begun.h5", "precious");
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        snprintf(line, sizeof line, "$shiver %s tiny.yaml %s", commands[i], low);
        shell_fails(line, 2, "'bar' and the obstacle 'floor' overlap at the start, 0.0005 m deep");
        assert_non_null(strstr(output.err, "move 'bar' by (0, 0, 0.0005) m, or give 'overlaps: keep'"));
        assert_string_equal(output.out, "");
    }
    shell_works("cat begun.h5", "precious");
    shell_works("ls | grep -c begun", "1");
    shell_write("low.yaml",
                "shiver_study: 1\nset: {objects.bar.position.2: 0.0295}\n"
                "vary: {fracture.safety: [0.5, 0.9]}\nmeasures: [energy]\nreference: {fracture.safety: 0.5}\n");
    shell_fails("$shiver study tiny.yaml low.yaml", 2, "overlap at the start");
}

/* Kept overlaps are named by check, and run says the same; a body without room is in its summary. */
static void test_overlaps(void **state)
{
    (void)state;
    const char *commands[] = {"check", "run --force --quiet"};
    char line[320], said[2][512];
    for (int i = 0; i < 2; i++) {
        snprintf(line, sizeof line, "$shiver %s tiny.yaml --set overlaps=keep --set objects.bar.position.2=0.0295",
                 commands[i]);
        assert_int_equal(shell(line), 0);
        const char *warning = strstr(output.err, "'bar' and the obstacle 'floor' overlap at the start, 0.0005 m deep");
        assert_non_null(warning);
        snprintf(said[i], sizeof said[i], "%s", warning);
    }
    assert_string_equal(said[0], said[1]);
    assert_non_null(strstr(said[0], "lets it be"));
    shell_works("$shiver check tiny.yaml", "stable step");
    assert_null(strstr(output.err, "overlap"));
    const char *between = "--set 'obstacles.lid={plane: {normal: [0, 0, -1], offset: -0.0615}}'";
    snprintf(line, sizeof line, "$shiver run --force tiny.yaml %s", between);
    shell_works(line, "finished");
    assert_null(strstr(output.out, "no room"));
    snprintf(line, sizeof line,
             "$shiver run --force tiny.yaml %s --set overlaps=keep --set obstacles.lid.plane.offset=-0.0585 "
             "--set materials.chalk.breakable=false --set objects.bar.position.2=0.03 --set objects.bar.velocity.2=0",
             between);
    shell_works(line, "fragment 0 of 'bar' between 'floor' and 'lid'");
    shell_works("$shiver export csv tiny.h5 --force", "");
    shell_works("cat tiny_events.csv", "squeeze");
}

/* A plan of a slow and finely stepped fall takes no time itself. */
static void test_plan_of_a_long_fall(void **state)
{
    (void)state;
    shell_works("timeout 5 $shiver plan tiny.yaml --trial 0 --set rigid.time_step=1e-9 --set duration=1000 --set "
                "'gravity=[0, 0, 0]' "
                "--set objects.bar.position.2=0.2 --set objects.bar.velocity.2=1",
                "no contact");
}

static void test_overrides(void **state)
{
    (void)state;
    shell_works("$shiver plan tiny.yaml --set output.rate=2000", "11 animation frames");
    shell_works("$shiver plan tiny.yaml --set output.rate=2000 --set duration=0.01", "21 animation frames");
    shell_fails("$shiver check tiny.yaml --set fracture.threshold=2", 2, "--set fracture.threshold: error");
    shell_fails("$shiver check tiny.yaml --set gravty=3", 2, "did you mean 'gravity'?");
    shell_fails("$shiver check tiny.yaml --set duration", 2, "--set");
}

static void test_bad_scenes(void **state)
{
    (void)state;
    shell_write("bad.yaml",
                "shiver: 1\nname: bad\nmaterials:\n  chalk: {densty: 1200, youngs_modulus: -5, poissons_ratio: 0.7,\n"
                "          fracture_energy: 1, cohesive_strength: .nan}\nobjects: {}\nduration: -1\n");
    const char *commands[] = {"check", "plan", "run"};
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        char line[64];
        snprintf(line, sizeof line, "$shiver %s bad.yaml", commands[i]);
        shell_fails(line, 2, "bad.yaml:4:");
        assert_string_equal(output.out, "");
        const char *expected[] = {"'densty'",       "'density'",   "youngs_modulus",
                                  "poissons_ratio", "bad.yaml:5:", "bad.yaml:7:"};
        for (size_t k = 0; k < sizeof expected / sizeof expected[0]; k++)
            if (!strstr(output.err, expected[k])) fail_msg("'%s' is missing in: %s", expected[k], output.err);
    }
    assert_int_not_equal(access("bad.h5", F_OK), 0);
    shell_fails("$shiver check missing.yaml", 2, "missing.yaml");
    shell_fails("$shiver check .", 2, "folder");
    shell_write("cut.yaml", "shiver: 1\nmaterials: {chalk: {density: 12");
    shell_fails("$shiver check cut.yaml", 2, "cut.yaml:");
    shell_fails("head -c 5000 $shiver >binary.yaml; $shiver check binary.yaml", 2, "binary.yaml");
    shell_fails("head -c 20000000 /dev/zero >huge.yaml; $shiver check huge.yaml", 2, "huge.yaml");
    shell_fails("$shiver run tiny.yaml --set 'objects.bar.mesh={gmsh: {file: nowhere.msh}}'", 2, "nowhere.msh");
    shell_fails("$shiver run tiny.yaml --set fracture.time_step=1e-3", 2, "stable step");
}

static void test_run_and_info(void **state)
{
    (void)state;
    shell_works("$shiver run tiny.yaml --output fine.h5", "finished: t = 0.005 s");
    assert_non_null(strstr(output.out, "ledger residual"));
    shell_works("$shiver info fine.h5", "tiny: finished");
    assert_non_null(strstr(output.out, "6 frames from 0 to 0.005 s"));
    shell_works("$shiver info fine.h5 --json", "\"status\": \"finished\"");
    assert_true(json_valid(output.out));
    shell_works("$shiver info fine.h5 --fragments", "birth s");
    shell_works("$shiver info fine.h5 --scene", tiny_scene);
    shell_works("$shiver run tiny.yaml --output fine.h5 --force --json", "\"status\": \"finished\"");
    assert_true(json_valid(output.out));
    shell_works("$shiver run tiny.yaml --output quiet.h5 --quiet", "");
    assert_string_equal(output.out, "");
    assert_string_equal(output.err, "");
    shell_fails("$shiver info tiny.yaml", 2, "not a run file");
    shell_fails("$shiver info missing.h5", 2, "missing.h5");
    shell_fails("head -c 3000 fine.h5 >cut.h5; $shiver info cut.h5", 2, "cut.h5");
    shell_fails("$shiver info .", 2, "");
}

/* The run file takes its name from the scene's, in the working folder. */
static void test_default_name(void **state)
{
    (void)state;
    shell_works("mkdir -p a && cp tiny.yaml a/other.scene.yaml && $shiver run a/other.scene.yaml", "other.scene.h5");
    assert_int_equal(access("other.scene.h5", R_OK), 0);
}

static void test_existing_output(void **state)
{
    (void)state;
    shell_write("kept.h5", "precious");
    shell_fails("$shiver run tiny.yaml --output kept.h5", 2, "--force");
    shell_works("cat kept.h5", "precious");
    /* With --force, too, a run that does not begin leaves it alone. */
    shell_fails("$shiver run tiny.yaml --output kept.h5 --force --set fracture.time_step=4e-3", 2, "stable step");
    shell_works("cat kept.h5", "precious");
    shell_works("$shiver run tiny.yaml --output kept.h5 --force; $shiver info kept.h5", "tiny: finished");
    shell_works("ls | grep -c part || true", "0");
}

static void test_unwritable(void **state)
{
    (void)state;
    shell_fails("$shiver run tiny.yaml --output nowhere/x.h5", 1, "nowhere/x.h5");
    shell_fails("$shiver run tiny.yaml --output /dev/full", 2, "not an ordinary file");
    shell_fails("$shiver check tiny.yaml >/dev/full", 1, "standard output");
    shell_fails("$shiver plan tiny.yaml --json >/dev/full", 1, "standard output");
    shell_fails("$shiver --help >/dev/full", 1, "standard output");
}

/* What is printed goes nowhere rather than into a file that got the stream's number. */
static void test_closed_streams(void **state)
{
    (void)state;
    shell_works("$shiver run tiny.yaml --force --output streams.h5 <&- 2>&- && $shiver info --verify streams.h5",
                "agree with their checksums");
    shell_fails("$shiver check tiny.yaml >&-", 1, "standard output");
    shell_works("$shiver run tiny.yaml --force --output streams.h5 --quiet >&- 2>&- <&-; $shiver info streams.h5",
                "tiny: finished");
}

/* No --force replaces what a command reads. */
static void test_inputs_are_kept(void **state)
{
    (void)state;
    shell_works("cp tiny.yaml own.yaml; $shiver run own.yaml --output own.yaml --force; cmp tiny.yaml own.yaml", "");
    shell_fails("$shiver run own.yaml --output ./own.yaml --force", 2, "is read by this command");
    shell_works("ln own.yaml other.name", "");
    shell_fails("$shiver run own.yaml --output other.name --force", 2, "is read by this command");
    shell_works("printf 'v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nv 0 0 1\\nf 1 3 2\\nf 1 2 4\\nf 2 3 4\\nf 1 4 3\\n' >tet.obj",
                "");
    shell_fails("$shiver run tiny.yaml --output tet.obj --force --set "
                "'obstacles.block={mesh: {file: tet.obj}, position: [9, 9, 9]}'",
                2, "is read by this command");
    shell_fails("$shiver mesh tet.obj --edge 0.5 --output tet.obj --force", 2, "is read by this command");
    shell_works("$shiver run tiny.yaml --force --output a_xdmf.h5 --quiet", "");
    shell_fails("$shiver export xdmf a_xdmf.h5 --output a --force", 2, "is read by this command");
}

static void test_permissions_are_kept(void **state)
{
    (void)state;
    shell_works("$shiver run tiny.yaml --output mode.h5 --quiet && chmod 640 mode.h5 && "
                "$shiver run tiny.yaml --output mode.h5 --quiet --force && stat -c %a mode.h5",
                "640");
    shell_works("ls mode.h5*", "mode.h5\n");
}

/* Devices are no files, and a name cannot write to the terminal. */
static void test_odd_inputs(void **state)
{
    (void)state;
    shell_fails("$shiver check tiny.yaml --set 'objects.bar.mesh={gmsh: {file: /dev/zero}}'", 2, "is a device");
    shell_fails("$shiver check /dev/zero", 2, "is a device");
    shell_fails("$shiver check \"$(printf 'a\\033[31mb\\302\\233c.yaml')\"", 2, "a?[31mb?c.yaml");
    shell_fails("$shiver run tiny.yaml --output $(printf '%05000d' 0)", 2, "too long");
    shell_fails("$shiver export csv tiny.yaml --output $(printf '%05000d' 0)", 2, "too long");
}

static void test_full_disk_of_an_export(void **state)
{
    (void)state;
    shell_works("$shiver run tiny.yaml --force --output big.h5 --quiet --set output.nodes=true --set output.rate=1e5",
                "");
    const char *const formats[] = {"xdmf", "csv", "vtk", "usd", "gltf", "svg"};
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        char line[128];
        snprintf(line, sizeof line, "ulimit -f 8; $shiver export %s big.h5 --output small", formats[i]);
        if (i < 3) shell_fails(line, 1, "make room on the disk");
        if (i >= 3) shell(line); /* small files may fit */
        if (output.status != 0) shell_works("ls | grep -c ^small || true", "0");
        shell_works("rm -f small*", "");
    }
}

static void test_full_disk(void **state)
{
    (void)state;
    /* The limit counts blocks of 512 bytes (dash) or 1024 (bash); either way it falls within the frames of this run. */
    shell_fails("ulimit -f 1000; $shiver run tiny.yaml --output full.h5 --set output.nodes=true --set output.rate=1e6 "
                "--set threads=1 --quiet",
                1, "full.h5");
    shell_works("$shiver info full.h5", "tiny: failed");
    shell_works("$shiver info full.h5 --json", "\"frames\": ");
    assert_true(atoi(strstr(output.out, "\"frames\": ") + 10) > 1);
}

static void test_interruption(void **state)
{
    (void)state;
    const char *signals[] = {"INT", "TERM"};
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++) {
        char line[512];
        snprintf(line, sizeof line,
                 "$shiver run tiny.yaml --output stopped.h5 --force --set duration=1e5 --set output.rate=100 --set "
                 "rigid.time_step=1e-4 & pid=$!; while ! [ -e stopped.h5 ] && kill -0 $pid; do sleep 0.05; done; sleep "
                 "0.3; kill -%s $pid; "
                 "wait $pid",
                 signals[i]);
        shell_fails(line, 130, "stopped at");
        assert_non_null(strstr(output.out, "interrupted: t ="));
        shell_works("$shiver info stopped.h5", "tiny: interrupted");
        assert_int_equal(unlink("stopped.h5"), 0);
    }
}

/* A wall behind a block, of which a part is nearer than the block is: all of it is drawn first. */
static void test_what_hides_is_drawn_later(void **state)
{
    (void)state;
    shell_write("wall.yaml",
                "shiver: 1\nname: wall\nmaterials: {brick: {library: brick}}\n"
                "objects: {block: {mesh: {box: {size: [60 mm, 60 mm, 60 mm], edge: 30 mm}}, material: brick, "
                "position: [0, 0, 0.36]}}\n"
                "obstacles: {wall: {box: {size: [20 mm, 300 mm, 400 mm]}, position: [-0.06, 0, 0.25]}}\n"
                "duration: 1e-3\n");
    shell_works("$shiver run wall.yaml --quiet && $shiver export svg wall.h5 --time 0", "wall.svg");
    shell_works(
        "sed -n 's/^<path fill=\"\\(#[0-9a-f]*\\)\".*/\\1/p' wall.svg >colours; grep -c $(head -1 colours) colours",
        "1\n");
}

/* A wall between the viewer and the block is no more to be seen than one that is far below. */
static void test_walls_let_the_eye_in(void **state)
{
    (void)state;
    shell_works("for at in '0, -0.1, 0.36' '0, 0, -50'; do $shiver run wall.yaml --quiet --force --output at.h5 "
                "--set \"obstacles.wall={box: {size: [400 mm, 20 mm, 400 mm]}, position: [$at]}\" && "
                "$shiver export svg at.h5 --time 0 --force >said && grep '^<path' at.svg >\"$at\"; done; "
                "cmp '0, -0.1, 0.36' '0, 0, -50' && grep -c '^<path' '0, 0, -50'",
                "20\n");
}

static void test_export(void **state)
{
    (void)state;
    shell_works("$shiver run tiny.yaml --output out.h5 --quiet; $shiver export csv out.h5", "");
    shell_works("head -1 out_trajectories.csv", "time");
    shell_works("wc -l <out_ledger.csv", "7");
    shell_works("head -2 out_genealogy.csv", "mass");
    shell_fails("$shiver export csv out.h5", 2, "--force");
    shell_works("$shiver export csv out.h5 --force", "");
    shell_works("$shiver export xdmf out.h5 --output there", "");
    shell_works("cat there_fragments.xmf there_mesh.xmf", "<Xdmf");
    shell_works("ls", "there_xdmf.h5");
    shell_works("cat there_obstacles.xmf", "Triangle");
    shell_works("for format in vtk gltf usd svg; do $shiver export $format out.h5 --output there; done", "there.glb");
    shell_works("cat there.pvd", "timestep=\"0\" part=\"0\" file=\"there_000000.vtu\"");
    shell_fails("$shiver export gltf out.h5 --output there --size 5", 2, "--size does not go with gltf");
    shell_fails("$shiver export mp4 out.h5 --output there --lasts 1e", 2, "--lasts");
    shell_fails("$shiver export png out.h5 --output there --frames 99", 2, "frames 0 to 5");
    shell_fails("$shiver export png out.h5 --output there --time 0,99", 2, "no time 99 s");
    shell_fails("$shiver export png out.h5 --output there --size 20", 2, "pixels");
    /* Where nothing is on the PATH: what is missing is told. */
    shell_fails("PATH=/nowhere $shiver export mp4 out.h5 --output there", 2, "Debian's package ffmpeg");
    shell_fails("PATH=/nowhere $shiver export png out.h5 --output there", 2,
                shv_view_is_built() ? "chromium" : "bootstrap");
    shell_works("ls | grep -c ^there_.*png || true", "0");
    shell_fails("$shiver export pdf out.h5", 2, "pdf");
    shell_fails("$shiver export csv tiny.yaml", 2, "not a run file");
}

/* A name with the format's ending, or its name as one, is that of the same file as without. */
static void test_names_of_an_export(void **state)
{
    (void)state;
    static const char *const cases[][3] = {
        {"csv", "named.csv", "named_ledger.csv"}, {"xdmf", "named.xmf", "named_mesh.xmf"},
        {"xdmf", "named.xdmf", "named_mesh.xmf"}, {"vtk", "named.pvd", "named.pvd"},
        {"vtk", "named.vtk", "named.pvd"},        {"gltf", "named.glb", "named.glb"},
        {"gltf", "named.gltf", "named.glb"},      {"usd", "named.usda", "named.usda"},
        {"usd", "named.usd", "named.usda"},       {"svg", "named.svg", "named.svg"},
        {"svg", "named.usd", "named.usd.svg"},    {"svg", "svg", "svg.svg"}};
    shell_works("$shiver run tiny.yaml --output plain.h5 --quiet", "");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char line[160];
        snprintf(line, sizeof line, "mkdir of%zu && $shiver export %s plain.h5 -o of%zu/%s && test -s of%zu/%s", i,
                 cases[i][0], i, cases[i][1], i, cases[i][2]);
        shell_works(line, "wrote of");
    }
}

static void test_view(void **state)
{
    (void)state;
    shell_works("$shiver run tiny.yaml --output seen.h5 --quiet", "");
    if (shv_view_is_built()) {
        shell_works("$shiver view seen.h5", "wrote seen.html");
        shell_works("grep -c DOCTYPE -i seen.html", "1");
        shell_fails("$shiver view seen.h5", 2, "--force");
        shell_works("$shiver view seen.h5 --two seen.h5 --every 2 --output both.html", "wrote both.html");
    } else {
        shell_fails("$shiver view seen.h5", 2, "./bootstrap view");
    }
    shell_fails("$shiver view seen.h5 --every 0", 2, "--every");
    shell_fails("$shiver view seen.h5 --output seen.h5 --force", 2, "read by this command");
    shell_fails("$shiver view tiny.yaml", 2, "not a run file");
    shell_fails("head -c 5000 seen.h5 >cut.h5; $shiver view cut.h5", 2, "cut.h5");
    shell_fails("$shiver view missing.h5", 2, "missing.h5");
    shell_works("ls | grep -c cut.html || true", "0");
}

static const char cube[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                           "f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\n"
                           "f 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n";

static void test_mesh(void **state)
{
    (void)state;
    shell_write("cube.obj", cube);
    shell_fails("$shiver mesh cube.obj", 2, "--edge");
    shell_fails("$shiver mesh cube.obj --edge nothing", 2, "positive number");
    shell_fails("$shiver mesh cube.obj --edge -1", 2, "positive number");
    shell_fails("$shiver mesh nowhere.obj --edge 1", 2, "nowhere.obj");
    shell_fails("PATH=/nonexistent $shiver mesh cube.obj --edge 0.5", 2, "install it");
    shell_write("evil.geo", "SystemCall \"touch evil.done\";\n");
    shell_fails("$shiver mesh evil.geo --edge 0.5", 2, "--script");
    shell_fails("cp evil.geo evil.Step; $shiver mesh evil.Step --edge 0.5", 2, "neither a surface");
    assert_int_equal(access("evil.done", F_OK), -1);
    shell_write("kept.msh", "precious");
    shell_fails("$shiver mesh cube.obj --edge 0.5 --output kept.msh", 2, "--force");
    shell_works("cat kept.msh", "precious");
    if (shell("command -v gmsh") != 0) return;
    shell_fails("$shiver mesh cube.obj --edge 1e-9", 2, "choose an edge of at least");
    /* A mesh that fails leaves the old one; gmsh goes with the program that called it. */
    shell_works(
        "printf 'not a mesh' >kept.stp; $shiver mesh kept.stp --edge 0.5 --force --output kept.msh; cat kept.msh",
        "precious");
    shell_works("$shiver mesh cube.obj --edge 0.004 --output killed.msh & sleep 2; kill -KILL $!; wait; sleep 1; "
                "grep -la '^gmsh.*killed.msh' /proc/[0-9]*/cmdline 2>/dev/null | wc -l",
                "0");
    shell_works("mkdir -p long.folder.name/with.many.parts.to.see.that.no.name.is.cut && "
                "TMPDIR=$PWD/long.folder.name/with.many.parts.to.see.that.no.name.is.cut $shiver mesh cube.obj --edge "
                "0.5 --json",
                "\"tets\"");
    assert_true(json_valid(output.out));
    shell_works("ls long.folder.name/with.many.parts.to.see.that.no.name.is.cut | wc -l", "0");
    shell_works("$shiver check tiny.yaml --set 'objects.bar.mesh={gmsh: {file: cube.msh, scale: 0.02}}'",
                "bar (chalk)");
    shell_works("$shiver check tiny.yaml --set 'objects.bar.mesh={stl: {file: cube.obj, scale: 0.02, edge: 0.01}}'",
                "bar (chalk)");
    shell_fails("PATH=/nonexistent $shiver check tiny.yaml "
                "--set 'objects.bar.mesh={stl: {file: cube.obj, scale: 0.02, edge: 0.01}}'",
                2, "apt-get install gmsh");
    shell_works("$shiver mesh cube.obj --edge 0.5 --force --output cube.msh",
                "mesh: {gmsh: {file: cube.msh, improve: true}}");
    shell_works("sed 's/^v \\(.*\\)/v \\1/; /^v/s/1/90/g' cube.obj >drawn_in_millimetres.obj; "
                "$shiver mesh drawn_in_millimetres.obj --edge 30 --force",
                "scale: 0.001");
}

static void test_scenes(void **state)
{
    (void)state;
    shell_works("for scene in $scenes/*.yaml; do $shiver check $scene || exit 1; done", "stable step");
    /* The drop of the manual on a coarse mesh, past its impact. */
    shell_works("$shiver run $scenes/sphere_drop.yaml --set objects.ball.mesh.ball.edge=0.025 --set duration=0.56 "
                "--output drop.h5",
                "finished: t = 0.56 s");
}

static const char falling[] =
    "shiver: 1\nduration: 0.1\n"
    "materials: {stone: {density: 1000, youngs_modulus: 1e9, poissons_ratio: 0.2, breakable: false}}\n"
    "objects: {block: {mesh: {box: {size: [0.1, 0.1, 0.1], edge: 0.1}}, material: stone}}\n"
    "probes: {whole: {nodes: {object: block}}, middle: {point: [0, 0, 0]}}\n";
static const char passing[] = "verification: 1\ntitle: a fall\nscene: falling.yaml\nsource: G. Galilei\nshort: true\n"
                              "quantities:\n  - {name: way, measure: last(whole.displacement.z), reference: -0.04905, "
                              "unit: m, tolerance: 1e-9}\n";

static void test_probes(void **state)
{
    (void)state;
    shell_write("falling.yaml", falling);
    shell_works("$shiver run falling.yaml --quiet && $shiver info falling.h5",
                "2 probes with 25 rows of samples: whole middle\n");
    shell_works("$shiver info falling.h5 --json", "\"probes\": 2, \"probe_rows\": 25");
    assert_true(json_valid(output.out));
    shell_works("$shiver export csv falling.h5 && head -n 2 falling_probes.csv", ",,,,,,,,,,,,\n");
    shell_fails("$shiver run falling.yaml --force --set probes.middle.point.0=3", 2,
                "probe middle: the point (3, 0, 0) m lies in no tet of any object");
}

static void test_verify(void **state)
{
    (void)state;
    char missing[1000];
    shell_write("falling.yaml", falling);
    shell_fails("$shiver verify", 2, "scenes/verification");
    shell_works("$shiver verify --help", "usage: shiver verify [CASE");
    shell_fails("$shiver verify --folder .", 2, "has no files *.case.yaml");
    shell_write("pass.case.yaml", passing);
    shell_works("$shiver verify --folder . --html v.html --markdown v.md", "1 cases: 1 pass, 0 miss with an");
    shell_works("grep -c 'class=.*pass' v.html", "");
    shell_works("$shiver verify --folder . pass --json", "\"verdict\": \"pass\"");
    assert_true(json_valid(output.out));
    shell_fails("$shiver verify --folder . pass --html v.html", 2, "--force");
    snprintf(missing, sizeof missing, "%s  - {name: wrong, measure: '1', reference: '2', tolerance: 0.1}\n", passing);
    shell_write("miss.case.yaml", missing);
    assert_int_equal(shell("$shiver verify --folder ."), 1);
    assert_non_null(strstr(output.out, "10 %   miss "));
    assert_non_null(strstr(output.out, "2 cases: 2 pass, 0 miss with an explanation, 1 miss without one"));
    shell_works("$shiver verify ./pass.case.yaml", "1 cases");
    snprintf(missing, sizeof missing,
             "%s  - {name: wrong, measure: '1', reference: '2', tolerance: 0.1, explained: so}\n", passing);
    shell_write("miss.case.yaml", missing);
    shell_works("$shiver verify --folder . miss", "\nMiss of wrong: so\n");
    shell_write("miss.case.yaml", "verification: 1\n");
    shell_fails("$shiver verify --folder . miss", 2, "miss.case.yaml:1:1: error: the verification case lacks");
    shell_fails("$shiver verify --folder . other", 2, "other.case.yaml");
}

/* The page of materials is what the program prints; what is in effect of a coarse mesh's material is in every report. */
static void test_materials(void **state)
{
    (void)state;
    shell_works("$shiver materials | sed -n 2p",
                "soda_lime_glass     2500       70      0.2    0.001        8"); /* in columns */
    if (shell("$shiver materials --markdown | diff - $scenes/../docs/materials.md") != 0)
        fail_msg("docs/materials.md differs: shiver materials --markdown > docs/materials.md\n%s", output.out);
    shell_works("$shiver materials --json", "\"plaster\"");
    const char *coarse = "--set materials.chalk='{library: plaster, unresolved: scale_strength}'";
    char line[256];
    /* R = 3.27 mm against five edges of 20 mm: the strength falls by √(3.27/(5 × 20)). */
    const char *commands[] = {"check", "plan", "run --force"};
    for (int i = 0; i < 3; i++) {
        snprintf(line, sizeof line, "$shiver %s tiny.yaml %s", commands[i], coarse);
        shell_works(line, "scale_strength; 2.5e+06 Pa as given");
        assert_non_null(strstr(output.out, "UNDER-RESOLVED"));
    }
    shell_works("$shiver info tiny.h5", "scale_strength; 2.5e+06 Pa as given");
    shell_works("$shiver info tiny.h5 --json", "\"nominal_strength\": 2500000");
    shell_works("$shiver check tiny.yaml --json --set materials.chalk='{library: plaster}'", "\"resolved\": false");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_small_obstacle),
        cmocka_unit_test(test_alike_objects),
        cmocka_unit_test(test_sliver),
        cmocka_unit_test(test_usage),
        cmocka_unit_test(test_wrong_words),
        cmocka_unit_test(test_check_and_plan),
        cmocka_unit_test(test_plan_of_a_long_fall),
        cmocka_unit_test(test_refused_overlaps),
        cmocka_unit_test(test_overlaps),
        cmocka_unit_test(test_overrides),
        cmocka_unit_test(test_bad_scenes),
        cmocka_unit_test(test_run_and_info),
        cmocka_unit_test(test_default_name),
        cmocka_unit_test(test_existing_output),
        cmocka_unit_test(test_unwritable),
        cmocka_unit_test(test_closed_streams),
        cmocka_unit_test(test_inputs_are_kept),
        cmocka_unit_test(test_permissions_are_kept),
        cmocka_unit_test(test_odd_inputs),
        cmocka_unit_test(test_full_disk_of_an_export),
        cmocka_unit_test(test_full_disk),
        cmocka_unit_test(test_interruption),
        cmocka_unit_test(test_export),
        cmocka_unit_test(test_names_of_an_export),
        cmocka_unit_test(test_view),
        cmocka_unit_test(test_mesh),
        cmocka_unit_test(test_scenes),
        cmocka_unit_test(test_what_hides_is_drawn_later),
        cmocka_unit_test(test_walls_let_the_eye_in),
        cmocka_unit_test(test_probes),
        cmocka_unit_test(test_verify),
        cmocka_unit_test(test_materials),
    };
    return cmocka_run_group_tests(tests, enter, shell_leave);
}
