# SPDX-License-Identifier: BSD-2-Clause
"""`bis envmap MAP`: what is in an environment map, as text, JSON or a page, and its levels, regions
and importance as pictures (thesis figures 3.5 and 3.6); or the map itself in another mapping."""
from __future__ import annotations

import math
import os
import sys
from collections.abc import Sequence
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Optional

from .._errors import Error, Status
from .._frames import FRAMES
from . import command, files, text
from .command import COUNT, DONE, FLAG, NAME, REAL, Command, Heading, Option, Say
from .scenes import telling

if TYPE_CHECKING:  # they need numpy, and the help does not
    from .._sampling import Envmap
    from .doctor import Diagnosis
    from .survey import Direction, Map, Survey

MAPPINGS = ("latlong", "angular", "equalarea", "mirrorball", "verticalcross", "horizontalcross",
            "cubestrip")
ENDINGS = (".exr", ".pfm", ".hdr", ".png")
PICTURES = ("map", "levels", "regions", "importance")

COMMAND = Command(
    "envmap", "envmap [options] MAP", "what is in a map; levels, regions, importance as pictures",
    [
        Heading("what to read"),
        Option("mapping", "M",
               "latlong (the default), angular (a light probe), equalarea (pbrt-v4's), mirrorball, "
               "verticalcross, horizontalcross or cubestrip; a square map must say which", NAME,
               names=MAPPINGS),
        Option("width", "N",
               "of the lat-long map that another one is resampled to (default: twice a square, "
               "four faces of a cube); with --to, of what is written (default: all detail)", COUNT,
               lo=1, hi=65536),
        Option("levels", "N", "levels of intensity (8)", COUNT, lo=1, hi=254, default=8),
        Option("areaexponent", "B",
               "importance goes with min(0.01 sr, a region's solid angle) to the power of B (0.15)",
               REAL, lo=0, hi=10, default=0.15),
        Option("convention", "P",
               "directions along the axes of a program that shows the same picture: bis (the "
               "default), blender, mitsuba, three (three.js, glTF viewers) or unity", NAME,
               names=tuple(FRAMES), default="bis"),
        Heading("what to write"),
        Option("to", "M",
               "no report, but the map itself in mapping M, to the file of --out; energy is kept, "
               "and printed", NAME, names=MAPPINGS),
        Option("json", None, "print JSON instead of text", FLAG),
        Option("html", "F", "write a page to explore the map, in one file that needs nothing else"),
        Option("out", "F",
               "write pictures: NAME.png makes NAME-map.png, NAME-levels.png, NAME-regions.png and "
               "NAME-importance.png; also .exr, .pfm, .hdr"),
        Option("outdir", "D", "the same into folder D, by the map's own name, as PNG"),
        Option("samples", "N", "directions drawn as dots on the importance (300)", COUNT,
               hi=1000000, default=300),
    ],
    1, 1,
    "Without --convention directions are in the map's own frame: z is up, towards\n"
    "row 0; theta is the angle from it, phi runs with the columns. Levels are\n"
    "equal steps of the logarithm of r+g+b, regions are connected pixels of one\n"
    "level, a light source each. On the pictures brighter is more; the importance\n"
    "is the density by which directions are drawn, on a logarithmic scale.\n")


# ---- the report ----

def _change(before: float, after: float) -> float:
    """In percent."""
    return 100 * (after / before - 1) if before > 0 else 0.0


def _vector(d: Direction) -> str:
    return "(%.3f %.3f %.3f)" % (d.x, d.y, d.z)


