# SPDX-License-Identifier: BSD-2-Clause
# bis: make, make test [T=alias or T=thesis] [SEED=n], make test-tools, make lint, make asan, make fuzz
# [FUZZ_SECONDS=60], make coverage, make bench, make data, make assignment, make grade, make grade-class, make install,
# make uninstall, make release, make deb, make clean. CC, CFLAGS, LDFLAGS, PREFIX, LIBDIR are yours.
#   make MPI=1           bis-mpi, too, for several machines (docs/command-line.md)
#   make EMBREE=0        build without Embree        make VARIANT=name   build in build/name
#   make V=1             show every command
#   make compile_commands.json   how each file is compiled, for editors and clang tools
# All processors compile, unless make was told otherwise (make -j1) or has several goals, which stay in their order;
# test and test-tools keep theirs by an arrow.
ifeq ($(MAKELEVEL)$(filter -j%,$(MAKEFLAGS))$(word 2,$(filter-out test-tools,$(MAKECMDGOALS))),0)
MAKEFLAGS += -j$(shell nproc)
endif
CFLAGS  ?= -O2 -g
VARIANT ?= release
PREFIX  ?= /usr/local
B       := build/$(VARIANT)

# What is optional is probed by compiling three lines. OpenMP: threads. Embree ships no .pc file on Debian: 4 first,
# then 3. x87: registers are wider than a double (processors of 32 bits), so results would depend on what the compiler
# keeps there. What was found is kept in build/.found, so that a make without work compiles nothing. It holds until the
# compiler is another one, or a folder in which headers and libraries are installed has changed since.
quoted   = '$(subst ','\'',$(1))'
probe    = $(shell t=$$(mktemp) && printf '%b' '$(2)\nint main(void) { $(3); return 0; }\n' | \
    $(CC) -x c - -o $$t $(4) 2>/dev/null && echo $(1); rm -f $$t)
embree   = $(call probe,embree$(1),\043include <embree$(1)/rtcore.h>,rtcReleaseDevice(rtcNewDevice(0)),-lembree$(1))
COMPILER := $(CC): $(shell $(CC) --version 2>/dev/null | head -n 1)
SEARCHED := /usr/include /usr/lib /usr/lib32 /usr/lib64 /usr/local /opt \
    $(subst :, ,$(CPATH) $(C_INCLUDE_PATH) $(LIBRARY_PATH))
FOUND    := $(shell f=build/.found; [ -f $$f ] && [ "$$(head -n 1 $$f)" = $(call quoted,$(COMPILER)) ] && \
    [ -z "$$(find $(SEARCHED) -maxdepth 2 -type d -newer $$f 2>/dev/null | head -n 1)" ] && tail -n 1 $$f)
ifeq ($(FOUND),)
FOUND    := found $(call probe,openmp,,,-fopenmp) $(or $(call embree,4),$(call embree,3)) \
    $(call probe,x87,\043include <float.h>\n_Static_assert(FLT_EVAL_METHOD == 2\054 "");) \
    $(call probe,jpeg,\043include <stdio.h>\n\043include <jpeglib.h>,struct jpeg_error_mgr e; jpeg_std_error(&e),-ljpeg)
$(shell mkdir -p build && printf '%s\n' $(call quoted,$(COMPILER)) '$(FOUND)' >build/.found)
endif
JPEG     := $(filter jpeg,$(FOUND))
OPENMP   := $(if $(filter openmp,$(FOUND)),-fopenmp)
SSE      := $(if $(filter x87,$(FOUND)),-msse2 -mfpmath=sse)
EMBREE_VERSION := $(if $(filter 0,$(EMBREE)),,$(patsubst embree%,%,$(filter embree%,$(FOUND))))
ifeq ($(EMBREE_VERSION),)
B := $(B)-noembree
endif
ifeq ($(MAKELEVEL),0)
$(if $(EMBREE_VERSION),,$(info bis: building without Embree; the voxel grid is the only accelerator))
$(if $(JPEG),,$(info bis: building without libjpeg; textures cannot be JPEGs))
$(if $(OPENMP),,$(info bis: $(CC) has no OpenMP; one thread))
endif

