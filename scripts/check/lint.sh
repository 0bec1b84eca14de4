#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# lint: the rules of the house (make lint calls it): what a reader of the sources sees and a user of the program does
# not. At the end how heavy the house is, beside the last release: a change that adds says what pays for it.
#     scripts/check/lint.sh BUILD_DIR
# Exit status 1 where a rule is broken.
build=$1
bad=0
if [ -f assignment ]; then # a starter kit: the rules are ours, the time of its loops is the student's
    exec sh scripts/check/check_vectors.sh
fi
for rule in "check_docstrings" "check_layers" "check_circles $build" "check_prefetch $build" "check_vectors" \
    "check_guide" "check_errata" "check_scenes" "check_32_bits" "check_release" "fragments --check" "spdx --check"; do
    # shellcheck disable=SC2086 # a name and its arguments
    set -- $rule
    name=$1
    shift
    sh "scripts/check/$name.sh" "$@" || { echo "make lint: $name: broken"; bad=1; }
done
sh scripts/check/weight.sh
exit $bad
