# SPDX-License-Identifier: BSD-2-Clause
"""judge_trial: right and wrong pictures of the kit's scenes, by Mitsuba 3 and by bis, for a trial of `bis judge`.

    python3 scripts/bench/judge_trial.py right OUT N [FIRST]  N right pictures of each scene by Mitsuba, N/4 by bis
    python3 scripts/bench/judge_trial.py wrong OUT            pictures of each scene with each mistake that changes it
    python3 scripts/bench/judge_trial.py judged OUT [NAME]... the verdicts on both, of all scenes or some

Writes OUT/right/NAME-PROGRAM.npy and OUT/wrong/NAME-MISTAKE.npy, float32 (n, 48, 64, 3), and OUT/right.csv and
OUT/wrong.csv with a row for each picture. Files that exist are not made again. Pictures of other seeds than from 1 go
into NAME-PROGRAM-FIRST.npy. The mistakes are made in what Mitsuba is given (its map, its scene, its integrator) or in
the picture. Phong's scenes, which Mitsuba lacks, are by bis alone. Verdicts are added to OUT/judge-right.csv and
OUT/judge-wrong.csv, which are docs/data. Right pictures are judged by the convention of their program, wrong ones as
a user's are; seconds are of user time.

BIS_LIBRARY names the library. Mitsuba 3.9 needs LLVM 16 or newer (DRJIT_LIBLLVM_PATH), and two threads: with one it
hangs."""
import csv
import os
import re
import sys
import time

import drjit as dr
import mitsuba as mi
import numpy as np

import bis
from bis.tools.judge import causes, kit, report, verdict

mi.set_variant('llvm_ad_rgb')
dr.set_thread_count(2)
WRONG_SEEDS, WRONG_SPP = {'mitsuba': 4, 'bis': 8}, 256  # pixels of bis share candidates, so it takes eight pictures
NOISES = (.03,) * 7 + (.01,) + (.03,) * 4  # of a pixel, in turn
METHODS = (('sir', .003), ('mis', .03), ('em', .03), ('sir', .01))  # of bis, in turn
MOST_SPP, CHUNK = 8192, 2048  # camera samples of a picture; of one call of Mitsuba
MOST_BIS = 16

def sine(m):
    return np.sin((np.arange(len(m)) + .5) * np.pi / len(m))[:, None, None].astype(np.float32)


def half_texel(m, axis):
    """The map with twice as many pixels, moved by one of them."""
    fine = m.repeat(2, 0).repeat(2, 1)
    return np.roll(fine, 1, 1) if axis else np.concatenate([fine[:1], fine[:-1]])


def from_srgb(x):
    return np.where(x <= .04045, x / 12.92, ((x + .055) / 1.055) ** 2.4).astype(np.float32)


