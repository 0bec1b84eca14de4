# SPDX-License-Identifier: BSD-2-Clause
"""`bis pixel SCENE X Y`: everything about one pixel, as text or JSON, CSV files and a page."""
from __future__ import annotations

import math
import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Iterator, Optional

from . import text as form
from .._errors import Error, Status
from .command import COUNT, FLAG, NAME, SCENE_NOTE, SEED_MAX, TEXT
from .command import Command, Heading, Option, Say, put, run
from .files import check_writable, outfile
from .scenes import open_scene

if TYPE_CHECKING:
    import numpy as np

    from .._stage import Candidates, Exact, Radiance, Rays, Runs, Stage

COMMAND = Command(
    name="pixel",
    usage="pixel [options] SCENE X Y",
    summary="everything about one pixel: the hit, the exact integral, every method against it; "
            "candidates, weights and samples",
    options=[
        Heading("what to write"),
        Option("output", "DIR",
               "the folder for CSV files and the page, made where it is missing (pixel_X_Y)", TEXT),
        Option("html", None,
               "write pixel.html, too: a page to explore, in one file that needs nothing else",
               FLAG),
        Option("json", None, "print JSON instead of text", FLAG),
        Heading("what to compute (these override the scene file, for all methods)"),
        Option("approximate", None,
               "what of pbrt bis does not model is replaced by the nearest that it does, and "
               "listed", FLAG),
        Option("candidates", "M", "rejection, sir, unoccluded: candidates", COUNT,
               lo=1, hi=1 << 20),
        Option("shadowrays", "N", "rejection, sir: candidates that are shadow-tested", COUNT,
               lo=1, hi=1 << 20),
        Option("samples", "N", "em, brdf, mis: light samples, at least 2", COUNT, lo=2, hi=1 << 20),
        Option("proposal", "P", "sir, unoccluded: em, brdf or mix; sir: product", NAME,
               names=["em", "brdf", "mix", "product"]),
        Option("repeats", "R", "estimates by each method, for its mean and its error (2000)", COUNT,
               lo=2, hi=10**8, default=2000),
        Option("seed", "N", "of the random numbers (the scene's)", COUNT, hi=SEED_MAX),
    ],
    min_operands=3, max_operands=3,
    notes=SCENE_NOTE + """
X counts from the left, Y from the top, both from 0, in the scene's film. The
ray goes through the pixel's centre. The folder gets methods.csv, candidates.csv
and rays.csv; with --html also pixel.html: figure 4.1 of the thesis (map, BRDF,
product), figure 4.2 (where each method looks), and the tables.
""")

MIS_RUNS = 1 << 14  # of the library: they stand in for a sum over too many patches
SHOWN = 4096  # rays of a method, and candidates that were not chosen: 10^6 dots are too many
WIDTH, HEIGHT, DECADES, CODES = 720, 360, 7, 65535  # of the page's sphere
# Beyond, tails at 3 standard errors are off by more than exp(0.1 3^3/6), a factor of 1.6.
TOO_SKEW = 0.1


@dataclass
class Method:
    """A row of the table: what was asked for, what came of it, and some of its shadow rays."""

    name: str
    claim: str
    is_open: bool  # it estimates L_ns
    settings: dict[str, Any]
    found: Runs
    estimates: int = 0  # that cast the rays
    rays: Optional[Rays] = None

    @property
    def is_too_skew(self) -> bool:
        """Whether z is not that of a normal distribution."""
        known = self.found.skewness, self.found.true_skewness
        return any(abs(s) > TOO_SKEW for s in known)  # false for NaN

    @property
    def accepted(self) -> float:
        """Accepted candidates, of a method that accepts some."""
        return self.found.accepted if "estimator" in self.settings else math.nan


@dataclass
class Report:
    """All that is told."""

    stage: Stage
    about: dict[str, Any]
    folder: str
    html: bool
    repeats: int
    exact: Optional[Exact] = None
    methods: list[Method] = field(default_factory=list)
    candidates: Optional[Candidates] = None


# ---- what is found ----

