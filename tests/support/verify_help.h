/* SPDX-License-Identifier: BSD-2-Clause */
/* verify_help: what the tests of `bis verify` share (tests/tools/test_verify*.c). Each check is handed something wrong
 * and must reject it, and something right, for several seeds, and must accept it. A run's own significance is 0.01; a
 * program takes 1e-3 for the p-values of all its right runs together, however many there are. What is wrong must be
 * rejected by the run itself.
 */
#ifndef TESTS_VERIFY_HELP_H
#define TESTS_VERIFY_HELP_H

#include "tools/verify/verify.h"

#include "bis/scene/scene.h"

enum { VERIFY_SEEDS = 3 };

/* verify_failures judges a run, shows its failed tests, counts them and clears the run. */
size_t verify_failures(bis_verify *v);

/* verify_judged returns how many p-values a run has, and would have if none of its tests were skipped because too few
 * draws tell too little. The scene alone decides this number, because only these tests are skipped by chance. */
size_t verify_judged(const bis_verify *v);

/* verify_assert_accepted judges a run and clears it: no test without a p-value may fail. What verify_judged says is
 * counted (stat_judges), and the p-values are judged when the program ends (stat_later). */
void verify_assert_accepted(bis_verify *v);

/* verify_glossy returns a coloured Phong material of this model. */
bis_material verify_glossy(const bis_bsdf_model *model, double exponent);

#define VERIFY_DIR "build/test_verify"

extern const char verify_one_pixel[]; /* a film; the command's own runs look at one pixel alone */

/* verify_write_map empties VERIFY_DIR and writes its map.pfm, 32 x 16 pixels. */
void verify_write_map(void);

/* verify_write_scene writes VERIFY_DIR/NAME: the options, then program_world. */
void verify_write_scene(const char *name, const char *options);

/* verify_run_file verifies a scene in this program, with as many draws as v says. */
void verify_run_file(bis_verify *v, const char *path);

typedef struct verify_built {
    bis_scene_desc *desc;
    bis_scene *scene;
} verify_built;

/* verify_build reads and builds a scene with all that `bis verify` needs of its light. */
verify_built verify_build(const char *path);
void verify_clear(verify_built *b);

#endif