def _doctor_text(d: Diagnosis) -> str:
    h = d.harmonics
    is_known = math.isfinite(h.of_itself[1])
    rms, worst = h.of_itself if is_known else h.of_mean
    lines = [
        "\nfrom above  E = %.4g %.4g %.4g; exposure %+.1f EV makes a grey card that faces up "
        "middle grey" % (*d.irradiance, round(d.exposure, 1) + 0.0),
        "to 1 %%      of this E, nothing hidden: %s samples" % ", ".join(
            "%.2g by %s" % (n, method) for method, n in d.samples.items())]
    if not d.irradiance.any():
        lines = ["\nfrom above  E = 0 0 0: no light comes from above"]
    lines.append("nine SH     their irradiance is off by %.1f %% (rms), at worst %.0f %%%s" % (
        100 * rms, 100 * worst,
        "" if is_known else " of the mean; there is some where no light arrives"))
    for lamp in d.lamps:
        where = lamp.direction
        lines.append("%-12s%5.2f%% of the power, %.3g sr, theta %.1f, phi %.1f   %s" % (
            "sun" if lamp.is_sun else "lamp", 100 * lamp.share, lamp.solid_angle, where.theta,
            where.phi, _vector(where)))
    lines += ["suspicious  " + words for words in d.findings or ["nothing"]]
    return "".join(line + "\n" for line in lines)


def _levels_text(s: Survey) -> str:
    lines = ["\nlevel       from         to    pixels    sphere     power   regions\n"]
    for k, level in enumerate(s.levels):
        lines.append("%5d %10.4g %10.4g %9d %8.4f%% %8.4f%% %9d\n" % (
            k, level.least, level.most, level.pixels, 100 * level.sphere, 100 * level.power,
            level.regions))
    return "".join(lines)


def _largest_text(s: Survey) -> str:
    lines = ["\nregions with most power\n"
             "  rank level     power   solid angle  theta    phi   direction\n"]
    for k, r in enumerate(s.largest, 1):
        d = r.direction
        where = " %6.1f %6.1f   %s" % (d.theta, d.phi, _vector(d)) if d else "  on all sides"
        lines.append("%6d %5d %8.4f%% %10.4g sr%s\n" % (
            k, r.level, 100 * r.power, r.solid_angle, where))
    return "".join(lines)


_RIGHT = " (right-handed: Scale -1 1 1 before LookAt, or the picture is mirrored)"
_HANDS = {"bis": "", "unity": "", "blender": _RIGHT, "mitsuba": _RIGHT, "three": _RIGHT}


def _scene_text(convention: str) -> str:
    """The line of a scene that gives its world the axes of a program: columns of the matrix."""
    columns = [" ".join(map(str, (*column, 0))) for column in zip(*FRAMES[convention])]
    return ("in a scene  AttributeBegin Transform [ %s  0 0 0 1 ] LightSource ... AttributeEnd: "
            "the world's axes are those of %s%s\n" % (
                "  ".join(columns), convention, _HANDS[convention]))


def report_text(path: str, s: Survey, light: Envmap, found: Diagnosis) -> str:
    """The report as text."""
    height, width = light.shape
    from_another = light.mapping != "latlong"
    lines = ["map         %s, %d x %d, %s%s" % (
        path, width, height, "resampled from " if from_another else "", light.mapping)]
    if light.resampled:
        before, after = light.resampled
        lines.append("power       %.6g before, %.6g after resampling (%+.3f%%)" % (
            before, after, _change(before, after)))
    lines += [
        "intensity   min %.4g, median %.4g, mean %.4g, max %.4g (r+g+b; min: of the pixels that "
        "are not black)" % (s.least, s.median, s.mean, s.most),
        "mean        %.4g %.4g %.4g (red, green, blue)" % s.mean_rgb,
        "power       %.6g (r+g+b integrated over the sphere)" % s.power,
        "bad values  %d NaN, %d infinite, %d negative, set to 0" % light.defects[:3],
        "black       %s of the sphere" % text.percent(s.black),
    ]
    if s.peak_direction:
        d = s.peak_direction
        lines += [
            "contrast    %.4g : 1" % (s.most / s.least),
            "brightest   0.1%% of the sphere holds %.2f%% of the power" % (100 * s.brightest),
            "peak        pixel (%d, %d), theta %.1f, phi %.1f degrees, direction %s" % (
                *s.peak, d.theta, d.phi, _vector(d)),
        ]
    n = len(s.levels)
    a_pixel = light.table_bytes / (width * height)
    lines += ["regions     %d in %d level%s" % (s.n_regions, n, "" if n == 1 else "s"),
              "table       %.1f bytes a pixel beyond the map" % a_pixel]
    words = "".join(line + "\n" for line in lines)
    if s.power == 0:
        return words
    return words + _doctor_text(found) + _levels_text(s) + _largest_text(s)


