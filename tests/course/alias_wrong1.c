/* SPDX-License-Identifier: BSD-2-Clause */
/* A giver stays with the large ones, although it has come to lie below the line: its own bin is never filled. */
/* loses: every_table_gives_the_weights */
/* [alias-build] */
 {
+    (void)push_small;
-        if (prob[lg] <= 1) push_small(s, pop_large(s)); /* lg has nothing left to give: now its own bin lacks */
+        if (prob[lg] <= 1) pop_large(s);
/* [end] */