MAPS = {
    'turned-90': lambda m: np.roll(m, m.shape[1] // 4, 1),
    'turned-37': lambda m: np.roll(m, round(m.shape[1] * 37 / 360), 1),
    'mirrored': lambda m: m[:, ::-1],
    'upside-down': lambda m: m[::-1],
    'half-texel-x': lambda m: half_texel(m, 1),
    'half-texel-y': lambda m: half_texel(m, 0),
    'sin-missing': lambda m: m / sine(m),
    'sin-twice': lambda m: m * sine(m),
    'clamped': lambda m: np.minimum(m, m.max() / 4),
    'map-srgb': from_srgb,
    'channels': lambda m: m[:, :, ::-1],
    'upper-half': lambda m: np.where(np.arange(len(m))[:, None, None] < len(m) // 2, m, 0),
    'lower-half': lambda m: np.where(np.arange(len(m))[:, None, None] < len(m) // 2, 0, m),
    'pole-rows': lambda m: np.pad(m[1:-1], ((1, 1), (0, 0), (0, 0))),
    'seam-columns': lambda m: np.pad(m[:, :-1], ((0, 0), (0, 1), (0, 0))),
}


def decoded(match):
    return match[1] + ' '.join('%g' % x for x in from_srgb(np.array(match[2].split(), float))) + match[3]


def metal_without_fresnel(match):
    """Reflects at all angles what it does head on."""
    square = float(match[1].split()[0]) ** 2
    return ('<string name="material" value="none"/><float name="specular_reflectance" value="%g"/>'
            % (square / (square + 4)))


def squared(match):
    return match[1] + '%g' % float(match[2]) ** 2 + match[3]


ASTRAY = 'type="astray"><float name="%s" value="%d"/></integrator>'
TEXTS = {
    'albedo-srgb': lambda s: re.sub(r'(name="reflectance" value=")([^"]*)(")', decoded, s),
    'alpha-squared': lambda s: re.sub(r'(name="alpha" value=")([^"]*)(")', squared, s),
    'fresnel-missing': lambda s: re.sub(r'<rgb name="eta"[^>]*/><rgb name="k" value="([^"]*)"/>',
                                        metal_without_fresnel, s),
    'normals-flipped': lambda s: re.sub(r'<bsdf type="twosided">(.*?)</bsdf></bsdf>',
                                        r'\1</bsdf><boolean name="flip_normals" value="true"/>', s),
    'half-pixel': lambda s: s.replace('<string name="fov_axis"',
                                      '<float name="principal_point_offset_x" value="%g"/><string name="fov_axis"'
                                      % (.5 / kit.WIDTH)),
    'gaussian': lambda s: s.replace('<rfilter type="box"/>', '<rfilter type="gaussian"/>'),
    'tent': lambda s: s.replace('<rfilter type="box"/>', '<rfilter type="tent"/>'),
    'shadows-missing': lambda s: s.replace('type="direct"/>', ASTRAY % ('shadows', 0)),
    'cos-missing': lambda s: s.replace('type="direct"/>', ASTRAY % ('cosine', -1)),
    'cos-twice': lambda s: s.replace('type="direct"/>', ASTRAY % ('cosine', 1)),
}
PHONG_TEXTS = {
    'albedo-srgb': lambda s: re.sub(r'(rgb reflectance" \[|float Kd" )([\d. ]+)(\]| )', decoded, s),
    'exponent-squared': lambda s: re.sub(r'(float exponent" )(\d+)()', squared, s),
    'shadows-missing': lambda s: s.replace('WorldBegin', 'Integrator "unoccluded"\nWorldBegin'),
}
PICTURES = {
    'twice': lambda p: 2 * p,
    'one-over-pi': lambda p: p / np.pi,
    'flipped-x': lambda p: p[:, ::-1],
    'flipped-y': lambda p: p[::-1],
    'gamma': lambda p: np.maximum(p, 0) ** (1 / 2.2),
    'reinhard': lambda p: p / (1 + p),
}


class Astray(mi.SamplingIntegrator):
    """Direct light by samples of the map alone; perhaps without shadows, or with another power of the cosine."""

    def __init__(self, props):
        super().__init__(props)
        self.shadows, self.power = bool(props.get('shadows', 1)), props.get('cosine', 0)

    def sample(self, scene, sampler, ray, medium=None, active=True):
        si = scene.ray_intersect(ray, active)
        seen = scene.environment().eval(si, active & ~si.is_valid())
        hit = active & si.is_valid()
        ds, weight = scene.sample_emitter_direction(si, sampler.next_2d(hit), self.shadows, hit)
        wo = si.to_local(ds.d)
        value = si.bsdf(ray).eval(mi.BSDFContext(), si, wo, hit) * weight
        value = value * dr.abs(wo.z) ** self.power if self.power else value
        return seen + dr.select(hit & (ds.pdf > 0), value, 0), hit, []


mi.register_integrator('astray', Astray)

class Mitsuba:
    """A scene of the kit in Mitsuba, perhaps with a mistake in its map or its text."""

    def __init__(self, folder, name, on_map=None, on_text=None):
        with open(f'{folder}/{name}.xml') as f:
            text = f.read().replace('maps/', folder + '/maps/').replace('meshes/', folder + '/meshes/')
        if on_map:
            path = folder + '/maps/mistaken.exr'
            mi.Bitmap(np.ascontiguousarray(kit.for_mitsuba(on_map(kit.light(name))))).write(path)
            text = text.replace(f'{folder}/maps/{kit.SCENES[name].map}-mitsuba.exr', path)
        self.scene = mi.load_string(on_text(text) if on_text else text)

    def render(self, spp, seed):
        parts = [min(CHUNK, spp - done) for done in range(0, spp, CHUNK)]
        return sum(n * np.array(mi.render(self.scene, spp=n, seed=seed * 64 + i), dtype=float)
                   for i, n in enumerate(parts)) / spp


class Bis:
    """A scene of the kit in bis, which needs no folder."""

    def __init__(self, folder, name, on_map=None, on_text=None):
        light, text = kit.light(name), kit.text(name)
        self.scene = bis.Scene(on_text(text) if on_text else text,
                               light=np.ascontiguousarray(on_map(light) if on_map else light))

    def render(self, spp, seed, **settings):
        return self.scene.render(spp=spp, seed=seed, **settings).rgb.astype(float)


def samples_for(render, noise):
    """Camera samples for this noise of a pixel, by the median of what two pictures differ."""
    a, b = render(16, 900001), render(16, 900002)
    a, b = a.sum(2), b.sum(2)
    noisy = np.abs(a - b) > 1e-5 * (a + b)
    now = np.median((np.abs(a - b) / (a + b))[noisy]) * 2 ** .5 / .6745 if noisy.any() else 0
    return int(np.clip(16 * (now / noise) ** 2, 16, MOST_SPP))


def right_by_mitsuba(folder, name, n, first):
    """Pictures and rows of the CSV."""
    scene = Mitsuba(folder, name)
    spp = {noise: samples_for(scene.render, noise) for noise in set(NOISES)}
    for i in range(n):
        noise = NOISES[i % len(NOISES)]
        yield scene.render(spp[noise], first + i), ('mitsuba', 'direct', first + i, spp[noise], noise)


def right_by_bis(name, n, first):
    """Pictures and rows of the CSV."""
    scene = Bis(None, name)
    spp = {(m, noise): min(MOST_BIS, samples_for(lambda n, seed: scene.render(n, seed, integrator=m), noise))
           for m, noise in METHODS}
    for i in range(n):
        method, noise = METHODS[i % len(METHODS)]
        samples = spp[method, noise]
        yield scene.render(samples, first + i, integrator=method), ('bis', method, first + i, samples, noise)


def wrong(folder, name):
    """(mistake, program, render) of every mistake that changes what the program is given, or its picture."""
    phong = kit.is_phong(name)
    light, made = kit.light(name), Bis if phong else Mitsuba
    with open(f'{folder}/{name}.{"txt" if phong else "xml"}') as f:
        text = f.read()
    for mistake, f in MAPS.items():
        if f(light).shape != light.shape or not np.array_equal(f(light), light):
            yield mistake, made(folder, name, on_map=f).render
    for mistake, f in (PHONG_TEXTS if phong else TEXTS).items():
        if f(text) != text:
            yield mistake, made(folder, name, on_text=f).render
    scene = made(folder, name)
    for mistake, f in PICTURES.items():
        yield mistake, lambda spp, seed, f=f: f(scene.render(spp, seed))

def keep(out, kind, label, pictures):
    """Save a stack and add its rows to the CSV, if it is not there yet."""
    path = f'{out}/{kind}/{label}.npy'
    if os.path.exists(path):
        return
    start = time.time()
    pictures = list(pictures)
    np.save(path, np.array([p for p, _ in pictures], np.float32))
    with open(f'{out}/{kind}.csv', 'a', newline='') as f:
        csv.writer(f).writerows([os.path.basename(path), i, *row] for i, (_, row) in enumerate(pictures))
    print(f'{label} {len(pictures)} pictures, {time.time() - start:.0f} s', flush=True)


def stacks(out, name):
    """(rows, pictures): those of Mitsuba alone, and the noisy ones in eights (of others ours is no more exact)."""
    with open(f'{out}/right.csv', newline='') as f:
        rows = [row for row in csv.reader(f) if re.fullmatch(name + r'-(mitsuba|bis)(-\d+)?\.npy', row[0])]
    groups = [[row] for row in rows if row[2] == 'mitsuba']
    for like in sorted({(row[0], *row[3:4], row[6]) for row in rows if row[6] == '%g' % max(NOISES)}):
        same = [row for row in rows if (row[0], row[3], row[6]) == like]
        groups += [same[i:i + 8] for i in range(0, len(same) - 7, 8)]
    for group in groups:
        stack = np.load(f'{out}/right/{group[0][0]}', mmap_mode='r')
        yield group, stack[[int(row[1]) for row in group]].astype(float)


def judge_right(out, name, made):
    """Rows of judge-right.csv."""
    separable = 'conductor' in kit.text(name)
    for group, theirs in stacks(out, name):
        program, method, seed, _, noise = group[0][2:7]
        like = causes.CONVENTIONS[1 + 2 * separable if program == 'mitsuba' else 0]
        _, v = report.truth_for(made(1, like), theirs, verdict.ROUNDING)
        parts = ['%.4g' % v.parts[k] if k in v.parts else '' for k in ('all tiles', 'worst tile', 'mean', 'outlines')]
        yield name, program, method, seed, len(group), noise, '%.4g' % v.p, *parts


def judge_wrong(out, name, made):
    """Rows of judge-wrong.csv."""
    for mistake in (*MAPS, *dict(TEXTS, **PHONG_TEXTS), *PICTURES):
        path = f'{out}/wrong/{name}-{mistake}.npy'
        if os.path.exists(path):
            start, theirs = os.times(), np.load(path).astype(float)
            c = report.judged(name, [path], theirs, verdict.ROUNDING, made)
            said = '; '.join('%s %.2g' % (f.name.replace(',', ''), f.verdict.p) for f in c.named)
            yield (name, mistake, len(theirs), 'right' if c.verdict.is_right else 'wrong', '%.2g' % c.verdict.p,
                   '%.5f' % c.verdict.noise, 'sure' if c.is_sure else '', len(c.named), said,
                   '%.1f' % (os.times().user - start.user))


def main():
    mode, out = sys.argv[1], os.path.abspath(sys.argv[2])
    if mode == 'judged':
        for name in sys.argv[3:] or kit.NAMES:
            made = report.studios_of_kit(name)
            for kind, rows in (('right', judge_right(out, name, made)), ('wrong', judge_wrong(out, name, made))):
                with open(f'{out}/judge-{kind}.csv', 'a', newline='') as f:
                    csv.writer(f, lineterminator='\n').writerows(rows)
        return
    folder = f'{out}/kit-{mode}'
    kit.write(folder)
    os.makedirs(f'{out}/{mode}', exist_ok=True)
    for name in kit.NAMES:
        if mode == 'right':
            n, first = int(sys.argv[3]), int(sys.argv[4]) if len(sys.argv) > 4 else 1
            more = f'-{first}' if first > 1 else ''
            keep(out, mode, name + '-bis' + more, right_by_bis(name, n if kit.is_phong(name) else n // 4, first))
            if not kit.is_phong(name):
                keep(out, mode, name + '-mitsuba' + more, right_by_mitsuba(folder, name, n, first))
            continue
        program, spp = ('bis', 16) if kit.is_phong(name) else ('mitsuba', WRONG_SPP)
        for k, (mistake, render) in enumerate(wrong(folder, name)):
            seeds = [100 * k + i + 1 for i in range(WRONG_SEEDS[program])]
            keep(out, mode, f'{name}-{mistake}',
                 ((render(spp, seed), (program, mistake, seed, spp)) for seed in seeds))


if __name__ == '__main__':
    main()
