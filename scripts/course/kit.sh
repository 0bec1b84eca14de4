#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# kit: what a service for teaching marks an assignment by (docs/assignments/README.md): this project, as far as marking
# needs it, and the files that the service calls.
#     scripts/course/kit.sh NAME gradescope TO.zip            (make kit A=NAME FOR=gradescope DEST=TO.zip)
#     scripts/course/kit.sh NAME classroom50 FOLDER           (make kit A=NAME FOR=classroom50 DEST=FOLDER)
# From the root. FOLDER must be new. It holds the solutions.
name=$1
kind=$2
to=$3
fail() {
    echo "make kit: $*" >&2
    exit 1
}

[ -d tests/course ] || fail "this is a starter kit; kits are made by the project that it comes from"
[ -f "tests/course/${name}_blank.c" ] || fail "there is no assignment \"$name\""
case $kind in gradescope | classroom50) ;; *) fail "FOR is gradescope, classroom50 or moodle, not \"$kind\"" ;; esac
[ -n "$to" ] || fail "say where to: make kit A=$name FOR=$kind DEST=../$name$([ "$kind" != gradescope ] || echo .zip)"
[ ! -e "$to" ] || fail "$to is there; name a new one"

work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/bis/tests/course" || exit 1
cp -Rp Makefile LICENSE include src scripts "$work/bis" && mkdir "$work/bis/docs" &&
    cp -Rp docs/live docs/scene-format.md "$work/bis/docs" && cp -Rp tests/support "$work/bis/tests" &&
    cp -p tests/course/"$name"[._]* "$work/bis/tests/course" || exit 1
cat >"$work/setup.sh" <<'EOF'
#!/bin/sh
# Once, before anything is marked: the packages, and the project's own objects.
set -e
bis=$(dirname "$0")/bis
[ -d "$bis" ] || bis=/autograder/source/bis
sh "$bis/scripts/setup.sh" --marking
pkg-config --atleast-version=3.1 OpenEXR || {
    echo "setup: OpenEXR is $(pkg-config --modversion OpenEXR), and bis needs 3.1:" \
        "take an image of Debian 12 or Ubuntu 24.04" >&2
    exit 1
}
make -s -C "$bis" -j2 grader
EOF
case $kind in
gradescope)
    cat >"$work/run_autograder" <<EOF
#!/bin/sh
exec make -s -C /autograder/source/bis grade A=$name DEST=/autograder/submission FOR=gradescope \\
    REPORT=/autograder/results/results.json
EOF
    chmod +x "$work/setup.sh" "$work/run_autograder"
    case $to in /*) ;; *) to=$PWD/$to ;; esac
    (cd "$work" && zip -q -r "$to" .) || fail "zip is needed, or does not work"
    ;;
classroom50)
    cat >"$work/autograder.py" <<EOF
"""Marks the assignment $name of bis. The runner calls this in the student's checkout, and reads result.json there."""
import os
import pathlib
import subprocess

here = pathlib.Path(__file__).resolve().parent
subprocess.run(["rm", "-rf", "result.json"], check=True)  # the student may have one
subprocess.run(["sh", here / "setup.sh"], check=True)
subprocess.run(["make", "-s", "-C", here / "bis", "grade", "A=$name", "DEST=" + os.getcwd(), "FOR=classroom50",
                "REPORT=" + os.path.join(os.getcwd(), "result.json")], check=True)
EOF
    mkdir -p "$to" && cp -Rp "$work/." "$to" || exit 1
    ;;
esac
echo "$to: assignment \"$name\" for $kind"
