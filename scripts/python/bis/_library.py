# SPDX-License-Identifier: BSD-2-Clause
"""The library: where it is, how its functions are called, how a mistake becomes an exception."""
from __future__ import annotations

import ctypes
import ctypes.util
import glob
import operator
import os
import warnings
from collections.abc import Sequence
from typing import Any, Callable, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import Error, Status, WrongType


def _candidates() -> list[str]:
    """The places of the library, the first one first."""
    here = os.path.dirname(os.path.abspath(__file__))
    build = os.path.join(here, "..", "..", "..", "build")
    if os.environ.get("BIS_LIBRARY"):
        return [os.environ["BIS_LIBRARY"]]
    return [*glob.glob(os.path.join(here, "libbis.so")),
            *glob.glob(build + "/release/library/libbis.so.*"),
            *glob.glob(build + "/release-*/library/libbis.so.*"),
            ctypes.util.find_library("bis") or "libbis.so"]


P, D, INT, TEXT = ctypes.c_void_p, ctypes.c_double, ctypes.c_int, ctypes.c_char_p
Floats = NDArray[np.float32]
Doubles = NDArray[np.float64]

# The letters of bis_flat_signatures that are no pointers; what a status returns is one.
_KINDS: dict[str, Any] = {"i": INT, "s": INT, "n": ctypes.c_size_t, "k": ctypes.c_uint32,
                          "q": ctypes.c_uint64, "r": D, "z": TEXT, "v": None}


class _Flat:
    """The functions bis_flat_NAME of the library, as attributes: what each takes the library tells
    itself."""

    def __init__(self, path: str) -> None:
        self._library = ctypes.CDLL(path)
        signatures = self._library.bis_flat_signatures
        signatures.restype = TEXT
        rows = [row.split() for row in signatures().decode("ascii").splitlines()]
        self._rows = {name: (returned, arguments) for name, returned, *arguments in rows}

    def __getattr__(self, name: str) -> Any:
        if "bis_flat_" + name not in self._rows:
            raise ImportError("the package bis needs another libbis.so than %s (version %s), which "
                              "has no bis_flat_%s: install both from one source"
                              % (self._library._name, version(), name))
        f = self._library["bis_flat_" + name]
        returned, arguments = self._rows["bis_flat_" + name]
        f.argtypes = [_KINDS.get(a.split(":")[1][0], P) for a in arguments]
        if returned[-1] == "s":
            f.argtypes = [*f.argtypes, TEXT, ctypes.c_size_t]
        f.restype = _KINDS[returned[-1]]
        setattr(self, name, f)
        return f


def _load() -> _Flat:
    found = _candidates()[0]
    try:
        library = _Flat(found)
    except (OSError, AttributeError) as e:
        raise ImportError("the package bis finds no usable libbis.so (%s): run `make` in the "
                          "repository or `make install`, or set BIS_LIBRARY to its path"
                          % e) from None
    build = library.build().decode("ascii")
    if os.environ.get("BIS_BUILD_ID", build) != build:
        # `bis trade` measures what that program is: a student's material, not the installed one.
        raise ImportError("%s is of another build than %s: make both, or install both, from one "
                          "source" % (found, os.environ.get("BIS_PROGRAM", "the program")))
    return library


flat = _load()


def version() -> str:
    """Return the version of the library.

    Returns
    -------
    str
        As "0.1.0".
    """
    return str(flat.version(), "ascii")


def run(f: Callable[..., int], *arguments: Any) -> tuple[int, str]:
    """Status and messages of a call, in which an array stands for its address."""
    say = ctypes.create_string_buffer(1 << 12)
    status = f(*[a.ctypes.data if isinstance(a, np.ndarray) else a for a in arguments],
               say, len(say))
    size = flat.said(None, 0)
    if size:
        say = ctypes.create_string_buffer(size)
        flat.said(say, size)
    return status, say.value.decode("utf-8", "replace")


def judge(status: int, text: str) -> None:
    """Raise the messages of a call that failed. Those of one that succeeded are warnings."""
    if status:
        raise Error(text, status)
    if text:
        warnings.warn(text, stacklevel=4)


def call(f: Callable[..., int], *arguments: Any) -> None:
    """Call a function that returns a status."""
    judge(*run(f, *arguments))


def opened(f: Callable[..., int], *arguments: Any) -> ctypes.c_void_p:
    """What such a function opens."""
    handle = P()
    judge(*run(f, ctypes.byref(handle), *arguments))
    return handle


