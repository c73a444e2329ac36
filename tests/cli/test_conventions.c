/* What is the same in all commands: options, exit statuses, streams, and what is generated from the tables. */
#include "cli/command.h"
#include "cli/json.h"
#include "cli/shell.h"

static const char scene[] =
    "shiver: 1\nduration: 0.1\n"
    "materials: {stone: {density: 1000, youngs_modulus: 1e9, poissons_ratio: 0.2, breakable: false}}\n"
    "objects: {block: {mesh: {box: {size: [0.1, 0.1, 0.1], edge: 0.1}}, material: stone}}\n";

static int enter(void **state)
{
    if (shell_enter(state) != 0) return -1;
    shell_write("block.yaml", scene);
    return 0;
}

static const char *line_of(const char *format, const char *word)
{
    static char line[1024];
    snprintf(line, sizeof line, format, word, word, word, word);
    return line;
}

/* ---- options ---- */

static void test_every_command(void **state)
{
    (void)state;
    for (int i = 0; i < SHV_COMMANDS; i++) {
        const char *name = shv_commands[i]->name;
        const char *forms[] = {"-o, --output", "--force", "-q, --quiet", "-h, --help", "-v, --version"};
        shell_works(line_of("$shiver %s -h", name), "usage: shiver ");
        for (size_t k = 0; k < sizeof forms / sizeof forms[0]; k++)
            if (!strstr(output.out, forms[k])) fail_msg("%s has no %s: %s", name, forms[k], output.out);
        static char help[sizeof output.out];
        memcpy(help, output.out, sizeof help);
        shell_works(line_of("$shiver %s --help", name), "");
        assert_string_equal(help, output.out);
        shell_works(line_of("$shiver %s -v && $shiver %s --version && $shiver %s -V", name), shv_version());
        shell_fails(line_of("$shiver %s --quiet=yes", name), 2, "--quiet takes no value");
        shell_fails(line_of("$shiver %s -x", name), 2, "unknown option -x");
        shell_fails(line_of("$shiver %s --output", name), 2, "--output needs a value: ");
        shell_fails(line_of("$shiver %s -o", name), 2, "--output needs a value: ");
        assert_string_equal(output.out, "");
    }
    static char version[64];
    snprintf(version, sizeof version, "shiver %s\n", shv_version());
    const char *asked[] = {"-v", "-V", "--version"};
    for (size_t i = 0; i < sizeof asked / sizeof asked[0]; i++) {
        shell_works(line_of("$shiver %s", asked[i]), "");
        assert_string_equal(output.out, version);
    }
}

static void test_values(void **state)
{
    (void)state;
    const char *forms[] = {"--output a.h5", "--output=a.h5", "-o a.h5", "-oa.h5", "-o=a.h5"};
    for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++) {
        shell_works(line_of("rm -f a.h5; $shiver run block.yaml -q %s && ls", forms[i]), "a.h5\n");
        assert_null(strstr(output.out, "=a"));
    }
    shell_works("$shiver run block.yaml --set=duration=0.2 --set=output.rate=10 --force -o a.h5",
                "finished: t = 0.2 s");
    shell_works("$shiver info --json a.h5", "\"frames\": 3,");
    /* What follows an option that needs a value is one, and after -- nothing is an option. */
    shell_fails("$shiver mesh block.yaml --edge -1", 2, "not '-1'");
    shell_works("cp block.yaml -- --odd.yaml && $shiver check -- --odd.yaml", "stable step");
    shell_fails("$shiver run block.yaml --sett=duration=1", 2, "unknown option --sett; did you mean --set?");
    shell_fails("$shiver run block.yaml --output=", 2, "no name");
    shell_fails("$shiver run block.yaml -o -", 2, "cannot go to standard output");
    shell_works("ls | grep -c '^-$' || true", "0");
}

/* ---- what is printed ---- */

static void test_report_to_file(void **state)
{
    (void)state;
    shell_works("$shiver check block.yaml", "stable step");
    shell_works("$shiver check block.yaml >printed; $shiver check block.yaml -o report && cmp printed report",
                "wrote report\n");
    shell_works("$shiver materials -o - | head -n 1", "name");
    shell_fails("$shiver check block.yaml -o report", 2, "--force");
    shell_works("$shiver check block.yaml -o report --json --force -q; cat report", "\"stable_step\"");
    assert_true(json_valid(output.out));
    /* After an error the old one is as it was; nothing is left over. */
    shell_fails("$shiver check block.yaml -o report --force --set gravty=1", 2, "gravity");
    shell_works("cat report; ls", "\"stable_step\"");
    assert_null(strstr(output.out, ".part"));
    shell_fails("$shiver check block.yaml -o block.yaml --force", 2, "is read by this command");
    shell_fails("$shiver check block.yaml -o nowhere/report", 1, "nowhere/report");
    /* The limit leaves room for the message, and the shell is not to die of a message of its own. */
    shell_fails("trap '' XFSZ; ulimit -f 1; $shiver materials -o full", 1, "File too large");
    assert_int_not_equal(access("full", F_OK), 0);
}

