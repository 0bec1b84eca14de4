/* clone_set: see clones.h. */
#include "clone.h"
#include "clone_sets.h"
#include "thesis/set.c"