def _direction_data(d: Any) -> Any:
    return d and {"theta_deg": d.theta, "phi_deg": d.phi, "x": d.x, "y": d.y, "z": d.z}


def _doctor_data(d: Diagnosis) -> dict[str, Any]:
    h = d.harmonics
    return {
        "irradiance_up": d.irradiance.tolist(), "exposure": d.exposure, "samples": d.samples,
        "lamps": [{"sun": lamp.is_sun, "power_share": lamp.share,
                   "solid_angle": lamp.solid_angle, "direction": _direction_data(lamp.direction)}
                  for lamp in d.lamps],
        "harmonics": {"radiance": h.radiance.tolist(), "irradiance": h.irradiance.tolist(),
                      "error_of_mean": h.of_mean, "error_of_itself": h.of_itself},
        "suspicious": d.findings}


def report_data(path: str, s: Survey, light: Envmap, d: Diagnosis) -> dict[str, Any]:
    """The report as an object of JSON."""
    before, after = light.resampled or (None, None)
    bad = light.defects
    peak = {"x": s.peak[0], "y": s.peak[1], "direction": _direction_data(s.peak_direction)}
    return {
        "map": path, "width": light.shape[1], "height": light.shape[0], "mapping": light.mapping,
        "power_before": before, "power_after": after, "min": s.least, "median": s.median,
        "mean": s.mean, "max": s.most, "mean_rgb": list(s.mean_rgb),
        "contrast": s.most / s.least if s.power > 0 else None,
        "power": s.power, "black_share": s.black, "brightest_0.1_percent": s.brightest,
        "peak": peak if s.peak_direction else None,
        "bad_values": {"nan": bad.nan, "infinite": bad.infinite, "negative": bad.negative,
                       "sphere_share": bad.solid_angle / (4 * math.pi)},
        "doctor": _doctor_data(d), "regions": s.n_regions, "table_bytes": light.table_bytes,
        "levels": [{"from": level.least, "to": level.most, "pixels": level.pixels,
                    "sphere_share": level.sphere, "power_share": level.power,
                    "regions": level.regions} for level in s.levels],
        "largest_regions": [{"level": r.level, "power_share": r.power, "solid_angle": r.solid_angle,
                             "direction": _direction_data(r.direction)} for r in s.largest],
    }


# ---- the pictures ----

def _picture_path(out: str, what: str) -> str:
    """"dir/NAME.png" and "levels" make "dir/NAME-levels.png"."""
    stem, ending = os.path.splitext(out)
    return "%s-%s%s" % (stem, what, ending)


def _write_pictures(o: SimpleNamespace, out: str, m: Map) -> None:
    """The map itself takes the exposure of its own log-average; the colours of the others are to be
    seen as they are."""
    from .._image import save_image
    from . import survey

    save_image(_picture_path(out, "map"), m.pixels)
    save_image(_picture_path(out, "levels"), survey.levels_picture(m, o.levels), 0)
    save_image(_picture_path(out, "regions"), survey.regions_picture(m), 0)
    save_image(_picture_path(out, "importance"), survey.importance_picture(m, o.samples), 0)


def _check_ending(out: str) -> None:
    if os.path.splitext(out)[1].lower() not in ENDINGS:
        raise Error('error: --out "%s": the ending must be .exr, .pfm, .hdr or .png' % out)


def _check_output(path: str, source: str) -> None:
    files.check_writable(path)
    files.check_distinct([source], [path])


def _find_out(o: SimpleNamespace, source: str) -> str:
    """Where pictures go: --out itself, or --outdir with the map's name and .png. "": none are asked
    for."""
    if o.html:
        _check_output(o.html, source)
    if not o.out and not o.outdir:
        return ""
    if o.out and o.outdir:
        raise Error("error: --out and --outdir exclude each other")
    stem = os.path.splitext(os.path.basename(source))[0]
    out: str = o.out or "%s/%s.png" % (o.outdir, stem)
    if len(os.fsencode(out)) > 4000:
        raise Error("error: --out: the name is longer than 4000 bytes")
    _check_ending(out)
    for what in PICTURES:
        _check_output(_picture_path(out, what), source)
    return out


