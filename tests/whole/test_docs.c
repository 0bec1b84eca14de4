/* SPDX-License-Identifier: BSD-2-Clause */
/* What the README and docs tell users to type works: every `./bis ...` line of their code blocks is run, small and
 * short, in a folder that looks like the repository's root. And the layers that README draws are those of the code,
 * the items of the errata have their tests, pasted code is that of the source, equations stand where the guide says;
 * each check can fail. */
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

/* scripts/check/SCRIPT.sh finds nothing in the folder, or this; at_once: that is the first that it says. */
static void assert_check(const char *script, const char *folder, const char *message, bool at_once)
{
    static char text[4096];
    char command[256], path[128];
    snprintf(path, sizeof path, "%s.out", folder);
    snprintf(command, sizeof command, "sh scripts/check/%s.sh %s > %s", script, folder, path);
    const int status = shell(command);
    read_text(text, sizeof text, path);
    if (status != (message != NULL)) fail_msg("status %d: %s", status, text);
    const char *const at = message ? strstr(text, message) : text;
    if (!at || (at_once && at != text)) fail_msg("no \"%s\" in: %s", message, text);
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
        "docs/scene-format.md", "docs/proof.md", "docs/envelope.md", "docs/errata.md", "docs/extending.md",
        "docs/budgets.md", "docs/measured.md", "docs/guide.md", "docs/theory.md", "docs/live.md",
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

/* ---- the guide ---- */

static void code_on_the_pages_is_what_the_compiler_sees(void **state)
{
    assert_int_equal(shell("sh scripts/check/fragments.sh --check"), 0);
}

/* The twins: a fresh root with one page. */
static void a_fragment_that_is_gone_or_differs_is_found(void **state)
{
    const char *right = "Text.\n\n<!-- src/a.c [add] -->\n```c\n    return a + b;\n```\n\n```c\nfree();\n```\n";
    const struct { const char *page, *source, *message; } cases[] = {
        {right, "{\n    /* [add] */\n    return a + b;\n    /* [end] */\n}\n", NULL},
        {right, "{\n    /* [add] */\n    return b + a;\n    /* [end] */\n}\n", "docs/page.md: code differs"},
        {right, "{\n    /* [sum] */\n    return a + b;\n    /* [end] */\n}\n",
         "docs/page.md:3: src/a.c has no fragment [add]"},
        {right, "{\n    /* [add] */\n    return a + b;\n}\n", "docs/page.md:3: src/a.c has no fragment [add]"},
        {"<!-- src/a.c [add] -->\nText.\n", "/* [add] */\nint a;\n/* [end] */\n",
         "docs/page.md:2: the block of code is missing"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        static char text[4096];
        assert_int_equal(shell("cd build && rm -rf fragments && mkdir -p fragments/docs fragments/src && echo > "
                               "fragments/README.md"),
            0);
        program_write_file("build/fragments/docs/page.md", cases[i].page);
        program_write_file("build/fragments/src/a.c", cases[i].source);
        int status = shell("sh scripts/check/fragments.sh --check build/fragments > build/fragments.out 2>&1");
        read_text(text, sizeof text, "build/fragments.out");
        assert_int_equal(status, cases[i].message != NULL);
        if (cases[i].message && !strstr(text, cases[i].message)) fail_msg("no \"%s\" in: %s", cases[i].message, text);
    }
}

static void every_equation_of_the_guide_stands_in_the_files_it_names(void **state)
{
    assert_int_equal(shell("sh scripts/check/check_guide.sh"), 0);
}

static void an_equation_that_a_file_does_not_name_is_found(void **state)
{
    static const char others[] =
        "| 3.17 | 3.2, 3.3, 3.4, 3.5, 3.6, 3.7, 3.8, 3.9, 3.10, 3.11, 3.12, 3.13, 3.14, 3.15, 3.16 | |\n"
        "| 4.1 | 4.2, 4.3, 4.4, 4.5, 4.6, 4.7, 4.8, 4.9 | [`src/a.c`](../src/a.c) |\n";
    static const char sections[] = "## 3.1 A\n*Do:* x\n<details>\ny\n</details>\n"
                                   "## 4.1 B\n*Do:* x\n<details>\ny\n</details>\n## 5 C\n";
    const char *page = "| 3.1 | light | [`src/a.c`](../src/a.c) `add` |\n";
    const struct { const char *page, *source, *message; } cases[] = {
        {page, "/* see eq. 3.1, eq. 4.1 */ int add(void);\n", NULL},
        {page, "/* the sum: thesis eq.\n * 3.1. eq. 4.1 */ int add(void);\n", NULL},
        {page, "/* see eq. 3.16, eq. 4.1 */ int add(void);\n", "docs/guide.md:1: src/a.c never says eq. 3.1"},
        {page, "/* see eq. 3.1, eq. 4.1 */ int sum(void);\n", "docs/guide.md:1: src/a.c has no add"},
        {"", "/* see eq. 3.1, eq. 4.1 */\n", "docs/guide.md: eq. 3.1 is not in the table"},
        {"Nothing.\n", "", "docs/guide.md: no table of equations"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(shell("cd build && rm -rf guide_check && mkdir -p guide_check/docs guide_check/src"), 0);
        char table[2048]; /* the table first: messages say line 1 */
        snprintf(table, sizeof table, "%s%s%s", cases[i].page, cases[i].source[0] ? others : "", sections);
        program_write_file("build/guide_check/docs/guide.md", table);
        program_write_file("build/guide_check/src/a.c", cases[i].source);
        assert_check("check_guide", "build/guide_check", cases[i].message, false);
    }
}

static void a_place_that_is_not_where_the_map_of_src_says_is_found(void **state)
{
    assert_int_equal(shell("cd build && rm -rf map_check && mkdir -p map_check/docs && "
                           "cp ../docs/guide.md map_check/docs/ && cp -R ../src ../include map_check/"), 0);
    assert_int_equal(shell("sh scripts/check/check_guide.sh build/map_check"), 0);
    assert_int_equal(shell("sed -i 's/^| a candidate gets its weight | `weigh`/| x | `no_such_name`/' "
                           "build/map_check/src/README.md"), 0);
    assert_int_equal(shell("sh scripts/check/check_guide.sh build/map_check | "
                           "grep -qx 'src/README.md:[0-9]*: src/thesis/set.c has no no_such_name'"), 0);
}

static void an_empty_line_in_a_table_is_found(void **state)
{
    static const char page[] = "build/cut_check/docs/x.md", head[] = "| a |\n| --- |\n| b |\n";
    char text[64];
    assert_int_equal(shell("rm -rf build/cut_check && mkdir -p build/cut_check/docs build/cut_check/src && "
                           "cp docs/guide.md build/cut_check/docs && cp -R src include build/cut_check"), 0);
    snprintf(text, sizeof text, "%s\n%s| c |\n", head, head);
    program_write_file(page, text);
    assert_check("check_guide", "build/cut_check", NULL, false);
    snprintf(text, sizeof text, "%s\n%s\n| c |\n| d |\n", head, head);
    program_write_file(page, text);
    assert_check("check_guide", "build/cut_check", "docs/x.md:9: an empty line cuts this table", false);
}

/* The twin of "every section of chapters 3 and 4 has something to do", which the check of equations above does, too. */
static void a_section_without_a_task_or_its_answer_is_found(void **state)
{
    static const char table[] = "## 5 C\n| 3.1 | 3.2, 3.3, 3.4, 3.5, 3.6, 3.7, 3.8, 3.9, 3.10, 3.11, 3.12, 3.13, "
                                "3.14, 3.15, 3.16, 3.17 | [`src/a.c`](../src/a.c) |\n"
                                "| 4.1 | 4.2, 4.3, 4.4, 4.5, 4.6, 4.7, 4.8, 4.9 | [`src/a.c`](../src/a.c) |\n";
    const char *box = "*Do:* x\n\n<details>\ny\n</details>\n";
    const struct { const char *first, *second, *message; } cases[] = {
        {box, box, NULL},
        {"Text.\n", box, "docs/guide.md:1: section 3.2.1 has no *Do:*"},
        {box, "Text.\n<details>\n</details>\n", "section 4.4 has no *Do:*"},
        {box, "*Do:* x\n", "section 4.4 hides no answer in <details> below its *Do:*"},
        {"<details>\ny\n</details>\n*Do:* x\n", box, "section 3.2.1 hides no answer in <details> below its *Do:*"},
        {box, "*Do:* x\n<details>\ny\n", "section 4.4 does not close its <details>"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char page[2048];
        assert_int_equal(shell("cd build && rm -rf guide_check && mkdir -p guide_check/docs guide_check/src"), 0);
        snprintf(page, sizeof page, "## 3.2.1 A\n%s## 4.4 B\n%s%s", cases[i].first, cases[i].second, table);
        program_write_file("build/guide_check/docs/guide.md", page);
        program_write_file("build/guide_check/src/a.c", "/* see eq. 3.1, eq. 4.1 */\n");
        assert_check("check_guide", "build/guide_check", cases[i].message, false);
    }
}

/* ---- docstrings ---- */

static void each_function_of_a_header_has_a_docstring_that_begins_with_its_name_and_a_verb(void **state)
{
    assert_int_equal(shell("sh scripts/check/check_docstrings.sh > build/test_docs.out"), 0);
}

#define COLUMNS_50 "12345678901234567890123456789012345678901234567890"

/* The twin: a fresh tree with a public header, a private one, and one file of src. */
static void a_wrong_docstring_a_reference_to_nothing_or_a_long_line_is_found(void **state)
{
    const struct { const char *header, *source, *message, *private; } cases[] = {
        {"/* f does it. */\nint f(int x);\n", "\n", NULL, NULL},
        {"/* f, and g, too, for more than\n * one. */\nint f(int x);\nstatic inline int g(void)\n{\n    return "
         "f(1);\n}\n", "\n", NULL, NULL},
        {"/* g does it. */\nint f(int x);\n", "\n",
         "include/bis/base/x.h:2: the comment above f does not begin with its name", NULL},
        {"/* f quietly does it. */\nint f(int x);\n", "\n", NULL, NULL},
        {"/* f is_mine(x) or not. */\nint f(int x);\n", "\n", "include/bis/base/x.h:2: no verb", NULL},
        {"/* f the answer to x. */\nint f(int x);\n", "\n", "include/bis/base/x.h:2: no verb", NULL},
        {"/* Does it. */\nint *f(int x,\n       int y);\n", "\n", "include/bis/base/x.h:2: the comment above f", NULL},
        {"/* f2 does it. */\nint f(int x);\n", "\n", "include/bis/base/x.h:2: the comment above f", NULL},
        {"/* f does it. */\nint f(int x);\n\nint g(int x);\n", "\n",
         "include/bis/base/x.h:4: the comment above g", NULL},
        {"/* f does it. */\ntypedef int t;\nint f(int x);\n", "\n",
         "include/bis/base/x.h:3: the comment above f", NULL},
        {"/* f does it. */\nint f(int x);\n", "/* As SP" "EC 5. */\n", "src/base/x.c:1:/* As SP" "EC 5. */", NULL},
        {"/* f does it. */\nint f(int x);\n", "/* " COLUMNS_50 COLUMNS_50 "12345678901234 */\n", NULL, NULL},
        {"/* f does it. */\nint f(int x);\n", "/* " COLUMNS_50 COLUMNS_50 "123456789012345 */\n",
         "src/base/x.c:1: 121 columns", NULL},
        {"/* f does it. */\nint f(int x);\n", "\n", NULL,
         "/* g does it. */\nBIS_LANES\nstatic void NAMED(g)(real x)\n{\n}\n"},
        {"/* f does it. */\nint f(int x);\n", "\n", "src/base/y.h:2: the comment above g",
         "/* Does it. */\nint g(int x);\n"},
        {"/* f does it. */\nint f(int x);\n", "\n", "src/base/y.h:2: the comment above g",
         "/* Does it. */\nFORMULA real g(real x)\n{\n}\n"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(
            shell("cd build && rm -rf docstrings && mkdir -p docstrings/include/bis/base docstrings/src/base"), 0);
        program_write_file("build/docstrings/include/bis/base/x.h", cases[i].header);
        program_write_file("build/docstrings/src/base/x.c", cases[i].source);
        program_write_file("build/docstrings/src/base/y.h", cases[i].private ? cases[i].private : "\n");
        assert_check("check_docstrings", "build/docstrings", cases[i].message, true);
    }
}

/* Of the files that are written by hand, each kind in one of its folders; a scene may be as wide as it likes. */
static void a_long_line_is_found_in_every_kind_of_file(void **state)
{
    static const char *const files[] = {"Makefile", ".ci/run", "src/base/x.awk", "tests/base/x.c", "scripts/x.sh",
                                        "scripts/x.awk", "scripts/x.mk", "tests/base/x.py", "data/generate/x.h",
                                        "docs/live/x.js"};
    const char *line = COLUMNS_50 COLUMNS_50 "12345678901234567890";
    char path[128], text[256], said[1024];

    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        assert_int_equal(shell("cd build && rm -rf docstrings && mkdir -p docstrings && cd docstrings && "
                               "mkdir -p include/bis/base .ci src/base tests/base scripts data/generate docs/live"), 0);
        program_write_file("build/docstrings/include/bis/base/x.h", "/* f does it. */\nint f(int x);\n");
        snprintf(text, sizeof text, "%s+\n", line);
        program_write_file("build/docstrings/tests/base/scene.txt", text);
        snprintf(path, sizeof path, "build/docstrings/%s", files[i]);
        for (int over = 0; over < 2; over++) {
            snprintf(text, sizeof text, "%s%s\n", line, over ? "+" : "");
            program_write_file(path, text);
            assert_int_equal(over,
                             shell("sh scripts/check/check_docstrings.sh build/docstrings > build/docstrings.out"));
        }
        snprintf(text, sizeof text, "%s:1: 121 columns, at most 120 are allowed\n", files[i]);
        read_text(said, sizeof said, "build/docstrings.out");
        assert_string_equal(said, text);
    }
}

/* 60 lines from { to }, and one more; 40 lines of a table beside them are none. Python's from def to its last. */
static void a_function_of_more_than_60_lines_is_found(void **state)
{
    static const char *const files[] = {"src/base/x.c", "tests/base/test_x.c", "scripts/x.c", "scripts/x.py"};
    char path[128], said[1024], expected[256];

    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        const bool is_python = i == 3;
        assert_int_equal(shell("cd build && rm -rf docstrings && mkdir -p docstrings && cd docstrings && "
                               "mkdir -p include/bis/base src/base tests/base scripts"), 0);
        program_write_file("build/docstrings/include/bis/base/x.h", "/* f does it. */\nint f(int x);\n");
        snprintf(path, sizeof path, "build/docstrings/%s", files[i]);
        for (int over = 0; over < 2; over++) {
            FILE *f = fopen(path, "w");
            assert_non_null(f);
            fputs(is_python ? "class c:\n    def f(x):\n" : "int f(int x)\n{\n    static const int of[] = {\n", f);
            for (int k = 0; k < 38 && !is_python; k++) fputs("        1,\n", f);
            fputs(is_python ? "        def h(): pass\n" : "    };\n", f);
            for (int k = 0; k < 58 + over; k++) fputs(is_python ? "        x += 1\n" : "    x += of[x];\n", f);
            fputs(is_python ? "\n    def g(x):\n        return x\n" : "}\n", f);
            fclose(f);
            assert_int_equal(over,
                             shell("sh scripts/check/check_docstrings.sh build/docstrings > build/docstrings.out"));
        }
        snprintf(expected, sizeof expected, "%s:2: f has 61 lines, at most 60 are allowed\n", files[i]);
        read_text(said, sizeof said, "build/docstrings.out");
        assert_string_equal(said, expected);
    }
}

#define FIVE "int a, int b, int c, int d, int e"

/* Six parameters and seven, one of them a function of two. A call has none; nor is flat counted, or what the script
 * lists. */
static void a_function_of_more_than_six_parameters_is_found(void **state)
{
    const struct { const char *file, *text, *message; } cases[] = {
        {"include/bis/base/x.h", "/* f does it. */\nint f(" FIVE ", int (*g)(int, int));\n", NULL},
        {"include/bis/base/x.h", "/* f does it. */\nint f(" FIVE ",\n int (*g)(int, int), int h) BIS_PRINTF(1, 2);\n",
         "include/bis/base/x.h:2: f has 7 parameters, at most 6 are allowed\n"},
        {"src/base/x.c", "static const int *f(" FIVE ", int g)\n{\n    h(a, b, c, d, e, g, 1);\n}\n", NULL},
        {"src/base/x.c", "int y;\nstatic const int *f(" FIVE ",\n                    int g, int h)\n{\n}\n",
         "src/base/x.c:2: f has 7 parameters, at most 6 are allowed\n"},
        {"src/base/y.h", "/* f does it. */\nstatic void NAMED(f)(" FIVE ", draws g, real h);\n",
         "src/base/y.h:2: f has 7 parameters, at most 6 are allowed\n"},
        {"src/base/x.c", "static int mix(" FIVE ", int g, int h)\n{\n}\n", NULL},
        {"src/flat/x.c", "int f(" FIVE ", int g, int h)\n{\n}\n", NULL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char path[64];
        assert_int_equal(shell("cd build && rm -rf docstrings && mkdir -p docstrings && cd docstrings && "
                               "mkdir -p include/bis/base src/base src/flat"), 0);
        program_write_file("build/docstrings/include/bis/base/x.h", "/* f does it. */\nint f(int x);\n");
        snprintf(path, sizeof path, "build/docstrings/%s", cases[i].file);
        program_write_file(path, cases[i].text);
        assert_check("check_docstrings", "build/docstrings", cases[i].message, true);
    }
}

/* ---- layers ---- */

static void arrows_only_go_down(void **state)
{
    assert_int_equal(shell("sh scripts/check/check_layers.sh > build/test_docs.out"), 0);
}

/* The twin: a fresh tree with one file that looks up, and one in a folder that nobody gave a row. */
static void an_include_that_goes_up_or_a_stranger_is_found(void **state)
{
    const struct { const char *name, *text, *message; } cases[] = {
        {"thesis/sir.c", "#include \"bis/base/vec.h\"\n", NULL},
        {"thesis/sir.c", "#include \"bis/base/vec.h\"\n#include \"bis/scene/scene.h\"\n",
         "src/thesis/sir.c:2: thesis may not include \"bis/scene/scene.h\""},
        {"base/file.c", "#  include \"shape/grid.h\"\n", "src/base/file.c:1: base may not include \"shape/grid.h\""},
        {"tools/verify/verify.c", "#include \"bis/thesis/envmap.h\"\n#include \"verify.h\"\n", NULL},
        {"tools/verify/verify.c", "#include \"cli/cli.h\"\n",
         "src/tools/verify/verify.c:1: tools may not include \"cli/cli.h\""},
        {"quux/quux.c", "", "src/quux/quux.c: folder \"quux\" has no line"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char path[256], command[512];
        snprintf(path, sizeof path, "build/layers/src/%s", cases[i].name);
        snprintf(command, sizeof command, "rm -rf build/layers && mkdir -p $(dirname %s) build/layers/include/bis/base",
            path);
        assert_int_equal(shell(command), 0);
        program_write_file("build/layers/include/bis/base/vec.h", "");
        program_write_file(path, *cases[i].text ? cases[i].text : "\n");
        assert_check("check_layers", "build/layers", cases[i].message, true);
    }
}

/* Two objects that take a function of each other, and a third beside them. */
static void files_that_need_each_other_are_found(void **state)
{
    const char *const folder = "build/circles";
    char command[1024], text[1024] = "";
    for (int twin = 0; twin < 2; twin++) {
        snprintf(command, sizeof command,
                 "rm -rf %s && mkdir -p %s/src/a %s/src/b && cd %s/src && "
                 "echo 'int bis_b(void); int bis_a(void); int bis_a(void) { return bis_b(); }' > a/a.c && "
                 "echo 'int bis_a(void); int bis_b(void); int bis_b(void) { return %s; }' > b/b.c && "
                 "echo 'int bis_a(void); int main(void) { return bis_a(); }' > b/c.c && "
                 "for f in a/a b/b b/c; do cc -c -o $f.o $f.c || exit 1; done",
                 folder, folder, folder, folder, twin ? "bis_a()" : "1");
        if (shell(command) != 0) skip();
        assert_int_equal(shell("sh scripts/check/check_circles.sh build/circles > build/circles.out"), twin);
        read_text(text, sizeof text, "build/circles.out");
        assert_int_equal(strstr(text, "a/a.c") && strstr(text, "b/b.c") && !strstr(text, "b/c.c"), twin);
    }
}

/* Objects with the instruction, and a twin in which one has none. */
static void a_prefetch_that_the_compiler_leaves_out_is_found(void **state)
{
    char command[1024];
    for (int twin = 0; twin < 2; twin++) {
        snprintf(command, sizeof command,
                 "rm -rf build/prefetch && mkdir -p build/prefetch/src/render && cd build/prefetch/src/render && "
                 "echo 'void f(const char *p); void f(const char *p) { __builtin_prefetch(p); }' > wave.c && "
                 "echo 'void f(const char *p); void f(const char *p) { %s }' > edges.c && "
                 "for f in wave edges; do cc -O2 -c -o $f.o $f.c || exit 1; done",
                 twin ? "(void)p;" : "__builtin_prefetch(p + 64);");
        if (shell(command) != 0) skip();
        const int found = shell("sh scripts/check/check_prefetch.sh build/prefetch > build/prefetch.out");
        assert_int_equal(found, twin && shell("case $(uname -m) in x86_64 | aarch64) ;; *) exit 1 ;; esac") == 0);
    }
}

/* The compiler's report of a loop over lanes, and of three twins that it leaves scalar. The first also tells whether
 * this compiler can be asked. */
static void a_loop_over_lanes_that_stays_scalar_is_found(void **state)
{
    static const char *const bodies[] = {"a[i] = b[i] * b[i];", "float v[3] = {b[i], 1, 2}; a[i] = v[i % 3];",
                                         "if (b[i] > 1) other(a, i);", "store(&a[i], b[i]);"};
    char command[1024];

    if (!getenv("BIS_COMPILE")) {
        print_message("run by make test, which tells how to compile\n");
        skip();
    }
    for (int i = 0; i < 4; i++) {
        FILE *f = fopen("build/vectors.c", "w");
        assert_non_null(f);
        fprintf(f, "#include \"bis/base/clones.h\"\nvoid other(float *, unsigned);\nvoid store(float *, float);\n"
                   "void all(float *, const float *, unsigned);\nBIS_LANES\nstatic void lanes(float *a, const float "
                   "*b, unsigned n)\n{\n"
                   "#pragma omp simd\n    for (unsigned i = 0; i < n; i++) {\n        %s\n    }\n}\n"
                   "void all(float *a, const float *b, unsigned n) { lanes(a, b, n); }\n", bodies[i]);
        fclose(f);
        snprintf(command, sizeof command, "sh scripts/check/check_vectors.sh build/vectors.c > build/vectors.out");
        const int status = shell(command);
        if (i == 0 && shell("grep -q SKIPPED build/vectors.out") == 0) skip();
        assert_int_equal(status, i > 0);
        assert_int_equal(shell("grep -q 'build/vectors.c:9: this loop is scalar' build/vectors.out") == 0, i > 0);
    }
}

static void a_shift_beyond_32_bits_is_found(void **state)
{
    if (!getenv("BIS_COMPILE")) skip();
    if (shell("sh scripts/check/check_32_bits.sh src/files/corners.c | grep -q 'not checked'") == 0) skip();
    assert_int_equal(shell("sh scripts/check/check_32_bits.sh"), 0);
    /* twin: a hash in size_t */
    assert_int_equal(shell("sed 's/(uint64_t)v << 32/(size_t)v << 32/; s/\"corners.h/\"files\\/corners.h/' "
                           "src/files/corners.c >build/shift.c && sh "
                           "scripts/check/check_32_bits.sh build/shift.c 2>/dev/null"),
        1);
}

/* ---- errata ---- */

static void every_item_of_the_errata_has_a_test_named_after_it_and_a_twin(void **state)
{
    assert_int_equal(shell("sh scripts/check/check_errata.sh"), 0);
}

#define ITEMS "**E1. One** (3.1). Text.\n\n**E2. Two.** Text.\n\n| item | right | as printed | twin |\n| --- | --- |\n"
#define ROW1 "| E1 | `one_E1` | the same | the other way |\n"
#define ROW2 "| E2 | `E2_is_right` | `E2_fails` | half of it |\n| | `two_E2` | | |\n"
#define LACK "cmocka_unit_test(one_E1),\ncmocka_unit_test(two_E2),\ncmocka_unit_test(E2_fails),\n"
#define TESTS LACK "cmocka_unit_test_setup(E2_is_right, up),\n"

static void an_item_without_its_test_or_its_twin_is_found(void **state)
{
    const struct { const char *page, *tests, *message; } cases[] = {
        {ITEMS ROW1 ROW2, TESTS, NULL},
        {ITEMS ROW1 ROW2, TESTS "cmocka_unit_test(grows_by_1e12_E1_E2),\n", NULL},
        {ITEMS ROW1, TESTS, "docs/errata.md: E2 has 0 rows in the table of tests"},
        {ITEMS ROW1 ROW1 ROW2, TESTS, "docs/errata.md: E1 has 2 rows"},
        {ITEMS ROW1 ROW2 "| E3 | `one_E1` | the same | x |\n", TESTS, "docs/errata.md: a row for E3, which is no item"},
        {ITEMS ROW1 ROW2, LACK, "docs/errata.md: E2: no test E2_is_right"},
        {ITEMS ROW1 "| E2 | `one_E1` | the same | x |\n", TESTS, "docs/errata.md: E2: one_E1 is not named after it"},
        {ITEMS ROW1 ROW2 "| | `one_E1` | | |\n", TESTS, "docs/errata.md: E2: one_E1 is not named after it"},
        {ITEMS ROW1 ROW2 "| | | `one_E1` | |\n", TESTS, "docs/errata.md: E2: one_E1 is not named after it"},
        {ITEMS ROW1 "| E2 | | `E2_fails` | x |\n", TESTS, "docs/errata.md: E2 has no test"},
        {ITEMS ROW1 "| E2 | `two_E2` | | x |\n", TESTS, "docs/errata.md: E2 has no twin"},
        {ITEMS ROW1 "| E2 | `two_E2` | none | |\n", TESTS, "docs/errata.md: E2: what is the twin"},
        {ITEMS ROW1 ROW2, TESTS "cmocka_unit_test(wrong_E3_too),\n", "tests/test_x.c: wrong_E3_too: E3 is no item"},
        {"**E2. Two.** Text.\n", TESTS, "docs/errata.md: E2 follows E0"},
        {"\n", TESTS, "docs/errata.md: no items"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(shell("cd build && rm -rf errata_check && mkdir -p errata_check/docs errata_check/tests"), 0);
        program_write_file("build/errata_check/docs/errata.md", cases[i].page);
        program_write_file("build/errata_check/tests/test_x.c", cases[i].tests);
        assert_check("check_errata", "build/errata_check", cases[i].message, false);
    }
}

/* The words of a scene, and the scenes that hold them; the twins lack one. */
static void every_word_of_a_scene_stands_in_a_scene(void **state)
{
    const struct { const char *page, *source, *scene, *message; } cases[] = {
        {"`float fov` and `Rotate degrees x y z`\n", "read(\"sobol\");\n", "Rotate 1 \"float fov\" \"sobol\"\n", NULL},
        {"`float fov`\n```\n`float gap`\n```\n", "read(\"sobol\");\n", "\"float fov\" \"sobol\"\n", NULL},
        {"`float fov`\n", "read(\"sobol\");\n", "\"sobol\" # \"float fov\"\n",
         "docs/scene-format.md: \"fov\" stands in no scene"},
        {"`float fov`\n", "read(\"sobol\");\n", "\"float fov\"\n", "src/parse/p.c: \"sobol\" stands in no scene"},
        {"`Rotate x y z`\n", "read(\"sobol\");\n", "\"sobol\"\n",
         "docs/scene-format.md: \"Rotate\" stands in no scene"},
        {"float fov\n", "read(\"sobol\");\n", "\"sobol\"\n", "no words found"},
    };
    assert_int_equal(shell("sh scripts/check/check_scenes.sh"), 0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char scene[512];
        assert_int_equal(shell("cd build && rm -rf scenes_check && mkdir -p scenes_check/docs scenes_check/src/parse "
                               "scenes_check/data/scenes"), 0);
        program_write_file("build/scenes_check/docs/scene-format.md", cases[i].page);
        program_write_file("build/scenes_check/src/parse/p.c", cases[i].source);
        /* the parameters' types, one of each */
        snprintf(scene, sizeof scene,
            "%sinteger float bool string rgb color point3 point vector3 vector normal normal3 point2 "
            "texture spectrum xyz blackbody\n",
            cases[i].scene);
        program_write_file("build/scenes_check/data/scenes/a.txt", scene);
        program_write_file("build/scenes_check/scene.txt", "");
        assert_check("check_scenes", "build/scenes_check", cases[i].message, false);
    }
}

/* What the sources no longer say cannot be changed. Twin: sources that are not the project's. */
static void every_mutation_finds_its_text(void **state)
{
    assert_int_equal(shell("sh scripts/check/mutate.sh -a"), 0);
    assert_int_equal(shell("cd build && rm -rf mutate && mkdir -p mutate && cp -R ../src ../include mutate && "
                           "sed 's/BIS_EDGE_OUTLINE;/BIS_EDGE_NONE;/' ../src/render/edges.c > "
                           "mutate/src/render/edges.c"), 0);
    assert_int_equal(shell("cd build/mutate && sh ../../scripts/check/mutate.sh -a > ../mutate.out"), 1);
    assert_int_equal(shell("grep -qx '.* edges .*outline.*: DOES NOT APPLY' build/mutate.out && test $(wc -l "
                           "<build/mutate.out) = 1"),
        0);
}

/* What scripts/check/run_tests.sh says of these programs, in RUNS/out. RUNS is a small project: its root is copied for
 * every job. */
#define RUNS "build/test_runs"
static int run_programs(const char *jobs, const char *programs)
{
    char command[512];
    snprintf(command, sizeof command, "cd " RUNS " && %s sh ../../scripts/check/run_tests.sh %s > out", jobs, programs);
    return shell(command);
}

/* What failed is kept where the last line says; it holds `file`. */
static void assert_kept(const char *file)
{
    char command[512];
    snprintf(command, sizeof command, "cd " RUNS " && folder=$(sed -n 's/.*what they wrote is in //p' out) && "
             "folder=${folder%%%% *} && test -f $folder/%s && rm -r ${folder%%/*/build}", file);
    assert_int_equal(shell(command), 0);
}

/* Programs that find the project's files and leave one of their own; some fail. */
static void each_job_of_the_tests_has_a_root_of_its_own(void **state)
{
    static const char good[] = "#!/bin/sh\npwd; test -f README.md && test -f tests/support/program.h && test ! -e "
                               "build/mine && echo x > build/mine\n";
    static const char bad[] = "#!/bin/sh\necho x > build/mine; exit 1\n";
    /* Two that end well only if they run at once: each makes a file beside the roots and waits for the other's. */
    static const char meet[] = "#!/bin/sh\ntouch ../%s; for i in 1 2 3 4 5 6 7 8 9 10; do test ! -e ../%s || exit 0; "
                               "sleep 1; done; exit 1\n";
    char one[256], other[256];
    snprintf(one, sizeof one, meet, "meet", "again");
    snprintf(other, sizeof other, meet, "again", "meet");
    assert_int_equal(shell("rm -rf " RUNS " && mkdir -p " RUNS "/tests/support " RUNS "/build/own && "
                           "cp README.md " RUNS " && cp tests/support/program.h " RUNS "/tests/support"), 0);
    program_write_file(RUNS "/build/own/good", good);
    program_write_file(RUNS "/build/own/again", good);
    program_write_file(RUNS "/build/own/bad", bad);
    program_write_file(RUNS "/build/own/worse", bad);
    program_write_file(RUNS "/build/own/meet", one);
    program_write_file(RUNS "/build/own/meet-again", other);
    assert_int_equal(shell("chmod 755 " RUNS "/build/own/*"), 0);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(run_programs("TEST_JOBS=1", "build/own/good build/own/again"), 1);
            /* the second finds what the first left */
        assert_kept("mine");
        assert_int_equal(run_programs("TEST_JOBS=2", "build/own/meet build/own/meet-again"), 0);
            /* each waits for the other, elsewhere */
        assert_int_equal(run_programs("", "build/own/good"), 0); /* and this run does not */
        assert_int_equal(shell("test ! -e $(sed -n 2p " RUNS "/out)"), 0);
    }
    assert_int_equal(run_programs("", "build/own/bad"), 1);
    assert_kept("mine");
    assert_int_equal(run_programs("TEST_JOBS=2", "build/own/bad build/own/good build/own/worse"), 1);
    assert_int_equal(shell("grep -q '^make test: FAILED: bad worse (3 programs' " RUNS "/out"), 0);
    assert_kept("mine");
    assert_false(program_exists(RUNS "/build/mine"));
}

/* `make test` runs every test program; T names a folder or a part of a name. `make -n` tells what would run. */
static void make_test_chooses_the_programs(void **state)
{
    static const struct {
        const char *choice, *files;
    } cases[] = {{"", "tests/*/test_*.c"}, {"T=shape", "tests/shape/test_*.c"}, {"T=film", "tests/*/test_*film*.c"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char command[512];
        snprintf(command, sizeof command, "ls %s | sed 's,.*/,,; s,[.]c$,,' | sort > build/test_choice.expected",
            cases[i].files);
        assert_int_equal(shell(command), 0);
        snprintf(command, sizeof command,
                 "env -u MAKEFLAGS -u MFLAGS -u T make -n test %s | grep run_tests[.]sh | tr ' ' '\\n' | sed -n "
                 "'s,.*/tests/test_,test_,p' | "
                 "sort > build/test_choice",
                 cases[i].choice);
        assert_int_equal(shell(command), 0);
        assert_int_equal(shell("test -s build/test_choice && diff build/test_choice.expected build/test_choice"), 0);
    }
    assert_int_not_equal(shell("env -u MAKEFLAGS -u MFLAGS -u T sh scripts/check/run_tests.sh > build/test_choice"),
        0); /* nothing chosen is no success */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(make_test_chooses_the_programs),
        cmocka_unit_test(every_command_of_the_readme_works),
        cmocka_unit_test(every_command_of_the_guide_works),
        cmocka_unit_test(a_section_without_a_task_or_its_answer_is_found),
        cmocka_unit_test(the_scripts_of_many_machines_make_the_picture_of_one),
        cmocka_unit_test(links_of_the_pages_lead_to_files),
        cmocka_unit_test(code_on_the_pages_is_what_the_compiler_sees),
        cmocka_unit_test(a_fragment_that_is_gone_or_differs_is_found),
        cmocka_unit_test(every_equation_of_the_guide_stands_in_the_files_it_names),
        cmocka_unit_test(an_equation_that_a_file_does_not_name_is_found),
        cmocka_unit_test(a_place_that_is_not_where_the_map_of_src_says_is_found),
        cmocka_unit_test(an_empty_line_in_a_table_is_found),
        cmocka_unit_test(each_function_of_a_header_has_a_docstring_that_begins_with_its_name_and_a_verb),
        cmocka_unit_test(a_wrong_docstring_a_reference_to_nothing_or_a_long_line_is_found),
        cmocka_unit_test(a_long_line_is_found_in_every_kind_of_file),
        cmocka_unit_test(a_function_of_more_than_60_lines_is_found),
        cmocka_unit_test(a_function_of_more_than_six_parameters_is_found),
        cmocka_unit_test(each_job_of_the_tests_has_a_root_of_its_own),
        cmocka_unit_test(arrows_only_go_down),
        cmocka_unit_test(an_include_that_goes_up_or_a_stranger_is_found),
        cmocka_unit_test(files_that_need_each_other_are_found),
        cmocka_unit_test(a_prefetch_that_the_compiler_leaves_out_is_found),
        cmocka_unit_test(a_loop_over_lanes_that_stays_scalar_is_found),
        cmocka_unit_test(a_shift_beyond_32_bits_is_found),
        cmocka_unit_test(every_item_of_the_errata_has_a_test_named_after_it_and_a_twin),
        cmocka_unit_test(an_item_without_its_test_or_its_twin_is_found),
        cmocka_unit_test(every_word_of_a_scene_stands_in_a_scene),
        cmocka_unit_test(every_mutation_finds_its_text),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
