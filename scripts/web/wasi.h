/* SPDX-License-Identifier: BSD-2-Clause */
/* wasi: what wasi-libc lacks of the system that src/ is written for. `make web` includes it before every file.
 *
 * WebAssembly has no files without a name (O_TMPFILE): opening with a flag that is no flag fails as it would on an old
 * kernel, and src/base/file.c then does without. It does not say how much memory a process has had: getrusage fails,
 * and src/tools/describe.c then reports 0. The field exists so that the line compiles. */
#pragma once

#include <fcntl.h>
#include <sys/resource.h>

#define O_TMPFILE O_DIRECTORY /* to write to a directory is refused */
#define ru_maxrss ru_utime.tv_sec
#define getrusage(who, usage) ((void)(usage), -1)
