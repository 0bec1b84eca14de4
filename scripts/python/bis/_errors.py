# SPDX-License-Identifier: BSD-2-Clause
"""What goes wrong, as exceptions. Without numpy, because `--help` works without it, too."""
from __future__ import annotations

import enum


class Status(enum.IntEnum):
    """What a function of the library returns: a bis_status of bis/base/status.h."""

    OK = 0
    IO = 1  #: a failure of the disk
    NOMEM = 2  #: no memory
    INPUT = 3  #: a mistake in the input


class Error(Exception):
    """A message of the library.

    Attributes
    ----------
    status : Status
        What kind of mistake it is.
    """

    def __init__(self, message: str, status: int = Status.INPUT) -> None:
        super().__init__(message)
        self.status = Status(status)


class WrongType(Error, TypeError):
    """An argument, or an object, of a kind that cannot be used. It is a TypeError, too."""