def _hash(x: int) -> int:
    """Mix 64 bits, as bis_hash does (bis/base/hash.h): each part of a report has its own seed."""
    mask = (1 << 64) - 1
    x ^= x >> 30
    x = x * 0xbf58476d1ce4e5b9 & mask
    x ^= x >> 27
    x = x * 0x94d049bb133111eb & mask
    return x ^ x >> 31


def _overridden(settings: dict[str, Any], o: Any) -> dict[str, Any]:
    """A method's settings with the command line's. What does not apply to it applies to others."""
    changed = dict(settings)
    for name in ("candidates", "shadowrays", "samples"):
        if name in o.given and name in settings:
            changed[name] = getattr(o, name)
    if o.proposal and settings["integrator"] == "sir":
        changed["proposal"] = o.proposal
    if o.proposal and settings["integrator"] == "unoccluded":
        changed["proposal"] = "mix" if o.proposal == "product" else o.proposal
    return changed


def _runs_to_show(settings: dict[str, Any]) -> int:
    """Enough estimates for some 150 dots."""
    rays = settings.get("shadowrays") or settings.get("samples") or 150
    return 1 if rays >= 150 else (150 + rays - 1) // rays


def ask(report: Report, o: Any) -> None:
    """Compute all that needs random numbers."""
    stage, seed = report.stage, report.about["seed"]
    report.exact = stage.exact(_hash(seed ^ 1 << 40))
    for i, asked in enumerate(report.about["methods"]):
        settings = _overridden(asked["settings"], o)
        found = stage.runs(report.repeats, _hash(seed ^ i + 2 << 40), **settings)
        method = Method(asked["method"], asked["claim"], asked["without_shadows"], settings, found)
        if not method.is_open:
            method.estimates = _runs_to_show(settings)
            method.rays = stage.rays(method.estimates, seed, **settings)
        report.methods.append(method)
    sir = next(m for m in report.methods if m.settings["integrator"] == "sir")
    report.candidates = stage.candidates(seed, **sir.settings)


# ---- text ----

def _vector(report: Report, name: str, v: list[float], is_direction: bool = True) -> str:
    line = "%-12s(%.6g %.6g %.6g)" % (name, *v)
    if is_direction:
        line += "   in the map: theta %.2f, phi %.2f degrees" % tuple(report.stage.angles([v])[0])
    return line


def _material_name(about: dict[str, Any]) -> str:
    lobe = about["lobe"]
    return "%s, %s %.6g" % (about["hit"]["material"]["model"], lobe["name"], lobe["value"])


def _angle(a: list[float], b: list[float]) -> float:
    """Between two unit vectors, in degrees; exact near 0, too."""
    cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    return math.degrees(math.atan2(math.hypot(*cross), sum(x * y for x, y in zip(a, b))))


def _hit_lines(report: Report) -> Iterator[str]:
    hit = report.about["hit"]
    material = hit["material"]
    file = ' "%s"' % hit["file"] if hit["file"] is not None else ""
    triangle = ", triangle %d" % hit["triangle"] if hit["triangle"] is not None else ""
    yield "shape       %s%s of line %d%s; %.6g from the eye" % (
        hit["shape"], file, hit["line"], triangle, hit["distance"])
    yield _vector(report, "point", hit["point"], False)
    yield _vector(report, "normal", hit["normal"])
    if repr(hit["normal"]) != repr(hit["geometric_normal"]):
        yield _vector(report, "of the face", hit["geometric_normal"])
    yield _vector(report, "to the eye", hit["wo"])
    yield _vector(report, "mirrored", hit["mirrored"])
    yield "material    %s, Kd (%.4g %.4g %.4g), Ks (%.4g %.4g %.4g); seen at %.2f degrees" % (
        _material_name(report.about), *material["Kd"], *material["Ks"],
        _angle(hit["normal"], hit["wo"]))


def _value(name: str, v: Radiance) -> str:
    return "%-12s%.6g +- %.1g   (%.6g %.6g %.6g)" % (
        name, v.sum, v.sum_standard_error, *v.rgb.tolist())


