/* clone_avx2_phong: see clones.h. */
#define CLONE_AVX2
#include "clone_phong.c"