# Dialect. The first two -fno- flags change no value, NaN or Inf; they let loops with floor and pow become vectors. The
# third: gcc 12 leaves out the rounding of (double)(float)x where it makes vectors of straight code. Never -ffast-math.
# Position-independent: the program and both libraries are made of the same objects. In three scenes that changes the
# number of instructions by less than 1e-4 (callgrind).
DIALECT := -std=c11 -D_GNU_SOURCE -Iinclude -Isrc $(OPENMP) $(SSE) -fno-math-errno -fno-trapping-math \
    -fno-tree-slp-vectorize -ffp-contract=off -fPIC -fno-semantic-interposition
# clang 19 warns where an enum's constant meets a double, but in C the constant is an int.
WARN    := -Wall -Wextra -Wshadow -Wconversion -Wdouble-promotion -Wstrict-prototypes -Wmissing-prototypes \
    -Wno-enum-float-conversion
# OpenEXR's .pc file names the C library, OpenEXRCore, among its own.
OURS    := $(DIALECT) -I$B/src $(WARN) $(shell pkg-config --cflags OpenEXR libpng zlib) \
    $(if $(EMBREE_VERSION),-DBIS_EMBREE=$(EMBREE_VERSION)) $(if $(JPEG),-DBIS_JPEG)
LIBS    := -Wl,--as-needed $(shell pkg-config --libs OpenEXR libpng zlib) \
    $(if $(EMBREE_VERSION),-lembree$(EMBREE_VERSION)) $(if $(JPEG),-ljpeg) -lpthread -lm

