/* SPDX-License-Identifier: BSD-2-Clause */
/* page_help: the data between its two marks; what node prints. */
#include "page_help.h"

#include "claim.h"
#include "html_check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char *read_all(const char *path)
{
    FILE *f = fopen(path, "r");
    assert_non_null(f);
    assert_int_equal(fseek(f, 0, SEEK_END), 0);
    const long n = ftell(f);
    rewind(f);
    char *text = malloc((size_t)n + 1);
    assert_int_equal(fread(text, 1, (size_t)n, f), n);
    fclose(f);
    text[n] = '\0';
    return text;
}

char *page_data(const char *path)
{
    static const char mark[] = "<script type=\"application/json\" id=\"data\">";
    char *page = read_all(path), *at = strstr(page, mark), *to = page;
    assert_non_null(at);
    at += strlen(mark);
    char *end = strstr(at, "</script>");
    assert_non_null(end);
    for (; at < end; at++) {
        if (*at == '\n') at += strspn(at + 1, " ");
        else *to++ = *at;
    }
    *to = '\0';
    return page;
}

char *page_shown(const char *path, const char *folder)
{
    char command[1024], why[200];
    if (system("command -v node > /dev/null") != 0) {
        print_message("no node here, which shows what a page looks like: scripts/setup.sh --web installs it\n");
        return NULL;
    }
    snprintf(command, sizeof command, "node tests/tools/page.js '%s' > %s/shown.html", path, folder);
    assert_int_equal(system(command), 0);
    snprintf(command, sizeof command, "%s/shown.html", folder);
    char *text = read_all(command), *to = text;
    if (!html_is_well_formed(text, why, sizeof why)) fail_msg("%s: %s", path, why);
    for (const char *at = text; *at; at++) {
        const int is_blank = *at == ' ' || *at == '\n';
        if (!is_blank) *to++ = *at;
        else if (to > text && to[-1] != ' ') *to++ = ' ';
    }
    *to = '\0';
    return text;
}

void page_in_order(const char *text, const char *const *parts)
{
    for (; *parts; parts++) {
        char part[8192] = "";
        for (size_t i = 0; (*parts)[i]; i++) part[i] = (*parts)[i] == '`' ? '"' : (*parts)[i];
        const char *at = strstr(text, part);
        if (!at) fail_msg("\"%s\" is not in\n%.6000s", part, text);
        text = at + strlen(part);
    }
}
