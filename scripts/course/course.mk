# SPDX-License-Identifier: BSD-2-Clause
# The course's assignments: docs/assignments/README.md. Included by the Makefile.
#   make assignment A=alias DEST=dir                      a starter kit
#   make grade A=alias DEST=dir                           the points of what was made of it
#   make grade-class A=alias FROM=handed-in/ [JOBS=2]     those of a class; FOR=moodle: and a table that Moodle imports
#   make leaderboard FROM=handed-in/                      of a class's densities (open), by error x time
#   make kit A=alias FOR=gradescope DEST=alias.zip        what Gradescope marks by; FOR=classroom50 DEST=folder: what
#                                                         Classroom 50 does (docs/assignments/README.md)
#   make check                                            in a kit: what make grade refuses, points, speed, memory
.PHONY: assignment kit grader grade grade-class leaderboard check check-clean

# How to compile a file more and link it before the library: for scripts/course/grade.sh and
# scripts/course/check_assignments.sh.
MARKING := test test-tools grade grade-class leaderboard
assignment lint check $(MARKING): export BIS_BUILD = $B
lint check $(MARKING): export BIS_COMPILE = $(CC) $(CFLAGS) $(OURS) $(SHARED_BY_TESTS)
$(MARKING): export BIS_LINK = $(CC) $(CFLAGS) $(OPENMP) $(LDFLAGS)
$(MARKING): export BIS_OBJECTS = $(SUPPORT) $(LIB)
$(MARKING): export BIS_SERVER = $(SERVER)
$(MARKING): export BIS_LIBS = $(LIBS) -lcmocka
$(MARKING): export BIS_SANITIZE = $(SANITIZED)

# A call in the place of a return is a jump in the plain program, and takes no stack; so it is in the other.
SANITIZED = $(ASAN) -foptimize-sibling-calls
assignment: $(LIB)
	@sh scripts/course/assignment.sh "$(A)" "$(DEST)"

# What answers the claims' questions with a student's functions, in a process of its own.
SERVER := $B/scripts/course/server.o $B/tests/support/course/answers.o $B/tests/support/lit.o
GRADER := $B/scripts/course/grade.o $B/scripts/course/tokens.o \
    $B/tests/support/course/box.o $B/tests/support/course/mark_run.o
$B/scripts/course/server.o $B/scripts/course/grade.o: OURS += $(SHARED_BY_TESTS)
$B/grade: $(GRADER)
	$(LINK) -lm
$(if $(wildcard tests/course),$(if $(filter %/test_assignments,$(CHOSEN)),test) test-tools: $B/grade $(SERVER))

grader: $(SUPPORT) $(LIB) $B/grade $(SERVER) $B/src/cli/main.o
grade: grader
	@sh scripts/course/grade.sh "$(A)" "$(DEST)" "$(FOR)" "$(REPORT)"

JOBS ?= 2
grade-class: grader
	@sh scripts/course/grade_class.sh "$(A)" "$(FROM)" "$(JOBS)" "$(FOR)"

leaderboard: grader
	@sh scripts/course/grade_class.sh open "$(FROM)" "$(JOBS)" leaderboard && cat "$(FROM:/=).open.leaderboard.csv"

kit: $(if $(filter moodle,$(FOR)),grade-class,$(if $(FOR),,assignment))
	@$(if $(filter-out moodle,$(FOR)),sh scripts/course/kit.sh "$(A)" "$(FOR)" "$(DEST)",:)

# The program is built twice, because the sanitizers see memory and change all times. `build/check.log` says why the
# second one is not built, if it is not.
CHECKED := $(if $(wildcard tests/test_assignment.c),$B/tests/test_assignment)
check: $(CHECKED) $B/grade
	@$(if $(CHECKED),,echo "make check: this is the project; a starter kit has a hand-in to check"; exit 1)
	@sh scripts/course/check.sh
	@$(CHECKED) --check
	@$(MAKE) VARIANT=asan CFLAGS="$(SANITIZED)" check-clean >build/check.log 2>&1; \
	 sed -n '/of 10  clean memory/,$$p' build/check.log | sed '/^make/d' | grep . || \
	 echo "        clean memory: not looked at: build/check.log"
check-clean: $(CHECKED)
	@$(CHECKED) --clean
