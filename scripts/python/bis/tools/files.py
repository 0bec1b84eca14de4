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


def _beside(target: str) -> str:
    name = ".bis-%x-%x" % (os.getpid(), time.time_ns() % 1_000_000_000)
    return os.path.join(os.path.dirname(target), name)


def _open_unnamed(folder: str) -> int:
    """A file without a name: whatever ends this process, nothing is left. -1 where the system has no such thing."""
    try:
        fd = os.open(folder or ".", os.O_TMPFILE | os.O_WRONLY | os.O_CLOEXEC, 0o666)
    except (OSError, AttributeError):
        return -1
    if os.access("/proc/self/fd/%d" % fd, os.F_OK):
        return fd
    os.close(fd)
    return -1


@contextlib.contextmanager
def outfile(path: str) -> Iterator[IO[bytes]]:
    """Write a file under no name, and let it take the place of an older one when it is complete.

    Parameters
    ----------
    path : str
        The file. An older one stays as it is if the body raises; a new one keeps an older one's mode.

    Yields
    ------
    binary file
        To write to.

    Raises
    ------
    Error
        The file cannot be written: with its name and the system's reason.
    """
    what = _irregular(path)
    if what:  # renaming onto /dev/null would remove it
        raise Error('%s: error: cannot write "%s": it is %s, must be a regular file or new'
                    % (path, path, what), Status.IO)
    try:
        target = os.path.realpath(path)
        temporary = _beside(target)
        fd = _open_unnamed(os.path.dirname(target))
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
                    # With src_dir_fd Python follows the link, which is what names the file; without, it does not.
                    os.link("/proc/self/fd/%d" % fd, temporary, src_dir_fd=fd, follow_symlinks=True)
                    is_named = True
            os.replace(temporary, target)
        except BaseException:
            if is_named:
                with contextlib.suppress(OSError):
                    os.unlink(temporary)
            raise
    except OSError as e:
        raise Error('%s: error: cannot write "%s": %s' % (path, path, e.strerror), Status.IO) from None


def check_writable(path: str) -> None:
    """Check whether a file can be made at path, before hours of work. The write itself is checked again.

    Parameters
    ----------
    path : str
        The file; its folder, behind all links, must be there and writable.

    Raises
    ------
    Error
        It cannot, and why.
    """
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
    _try_to_make(path)


class _Tried(Exception):
    """A file could be made, and shall not be."""


def _try_to_make(path: str) -> None:
    """The surest test is to do it. Nothing is left."""
    with contextlib.suppress(_Tried), outfile(path):
        raise _Tried


def check_distinct(inputs: Sequence[str], outputs: Sequence[str]) -> None:
    """Refuse an output that is one of the inputs or another output, because what it holds would be lost.

    Parameters
    ----------
    inputs, outputs : sequence of str
        Files. A pipe, a device or "-" may stand for several.

    Raises
    ------
    Error
        Which two are one file.
    """
    for i, output in enumerate(outputs):
        if output == "-" or _irregular(output):
            continue
        for other in inputs:
            if _is_same(output, other):
                raise Error('error: output "%s" would replace "%s", which is read; '
                            "give the output another name" % (output, other))
        for other in outputs[:i]:
            if _is_same(output, other):
                raise Error('error: outputs "%s" and "%s" are one file; give one of them another name'
                            % (other, output))


def _is_same(a: str, b: str) -> bool:
    if os.path.exists(a) and os.path.exists(b):
        return os.path.samefile(a, b)
    return os.path.realpath(a) == os.path.realpath(b)