SRC     := $(filter-out src/cli/main.c src/cli/ranks_mpi.c,$(wildcard src/*/*.c src/*/*/*.c))
PAGES   := $(filter-out %/frame.html,$(wildcard scripts/python/pages/*.html))
# The commands that are Python.
INSTRUMENTS := $(filter-out bis-instrument,$(notdir $(wildcard scripts/python/bis-*)))
# The pages of the instruments, each in one file, where the package finds them.
ASSEMBLED := $(PAGES:scripts/python/pages/%=scripts/python/bis/pages/%)
OBJ     := $(SRC:%.c=$B/%.o) $B/src/cli/help_scene.o $B/src/flat/face.o
LIB     := $B/libbis.a
# What `make install` gives to other programs (docs/library.md): without src/cli, because a library does not exit.
VERSION := $(shell sed -n 's/^.define BIS_VERSION "\(.*\)"/\1/p' include/bis/base/version.h)
STATIC  := $B/library/libbis.a
SHARED_LIB := $B/library/libbis.so.$(VERSION)
LIBRARY_OBJ := $(filter-out $B/src/cli/%,$(OBJ)) $B/flat_build.o
INSTALLED   = $B/bis $B/bis.1 $B/bis.pc $(STATIC) $(SHARED_LIB) $(ASSEMBLED)
# A format is a literal, so that the compiler sees whether the arguments fit.
$(SRC:%.c=$B/%.o): OURS += -Wformat=2
# tests/LAYER/test_NAME.c becomes $B/tests/test_NAME: a test's name is unique. A starter kit has its one test in tests/
# itself.
TEST_SRC := $(wildcard tests/test_*.c tests/*/test_*.c)
program  = $(patsubst %.c,$B/tests/%,$(notdir $(1)))
TESTS   := $(call program,$(TEST_SRC))
# Tests of the program by Python's standard library: files as other programs write them, and what bis makes of each.
# Those of tests/python need numpy: the first python3 that has it runs them (PYTHON names another).
ifeq ($(origin PYTHON),undefined)
PYTHON  := $(shell for p in $$BIS_PYTHON python3 /usr/bin/python3; do \
    $$p -c 'import numpy' 2>/dev/null && echo $$p && break; done)
endif
SCRIPTS := $(wildcard tests/foreign/test_*.py tests/whole/test_*.py) \
    $(if $(PYTHON),$(wildcard tests/python/test_*.py tests/python/*/test_*.py))
# `make test` runs the tests of the renderer, `make test-tools` the long ones: of the instruments, of marks, of what is
# built and installed. T chooses among both, by folder or by a part of the name.
ALL_TESTS := $(TEST_SRC) $(SCRIPTS)
IN_TOOLS  := $(filter tests/tools/% tests/course/% tests/whole/% tests/python/%,$(ALL_TESTS))
called     = $(sort $(filter tests/$(T)/%,$(1)) $(foreach t,$(1),$(if $(findstring $(T),$(notdir $t)),$t)))
runs       = $(foreach t,$(1),$(if $(filter %.c,$t),$(call program,$t),$t))
CHOSEN    := $(call runs,$(if $(T),$(call called,$(ALL_TESTS)),$(filter-out $(IN_TOOLS),$(ALL_TESTS))))
LONG      := $(call runs,$(if $(T),$(call called,$(IN_TOOLS)),$(IN_TOOLS)))
SUPPORT := $(patsubst %.c,$B/%.o,$(wildcard tests/support/*.c tests/support/*/*.c))
# Programs beside bis: the generator of data/, the benchmarks.
DATA_SRC := $(wildcard data/generate/*.c)
TOOLS    := $(patsubst scripts/bench/%.c,$B/%,$(filter-out scripts/bench/measure.c,$(wildcard scripts/bench/*.c)))
STAMP    := data/models/.made

SANITIZE := address,undefined,float-divide-by-zero,float-cast-overflow
ASAN     := -O1 -g -fno-sanitize-recover=all -fsanitize=$(SANITIZE)
FUZZERS  := $(patsubst tests/fuzz/%.c,$B/%,$(wildcard tests/fuzz/fuzz_*.c))
SEEDERS  := $(patsubst %,$B/tests/test_%,image image_hdr image_pfm image_exr image_png image_screen \
    ply obj gzip part convert)

# What was asked for is built, whatever was built before: objects depend on the compiler and the flags as they were
# given ($B/.flags changes only when they do), and ./bis is the program that was made last.
FLAGS   := $(COMPILER) $(CFLAGS) $(OURS) -- $(LDFLAGS) $(LIBS)
# $(call say,CC,what): a short line in the place of the command; V=1 shows the command itself.
Q       := $(if $(V),,@)
say      = $(if $(V),,@echo "  $(1)	$(2)")

# What links and compiles MPI programs; `make test` builds bis-mpi where there is one.
MPICC  ?= mpicc
HAS_MPI := $(shell command -v $(MPICC))

.PHONY: FORCE all pages data web test-web test-32 test test-tools lint python-parts test-browser test-long \
    asan fuzz fuzz-run coverage docs figures bench installed install uninstall \
    tarball release deb clean
all: bis data $(SHARED_LIB) $(ASSEMBLED) $(if $(filter 1,$(MPI)),bis-mpi)

pages: $(ASSEMBLED)

bis bis-mpi: %: $B/% FORCE
	@cmp -s $< $@ || cp -f $< $@

$B/.flags: FORCE
	@mkdir -p $B
	@printf '%s\n' $(call quoted,$(FLAGS)) | cmp -s - $@ || printf '%s\n' $(call quoted,$(FLAGS)) >$@

# LINK: objects, then what they need.
define LINK
$(call say,LINK,$@)
$Q$(CC) $(CFLAGS) $(OPENMP) $(LDFLAGS) -o $@ $(filter %.o,$^) $(filter %.a,$^)
endef
$B/bis: $B/src/cli/main.o $(LIB)
	$(LINK) $(LIBS)
# MPICC is a wrapper of the compiler CC, which Open MPI and MPICH take from the environment.
$B/bis-mpi $B/src/cli/ranks_mpi.o: export OMPI_CC = $(CC)
$B/bis-mpi $B/src/cli/ranks_mpi.o: export MPICH_CC = $(CC)
$B/bis-mpi: $B/src/cli/main.o $B/src/cli/ranks_mpi.o $(LIB)
	$(call say,LINK,$@)
	$Q$(MPICC) $(CFLAGS) $(OPENMP) $(LDFLAGS) -o $@ $^ $(LIBS)
$B/src/cli/ranks_mpi.o: src/cli/ranks_mpi.c $B/.flags
	@mkdir -p $(@D)
	$(call say,MPICC,$<)
	$Q$(MPICC) $(CFLAGS) $(OURS) -Wformat=2 -MMD -MP -c -o $@ $<
$B/bis-data: $(DATA_SRC:%.c=$B/%.o) $(LIB)
	$(LINK) $(LIBS)
$B/bench_error: $B/scripts/bench/measure.o
$B/figures: $(patsubst %.c,$B/%.o,$(wildcard scripts/figures/*.c)) $B/scripts/bench/measure.o $(LIB)
	$(LINK) $(LIBS)
$(TOOLS): $B/%: $B/scripts/bench/%.o $(LIB)
	$(LINK) $(LIBS)
$(foreach t,$(TEST_SRC),$(eval $(call program,$t): $(t:%.c=$B/%.o)))
# tests/support/seed.c stands between the tests and the random numbers.
SEEDED := -Wl,--wrap=bis_rng_init
$(TESTS): $(SUPPORT) $(LIB)
	$(LINK) $(SEEDED) $(LIBS) -lcmocka
# A test has a parameter `state`, because cmocka hands one to each; few use it.
SHARED_BY_TESTS := -Itests/support -Itests/support/course
TESTING := $(SHARED_BY_TESTS) -Wno-unused-parameter
$B/tests/%.o: OURS += $(TESTING)

# Which build this is: a sum over the objects of the library.
$B/flat_build.o: $(filter-out $B/flat_build.o,$(LIBRARY_OBJ))
	$Qprintf '#include "bis/flat/flat.h"\nconst char *bis_flat_build(void) { return "%s"; }\n' \
	    "$$(cat $^ | cksum | tr ' ' -)" | $(CC) $(CFLAGS) $(OURS) -x c -c -o $@ -
$B/src/cli/instrument.o: OURS += -DBIS_BUILD_FOLDER='"$B"'

$(LIB): $(OBJ) $B/flat_build.o
	$(call say,AR,$@)
	@rm -f $@
	$Q$(AR) rcs $@ $^

$(STATIC): $(LIBRARY_OBJ)
	@mkdir -p $(@D)
	$(call say,AR,$@)
	@rm -f $@
	$Q$(AR) rcs $@ $^

# Before 1.0 a new minor version may change any function: it is part of the soname. Names that do not begin with bis_
# stay inside.
$(SHARED_LIB): $(LIBRARY_OBJ)
	@mkdir -p $(@D)
	@echo '{ global: bis_*; local: *; };' >$B/library/names.map
	$(call say,LINK,$@)
	$Q$(CC) $(CFLAGS) $(OPENMP) $(LDFLAGS) -shared -Wl,-soname,libbis.so.$(basename $(VERSION)) \
	    -Wl,--version-script=$B/library/names.map -o $@ $^ $(LIBS)

# @PREFIX@ is filled in by scripts/install.sh.
$B/bis.pc: $B/.flags include/bis/base/version.h Makefile
	@printf '%s\n' 'prefix=@PREFIX@' 'includedir=$${prefix}/include' 'libdir=$${prefix}/lib' '' 'Name: bis' \
	    'Description: direct light from environment maps' 'Version: $(VERSION)' 'Cflags: -I$${includedir}' \
	    'Libs: -L$${libdir} -lbis' 'Libs.private: $(OPENMP) $(filter-out -Wl%,$(LIBS))' >$@
$B/bis.1: $B/bis $(wildcard scripts/python/bis/tools/*.py)
	@$B/bis help --man >$@

$B/%.o: %.c $B/.flags
	@mkdir -p $(@D)
	$(call say,CC,$<)
	$Q$(CC) $(CFLAGS) $(OURS) -MMD -MP -c -o $@ $<

# scripts/python/pages/NAME.html in the frame of all pages, with what that loads put in by page.awk.
$(ASSEMBLED): scripts/python/bis/pages/%: scripts/python/pages/% scripts/python/pages/page.awk \
    scripts/python/pages/frame.html docs/live/plot.js docs/live/page.css
	@mkdir -p $(@D)
	$(call say,PAGE,$@)
	$Qawk -f scripts/python/pages/page.awk $< scripts/python/pages/frame.html >$@.new && mv $@.new $@
# The tables of the scene format, for `bis help`.
$B/src/cli/help_scene.o: docs/scene-format.md src/cli/help_scene.awk src/cli/help.h $B/.flags
	@mkdir -p $(@D)
	$(call say,CC,$<)
	$Qawk -f src/cli/help_scene.awk $< | $(CC) $(CFLAGS) $(OURS) -x c -c -o $@ -

# What follows from the prototypes of include/bis/flat: the functions around those of src/flat. FACE: of these headers.
define FACE
@mkdir -p $(@D)
$(call say,FACE,$@)
$Qawk -f src/flat/face.awk -v to=$(patsubst .%,%,$(suffix $@)) $(filter %.h,$^) >$@.new && mv $@.new $@
endef
$B/src/flat/face.h $B/src/flat/face.c: src/flat/face.awk $(wildcard include/bis/flat/*.h)
	$(FACE)
$(filter $B/src/flat/%,$(OBJ)): | $B/src/flat/face.h
$B/src/flat/face.o: $B/src/flat/face.c $B/.flags
	$(call say,CC,$<)
	$Q$(CC) $(CFLAGS) $(OURS) -MMD -MP -c -o $@ $<

compile_commands.json: FORCE
	@sh scripts/check/compile_commands.sh $(call quoted,$(CC) $(CFLAGS) $(OURS) $(TESTING)) $(ALL_C) >$@

# data/models and data/maps, made anew when the generator's own sources change.
data: $(STAMP)
$(STAMP): $(DATA_SRC) $(wildcard data/generate/*.h) | $B/bis-data
	$(call say,DATA,data/)
	$Q$B/bis-data data
	@touch $@

# Test programs run from here, where they find data/ and the program itself. SEED=n draws the random numbers of every
# statistical test anew (scripts/check/run_tests.sh).
STATISTICAL = $(notdir $(basename $(shell grep -lE 'stat_(level|later|assert)' $(TEST_SRC))))
# $(call needs,PROGRAMS): what must be built before these run.
needs = $(filter $B/%,$(1)) $B/bis $B/bis-data $(SHARED_LIB) $(ASSEMBLED) $(STAMP) \
    $(if $(filter %/test_mpi,$(1)),$(if $(HAS_MPI),$B/bis-mpi)) $(if $(filter %/test_library,$(1)),$(INSTALLED)) \
    $(if $(filter %/test_figures,$(1)),$B/figures)
define RUN_TESTS
@BIS_PROGRAM=$B/bis BIS_LIBRARY=$(abspath $(SHARED_LIB)) PYTHON='$(PYTHON)' SEED='$(SEED)' \
    STATISTICAL='$(if $(SEED),$(STATISTICAL))' sh scripts/check/run_tests.sh
endef
test: $(call needs,$(CHOSEN))
	$(RUN_TESTS) $(CHOSEN)

$(if $(filter test,$(MAKECMDGOALS)),test-tools: | test)
test-tools: $(call needs,$(LONG))
	$(RUN_TESTS) $(LONG)
	@[ -n '$(PYTHON)' ] || echo "make test-tools: the tests of Python were SKIPPED: no python3 here has numpy;" \
	    "scripts/setup.sh installs it, PYTHON=program names another"

# The rules of the house: layers, circles, columns, docstrings, vectors, pages, licences; and how heavy the house is.
lint: $B/bis
	@sh scripts/check/lint.sh $B

# With the slow cases: maps of 16384 x 8192, tables of 1e8 items, grids of 1e8 cells. Minutes and 8 GB more.
test-long:
	BIS_LONG=1 TEST_SECONDS=$${TEST_SECONDS:-3000} $(MAKE) test test-tools

# README and docs/ as a static site with MathML, in build/docs, with the figures of `make web` where its compiler is
# installed. pandoc makes it; who reads the .md files needs none of it.
HAS_WASM := $(and $(shell command -v clang),$(shell command -v wasm-ld),$(wildcard /usr/include/wasm32-wasi/stdio.h))
docs: $(if $(HAS_WASM),web)
	@sh scripts/site/site.sh build/docs

# The pages of bis trade, pixel and envmap and the site in a headless Chromium, where there is one; no part of `make
# test`.
test-browser: $B/bis $(STAMP)
	@sh scripts/check/test_browser.sh $B/bis $B/browser

# The library as WebAssembly and the figures that live (docs/live.md), in build/web. Debian's clang, lld, wasi-libc and
# libclang-rt-dev-wasm32, and gzip; nothing of it is needed for `make` or `make test`.
W        := build/web
WASM_CC  ?= clang
WASM_SRC := $(filter-out src/cli/% src/files/image_exr% src/files/image_png% src/files/gzip.c \
    src/flat/flat_image.c src/base/threads.c,$(SRC)) scripts/web/wasm.c
WASM_OBJ := $(WASM_SRC:%.c=$W/objects/%.o) $W/objects/src/flat/face.o
WASM     := --target=wasm32-wasi -O2 -std=c11 -D_GNU_SOURCE -Iinclude -Isrc -I$W/src -include scripts/web/wasi.h \
    -nostdlibinc -isystem /usr/include/wasm32-wasi \
    -D_WASI_EMULATED_SIGNAL -D_WASI_EMULATED_MMAN -D_WASI_EMULATED_PROCESS_CLOCKS -fno-math-errno -fno-trapping-math \
    -ffp-contract=off -msimd128
# All memory of a page: the stack, which stands first so that an overflow is caught, and a heap that grows to 512 MiB.
WASM_LINK := --target=wasm32-wasi -mexec-model=reactor -Wl,-z,stack-size=4194304 -Wl,--stack-first \
    -Wl,--max-memory=536870912 -Wl,--gc-sections -Wl,--strip-all \
    -lwasi-emulated-signal -lwasi-emulated-mman -lwasi-emulated-process-clocks -lwasi-emulated-getpid -lm
FLAT_NAMES = $(sort $(shell grep -ho '\bbis_flat_[a-z0-9_]*' include/bis/flat/*.h))
$W/objects/%.o: %.c scripts/web/wasi.h Makefile
	@mkdir -p $(@D)
	$(call say,WASM,$<)
	$Q$(WASM_CC) $(WASM) -w -MMD -MP -c -o $@ $<
$W/src/flat/face.h $W/src/flat/face.c: src/flat/face.awk $(filter-out %/image.h,$(wildcard include/bis/flat/*.h))
	$(FACE)
$(filter $W/objects/src/flat/%,$(WASM_OBJ)): | $W/src/flat/face.h
$W/objects/src/flat/face.o: $W/src/flat/face.c Makefile
	@mkdir -p $(@D)
	$Q$(WASM_CC) $(WASM) -w -MMD -MP -c -o $@ $<
$W/bis.wasm: $(WASM_OBJ)
	$(call say,LINK,$@)
	$Q$(WASM_CC) -o $@ $^ $(WASM_LINK) $(FLAT_NAMES:%=-Wl,--export-if-defined=%) -Wl,--export=malloc -Wl,--export=free
web: $W/bis.wasm $B/bis $(SHARED_LIB) $(STAMP)
	@sh scripts/web/pages.sh $B/bis $W

# Each figure in a headless Chromium, its hashes against those of the native library; no part of `make test`.
test-web: web $(SHARED_LIB)
	@python3 tests/web/test_web.py $W $(SHARED_LIB) $(FIGURE)

# The tests of base and thesis, built with -m32; skipped with a word where its libraries are missing.
test-32:
	@sh scripts/check/check_32_bits.sh --run

# Its own build folder: never mixes with, nor replaces, the release binary.
# A Python that loads such a library must have the sanitizer's first; its own leaks are not ours.
asan:
	@mkdir -p build
	@printf '#!/bin/sh\nLD_PRELOAD=%s ASAN_OPTIONS=detect_leaks=0 exec %s "$$@"\n' \
	    "$$($(CC) -print-file-name=libasan.so)" '$(or $(PYTHON),python3)' >build/python-asan && chmod +x build/python-asan
	BIS_PYTHON='$(CURDIR)/build/python-asan' $(MAKE) VARIANT=asan CFLAGS="$(ASAN)" test test-tools

# Every reader under libFuzzer and the sanitizers, so many seconds each; the tests' own files are what it begins with.
# clang alone has it.
FUZZ_SECONDS ?= 60
fuzz:
	$(MAKE) VARIANT=fuzz CC=clang EMBREE=0 \
	    CFLAGS="-O1 -g -fno-sanitize-recover=all -fsanitize=fuzzer-no-link,$(SANITIZE)" fuzz-run
fuzz-run: $(FUZZERS) $(SEEDERS) $B/bis
	@sh scripts/check/fuzz.sh $B $(FUZZ_SECONDS) $(FUZZ)
$(FUZZERS): $B/fuzz_%: $B/tests/fuzz/fuzz_%.o $B/tests/fuzz/input.o $(LIB)
	$(LINK) -fsanitize=fuzzer $(LIBS)

# Lines and branches of src/ that the tests reach, file by file.
coverage:
	$(MAKE) VARIANT=coverage CFLAGS="-O1 -g --coverage" test test-tools
	@sh scripts/check/coverage.sh build/coverage

# The thesis's figures again, in build/figures (docs/trust.md): our own model and maps, or those of BIS_SHARED where
# it is set. C computes them; docs/live/plot.js draws, under node, which a clone does not need.
figures: $B/bis $B/figures $(STAMP)
	@sh scripts/figures/figures.sh $B

bench: $B/bis $B/bis-data $(TOOLS) $(STAMP)
	@sh scripts/bench/bench.sh $B

# What a wheel holds beside the files of scripts/python/bis, without symbols, into TO: scripts/python/make_wheel.py
# calls it.
python-parts: $B/bis $(SHARED_LIB) $(ASSEMBLED)
	@mkdir -p '$(TO)/program' '$(TO)/pages' && install -s -m 755 $B/bis '$(TO)/program/bis' && \
	 for n in $(INSTRUMENTS); do install -m 755 scripts/python/bis-instrument '$(TO)'/program/$$n; done && \
	 install -m 644 $(ASSEMBLED) '$(TO)/pages' && \
	 install -s -m 644 $(SHARED_LIB) '$(TO)/libbis.so'

# The program, its man page, and what other programs need of the library: docs/library.md. `make installed` builds them
# only.
installed: $(INSTALLED)
install: $(INSTALLED) $(if $(filter 1,$(MPI)),$B/bis-mpi)
	@MPI=$(MPI) DESTDIR='$(DESTDIR)' sh scripts/install.sh $B '$(PREFIX)' '$(LIBDIR)'

uninstall:
	@DESTDIR='$(DESTDIR)' sh scripts/install.sh --remove '$(PREFIX)' '$(LIBDIR)'

# What is committed, as build/dist/bis-VERSION.tar.gz with its hash: the same bytes whoever makes it. `make release`
# also builds, tests, installs and uninstalls it, from the tarball alone. `make deb` makes Debian packages of it in
# chroots (as root).
tarball release:
	@sh scripts/release.sh $@
deb:
	@sh scripts/deb.sh

clean:
	rm -rf build bis bis-mpi compile_commands.json data/models data/maps

include scripts/course/course.mk
# Every source whose object is kept: named here, because make deletes an object that only a chain of rules mentions.
ALL_C   := $(SRC) src/cli/main.c $(TEST_SRC) \
    $(wildcard tests/support/*.c tests/support/*/*.c tests/fuzz/*.c scripts/*/*.c data/generate/*.c)
.SECONDARY: $(ALL_C:%.c=$B/%.o)
-include $(ALL_C:%.c=$B/%.d) $B/src/flat/face.d $(WASM_OBJ:.o=.d)
