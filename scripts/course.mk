# The course's assignments: docs/assignments/README.md. Included by the Makefile.
#   make assignment A=alias DEST=dir     a starter kit
#   make grade DEST=dir                  the points of what was made of it
.PHONY: assignment grade

# How to compile a file more and link it before the library: for scripts/grade.sh and scripts/check_assignments.sh.
test grade: export BIS_BUILD = $B
test grade: export BIS_COMPILE = $(CC) $(CFLAGS) $(OURS) -Itests
test grade: export BIS_LINK = $(CC) $(CFLAGS) $(OPENMP) $(LDFLAGS)
test grade: export BIS_OBJECTS = $(SUPPORT) $(LIB)
test grade: export BIS_LIBS = $(LIBS) -lcmocka
test grade: export BIS_SANITIZE = -O1 -g -fno-sanitize-recover=all -fsanitize=$(SANITIZE)

assignment:
	@sh scripts/assignment.sh "$(A)" "$(DEST)"

grade: $(SUPPORT) $(LIB) $B/src/cli/main.o
	@sh scripts/grade.sh "$(DEST)"