def _exact_lines(e: Exact) -> Iterator[str]:
    if e.by_patches:
        how = "by %d rays, at least 2 in each patch above the horizon, of %d" % (e.rays, e.patches)
    else:
        how = "by %d runs of mis; %d patches are too many for their sum" % (MIS_RUNS, e.patches)
    yield "\nreflected radiance, r+g+b and (r g b), " + how
    yield _value("exact", e.lit)
    yield _value("unoccluded", e.unoccluded)
    if e.unoccluded.sum > 0:
        yield "seen        %.2f %%" % (100 * e.lit.sum / e.unoccluded.sum)
    else:
        yield "seen        -"  # no light to be seen


def _draws(m: Method) -> str:
    s = m.settings
    if "samples" in s:
        return "%d" % s["samples"]
    drawn = str(s.get("candidates", "-"))
    return drawn if m.is_open else "%s/%s" % (s.get("shadowrays", "-"), drawn)


def _method_line(m: Method, e: Exact) -> str:
    found, truth = m.found, (e.unoccluded if m.is_open else e.lit).sum
    line = "%-16s %9s %11.6g %10.2g" % (
        m.name, _draws(m), found.mean.sum, found.mean.sum_standard_error)
    line += " %8.4f" % (found.mean.sum / truth) if truth > 0 else " %8s" % "-"
    if math.isfinite(found.z):
        line += " %7.2f%s" % (found.z, "?" if m.is_too_skew else " ")
    else:
        line += " %8s" % "-"
    if math.isfinite(found.relative_error):
        line += " %10.3g %%" % (100 * found.relative_error)
    else:
        line += " %12s" % "-"
    return line + " %8.4g" % found.rays


def _method_lines(report: Report, e: Exact) -> Iterator[str]:
    yield "\n%-16s %9s %11s %10s %8s %8s %12s %8s" % (
        "method", "draws", "mean", "+-", "of exact", "z", "error of one", "rays")
    for m in report.methods:
        yield _method_line(m, e)
    yield ("Means of %d estimates; z: the difference from exact (unoccluded: from that) in "
           "standard errors; error of one: the\n"
           "root mean square difference of a single estimate from exact; rays: cast by one. "
           "z with a ?: rare and bright estimates\n"
           "make the mean too skew for its standard error, which misses what has not been hit: "
           "ask for more --repeats." % report.repeats)


def _candidate_lines(c: Candidates, e: Exact) -> Iterator[str]:
    drawn = len(c.weight)
    yield "\none estimate by sir"
    whose = ""
    if math.isfinite(c.share_of_map):
        whose = ", %d from the map, %d from the BRDF" % (c.n_map, drawn - c.n_map)
    yield "candidates  %d drawn%s; %d weigh something" % (drawn, whose, c.positive)
    if c.weights <= 0:
        return
    yield "weights     sum %.6g, mean %.6g (estimates %.6g); the largest is %.3g %% of all" % (
        c.weights, c.weights / drawn, e.unoccluded.sum, 100 * c.largest_share)
    yield "effective   sample size %.4g = (sum w)^2 / sum w^2" % c.effective_sample_size
    yield "chosen      %d rays at %d candidates, %d of them see the light" % (
        c.shadowrays, c.distinct, c.n_seen)
    r, g, b = c.estimate.tolist()
    yield "estimate    %.6g   (%.6g %.6g %.6g)" % (r + g + b, r, g, b)


def _lines(report: Report) -> Iterator[str]:
    about = report.about
    yield "pixel       (%d, %d) of %d x %d, %s" % (
        about["x"], about["y"], about["width"], about["height"], about["scene"])
    if about["hit"]:
        yield from _hit_lines(report)
    if report.exact is None or report.candidates is None:
        own = "" if about["hit"] else ", the light's own"
        yield "nothing     %s" % about["nothing"]
        yield "radiance    (%.6g %.6g %.6g)%s" % (*about["radiance"], own)
        return
    yield from _exact_lines(report.exact)
    yield from _method_lines(report, report.exact)
    yield from _candidate_lines(report.candidates, report.exact)
    yield "\nwritten     %s/%smethods.csv candidates.csv rays.csv" % (
        report.folder, "pixel.html " if report.html else "")


def text_of(report: Report) -> str:
    """The report as text."""
    return "".join(line + "\n" for line in _lines(report))


# ---- JSON ----

