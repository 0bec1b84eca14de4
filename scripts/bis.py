"""bis from Python: pictures, maps, alias tables and materials as numpy arrays. One file; it needs numpy and libbis.so.

    import bis
    picture, stats = bis.render("scene.txt", integrator="sir", spp=16)     # (h, w, 3) float32, dict
    w, L, pdf = bis.Envmap("map.hdr").sample(1000)                         # (n, 3), (n, 3), (n,)

The library is that of the environment variable BIS_LIBRARY, else a libbis.so beside this file, in build/release/library of
the repository, or where the system looks for libraries. A mistake raises bis.Error with the library's own message;
warnings of the library become Python's. docs/library.md explains the functions.
"""
import ctypes
import ctypes.util
import glob
import json
import operator
import os
import threading
import warnings

import numpy as np

__all__ = ["Error", "AliasTable", "Envmap", "Material", "render", "version"]


class Error(Exception):
    """A message of the library. status is 1 for a failure of the disk, 2 for no memory, 3 for a mistake in the input."""

    def __init__(self, message, status=3):
        super().__init__(message)
        self.status = status


def _load():
    here = os.path.dirname(os.path.abspath(__file__))
    found = [os.environ["BIS_LIBRARY"]] if os.environ.get("BIS_LIBRARY") else (
        sorted(glob.glob(os.path.join(here, "libbis.so*")))
        + sorted(glob.glob(os.path.join(here, "..", "build", "release*", "library", "libbis.so.*")))
        + [ctypes.util.find_library("bis") or "libbis.so"])
    try:
        library = ctypes.CDLL(found[0])
        library.bis_flat_version.restype = ctypes.c_char_p
        return library
    except (OSError, AttributeError) as e:
        raise ImportError("bis.py finds no usable libbis.so (%s): run `make install`, or set BIS_LIBRARY to its path" % e) from None


_library = _load()
_P, _N, _D = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_double


def _declare(name, *arguments, result=ctypes.c_int):
    f = getattr(_library, "bis_flat_" + name)
    f.argtypes, f.restype = list(arguments), result
    return f


_S = (ctypes.c_char_p, _N)  # the buffer of messages and its size
_light_open = _declare("light_open", _P, ctypes.c_char_p, ctypes.c_char_p, _D, *_S)
_light_close = _declare("light_close", _P, result=None)
_light_shape = _declare("light_shape", _P, _P, result=None)
_light_pixels = _declare("light_pixels", _P, _P, result=None)
_light_power = _declare("light_power", _P, result=_D)
_light_sample = _declare("light_sample", _P, _N, _P, _P, _P, _P, *_S)
_light_look = _declare("light_look", _P, _N, _P, _P, _P, *_S)
_alias_build = _declare("alias_build", _N, _P, _P, _P, _P, *_S)
_alias_sample = _declare("alias_sample", _N, _P, _P, _N, _P, _P, *_S)
_bsdf_open = _declare("bsdf_open", _P, ctypes.c_char_p, _P, _P, _D, _P, _P, *_S)
_bsdf_close = _declare("bsdf_close", _P, result=None)
_bsdf_sample = _declare("bsdf_sample", _P, _N, _P, _P, _P, *_S)
_bsdf_look = _declare("bsdf_look", _P, _N, _P, _P, _P, *_S)
_render = _declare("render", _P, ctypes.c_char_p, _P, _P, *_S)
_picture_close = _declare("picture_close", _P, result=None)
_picture_shape = _declare("picture_shape", _P, _P, result=None)
_picture_pixels = _declare("picture_pixels", _P, _P, result=None)
_picture_stats = _declare("picture_stats", _P, result=ctypes.c_char_p)


def _run(f, *arguments):
    """Status and messages of a call."""
    say = ctypes.create_string_buffer(1 << 14)
    status = f(*arguments, say, len(say))
    return status, say.value.decode("utf-8", "replace")


def _judge(status, text):
    if status:
        raise Error(text, status)
    if text:
        warnings.warn(text, stacklevel=4)


def _call(f, *arguments):
    _judge(*_run(f, *arguments))


