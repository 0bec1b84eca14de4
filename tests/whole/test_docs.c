/* SPDX-License-Identifier: BSD-2-Clause */
/* What the README and docs tell users to type works: every `./bis ...` line of their code blocks is run, small and
 * short, in a folder that looks like the repository's root. Links lead to files; pasted code is that of the source,
 * equations and names stand where the pages say, items of the errata have their tests; each check can fail. */
#include "claim.h"
#include "file_help.h"
#include "program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define DIR "build/test_docs"

static int shell(const char *command)
{
    fflush(stdout);
    int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

/* A stand-in for the root: the scene and data of the repository, `bis` the program under test. */
static void make_root(void)
{
    char here[2048], target[4096];
    const char *program = getenv("BIS_PROGRAM");
    program_folder(DIR);
    assert_non_null(getcwd(here, sizeof here));
    const char *names[] = {"scene.txt", "data"};
    for (int i = 0; i < 2; i++) {
        char link[64];
        snprintf(target, sizeof target, "%s/%s", here, names[i]);
        snprintf(link, sizeof link, DIR "/%s", names[i]);
        assert_int_equal(symlink(target, link), 0);
    }
    if (!program || !*program) program = "build/release/bis";
    snprintf(target, sizeof target, "%s%s%s", program[0] == '/' ? "" : here, program[0] == '/' ? "" : "/", program);
    assert_int_equal(symlink(target, DIR "/bis"), 0);
}

/* The last line of a page that could be run ends in `&& ./bis scene.txt`: what stands before is the set-up. */
static const char *find_program(const char *line)
{
    const char *at = strstr(line, "./bis ");
    return at && (at == line || strncmp(at - 3, "&& ", 3) == 0) ? at : NULL;
}

static bool renders(const char *command)
{
    static const char *const others[] = {"./bis compare", "./bis envmap", "./bis pixel", "./bis help"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        if (strncmp(command, others[i], strlen(others[i])) == 0) return false;
    }
    return !strstr(command, "--plan");
}

/* Small and short. */
static const char *shortened(const char *command)
{
    if (renders(command)) return " --resolution 20x15 --spp 1 --quiet";
    return strncmp(command, "./bis pixel", 11) == 0 ? " --repeats 2" : "";
}

enum { MOST_COMMANDS = 64 };

/* Runs the commands on a page, each once; returns the number of different ones. */
static int run_commands_of(const char *page)
{
    static char ran[MOST_COMMANDS][1024];
    char line[1024], command[2048];
    bool in_code = false;
    int n = 0;
    FILE *f = fopen(page, "r");
    assert_non_null(f);
    while (fgets(line, sizeof line, f)) {
        line[strcspn(line, "\n")] = '\0';
        if (strncmp(line, "```", 3) == 0) in_code = !in_code;
        const char *bis = in_code ? find_program(line) : NULL;
        if (!bis) continue;
        int before = 0;
        while (before < n && strcmp(ran[before], bis) != 0) before++;
        if (before < n) continue;
        assert_true(n < MOST_COMMANDS);
        snprintf(ran[n], sizeof ran[n], "%s", bis);
        snprintf(command, sizeof command, "cd " DIR " && %s%s > out 2> err", bis, shortened(bis));
        int status = shell(command);
        if (status != 0) fail_msg("%s: `%s` exits with %d", page, command, status);
        n++;
    }
    fclose(f);
    return n;
}

static void every_command_of_the_readme_works(void **state)
{
    make_root();
    assert_true(run_commands_of("README.md") >= 5);
    assert_true(program_exists(DIR "/bis.png")); /* the first command */
}

/* What a "Do" box of the guide asks for can be done. */
static void every_command_of_the_guide_works(void **state)
{
    make_root();
    assert_true(run_commands_of("docs/guide.md") >= 12);
    assert_true(program_exists(DIR "/pixel_350_300/pixel.html") && program_exists(DIR "/sky-importance.png"));
}

/* Copies the block of code behind the line `mark` of docs/command-line.md to the file. */
static void copy_block(const char *mark, const char *path)
{
    char line[1024];
    bool is_near = false, is_in = false;
    int n_lines = 0;
    FILE *page = fopen("docs/command-line.md", "r"), *script = fopen(path, "w");

    assert_non_null(page);
    assert_non_null(script);
    while (fgets(line, sizeof line, page)) {
        const bool is_fence = strncmp(line, "```", 3) == 0;
        if (is_in && is_fence) break;
        if (is_in) n_lines++, fputs(line, script);
        is_in |= is_near && is_fence;
        is_near |= strncmp(line, mark, strlen(mark)) == 0;
    }
    fclose(page);
    assert_int_equal(fclose(script), 0);
    assert_in_range(n_lines, 4, 20);
}

/* The loop over parts runs as it stands, and its picture is that of one render. The tasks of the array job run one
 * after the other, with a stand-in for srun; only the camera samples are fewer, and the pixels. */
static void the_scripts_of_many_machines_make_the_picture_of_one(void **state)
{
    make_root();
    copy_block("<!-- loop -->", DIR "/loop.sh");
    assert_int_equal(shell("cd " DIR " && sh -e loop.sh 2> err"), 0);
    assert_int_equal(shell("cd " DIR " && ./bis scene.txt --resolution 200x150 --spp 6 --quiet --outfile whole.png && "
                           "cmp whole.png picture.png"), 0);

    copy_block("<!-- array job -->", DIR "/job.sh");
    program_write_file(DIR "/srun", "#!/bin/sh\nexec \"$@\"\n");
    assert_int_equal(shell("cd " DIR " && chmod +x srun && rm -f part-* && grep -q 'spp 1024' job.sh && "
                           "sed 's/--spp 1024/--resolution 80x64 --spp 2 --quiet/' job.sh > short.sh && "
                           "for i in $(seq 16); do PATH=.:$PATH SLURM_CPUS_PER_TASK=2 SLURM_ARRAY_TASK_ID=$i sh -e "
                           "short.sh || exit 1; done"), 0);
    assert_int_equal(shell("cd " DIR " && ./bis merge part-*.bispart --quiet --outfile job.png && ./bis scene.txt "
                           "--resolution 80x64 --spp 2 --quiet --outfile whole.png && cmp whole.png job.png"), 0);
}

/* No link of a page leads nowhere. */
static void links_of_the_pages_lead_to_files(void **state)
{
    const char *pages[] = {"README.md", "docs/command-line.md", "src/README.md", "docs/integrators.md",
        "docs/scene-format.md", "docs/trust.md", "docs/trust.md", "docs/errata.md", "docs/extending.md",
        "docs/trust.md", "docs/trust.md", "docs/guide.md", "docs/theory.md", "docs/live.md",
        "docs/library.md", "docs/assignments/README.md", "docs/paper.md", "docs/SECURITY.md",
        "docs/CODE_OF_CONDUCT.md", "src/thesis/README.md", "CONTRIBUTING.md", "CHANGELOG.md"};
    for (size_t i = 0; i < sizeof pages / sizeof *pages; i++) {
        char text[1 << 16], path[1024];
        read_text(text, sizeof text, pages[i]);
        for (const char *at = strstr(text, "]("); at; at = strstr(at + 1, "](")) {
            size_t n = strcspn(at + 2, ")#");
            if (n == 0 || strncmp(at + 2, "http", 4) == 0) continue;
            const char *slash = strrchr(pages[i], '/');
            snprintf(path, sizeof path, "%.*s%.*s", slash ? (int)(slash - pages[i] + 1) : 0, pages[i], (int)n, at + 2);
            if (!program_exists(path)) fail_msg("%s: no %s", pages[i], path);
        }
    }
}

/* ---- what the pages say of the code ---- */

/* Each check of scripts/check finds nothing here, and its twin, a copy in which one line is another, is found. */
static void the_pages_say_what_is_in_the_code(void **state)
{
    static const struct {
        const char *check, *file, *edit, *message;
    } checks[] = {
        {"fragments.sh --check", "src/thesis/alias.c", "s/return /return 1 + /", "code differs"},
        {"check_guide.sh", "src/README.md", "s/| `weigh` in/| `no_such_name` in/", "has no no_such_name"},
        {"check_docstrings.sh", "include/bis/thesis/alias.h", "s,^/\\* bis_alias_init ,/* It ,",
         "does not begin with its name"},
        {"check_layers.sh", "src/thesis/sir.c", "1i #include \"bis/scene/scene.h\"", "thesis may not include"},
        {"check_errata.sh", "tests/thesis/errata.md", "s/^| E20 |.*/| E20 | | | |/", "E20 has no twin"},
        {"check_scenes.sh", "docs/scene-format.md", "s/`float fov`/`float gap`/", "\"gap\" stands in no scene"},
    };
    static char text[1 << 16];
    for (size_t i = 0; i < sizeof checks / sizeof *checks; i++) {
        char command[1024];
        snprintf(command, sizeof command, "sh scripts/check/%s > build/check.out 2>&1", checks[i].check);
        if (shell(command) != 0) {
            read_text(text, sizeof text, "build/check.out");
            fail_msg("%s: %s", checks[i].check, text);
        }
        snprintf(command, sizeof command,
                 "rm -rf build/check_twin && mkdir build/check_twin && "
                 "cp -R README.md CONTRIBUTING.md Makefile scene.txt docs src include tests data build/check_twin && "
                 "sed -i '%s' build/check_twin/%s && sh scripts/check/%s build/check_twin > build/check.out 2>&1",
                 checks[i].edit, checks[i].file, checks[i].check);
        const int status = shell(command);
        read_text(text, sizeof text, "build/check.out");
        if (status == 0 || !strstr(text, checks[i].message)) fail_msg("the twin of %s: %s", checks[i].check, text);
    }
    assert_int_equal(shell("rm -rf build/check_twin"), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_command_of_the_readme_works),
        cmocka_unit_test(every_command_of_the_guide_works),
        cmocka_unit_test(the_scripts_of_many_machines_make_the_picture_of_one),
        cmocka_unit_test(links_of_the_pages_lead_to_files),
        cmocka_unit_test(the_pages_say_what_is_in_the_code),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
