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
from ._library import TEXT, Doubles, Floats, Handle, array, call, flat, in_range, judge, opened
from ._library import run, text_bytes, whole
from ._render import Scene, settings_of, sky_of, wait


Flags = NDArray[np.bool_]


class Radiance(NamedTuple):
    """An estimate of radiance by colour."""

    rgb: Doubles  #: (3,)
    standard_error: Doubles  #: of each
    sum: float  #: of the colours
    sum_standard_error: float


def _radiance(value: Doubles) -> Radiance:
    """From mean[4] and se[4] of the library."""
    return Radiance(value[0:3], value[4:7], float(value[3]), float(value[7]))


@dataclass(frozen=True)
class Exact:
    """What is exact at a point."""

    lit: Radiance  #: eq. 4.1 of the thesis
    unoccluded: Radiance  #: without visibility, eq. 4.5
    #: by a sum over the patches of the light; else by a long run of `mis`, for too many patches
    by_patches: bool
    patches: int  #: of the light
    rays: int  #: of the sum
    #: (3,) of F V/q, r+g+b, of one direction that is drawn by q_L, by q_f, or by their mean; known
    #: by patches
    variance: Doubles
    third: Doubles  #: the third central moment of the same


@dataclass(frozen=True)
class Runs:
    """Many estimates by one method."""

    estimates: Floats  #: (n, 3)
    mean: Radiance
    #: the difference of the mean from what is exact (of a method without shadows: from
    #: `unoccluded`), r+g+b, in standard errors. NaN where nothing scatters
    z: float
    skewness: float  #: of the mean, from the estimates
    #: the same of em, brdf and mis by the moments of `Exact`, as if all directions were
    #: independent; else NaN. Where either is beyond 0.1, rare and bright estimates make z unlike
    #: that of a normal distribution
    true_skewness: float
    #: root mean square difference of one estimate from what is exact, over that; NaN: that is 0
    relative_error: float
    rays: float  #: shadow rays of one estimate
    accepted: float  #: candidates of rejection, of one estimate


@dataclass(frozen=True)
class Candidates:
    """One estimate by sir, taken apart (thesis 4.4)."""

    wi: Floats  #: (M, 3) the directions
    weight: Doubles  #: (M,) product over q
    from_map: Flags  #: (M,) from the map; else from the BRDF
    chosen: NDArray[np.uint32]  #: (M,) how often
    seen: Flags  #: (M,) chosen, and nothing hides the light
    #: (M,) the densities of both proposals and of their mixture: NaN where the weight is 0
    q_map: Doubles
    q_brdf: Doubles
    q: Doubles
    product: Doubles  #: (M,) f cos Le, r+g+b: 0 where the weight is 0
    shadowrays: int  #: N
    weights: float  #: their sum
    squared_weights: float
    effective_sample_size: float
    largest_share: float
    share_of_map: float  #: beta of the mixture; NaN where nothing has a weight
    n_map: int  #: candidates of the map
    positive: int  #: those with a weight
    distinct: int  #: those that were chosen
    n_seen: int  #: choices that see the light
    estimate: Doubles  #: (3,) of eq. 4.1
    estimate_unoccluded: Doubles  #: (3,) of eq. 4.5


class Rays(NamedTuple):
    """The shadow rays of some estimates."""

    wi: Floats  #: (n, 3) their directions
    sample: NDArray[np.uint32]  #: (n,) the camera sample that cast each
    seen: Flags  #: (n,) whether it reached the light


class Densities(NamedTuple):
    """What lies in given directions, (n,) each, in 1/sr."""

    q_map: Doubles  #: eq. 4.2
    q_brdf: Doubles  #: eq. 4.3
    product: Doubles  #: f cos Le, r+g+b: eq. 4.4 without its divisor


class Sphere(NamedTuple):
    """Fields over all directions, (rows, columns) in the frame of the light, row 0 at +z."""

    q_map: Floats  #: the density of the map
    f_cos: Floats  #: f cos, r+g+b
    product: Floats  #: f cos Le, r+g+b
    seen: Floats  #: what of the product nothing hides


class BestWeights(NamedTuple):
    """What multiple importance sampling reaches (docs/theory.md, "The best weights")."""

    mean: float  #: of one estimate, r+g+b
    balance: float  #: its standard deviation by the balance heuristic
    best: float  #: and by the best weights
    beta: float  #: of the best weights
    overlap: float  #: of the two densities, in [0, 1]