def _json_value(v: Radiance) -> dict[str, Any]:
    return {"radiance": v.rgb.tolist(), "standard_error": v.standard_error.tolist(), "sum": v.sum,
            "sum_standard_error": v.sum_standard_error}


def _json_method(m: Method, repeats: int) -> dict[str, Any]:
    s = m.settings
    by_samples = "samples" in s
    return {"method": m.name, "claim": m.claim, "samples": s.get("samples"),
            "candidates": None if by_samples else s.get("candidates"),
            "shadowrays": None if by_samples or m.is_open else s.get("shadowrays"),
            "repeats": repeats, **_json_value(m.found.mean), "z": m.found.z,
            "skewness": m.found.skewness, "relative_error": m.found.relative_error,
            "rays": m.found.rays, "accepted": m.accepted}


def _json_candidates(c: Candidates) -> dict[str, Any]:
    return {"drawn": len(c.weight), "share_of_map": c.share_of_map, "positive": c.positive,
            "weights": c.weights, "squared_weights": c.squared_weights,
            "effective_sample_size": c.effective_sample_size, "largest_share": c.largest_share,
            "shadowrays": c.shadowrays, "distinct": c.distinct, "seen": c.n_seen,
            "estimate": c.estimate.tolist(), "estimate_unoccluded": c.estimate_unoccluded.tolist()}


def json_of(report: Report) -> dict[str, Any]:
    """The report as `--json` prints it. What is not known is null."""
    about = report.about
    names = "scene", "x", "y", "width", "height", "seed", "hit", "nothing"
    told = {name: about[name] for name in names}
    if report.exact is None or report.candidates is None:
        return {**told, "radiance": about["radiance"]}
    e = report.exact
    return {**told,
            "exact": {"by": "patches" if e.by_patches else "mis", "patches": e.patches,
                      **_json_value(e.lit)},
            "unoccluded": _json_value(e.unoccluded),
            "methods": [_json_method(m, report.repeats) for m in report.methods],
            "candidates": _json_candidates(report.candidates),
            "folder": report.folder}


# ---- tables ----

def _row(v: Radiance) -> list[float]:
    return [*v.rgb.tolist(), v.sum, *v.standard_error.tolist(), v.sum_standard_error]


def _methods_table(report: Report) -> Iterator[list[Any]]:
    yield ["method", "repeats", "r", "g", "b", "sum", "se_r", "se_g", "se_b", "se_sum", "z",
           "skewness", "relative_error", "rays", "accepted"]
    assert report.exact
    yield ["exact", None, *_row(report.exact.lit)] + [None] * 5
    yield ["without visibility", None, *_row(report.exact.unoccluded)] + [None] * 5
    for m in report.methods:
        yield [m.name, report.repeats, *_row(m.found.mean), m.found.z, m.found.skewness,
               m.found.relative_error, m.found.rays, m.accepted]


@dataclass
class Places:
    """Candidates or rays as columns of numbers."""

    angles: list[list[float]]
    wi: list[list[float]]
    density: list[list[float]]  # q_map, q_brdf, product


def _places(stage: Stage, wi: np.ndarray) -> Places:
    import numpy as np
    return Places(stage.angles(wi).tolist(), wi.astype(float).tolist(),
                  np.stack(stage.look(wi), axis=1).tolist())


def _from(c: Candidates) -> list[Optional[str]]:
    """Who drew each candidate; None where that cannot be told."""
    if math.isnan(c.share_of_map):
        return [None] * len(c.weight)
    return ["map" if is_map else "brdf" for is_map in c.from_map.tolist()]


def _candidates_table(report: Report) -> Iterator[list[Any]]:
    yield ["candidate", "from", "theta_deg", "phi_deg", "x", "y", "z", "q_map", "q_brdf", "q",
           "product", "weight", "share", "chosen", "seen"]
    c = report.candidates
    assert c
    angles, wi = report.stage.angles(c.wi).tolist(), c.wi.astype(float).tolist()
    columns = zip(_from(c), angles, wi, c.q_map.tolist(), c.q_brdf.tolist(), c.q.tolist(),
                  c.product.tolist(), c.weight.tolist(), c.chosen.tolist(), c.seen.tolist())
    for i, (whose, angle, w, q_map, q_brdf, q, product, weight, chosen, seen) in enumerate(columns):
        place = [*angle, *w] if weight > 0 else [None] * 5
        share = weight / c.weights if c.weights > 0 else 0
        yield [i, whose, *place, q_map, q_brdf, q, product, weight, share, chosen,
               int(seen) if chosen else None]