def given(name: str, a: ArrayLike) -> NDArray[Any]:
    """a as an array of numpy. A mask would be lost, and what it hides would count."""
    if any(np.ma.is_masked(part) for part in (a if isinstance(a, (list, tuple)) else (a,))):
        raise Error("%s has masked values: give them a value by .filled(...)" % name)
    return np.asarray(a)


def array(a: ArrayLike, columns: int, dtype: Any, name: str = "an array") -> NDArray[Any]:
    """a as a dense array (n, columns), or (n,) for columns = 0. C cannot see the sizes."""
    raw = given(name, a)
    if raw.dtype.kind not in "iuf" and raw.size:
        raise WrongType("%s holds values of the type %s: give numbers" % (name, raw.dtype))
    a = np.ascontiguousarray(raw, dtype)
    if columns and (a.ndim != 2 or a.shape[1] != columns):
        raise Error("%s has the shape %s: give (n, %d)" % (name, a.shape, columns))
    if not columns and a.ndim != 1:
        raise Error("%s has the shape %s: give (n,)" % (name, a.shape))
    return a


def text_bytes(name: str, text: Any) -> bytes:
    """A path or a name as bytes. A NUL would end it in C, so that another file would be opened
    than the one given."""
    try:
        encoded = os.fsencode(text)
    except TypeError:
        raise WrongType("%s is %r: give a text" % (name, text)) from None
    if b"\0" in encoded:
        raise Error("%s holds a NUL: give a text without" % name)
    return encoded


def whole(name: str, value: Any) -> int:
    """An integer. True is none, although Python counts with it: it is most likely a slip."""
    try:
        if isinstance(value, (bool, np.bool_)):
            raise TypeError
        return operator.index(value)
    except TypeError:
        raise WrongType("%s is %r: give an integer" % (name, value)) from None


def real(name: str, value: Any) -> float:
    """A number. True is none."""
    try:
        if isinstance(value, (bool, np.bool_, str, bytes)):
            raise TypeError
        return float(value)
    except (TypeError, ValueError):
        raise WrongType("%s is %r: give a number" % (name, value)) from None


def in_range(name: str, value: Any, lo: int, hi: int, what: str = "an integer") -> int:
    """An integer in [lo, hi]."""
    number = whole(name, value)
    if not lo <= number <= hi:
        raise Error("%s is %s: give %s in [%d, %d]" % (name, value, what, lo, hi))
    return number


def texts(words: Sequence[bytes]) -> Any:
    """Texts as the library takes a list of them."""
    return (TEXT * (len(words) + 1))(*words, None)


def numbers(n: Optional[int], columns: int, seed: int,
            u: Optional[ArrayLike]) -> NDArray[np.float64]:
    """Random numbers (n, columns): those that the caller gives, or numpy's."""
    if (n is None) == (u is None):
        raise Error("give n (how many) or u (random numbers), one of both")
    if u is not None:
        return array(u, columns, np.float64, "u")
    count = in_range("n", n, 0, (1 << 40) - 1, "a count")
    seed = in_range("seed", seed, 0, (1 << 53) - 1)
    return np.random.default_rng(seed).random((count, columns) if columns else count)


def filled(f: Callable[..., None], handle: Any, size: Any, kind: Any = np.float64) -> NDArray[Any]:
    """An array that the library fills."""
    a = np.empty(size, kind)
    f(handle, a.ctypes.data)
    return a


def shape(f: Callable[..., None], handle: Any) -> tuple[int, int]:
    """Height and width of what the library has made."""
    size = (ctypes.c_int * 2)()
    f(handle, size)
    return size[1], size[0]


class Made:
    """An object whose values __init__ makes. One that was born without it says so, where it would
    have no attribute."""

    _made: tuple[str, ...] = ()

    def __getattr__(self, name: str) -> Any:
        kind = type(self).__name__
        if name in type(self)._made:
            raise WrongType("this %s was never made: call bis.%s(...)" % (kind, kind))
        raise AttributeError("%r object has no attribute %r" % (kind, name))


class Handle(Made):
    """What the library has made, and frees with the object. There is one object for each."""

    _close: Callable[[Any], None]

    def __reduce_ex__(self, protocol: Any) -> Any:
        # copy.copy, copy.deepcopy and pickle all ask here. A second object with the same handle
        # would free it again.
        kind = type(self).__name__
        raise WrongType("a bis.%s cannot be copied or pickled, because it lives in the library: "
                        "use the object itself, or make another one of the same arguments" % kind)

    def __del__(self) -> None:
        handle = self.__dict__.pop("_handle", None)
        if handle:
            type(self)._close(handle)
