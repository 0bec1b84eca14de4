# SPDX-License-Identifier: BSD-2-Clause
"""One point of a scene: what is exact there, what each method makes of it, and where it looks."""
from __future__ import annotations

import ctypes
import json
from dataclasses import dataclass
from typing import Any, NamedTuple, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import Error, WrongType
from ._library import D, INT, N, P, SAY, TEXT, Handle, array, call, declare, judge, run
from ._library import text_bytes, whole
from ._render import Scene, _list, _said, _wait
from ._sampling import Envmap

U64, U32 = ctypes.c_uint64, ctypes.c_uint32
_of = declare("stage_of", P, P, P, *SAY)
_close = declare("stage_close", P, result=None)
_at = declare("stage_at", P, INT, INT, P, *SAY)
_about = declare("stage_about", P, P, *SAY)
_truth = declare("stage_truth", P, U64, P, P, P, *SAY)
_method = declare("stage_method", P, P, U64, N, P, P, P, P, *SAY)
_estimate = declare("stage_estimate", P, P, U64, N, P, P, P, P, *SAY)
_rays = declare("stage_rays", P, P, U64, U32, N, P, P, P, *SAY)
_look = declare("stage_look", P, N, P, P, *SAY)
_sees = declare("stage_sees", P, N, P, P, *SAY)
_angles = declare("stage_angles", P, N, P, P, *SAY)
_sphere = declare("stage_sphere", P, INT, INT, INT, P, *SAY)
_mis = declare("stage_mis", P, P, U32, N, P, *SAY)
_noises = declare("stage_noises", P, P, U32, N, P, *SAY)
_bounds = declare("stage_bounds", P, P, *SAY)
_accept = declare("stage_accept", P, TEXT, N, P, P, P, P, P, *SAY)

Floats = NDArray[np.float32]
Doubles = NDArray[np.float64]
Flags = NDArray[np.bool_]


class Radiance(NamedTuple):
    """An estimate of radiance by colour.

    Parameters
    ----------
    rgb : array (3,)
        Red, green, blue.
    standard_error : array (3,)
        Of each.
    sum : float
        Their sum.
    sum_standard_error : float
        Of the sum.
    """

    rgb: Doubles
    standard_error: Doubles
    sum: float
    sum_standard_error: float


def _radiance(value: Doubles) -> Radiance:
    """From mean[4] and se[4] of the library."""
    return Radiance(value[0:3], value[4:7], float(value[3]), float(value[7]))


@dataclass(frozen=True)
class Exact:
    """What is exact at a point.

    Attributes
    ----------
    lit, unoccluded : Radiance
        Eq. 4.1 of the thesis, and without visibility, eq. 4.5.
    by_patches : bool
        By a sum over the patches of the light; else by a long run of `mis`, for a light of too many
        patches.
    patches, rays : int
        Of the light; of the sum.
    variance, third : array (3,)
        Variance and third central moment of F V/q, r+g+b, of one direction that is drawn by q_L, by
        q_f, or by their mean. They are known by patches.
    """

    lit: Radiance
    unoccluded: Radiance
    by_patches: bool
    patches: int
    rays: int
    variance: Doubles
    third: Doubles


@dataclass(frozen=True)
class Runs:
    """Many estimates by one method.

    Attributes
    ----------
    estimates : array (n, 3)
        Each of them.
    mean : Radiance
        Their mean and its standard error.
    z : float
        The difference of the mean from what is exact (of a method without shadows: from
        `unoccluded`), r+g+b, in standard errors. NaN where nothing scatters.
    skewness : float
        Of the mean, from the estimates.
    true_skewness : float
        The same of em, brdf and mis by the moments of `Exact`, as if all directions were
        independent; else NaN. Where either is beyond 0.1, rare and bright estimates make z unlike
        that of a normal distribution.
    relative_error : float
        The root mean square difference of one estimate from what is exact, over that; NaN where
        that is 0.
    rays, accepted : float
        Shadow rays, and accepted candidates of rejection, of one estimate.
    """

    estimates: Floats
    mean: Radiance
    z: float
    skewness: float
    true_skewness: float
    relative_error: float
    rays: float
    accepted: float