def _array(a, columns, dtype):
    """a as a dense array (n, columns), or (n,) for columns = 0. The sizes are checked here, because C cannot see them."""
    a = np.ascontiguousarray(a, dtype)
    if columns and (a.ndim != 2 or a.shape[1] != columns):
        raise Error("an array has the shape %s: give (n, %d)" % (a.shape, columns))
    if not columns and a.ndim != 1:
        raise Error("an array has the shape %s: give (n,)" % (a.shape,))
    return a


def _bytes(name, text):
    """A path or a name as bytes. NUL would end it in C, so that another file would be opened than the one given."""
    try:
        text = os.fsencode(text)
    except TypeError:
        raise Error("%s is %r: give a text" % (name, text)) from None
    if b"\0" in text:
        raise Error("%s holds a NUL: give a text without" % name)
    return text


def _numbers(n, columns, seed, u):
    """Random numbers (n, columns): those that the caller gives, or numpy's."""
    if (n is None) == (u is None):
        raise Error("give n (how many) or u (random numbers), one of both")
    if n is None:
        return _array(u, columns, np.float64)
    try:
        count, seed = operator.index(n), operator.index(seed)
    except TypeError:
        raise Error("n is %r and seed is %r: give integers" % (n, seed)) from None
    if not 0 <= count < 1 << 40:
        raise Error("n is %s: give a count >= 0" % n)
    if not 0 <= seed < 1 << 53:
        raise Error("seed is %s: give an integer in [0, 9007199254740991]" % seed)
    return np.random.default_rng(seed).random((count, columns) if columns else count)


def _shape(f, handle):
    shape = (ctypes.c_int * 2)()
    f(handle, shape)
    return shape[1], shape[0]


def version():
    """The version of the library, "0.1.0"."""
    return _library.bis_flat_version().decode()


class _Handle:
    """What the library has made, and frees with the object."""

    _handle = _close = None

    def __copy__(self):
        """The object itself: a second one with its handle would free it again, and nothing in it ever changes."""
        return self

    def __deepcopy__(self, memo):
        return self

    def __del__(self):
        if self._handle:
            type(self)._close(self._handle)
            self._handle = None


class Envmap(_Handle):
    """A map, in its own frame with z up. table is "alias" or "cdf"; area_exponent is b of thesis 3.4."""

    _close = staticmethod(_light_close)

    def __init__(self, path, table="alias", area_exponent=0.15):
        handle = _P()
        _call(_light_open, ctypes.byref(handle), _bytes("path", path), _bytes("table", table), area_exponent)
        self._handle = handle
        self.shape = _shape(_light_shape, handle)

    @property
    def pixels(self):
        """A copy of the radiance, (h, w, 3), row 0 at +z."""
        a = np.empty(self.shape + (3,), np.float32)
        _light_pixels(self._handle, a.ctypes.data)
        return a

    @property
    def power(self):
        """The integral of r+g+b over the sphere."""
        return _light_power(self._handle)

    def sample(self, n=None, seed=0, u=None):
        """Directions (n, 3), radiance (n, 3) and density (n,) in 1/sr, drawn by the importance. u: (n, 4) in [0, 1)."""
        u = _numbers(n, 4, seed, u)
        w, L, pdf = np.empty((len(u), 3), np.float32), np.empty((len(u), 3), np.float32), np.empty(len(u))
        _call(_light_sample, self._handle, len(u), u.ctypes.data, w.ctypes.data, L.ctypes.data, pdf.ctypes.data)
        return w, L, pdf

    def look(self, w):
        """Radiance (n, 3) and density (n,) in 1/sr at directions w (n, 3)."""
        w = _array(w, 3, np.float32)
        L, pdf = np.empty((len(w), 3), np.float32), np.empty(len(w))
        _call(_light_look, self._handle, len(w), w.ctypes.data, L.ctypes.data, pdf.ctypes.data)
        return L, pdf


