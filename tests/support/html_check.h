/* SPDX-License-Identifier: BSD-2-Clause */
/* html_check: is a page well formed, and does it need nothing but itself? */
#ifndef TESTS_HTML_CHECK_H
#define TESTS_HTML_CHECK_H

#include <stdbool.h>
#include <stddef.h>

/* Every element is closed in its turn, every attribute quoted, every & begins an entity, no < stands in text; what is
 * between <style> or <script> and its end is not looked into. False: `why` says where. */
bool html_is_well_formed(const char *page, char *why, size_t size);

/* No address of another place: outside of scripts no "http", no src or href, no url( but of data:; in scripts nothing
 * that fetches. (What a script fetches all the same, make test-browser sees.) */
bool html_is_self_contained(const char *page, char *why, size_t size);

/* How often a string occurs. */
int html_count(const char *page, const char *what);

#endif