static void test_quiet(void **state)
{
    (void)state;
    const char *commands[] = {"check block.yaml",
                              "plan block.yaml --trial 0",
                              "run block.yaml --force -o q.h5",
                              "info q.h5",
                              "compare block.yaml --steps 1e-2 --force",
                              "export csv q.h5 --force"};
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        shell_works(line_of("$shiver %s", commands[i]), "");
        assert_string_not_equal(output.out, "");
        shell_works(line_of("$shiver %s -q", commands[i]), "");
        assert_string_equal(output.out, "");
        assert_string_equal(output.err, "");
    }
    shell_works("$shiver info q.h5 --quiet --json", "\"frames\"");
    shell_fails("$shiver check -q block.yaml --set gravty=1", 2, "gravity");
}

/* ---- standard input ---- */

static void test_piped_scene(void **state)
{
    (void)state;
    shell_works("$shiver check - <block.yaml", "stable step");
    shell_works("cat block.yaml | $shiver plan - --trial 0", "animation frames");
    shell_fails("$shiver run - <block.yaml", 2, "give --output, or a 'name'");
    shell_works("cat block.yaml | $shiver run - --output piped.h5", "piped.h5");
    shell_works("$shiver info piped.h5 --scene", scene);
    shell_works("(cat block.yaml; echo 'name: from.pipe') | $shiver run - && ls", "from.pipe.h5\n");
    shell_fails("(cat block.yaml; echo 'name: ../up') | $shiver run -", 2, "without slashes");
    shell_works("(cat block.yaml; echo 'output: {file: said.h5}') | $shiver run - && ls", "said.h5\n");
    shell_fails("$shiver compare - --steps 1e-2 <block.yaml", 2, "give --output");
    shell_works("$shiver compare - --steps 1e-2 -o piped <block.yaml", "wrote piped/report.html");
    /* Names of files start from the working folder; faults name the stream. */
    shell_write("corner.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
    shell_works("(cat block.yaml; echo 'obstacles: {corner: {mesh: {file: corner.obj}, position: [9, 9, 9]}}') | "
                "$shiver check -",
                "stable step");
    shell_fails("(cat block.yaml; echo 'gravty: 1') | $shiver check -", 2, "standard input:5:1: error");
    shell_fails("$shiver check - <&-", 2, "cannot read standard input");
    shell_fails("$shiver check -", 2, "standard input"); /* an empty one */
    shell_fails("head -c 20000000 /dev/zero | $shiver check -", 2, "standard input has");
    shell_fails("$shiver info - <block.yaml", 2, "cannot read '-'");
    shell_fails("$shiver study - block.yaml <block.yaml", 2, "cannot read '-'");
}

/* ---- errors ---- */

static void test_missing_inputs(void **state)
{
    (void)state;
    const char *commands[] = {"run none",
                              "check none",
                              "plan none",
                              "mesh none --edge 1",
                              "info none",
                              "view none",
                              "export csv none",
                              "compare none",
                              "study none none",
                              "study block.yaml none",
                              "stability none",
                              "stability --suite none",
                              "view block.yaml --two none"};
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++)
        shell_fails(line_of("$shiver %s", commands[i]), 2,
                    "shiver: cannot read 'none': No such file or directory; check the name and the permissions\n");
    shell_fails("$shiver verify none --folder .", 2, "there is no case 'none'");
    shell_fails("$shiver verify", 2, "no folder 'scenes/verification'");
    shell_fails("$shiver stability --suite", 2, "no folder 'scenes/extreme'");
    shell_fails("$shiver generate none", 2, "give man, bash or zsh");
}

static void test_unwritable_outputs(void **state)
{
    (void)state;
    shell_works("$shiver run block.yaml -q --force -o x.h5", "");
    const char *commands[] = {"run block.yaml -o no/x", "check block.yaml -o no/x", "export csv x.h5 -o no/x",
                              "compare block.yaml -o no/x", "info x.h5 -o no/x"};
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++)
        shell_fails(line_of("$shiver %s", commands[i]), 1, "no/x");
}

