/* SPDX-License-Identifier: BSD-2-Clause */
/* As printed (E14): the alias where the coin exceeds prob, so a coin of 0 gives j, even when prob is 0. */
/* loses: an_item_of_weight_0_is_not_drawn_even_when_the_coin_is_0 */
/* [alias-sample] */
-    assert(u >= 0 && u < 1);
-    return x - (double)j < prob[j] ? j : alias[j];
+    return x - (double)j > prob[j] ? alias[j] : j;
/* [end] */