@dataclass(frozen=True)
class Candidates:
    """One estimate by sir, taken apart (thesis 4.4).

    Attributes
    ----------
    wi : array (M, 3)
        The directions.
    weight : array (M,)
        Product over q.
    from_map : array (M,) of bool
        From the map; else from the BRDF.
    chosen : array (M,) of int
        How often.
    seen : array (M,) of bool
        Chosen, and nothing hides the light.
    q_map, q_brdf, q, product : array (M,)
        The densities of both proposals, that of their mixture, and f cos Le, r+g+b. Where the
        weight is 0 the three densities are NaN and the product is 0.
    shadowrays : int
        N.
    weights, squared_weights, effective_sample_size, largest_share : float
        Sums over the weights, and what follows from them.
    share_of_map : float
        beta of the mixture; NaN where nothing has a weight.
    n_map, positive, distinct, n_seen : int
        Candidates of the map, those with a weight, those that were chosen; choices that see the
        light.
    estimate, estimate_unoccluded : array (3,)
        Of eq. 4.1 and 4.5.
    """

    wi: Floats
    weight: Doubles
    from_map: Flags
    chosen: NDArray[np.uint32]
    seen: Flags
    q_map: Doubles
    q_brdf: Doubles
    q: Doubles
    product: Doubles
    shadowrays: int
    weights: float
    squared_weights: float
    effective_sample_size: float
    largest_share: float
    share_of_map: float
    n_map: int
    positive: int
    distinct: int
    n_seen: int
    estimate: Doubles
    estimate_unoccluded: Doubles


class Rays(NamedTuple):
    """The shadow rays of some estimates.

    Parameters
    ----------
    wi : array (n, 3)
        Their directions.
    sample : array (n,) of int
        The camera sample that cast each.
    seen : array (n,) of bool
        Whether it reached the light.
    """

    wi: Floats
    sample: NDArray[np.uint32]
    seen: Flags


class Densities(NamedTuple):
    """What lies in given directions, in 1/sr.

    Parameters
    ----------
    q_map, q_brdf : array (n,)
        The densities of the proposals, eq. 4.2 and 4.3.
    product : array (n,)
        f cos Le, r+g+b; eq. 4.4 without its divisor.
    """

    q_map: Doubles
    q_brdf: Doubles
    product: Doubles


class Sphere(NamedTuple):
    """Fields over all directions, (rows, columns) in the frame of the light, row 0 at +z.

    Parameters
    ----------
    q_map : array
        The density of the map.
    f_cos : array
        f cos, r+g+b.
    product : array
        f cos Le, r+g+b.
    seen : array
        What of the product nothing hides.
    """

    q_map: Floats
    f_cos: Floats
    product: Floats
    seen: Floats


class BestWeights(NamedTuple):
    """What multiple importance sampling reaches (docs/theory.md, "The best weights").

    Parameters
    ----------
    mean : float
        Of one estimate, r+g+b.
    balance, best : float
        Its standard deviation by the balance heuristic, and by the best weights.
    beta : float
        Of the best weights.
    overlap : float
        Of the two densities, in [0, 1].
    """

    mean: float
    balance: float
    best: float
    beta: float
    overlap: float


class Noises(NamedTuple):
    """The two noises of sir (docs/errata.md E31).

    Parameters
    ----------
    mean : float
        Of one estimate, r+g+b.
    deviation : float
        The standard deviation of one estimate.
    of_candidates, of_choice : float
        The parts of it by the candidates and by the choice among them. Their squares add up to that
        of the whole.
    rays : float
        Of one estimate.
    """

    mean: float
    deviation: float
    of_candidates: float
    of_choice: float
    rays: float


class Acceptance(NamedTuple):
    """Candidates held against the bound of rejection.

    Parameters
    ----------
    height : array (n,)
        u times the bound.
    taken : array (n,) of bool
        Whether it lies below the weight.
    """

    height: Doubles
    taken: Flags


def _number(text: str) -> Any:
    """An integer of JSON. -0 is one of a double, whose sign an int would lose."""
    return -0.0 if text == "-0" else int(text)


def _texts(settings: dict[str, Any]) -> Any:
    """Settings of an integrator as the library takes them."""
    return _list(_said(None, None, None, None, settings))