# ---- --to ----

def _check_conversion(o: SimpleNamespace, source: str) -> None:
    if not o.out or o.outdir or o.json or o.html:
        raise Error("error: --to %s writes one map: name it by --out FILE, without --outdir, "
                    "--html and --json" % o.to)
    _check_ending(o.out)
    _check_output(o.out, source)


def _convert(o: SimpleNamespace, light: Envmap) -> str:
    """Write the map in another mapping. What it was before it was read is lat-long, or was
    resampled to it."""
    from .._image import save_image

    pixels, before, after = light.to_mapping(o.to, o.width)
    save_image(o.out, pixels, attributes={"bis:mapping": o.to})
    if light.resampled:
        before = light.resampled[0]
    height, width = pixels.shape[:2]
    return ("wrote       %s, %d x %d, %s\n"
            "power       %.6g before, %.6g after resampling (%+.3f%%)\n"
            % (o.out, width, height, o.to, before, after, _change(before, after)))


# ---- the command ----

def _is_picture(source: str) -> bool:
    """Whether the file can be read. One that can may still be no map: of another shape than its
    mapping's."""
    from .._image import read_image

    try:
        read_image(source)
    except Error:
        return False
    return True


def _open(o: SimpleNamespace, source: str, say: Say) -> Envmap:
    """Read the map. A conversion needs no regions, and no width of the lat-long map between."""
    from .._sampling import Envmap

    with telling(say):
        try:
            if o.to:
                return Envmap(source, "cdf", 0, o.mapping)
            return Envmap(source, "alias", o.areaexponent, o.mapping, levels=o.levels,
                          width=o.width)
        except Error as e:
            # A picture may still be no map: a part of one, or a cube without six faces.
            is_read = 'cannot read "' not in str(e) and _is_picture(source)
            raise Error(str(e), e.status if is_read else Status.IO) from None


def _turn(s: Survey, d: Diagnosis, convention: str) -> None:
    """Give all directions along other axes. Their angles stay those of the picture."""
    def turned(w: Optional[Direction]) -> Any:
        if w is None:
            return None
        x, y, z = (sum(a * b for a, b in zip(axis, w[2:])) for axis in FRAMES[convention])
        return w._replace(x=x, y=y, z=z)

    s.peak_direction = turned(s.peak_direction)
    s.largest = [r._replace(direction=turned(r.direction)) for r in s.largest]
    d.lamps[:] = [lamp._replace(direction=turned(lamp.direction)) for lamp in d.lamps]


def _report(o: SimpleNamespace, source: str, out: str, light: Envmap) -> str:
    from . import doctor, page, survey

    m = survey.Map(light)
    s = survey.survey(m, o.levels)
    d = doctor.diagnose(m, o.convention)
    _turn(s, d, o.convention)
    if out:
        _write_pictures(o, out, m)
    data = {**report_data(source, s, light, d), "convention": o.convention}
    words = report_text(source, s, light, d)
    if o.convention != "bis":
        words += "\n" + _scene_text(o.convention)
    if o.html:
        page.write(o.html, "envmap", {**data, **survey.page_data(s, m, o.samples)}, words)
    return text.json(data) if o.json else words


def _body(o: SimpleNamespace, operands: list[str], say: Say) -> int:
    source = operands[0]
    out = ""
    if o.to:
        _check_conversion(o, source)
    else:
        out = _find_out(o, source)
    light = _open(o, source, say)
    words = _convert(o, light) if o.to else _report(o, source, out, light)
    sys.stdout.buffer.write(words.encode("utf-8", "surrogateescape"))
    return DONE


def main(argv: Sequence[str]) -> int:
    """Run the command with these arguments. Returns its exit state."""
    return command.run(COMMAND, argv, _body)
