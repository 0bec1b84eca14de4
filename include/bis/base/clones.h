/* SPDX-License-Identifier: BSD-2-Clause */
/* clones: one function compiled for several processors, so that a plain loop uses the widest vectors of the machine.
 *
 * BIS_LANES before a static function makes a clone for AVX-512, one for AVX2 and one for any processor. The loader
 * chooses when the program starts. BIS_INLINE before a function copies it into every clone. */
#pragma once

/* Clones need an indirect function of glibc's loader. They are off under the sanitizers, because a sanitizer
 * instruments the function that chooses, and that function runs before the sanitizer is ready. They are for static
 * functions only, because clang 14 gives an exported clone a name that its callers in other files do not know. No two
 * files may have one of the same name, because the function of clang that chooses is not static
 * (scripts/check/check_layers.sh looks). */
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__) && !defined(BIS_ONE_CLONE)
#if !defined(__has_feature)
#define BIS_LANES __attribute__((target_clones("avx512f", "avx2", "default")))
#elif !__has_feature(address_sanitizer) && !__has_feature(thread_sanitizer) && \
    !__has_feature(undefined_behavior_sanitizer)
#define BIS_LANES __attribute__((target_clones("avx512f", "avx2", "default")))
#endif
#endif
#ifndef BIS_LANES
#define BIS_LANES
#endif

/* Copies the function into every clone before the clone is compiled, because a loop that contains a call cannot
 * become a vector loop. Unused: a student's function may do without its helper, and clang would warn. */
#define BIS_INLINE __attribute__((always_inline, unused))
