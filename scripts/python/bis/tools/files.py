# SPDX-License-Identifier: BSD-2-Clause
"""Files that are written whole or not at all, and checks of their names before hours of work."""
from __future__ import annotations

import contextlib
import errno
import os
import stat
import time
from collections.abc import Iterator
from typing import IO, Optional, Sequence

from .._errors import Error, Status


def _irregular(path: str) -> Optional[str]:
    """What stands at path in the place of a regular file; None: such a file, or nothing."""
    try:
        mode = os.stat(path).st_mode
    except OSError:
        return None
    if stat.S_ISREG(mode):
        return None
    return "a folder" if stat.S_ISDIR(mode) else "not a regular file"


def _open_unnamed(folder: str) -> int:
    """A file without a name: whatever ends this process, nothing is left. -1 where the system has
    no such thing."""
    try:
        fd = os.open(folder or ".", os.O_TMPFILE | os.O_WRONLY | os.O_CLOEXEC, 0o666)
    except (OSError, AttributeError):
        return -1
    if os.access("/proc/self/fd/%d" % fd, os.F_OK):
        return fd
    os.close(fd)
    return -1


def _cannot_write(path: str, why: Optional[str]) -> Error:
    return Error('%s: error: cannot write "%s": %s' % (path, path, why), Status.IO)


@contextlib.contextmanager
def outfile(path: str) -> Iterator[IO[bytes]]:
    """Write a file under no name, and let it take the place of an older one, with its mode, when it
    is complete. If the body raises, the older one stays as it is."""
    what = _irregular(path)
    if what:  # renaming onto /dev/null would remove it
        raise _cannot_write(path, "it is %s, must be a regular file or new" % what)
    try:
        target = os.path.realpath(path)
        folder = os.path.dirname(target)
        name = ".bis-%x-%x" % (os.getpid(), time.time_ns() % 1_000_000_000)
        temporary = os.path.join(folder, name)
        fd = _open_unnamed(folder)
        is_named = fd < 0
        if is_named:
            fd = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666)
        try:
            with contextlib.suppress(OSError):
                os.fchmod(fd, stat.S_IMODE(os.stat(target).st_mode))
            with os.fdopen(fd, "wb") as out:
                yield out
                out.flush()
                if not is_named:
                    # Only with src_dir_fd does Python follow the link, which names the file.
                    os.link("/proc/self/fd/%d" % fd, temporary, src_dir_fd=fd, follow_symlinks=True)
                    is_named = True
            os.replace(temporary, target)
        except BaseException:
            if is_named:
                with contextlib.suppress(OSError):
                    os.unlink(temporary)
            raise
    except OSError as e:
        raise _cannot_write(path, e.strerror) from None


def check_writable(path: str) -> None:
    """Check whether a file can be made at path, behind all links, before hours of work. The write
    itself is checked again."""
    def refuse(reason: str) -> None:
        raise Error('error: "%s" cannot be written: %s' % (path, reason), Status.IO)

    what = _irregular(path)
    if what:
        refuse("it is " + what)
    folder = os.path.dirname(os.path.realpath(path)) or "."
    if os.path.exists(folder) and not os.path.isdir(folder):
        refuse('"%s" is not a folder' % folder)
    if not os.access(folder, os.W_OK | os.X_OK):
        reason = errno.EACCES if os.path.isdir(folder) else errno.ENOENT
        refuse('folder "%s": %s' % (os.path.dirname(path) or ".", os.strerror(reason)))
    with contextlib.suppress(_Tried), outfile(path):  # the surest test is to do it
        raise _Tried  # and nothing is left


class _Tried(Exception):
    """A file could be made, and shall not be."""


def check_distinct(inputs: Sequence[str], outputs: Sequence[str]) -> None:
    """Refuse an output that is one of the inputs or another output, because what it holds would be
    lost. A pipe, a device or "-" may stand for several."""
    for i, output in enumerate(outputs):
        if output == "-" or _irregular(output):
            continue
        for other in inputs:
            if _is_same(output, other):
                raise Error('error: output "%s" would replace "%s", which is read; '
                            "give the output another name" % (output, other))
        for other in outputs[:i]:
            if _is_same(output, other):
                raise Error('error: outputs "%s" and "%s" are one file; give one of them another '
                            "name" % (other, output))


def _is_same(a: str, b: str) -> bool:
    if os.path.exists(a) and os.path.exists(b):
        return os.path.samefile(a, b)
    return os.path.realpath(a) == os.path.realpath(b)