class Noises(NamedTuple):
    """The two noises of sir (docs/errata.md E31). Their squares add up to that of the whole."""

    mean: float  #: of one estimate, r+g+b
    deviation: float  #: the standard deviation of one estimate
    of_candidates: float  #: the part of it by the candidates
    of_choice: float  #: and by the choice among them
    rays: float  #: of one estimate


class Acceptance(NamedTuple):
    """Candidates held against the bound of rejection."""

    height: Doubles  #: (n,) u times the bound
    taken: Flags  #: (n,) whether it lies below the weight


def _number(text: str) -> Any:
    """An integer of JSON. -0 is one of a double, whose sign an int would lose."""
    return -0.0 if text == "-0" else int(text)


def _seed(seed: Any, bits: int = 64) -> int:
    return in_range("seed", seed, 0, (1 << bits) - 1)


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

    _close = staticmethod(flat.stage_close)
    _made = ("_handle", "_scene")

    def __init__(self, scene: Scene, light: Any = None) -> None:
        if not isinstance(scene, Scene):
            raise WrongType("scene is %r: give a bis.Scene" % (scene,))
        sky = sky_of(light)
        self._handle = opened(flat.stage_of, scene._handle, sky and sky._handle)
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
        call(flat.stage_at, self._handle, whole("x", x), whole("y", y), found)
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
        call(flat.stage_about, self._handle, ctypes.byref(text))
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
        self._patiently(flat.stage_truth, _seed(seed), value, moments, count)
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
        count = in_range("n", n, 2, 10**8)
        if not self.__dict__.get("_knows"):
            self.exact()
        stop = ctypes.c_int(0)
        estimates, value, figures = np.empty((count, 3), np.float32), np.empty(8), np.empty(6)
        self._patiently(flat.stage_method, settings_of(settings), _seed(seed), count,
                        ctypes.byref(stop), estimates, value, figures, stop=stop)
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
        texts, room = settings_of(dict({"integrator": "sir"}, **settings)), 1 << 12
        while True:
            wi, w, total = np.empty((room, 3), np.float32), np.empty(room), np.empty(17)
            counts = np.empty((room, 3), np.uint32)
            status, said = run(flat.stage_estimate, self._handle, texts, _seed(seed), room, wi, w,
                               counts, total)
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
        texts, n = settings_of(settings), ctypes.c_size_t(1 << 12)
        count = in_range("runs", runs, 0, 1 << 20)
        room = 0
        while n.value > room:
            room = n.value
            wi, which = np.empty((room, 3), np.float32), np.empty((room, 2), np.uint32)
            call(flat.stage_rays, self._handle, texts, _seed(seed), count, room, wi, which,
                 ctypes.byref(n))
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
        call(flat.stage_look, self._handle, len(wi), wi, density)
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
        call(flat.stage_sees, self._handle, len(wi), wi, seen)
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
        call(flat.stage_angles, self._handle, len(wi), wi, angle)
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
        self._patiently(flat.stage_sphere, *shape, field)
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
        return BestWeights(*self._measured(flat.stage_mis, "mis", n, seed, settings))

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
        return Noises(*self._measured(flat.stage_noises, "sir", n, seed, settings))

    def _measured(self, f: Any, integrator: str, n: int, seed: int,
                  settings: dict[str, Any]) -> list[float]:
        found = np.empty(5)
        self._patiently(f, settings_of({"integrator": integrator, **settings}), _seed(seed, 32),
                        whole("n", n), found)
        return found.tolist()

    def bounds(self) -> dict[str, float]:
        """Compute the bounds of rejection (figure 4.4).

        Returns
        -------
        dict
            "em" and "brdf": no weight of that proposal is larger.
        """
        bound = np.empty(2)
        call(flat.stage_bounds, self._handle, bound)
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
        height, taken = np.empty(len(w)), np.empty(len(w), np.uint32)
        call(flat.stage_accept, self._handle, text_bytes("proposal", proposal), len(w), w, numbers,
             height, taken, np.empty(1, np.uint32))
        return Acceptance(height, taken > 0)

    def _patiently(self, f: Any, *arguments: Any, stop: Optional[ctypes.c_int] = None) -> None:
        """Call a function that may take long, in a thread: Python hears of Ctrl-C between calls."""
        said: list[tuple[int, str]] = []
        wait(lambda: said.append(run(f, self._handle, *arguments)),
             ctypes.c_int() if stop is None else stop)
        judge(*said[0])
