# bis: make, make test [T=alias], make asan, make bench, make data, make clean. CC, CFLAGS, LDFLAGS, PREFIX are yours.
#   make EMBREE=0        build without Embree        make VARIANT=name   build in build/name
CFLAGS  ?= -O2 -g
VARIANT ?= release
PREFIX  ?= /usr/local
B       := build/$(VARIANT)

# Dialect. The two -fno- flags change no value, NaN or Inf; they let loops with floor and pow become vectors. Never -ffast-math.
DIALECT := -std=c11 -D_GNU_SOURCE -Iinclude -Isrc -fopenmp -fno-math-errno -fno-trapping-math
WARN    := -Wall -Wextra -Wshadow -Wconversion -Wdouble-promotion -Wstrict-prototypes -Wmissing-prototypes

# Libraries. OpenEXRCore has no .pc file of its own: OpenEXR's gives the include directory.
EXR_CFLAGS := $(shell pkg-config --cflags OpenEXR 2>/dev/null)
PNG_CFLAGS := $(shell pkg-config --cflags libpng 2>/dev/null)
LIBS       := -lOpenEXR-3_1 -lOpenEXRCore $(shell pkg-config --libs libpng 2>/dev/null || echo -lpng) -lm

# Embree ships no .pc file on Debian: three lines that compile, link and run find it. 4 first, then 3.
embree_probe = $(shell mkdir -p build && printf '\#include <$(1)/rtcore.h>\nint main(void) { rtcReleaseDevice(rtcNewDevice(0)); return 0; }\n' > build/probe.c && \
    $(CC) build/probe.c -o build/probe -l$(2) 2>/dev/null && echo yes)
ifeq ($(EMBREE),0)
else ifeq ($(call embree_probe,embree4,embree4),yes)
EMBREE_CFLAGS := -DBIS_EMBREE=4
LIBS += -lembree4
else ifeq ($(call embree_probe,embree3,embree3),yes)
EMBREE_CFLAGS := -DBIS_EMBREE=3
LIBS += -lembree3
else
EMBREE := 0
endif
ifeq ($(EMBREE),0)
B := $(B)-noembree
ifeq ($(MAKELEVEL),0)
$(info bis: building without Embree; the voxel grid is the only accelerator)
endif
endif

OURS := $(DIALECT) $(WARN) $(EXR_CFLAGS) $(PNG_CFLAGS) $(EMBREE_CFLAGS)
SRC  := $(filter-out src/main.c,$(wildcard src/*.c))
OBJ  := $(SRC:%.c=$B/%.o)
LIB  := $B/libbis.a
TESTS := $(patsubst tests/%.c,$B/tests/%,$(wildcard tests/test_*.c))
SUPPORT := $(patsubst %.c,$B/%.o,$(filter-out $(wildcard tests/test_*.c),$(wildcard tests/*.c)))
DATA_TOOL := build/release/bis-data

.PHONY: all data test asan bench clean install check-style
all: bis data

bis: $B/bis
	@cp -f $< $@

$B/bis: $B/src/main.o $(LIB)
	$(CC) $(CFLAGS) -fopenmp $(LDFLAGS) -o $@ $^ $(LIBS)

$(LIB): $(OBJ)
	@rm -f $@
	$(AR) rcs $@ $^

$B/%.o: %.c Makefile
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(OURS) -MMD -MP -c -o $@ $<

$B/tests/%: $B/tests/%.o $(SUPPORT) $(LIB)
	$(CC) $(CFLAGS) -fopenmp $(LDFLAGS) -o $@ $^ $(LIBS) -lcmocka

-include $(OBJ:.o=.d) $(SUPPORT:.o=.d) $(TESTS:=.d) $B/src/main.d
.SECONDARY:

clean:
	rm -rf build bis