def _rays_table(report: Report) -> Iterator[list[Any]]:
    yield ["method", "sample", "theta_deg", "phi_deg", "x", "y", "z", "q_map", "q_brdf", "product",
           "seen"]
    for m in report.methods:
        if m.rays is None:
            continue
        p = _places(report.stage, m.rays.wi)
        columns = zip(p.angles, p.wi, p.density, m.rays.sample.tolist(), m.rays.seen.tolist())
        for angle, w, density, sample, seen in columns:
            yield [m.name, sample, *angle, *w, *density, int(seen)]


TABLES = {"methods.csv": _methods_table, "candidates.csv": _candidates_table,
          "rays.csv": _rays_table}


def write_files(report: Report) -> None:
    """The tables, and the page where it is asked for."""
    from . import page
    for name, rows in TABLES.items():
        with outfile(os.path.join(report.folder, name)) as out:
            out.write("".join(form.csv(*row) + "\n" for row in rows(report)).encode("utf-8"))
    if report.html:
        path = os.path.join(report.folder, "pixel.html")
        page.write(path, "pixel", _page_data(report), text_of(report))


# ---- the page ----

def _integral(density: np.ndarray) -> float:
    """Over the sphere, by rows of equal solid angle."""
    import numpy as np
    total = 0.0
    rows = np.add.accumulate(density.astype(float), axis=1)[:, -1].tolist()
    for y, row in enumerate(rows):
        middle = math.pi * (y + 0.5) / HEIGHT
        total += row * (2 * math.pi / WIDTH * 2 * math.sin(middle) * math.sin(math.pi / 2 / HEIGHT))
    return total


def _scaled(density: np.ndarray, divisor: float) -> np.ndarray:
    return (density.astype(float) / divisor).astype("f4") if divisor > 0 else density


def _codes(density: np.ndarray, top: int) -> np.ndarray:
    """Two bytes each: 0 is below the scale, else 1 + (CODES - 1) t."""
    import numpy as np
    with np.errstate(divide="ignore"):
        t = 1 + (np.log10(density.astype(float)) - top) / DECADES
    x = (CODES - 1) * np.minimum(np.maximum(t, 0), 1)
    whole = np.floor(x)
    return np.where(t >= 0, 1 + whole + (x - whole >= 0.5), 0).astype(np.uint32)


def _json_sphere(report: Report) -> dict[str, Any]:
    """The densities in places of the sphere.

    Each place has the mean over a few directions, as many as the map has pixels there, at most
    8 x 8, so that a lamp of one pixel is not missed. The BRDF's is over its integral (eq. 4.3),
    the product's over L_ns (eq. 4.4), so that what is seen integrates to L/L_ns.
    """
    from . import page
    stage, about, e = report.stage, report.about, report.exact
    assert e
    wanted = ((about["map_width"] or 1) + WIDTH - 1) // WIDTH
    q_map, f_cos, product, seen = stage.sphere(WIDTH, HEIGHT, max(2, min(wanted, 8)))
    fields = {"map": q_map, "brdf": _scaled(f_cos, _integral(f_cos)),
              "product": _scaled(product, e.unoccluded.sum),
              "seen": _scaled(seen, e.unoccluded.sum)}
    most = max(float(fields[name].max()) for name in ("map", "brdf", "product"))
    top = math.ceil(math.log10(most)) if most > 0 else 0
    sphere: dict[str, Any] = {"width": WIDTH, "height": HEIGHT, "top": top, "decades": DECADES}
    for name, density in fields.items():
        sphere[name] = page.numbers(_codes(density, top), 2)
    hit = about["hit"]
    for name, w in (("n", hit["normal"]), ("eye", hit["wo"]), ("R", hit["mirrored"])):
        sphere[name] = dict(zip(("theta_deg", "phi_deg"), stage.angles([w])[0].tolist()))
    return sphere