static int count(const char *text, const char *part)
{
    int found = 0;
    for (; (text = strstr(text, part)); text++) found++;
    return found;
}

static void test_errors_are_printed_once(void **state)
{
    (void)state;
    const char *commands[] = {"run", "check", "plan", "compare", "stability"};
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        shell_fails(line_of("$shiver %s block.yaml --set gravty=1", commands[i]), 2, "unknown key 'gravty'");
        assert_int_equal(count(output.err, "gravty"), 2); /* the place, and the key in the message */
        assert_int_equal(count(output.err, "\n"), 1);
    }
    shell_write("bad.case.yaml", "verification: 1\n");
    shell_fails("$shiver verify ./bad.case.yaml", 2, "bad.case.yaml:1:1: error: ");
    char first[256];
    snprintf(first, sizeof first, "%.*s", (int)strcspn(output.err, "\n"), output.err);
    assert_int_equal(count(output.err, first), 1);
    shell_write("bad.study.yaml", "shiver_study: 1\nvari: {}\n");
    shell_fails("$shiver study block.yaml bad.study.yaml", 2, "vari");
    assert_int_equal(count(output.err, "unknown key 'vari'"), 1);
}

/* ---- manual page and completion ---- */

/* Every command and option is in all three, as --help has them. */
static void test_generated_texts(void **state)
{
    (void)state;
    static char texts[3][sizeof output.out];
    static const char *const names[] = {"man", "bash", "zsh"};
    for (int t = 0; t < 3; t++) {
        shell_works(line_of("$shiver generate %s", names[t]), "shiver");
        memcpy(texts[t], output.out, sizeof texts[t]);
    }
    for (int i = 0; i < SHV_COMMANDS; i++) {
        const ShvOption *options[SHV_MOST_LISTED];
        const int total = shv_cli_options(shv_commands[i], options);
        char begins[3][64], option[64];
        snprintf(begins[0], sizeof begins[0], ".SS \"shiver %s ", shv_commands[i]->name);
        snprintf(begins[1], sizeof begins[1], "    %s) ", shv_commands[i]->name);
        snprintf(begins[2], sizeof begins[2], "        %s) ", shv_commands[i]->name);
        for (int t = 0; t < 3; t++)
            if (!strstr(texts[t], begins[t])) fail_msg("%s lacks %s", names[t], begins[t]);
        for (int k = 0; k < total; k++)
            for (int t = 0; t < 3; t++) {
                const bool once = t == 0 && shv_cli_is_common(options[k]);
                size_t length = 0;
                for (const char *c = options[k]->name; *c; c++) {
                    if (t == 0 && *c == '-') option[length++] = '\\';
                    option[length++] = *c;
                }
                option[length] = '\0';
                if (!strstr(once ? texts[t] : strstr(texts[t], begins[t]), option))
                    fail_msg("%s: %s lacks %s", names[t], shv_commands[i]->name, options[k]->name);
            }
    }
}

/* Skipped in part where a shell or groff is not installed. */
static void test_shells_take_them(void **state)
{
    (void)state;
    if (shell("command -v bash") == 0) {
        const char *complete = "bash -c 'source <('$shiver' generate bash); COMP_WORDS=(shiver %s); "
                               "COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _shiver; echo \"${COMPREPLY[*]}\"'";
        shell_works(line_of(complete, "ch"), "check\n");
        shell_works(line_of(complete, "export --col"), "--colour\n");
        shell_works(line_of(complete, "export g"), "gltf\n");
        shell_works(line_of(complete, "run --au"), "--audit-wake\n");
        assert_string_equal(output.err, "");
    }
    if (shell("command -v zsh") == 0) shell_works("$shiver generate zsh -o _shiver && zsh -n _shiver", "");
    if (shell("command -v groff") == 0) {
        shell_works("$shiver generate man | groff -k -man -ww -Tutf8 >page", "");
        assert_string_equal(output.err, "");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_command),      cmocka_unit_test(test_values),
        cmocka_unit_test(test_report_to_file),     cmocka_unit_test(test_quiet),
        cmocka_unit_test(test_piped_scene),        cmocka_unit_test(test_missing_inputs),
        cmocka_unit_test(test_unwritable_outputs), cmocka_unit_test(test_errors_are_printed_once),
        cmocka_unit_test(test_generated_texts),    cmocka_unit_test(test_shells_take_them),
    };
    return cmocka_run_group_tests(tests, enter, shell_leave);
}