def _seed(seed: Any) -> int:
    value = whole("seed", seed)
    if not 0 <= value < 1 << 64:
        raise Error("seed is %s: give an integer in [0, 18446744073709551615]" % seed)
    return value


def _seed32(seed: Any) -> int:
    value = whole("seed", seed)
    if not 0 <= value < 1 << 32:
        raise Error("seed is %s: give an integer in [0, 4294967295]" % seed)
    return value


class Stage(Handle):
    """One point of a scene: that which the centre of a pixel sees.

    Choose it with `at`. Where the pixel sees no surface, `about` says so, and the other methods
    raise an `Error`. A seed is an integer in [0, 2^64 - 1]; the same seed gives the same numbers,
    for any number of threads.

    Parameters
    ----------
    scene : Scene
        It may be rendered meanwhile, and have other stages.
    light : Envmap, path or array (h, w, 3), optional
        A map in the place of the scene's light.
    """

    _close = staticmethod(_close)
    _made = ("_handle", "_scene")

    def __init__(self, scene: Scene, light: Any = None) -> None:
        if not isinstance(scene, Scene):
            raise WrongType("scene is %r: give a bis.Scene" % (scene,))
        sky = light if light is None or isinstance(light, Envmap) else Envmap(light)
        handle = P()
        call(_of, ctypes.byref(handle), scene._handle, sky and sky._handle)
        self._handle = handle
        self._scene = scene  # the library looks at it

    def at(self, x: int, y: int) -> bool:
        """Choose the pixel whose centre sees the point.

        Parameters
        ----------
        x, y : int
            From the left and from the top, from 0.

        Returns
        -------
        bool
            Whether it sees a surface.
        """
        found = np.empty(8)
        call(_at, self._handle, whole("x", x), whole("y", y), found.ctypes.data)
        return bool(found[0])

    def about(self) -> dict[str, Any]:
        """Tell what is known of the pixel without a random number.

        Returns
        -------
        dict
            scene, light, width, height, seed, sampler, x, y; hit (None: no surface) with the shape,
            its file and line, the triangle, the point, the normals and the material; uv; lobe, the
            name and value of what the width of the material's lobe is; nothing, why nothing is
            reflected, or None; radiance, what the camera sees then; methods, those worth a run,
            with the numbers of the scene's integrator.
        """
        text = TEXT()
        call(_about, self._handle, ctypes.byref(text))
        return json.loads((text.value or b"").decode("utf-8"), parse_int=_number)

    def exact(self, seed: int = 0) -> Exact:
        """Compute what is exact at the point, with its error.

        Parameters
        ----------
        seed : int
            Of the random numbers within the patches.

        Returns
        -------
        Exact
            By colour, with and without visibility.
        """
        value, moments, count = np.empty((2, 8)), np.empty((2, 3)), np.empty(3, np.uint64)
        self._patiently(ctypes.c_int(0), _truth, _seed(seed), value.ctypes.data,
                        moments.ctypes.data, count.ctypes.data)
        self._knows = True
        return Exact(_radiance(value[0]), _radiance(value[1]), bool(count[0]), int(count[1]),
                     int(count[2]), moments[0], moments[1])

    def runs(self, n: int = 2000, seed: int = 0, **settings: Any) -> Runs:
        """Make many estimates by one method and hold them against what is exact.

        The exact value is that of the last call of `exact`; without one, that is called first.
        Ctrl-C ends the work.

        Parameters
        ----------
        n : int
            How many, in [2, 1e8].
        seed : int
            Of the random numbers.
        **settings
            integrator and its parameters (`bis help integrators`); what they do not say is as in
            the scene.

        Returns
        -------
        Runs
            The estimates and their figures.
        """
        count = whole("n", n)
        if not 2 <= count <= 10**8:
            raise Error("n is %s: give an integer in [2, 100000000]" % n)
        if not self.__dict__.get("_knows"):
            self.exact()
        stop = ctypes.c_int(0)
        estimates, value, figures = np.empty((count, 3), np.float32), np.empty(8), np.empty(6)
        self._patiently(stop, _method, _texts(settings), _seed(seed), count, ctypes.byref(stop),
                        estimates.ctypes.data, value.ctypes.data, figures.ctypes.data)
        return Runs(estimates, _radiance(value), *figures.tolist())

    def candidates(self, seed: int = 0, **settings: Any) -> Candidates:
        """Make one estimate by sir and take it apart.

        With the seed of a scene it is that of the first camera sample of the pixel in a render
        whose samples go through the pixels' centres.

        Parameters
        ----------
        seed : int
            Of the random numbers.
        **settings
            Of integrator sir; what they do not say is as in the scene.

        Returns
        -------
        Candidates
            Arrays, and the figures that follow from them.
        """
        texts, room = _texts(dict({"integrator": "sir"}, **settings)), 1 << 12
        while True:
            wi, w, total = np.empty((room, 3), np.float32), np.empty(room), np.empty(17)
            counts = np.empty((room, 3), np.uint32)
            status, said = run(_estimate, self._handle, texts, _seed(seed), room, wi.ctypes.data,
                               w.ctypes.data, counts.ctypes.data, total.ctypes.data)
            if status and "do not fit into arrays" in said and room < 1 << 32:
                room *= 16
                continue
            judge(status, said)
            break
        m = int(total[0])
        wi, w, counts = wi[:m], w[:m], counts[:m]
        weighs = w > 0
        densities = np.full((m, 3), np.nan)
        densities[:, 2] = 0
        densities[weighs] = np.stack(self.look(wi[weighs]), axis=1)
        q = np.full(m, np.nan)
        q[weighs] = densities[weighs, 2] / w[weighs]
        return Candidates(wi, w, counts[:, 0] > 0, counts[:, 1], counts[:, 2] > 0,
                          densities[:, 0], densities[:, 1], q, densities[:, 2], int(total[1]),
                          *total[2:7].tolist(), *[int(x) for x in total[7:11]],
                          total[11:14], total[14:17])

    def rays(self, runs: int = 1, seed: int = 0, **settings: Any) -> Rays:
        """Write down the shadow rays of estimates by any method.

        Parameters
        ----------
        runs : int
            How many estimates, in [0, 2^20]: camera samples 0 to runs - 1 of the pixel.
        seed : int
            Of the random numbers.
        **settings
            integrator and its parameters; what they do not say is as in the scene.

        Returns
        -------
        Rays
            In the order in which they were cast.
        """
        count, texts, n = whole("runs", runs), _texts(settings), ctypes.c_size_t(1 << 12)
        if not 0 <= count <= 1 << 20:
            raise Error("runs is %s: give an integer in [0, 1048576]" % runs)
        room = 0
        while n.value > room:
            room = n.value
            wi, which = np.empty((room, 3), np.float32), np.empty((room, 2), np.uint32)
            call(_rays, self._handle, texts, _seed(seed), count, room, wi.ctypes.data,
                 which.ctypes.data, ctypes.byref(n))
        return Rays(wi[:n.value], which[:n.value, 0], which[:n.value, 1] > 0)

    def look(self, wi: ArrayLike) -> Densities:
        """Look at the densities of directions.

        Parameters
        ----------
        wi : array (n, 3)
            Directions of any length but 0.

        Returns
        -------
        Densities
            Of the map, of the BRDF, and the product.
        """
        wi = array(wi, 3, np.float32, "wi")
        density = np.empty((len(wi), 3))
        call(_look, self._handle, len(wi), wi.ctypes.data, density.ctypes.data)
        return Densities(density[:, 0], density[:, 1], density[:, 2])

    def sees(self, wi: ArrayLike) -> Flags:
        """Trace shadow rays.

        Parameters
        ----------
        wi : array (n, 3)
            Directions of any length but 0.

        Returns
        -------
        array (n,) of bool
            Where no surface hides the light.
        """
        wi = array(wi, 3, np.float32, "wi")
        seen = np.empty(len(wi), np.uint8)
        call(_sees, self._handle, len(wi), wi.ctypes.data, seen.ctypes.data)
        return seen > 0

    def angles(self, wi: ArrayLike) -> Doubles:
        """Compute where directions lie in the map.

        Parameters
        ----------
        wi : array (n, 3)
            Directions in world space.

        Returns
        -------
        array (n, 2)
            theta from +z of the map and phi with its columns, in degrees.
        """
        wi = array(wi, 3, np.float32, "wi")
        angle = np.empty((len(wi), 2))
        call(_angles, self._handle, len(wi), wi.ctypes.data, angle.ctypes.data)
        return angle

    def sphere(self, columns: int = 720, rows: int = 360, sub: int = 2) -> Sphere:
        """Look at all directions.

        Parameters
        ----------
        columns, rows : int
            Cells, in [1, 4096].
        sub : int
            A cell has the mean over sub x sub directions in it.

        Returns
        -------
        Sphere
            Four fields.
        """
        shape = [whole(name, v) for name, v in (("columns", columns), ("rows", rows), ("sub", sub))]
        if not all(1 <= v <= 4096 for v in shape):
            raise Error("a sphere of %s x %s cells of %s: give 1 to 4096 each"
                        % (columns, rows, sub))
        field = np.empty((4, shape[1], shape[0]), np.float32)
        self._patiently(ctypes.c_int(0), _sphere, *shape, field.ctypes.data)
        return Sphere(*field)

    def best_weights(self, n: int = 10000, seed: int = 0, **settings: Any) -> BestWeights:
        """Measure what the best weights of multiple importance sampling would reach.

        Parameters
        ----------
        n : int
            Estimates, in [2, 1e6].
        seed : int
            Below 2^32.
        **settings
            Of integrator mis.

        Returns
        -------
        BestWeights
            Of independent samples.
        """
        found = np.empty(5)
        texts = _texts(dict({"integrator": "mis"}, **settings))
        self._patiently(ctypes.c_int(0), _mis, texts, _seed32(seed), whole("n", n),
                        found.ctypes.data)
        return BestWeights(*found.tolist())

    def noises(self, n: int = 1000, seed: int = 0, **settings: Any) -> Noises:
        """Measure the two noises of sir.

        Parameters
        ----------
        n : int
            Estimates, in [2, 1e5].
        seed : int
            Below 2^32.
        **settings
            Of integrator sir.

        Returns
        -------
        Noises
            Of the candidates, and of the choice among them.
        """
        found = np.empty(5)
        texts = _texts(dict({"integrator": "sir"}, **settings))
        self._patiently(ctypes.c_int(0), _noises, texts, _seed32(seed), whole("n", n),
                        found.ctypes.data)
        return Noises(*found.tolist())

    def bounds(self) -> dict[str, float]:
        """Compute the bounds of rejection (figure 4.4).

        Returns
        -------
        dict
            "em" and "brdf": no weight of that proposal is larger.
        """
        bound = np.empty(2)
        call(_bounds, self._handle, bound.ctypes.data)
        return {"em": float(bound[0]), "brdf": float(bound[1])}

    def accept(self, proposal: str, weight: ArrayLike, u: ArrayLike) -> Acceptance:
        """Hold candidates against the bound of their proposal, as rejection does.

        Parameters
        ----------
        proposal : {"em", "brdf"}
            What they were drawn by.
        weight : array (n,)
            Their product over q.
        u : array (n,)
            Random numbers in [0, 1).

        Returns
        -------
        Acceptance
            Where each lies, and whether it is taken.
        """
        w, numbers = array(weight, 0, np.float64, "weight"), array(u, 0, np.float64, "u")
        if len(w) != len(numbers):
            raise Error("weight has %d items and u has %d" % (len(w), len(numbers)))
        height, taken, count = np.empty(len(w)), np.empty(len(w), np.uint32), U32()
        call(_accept, self._handle, text_bytes("proposal", proposal), len(w), w.ctypes.data,
             numbers.ctypes.data, height.ctypes.data, taken.ctypes.data, ctypes.byref(count))
        return Acceptance(height, taken > 0)

    def _patiently(self, stop: ctypes.c_int, f: Any, *arguments: Any) -> None:
        """Call a function that may take long, in a thread: Python hears of Ctrl-C between calls."""
        said: list[tuple[int, str]] = []

        def work() -> None:
            said.append(run(f, self._handle, *arguments))

        _wait(work, stop, [], None)
        judge(*said[0])