def _json_rays(report: Report) -> Iterator[dict[str, Any]]:
    for m in report.methods:
        if m.rays is None:
            continue
        p = _places(report.stage, m.rays.wi[:SHOWN])
        columns = zip(p.angles, p.density, m.rays.sample.tolist(), m.rays.seen.tolist())
        for angle, density, sample, seen in columns:
            yield {"method": m.name, "sample": sample, "theta_deg": angle[0], "phi_deg": angle[1],
                   "q_map": density[0], "q_brdf": density[1], "product": density[2], "seen": seen}


def _json_candidate_list(report: Report) -> Iterator[dict[str, Any]]:
    """Those that weigh something: the others have no direction."""
    c, n = report.candidates, 0
    assert c
    angles, whose = report.stage.angles(c.wi).tolist(), _from(c)
    for i, (weight, chosen) in enumerate(zip(c.weight.tolist(), c.chosen.tolist())):
        if weight <= 0:
            continue
        n += not chosen
        if not chosen and n > SHOWN:
            continue
        yield {"from": whose[i], "candidate": i, "theta_deg": angles[i][0], "phi_deg": angles[i][1],
               "q_map": float(c.q_map[i]), "q_brdf": float(c.q_brdf[i]), "q": float(c.q[i]),
               "product": float(c.product[i]), "weight": weight, "share": weight / c.weights,
               "chosen": chosen, "seen": bool(c.seen[i]) if chosen else None}


def _page_data(report: Report) -> dict[str, Any]:
    """What the page shows beyond the report (docs/live.md)."""
    shown = [{"method": m.name, "estimates": m.estimates,
              "rays": 0 if m.rays is None else len(m.rays.wi), "too_skew": m.is_too_skew}
             for m in report.methods]
    return {**json_of(report), "sphere": _json_sphere(report), "shown": shown,
            "rays": list(_json_rays(report)),
            "candidate_list": list(_json_candidate_list(report)), "light": report.about["light"],
            "material_name": _material_name(report.about)}


# ---- the command ----

def _places_of(words: list[str], about: dict[str, Any]) -> list[int]:
    """X and Y. Both mistakes are told."""
    wrong = []
    size = about["width"], about["height"]
    for name, word, limit in zip("XY", words, size):
        if not (word.isascii() and word.isdigit() and int(word) < limit):
            wrong.append('error: %s is "%s", must be an integer in [0, %d]: the film of the scene '
                         "has %d x %d pixels" % (name, word, limit - 1, *size))
    if wrong:
        raise Error("\n".join(wrong))
    return [int(word) for word in words]


def _make_folder(path: str) -> None:
    try:
        os.mkdir(path)
    except FileExistsError:
        if not os.path.isdir(path):
            raise Error('error: --output "%s": it is there already, and is no folder' % path,
                        Status.IO) from None
    except OSError as e:
        raise Error('error: --output "%s": the folder cannot be made: %s' % (path, e.strerror),
                    Status.IO) from None
    check_writable(os.path.join(path, "methods.csv"))


def _body(o: Any, operands: list[str], say: Say) -> int:
    given = {"seed": o.seed} if "seed" in o.given else {}
    scene = open_scene(operands[0], say, approximate=o.approximate, **given)
    x, y = _places_of(operands[1:], scene.about())
    stage = scene.stage()
    stage.at(x, y)
    about = stage.about()
    if operands[0] != "-":
        about["scene"] = operands[0]  # byte for byte, whatever these are
    report = Report(stage, about, o.output or "pixel_%d_%d" % (x, y), o.html, o.repeats)
    if not report.about["nothing"]:  # an answer without files: nothing is hit, or nothing reflected
        _make_folder(report.folder)  # before the work, whose files could go nowhere
        ask(report, o)
        write_files(report)
    put(form.json(json_of(report)) if o.json else text_of(report))
    return 0


def main(argv: list[str]) -> int:
    """Run `bis pixel` with these arguments.

    Parameters
    ----------
    argv : list of str
        What stands behind the word `pixel`.

    Returns
    -------
    int
        The exit status.
    """
    return run(COMMAND, argv, _body)
