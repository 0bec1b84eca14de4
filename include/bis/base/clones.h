/* clones: one function compiled for several processors, so that a plain loop runs as wide vectors where there are any.
 *
 * BIS_LANES before a static function makes a clone for AVX-512, one for AVX2 and one for any processor. The loader
 * chooses when the program starts. BIS_INLINE before a function copies it into every clone. */
#ifndef BIS_CLONES_H
#define BIS_CLONES_H

/* Clones need an indirect function of glibc's loader. Sanitizers instrument the function that chooses, and it runs
 * before they are ready. For static functions only: clang 14 gives an exported one another name than its callers in other
 * files know. */
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    !defined(BIS_ONE_CLONE)
#if !defined(__has_feature)
#define BIS_LANES __attribute__((target_clones("avx512f", "avx2", "default")))
#elif !__has_feature(address_sanitizer) && !__has_feature(thread_sanitizer) && !__has_feature(undefined_behavior_sanitizer)
#define BIS_LANES __attribute__((target_clones("avx512f", "avx2", "default")))
#endif
#endif
#ifndef BIS_LANES
#define BIS_LANES
#endif

/* Into every clone, before it is made: a loop with a call in it is no vector. */
#define BIS_INLINE __attribute__((always_inline))

#endif
