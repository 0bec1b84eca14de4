# SPDX-License-Identifier: BSD-2-Clause
# For scripts/check/mutants: the library as a shared one, so that a change of one source links one file and no test
# program.
#     make -f scripts/check/mutants.mk VARIANT=name CFLAGS=... shared
include Makefile
SHARED := $B/shared
# Left out: those that judge scripts and pages, compile kits, or need the generator of data/.
OTHERS := $(patsubst %,$B/tests/test_%,assignments data docs figures)
.PHONY: shared
shared: $(SHARED)/libbis.so $(SHARED)/bis $(patsubst $B/tests/%,$(SHARED)/%,$(filter-out $(OTHERS),$(TESTS)))
$(SHARED)/libbis.so: $(OBJ) $B/flat_build.o
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(OPENMP) -shared -Wl,-soname,libbis.so -o $@ $^ $(LIBS)
$(SHARED)/bis: $B/src/cli/main.o | $(SHARED)/libbis.so
	$(CC) $(CFLAGS) $(OPENMP) -Wl,-rpath,'$$ORIGIN' -o $@ $^ $(SHARED)/libbis.so $(LIBS)
$(foreach t,$(TEST_SRC),$(eval $(SHARED)/$(basename $(notdir $t)): $(t:%.c=$B/%.o)))
$(TESTS:$B/tests/%=$(SHARED)/%): $(SUPPORT) | $(SHARED)/libbis.so
	$(CC) $(CFLAGS) $(OPENMP) -Wl,-rpath,'$$ORIGIN' -o $@ $^ $(SHARED)/libbis.so $(SEEDED) $(LIBS) -lcmocka
