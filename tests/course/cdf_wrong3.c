/* SPDX-License-Identifier: BSD-2-Clause */
/* Sums of float; the remainder as it comes. */
/* loses: C_is_the_running_sum_of_the_probabilities */
/* loses: the_remainder_tells_where_u_lies_in_the_interval */
/* loses: many_small_items_after_a_large_one_do_not_vanish */
/* [cdf-sum] */
-    double sum = 0, low = 0;
+    float sum = 0;
-        double p = weight_scaled(s, f[i]), next = sum + p, added = next - sum;
-        low += (sum - (next - added)) + (p - added);
-        sum = next;
-        c[i + 1] = sum + low;
+        sum += (float)weight_scaled(s, f[i]);
+        c[i + 1] = (double)sum;
/* [end] */
/* [cdf-search] */
-    size_t g = bis_cdf_part(c, u);
+    size_t g = (size_t)(u * (double)c->n_guide); /* exact: n_guide is a power of two */
-    if (remainder) {
-        double r = (u - c->c[i]) / (c->c[i + 1] - c->c[i]);
-        *remainder = fmin(r, 1 - DBL_EPSILON / 2); /* the two differences may round to the same number */
-    }
+    if (remainder) *remainder = (u - c->c[i]) / (c->c[i + 1] - c->c[i]);
/* [end] */
