/* SPDX-License-Identifier: BSD-2-Clause */
/* Numbers of 16 bits, as for the columns of a map: right up to 65536 items. */
/* loses: tables_hold_for_a_contrast_of_1e12_and_a_million_items */
/* [alias-build] */
-        uint32_t sm = pop_small(s), lg = top_large(s);
+        uint32_t sm = pop_small(s);
+        uint16_t lg = (uint16_t)top_large(s);
/* [end] */
