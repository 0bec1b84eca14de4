/* SPDX-License-Identifier: BSD-2-Clause */
/* Levels are rounded to the nearest instead of down. */
/* loses: levels_are_equal_steps_of_the_logarithm */
/* [level] */
-    const double bin = l->n * log(intensity / l->least) / l->log_range;
+    const double bin = l->n * log(intensity / l->least) / l->log_range + 0.5;
/* [end] */
