/* SPDX-License-Identifier: BSD-2-Clause */
/* page_help: pages that bis wrote, with their data, and as their scripts show them. */
#ifndef TESTS_PAGE_HELP_H
#define TESTS_PAGE_HELP_H

/* page_data returns the JSON object in the page at path, with line breaks and indentation left out, to be freed. */
char *page_data(const char *path);

/* page_shown returns the page at path after its script has run (tests/tools/page.js under node), well formed, with runs
 * of blanks as one, to be freed; path may end in #PART, as an address does. NULL, after a word of why, where there is
 * no node. `folder` takes a file. */
char *page_shown(const char *path, const char *folder);

/* page_in_order asserts that each of parts[], ended by NULL, stands in the text behind the one before; a ` is a
 * quotation mark. */
void page_in_order(const char *text, const char *const *parts);

#endif