class AliasTable:
    """The two tables of thesis 3.2.2 for some weights: prob and alias, and their sum, total."""

    def __init__(self, weights):
        w = _array(weights, 0, np.float64)
        self.prob, self.alias = np.empty(len(w)), np.empty(len(w), np.uint32)
        total = _D()
        _call(_alias_build, len(w), w.ctypes.data, self.prob.ctypes.data, self.alias.ctypes.data, ctypes.byref(total))
        self.total = total.value

    def sample(self, n=None, seed=0, u=None):
        """Items (n,). u: (n,) in [0, 1)."""
        if np.asarray(self.alias).dtype.kind not in "iu" or np.any(np.asarray(self.alias) < 0):
            raise Error("alias holds what is no item: give integers >= 0")
        prob, alias = _array(self.prob, 0, np.float64), _array(self.alias, 0, np.uint32)
        if len(prob) != len(alias):
            raise Error("prob has %d items and alias has %d" % (len(prob), len(alias)))
        u = _numbers(n, 0, seed, u)
        items = np.empty(len(u), np.uint32)
        _call(_alias_sample, len(prob), prob.ctypes.data, alias.ctypes.data, len(u), u.ctypes.data, items.ctypes.data)
        return items


class Material(_Handle):
    """A material at a point, seen from wo. Give exponent for Phong's model, or roughness for microfacets (GGX)."""

    _close = staticmethod(_bsdf_close)

    def __init__(self, Kd, Ks, exponent=None, roughness=None, normal=(0, 0, 1), wo=(0, 0, 1)):
        if (exponent is None) == (roughness is None):
            raise Error("give exponent (Phong) or roughness (microfacets), one of both")
        model, width = ("phong", exponent) if roughness is None else ("microfacet", roughness)
        colours = [np.ascontiguousarray(np.broadcast_to(np.asarray(k, np.float64), 3)) for k in (Kd, Ks)]
        vectors = [_array([v], 3, np.float64) for v in (normal, wo)]
        handle = _P()
        _call(_bsdf_open, ctypes.byref(handle), model.encode(), colours[0].ctypes.data, colours[1].ctypes.data, width,
              vectors[0].ctypes.data, vectors[1].ctypes.data)
        self._handle = handle

    def sample(self, n=None, seed=0, u=None):
        """Directions (n, 3), and (n,) whether each is of the specular lobe. u: (n, 3) in [0, 1). Some are below the horizon."""
        u = _numbers(n, 3, seed, u)
        wi, lobe = np.empty((len(u), 3), np.float32), np.empty(len(u), np.uint8)
        _call(_bsdf_sample, self._handle, len(u), u.ctypes.data, wi.ctypes.data, lobe.ctypes.data)
        return wi, lobe.astype(bool)

    def look(self, wi):
        """f (n, 3) in 1/sr without the cosine, and the density (n,) of drawing the directions wi (n, 3)."""
        wi = _array(wi, 3, np.float32)
        f, pdf = np.empty((len(wi), 3), np.float32), np.empty(len(wi))
        _call(_bsdf_look, self._handle, len(wi), wi.ctypes.data, f.ctypes.data, pdf.ctypes.data)
        return f, pdf


def _text(value):
    return str(value).lower() if isinstance(value, (bool, np.bool_)) else str(value)


def render(scene, **settings):
    """Render a scene: the picture (h, w, 3), and the figures of `bis --stats` as a dict.

    Settings are integrator, accelerator, spp, seed, seconds, error, threads, width, height, and the parameters of the
    integrator, as in render("scene.txt", integrator="sir", candidates=256, spp=16). Ctrl-C ends the render."""
    texts = [_bytes("a setting", "%s=%s" % (name, _text(value))) for name, value in settings.items()]
    path = _bytes("scene", scene)
    wanted = (ctypes.c_char_p * (len(texts) + 1))(*texts, None)
    handle, stop, said = _P(), ctypes.c_int(0), []

    # In a thread of its own, because Python hears of Ctrl-C only between calls.
    worker = threading.Thread(target=lambda: said.append(_run(_render, ctypes.byref(handle), path, wanted, ctypes.byref(stop))))
    worker.start()
    try:
        while worker.is_alive():
            worker.join(0.1)
    except BaseException:
        stop.value = 1
        worker.join()
        _picture_close(handle)
        raise
    _judge(*said[0])
    try:
        rgba = np.empty(_shape(_picture_shape, handle) + (4,), np.float32)
        _picture_pixels(handle, rgba.ctypes.data)
        return np.ascontiguousarray(rgba[:, :, :3]), json.loads(_picture_stats(handle).decode())
    finally:
        _picture_close(handle)
