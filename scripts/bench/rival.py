# SPDX-License-Identifier: BSD-2-Clause
"""rival: seconds on one core to relMSE 1e-2 and 1e-3, bis beside Mitsuba 3, in one run. docs/trust.md reads the
table.

    python3 scripts/bench/rival.py BIS SHARED OUT     SHARED has mesh/ and env/, OUT keeps references and scenes

Both render the dragon under Grace Cathedral, antialiased, in four materials. A picture's seconds are those of rendering
alone: scenes are loaded and kernels compiled before. Every number of camera samples is a render of its own, with three
seeds: the least seconds count, and the mean error.

The references are bis's: a long mis, h, and a long sir, k. Both are unbiased and independent, so the error of a
picture a is the mean of (a - h)(a - k) / (k^2 + (0.1 mean k)^2), in which their own errors cancel. What the programs do
differently (a map's texels, the start of a shadow ray) would count against Mitsuba. The column "floor" shows how much
that is: the same mean with the pictures a, b of two numbers of samples, (a - h)(b - k), in which all noise cancels.

A pool of one thread hangs in Mitsuba 3: it gets two, on the one core that the caller allows (taskset)."""
import json
import math
import os
import subprocess
import sys
import time

import numpy as np
import drjit as dr
import mitsuba as mi

mi.set_variant('llvm_ad_rgb')
dr.set_thread_count(2)
bis, shared, out = (os.path.abspath(p) for p in sys.argv[1:4])
MESH, MAP = shared + '/mesh/dragon_871k.ply', shared + '/env/grace_latlong_pbrt2.exr'
WIDTH, HEIGHT, FOV = 176, 248, 28
EYE, LOOK = np.array([-0.09, 0.17, 0.30]), np.array([-0.007, 0.122, -0.004])
MATERIALS = {'s10': (1, 0, 10), 's50': (1, 0, 50), 'm50': (.5, .5, 50), 'd': (0, 1, 1)}  # Ks, Kd, n
SETTINGS = {'default': ('', []), 'thesis': ('Sampler "stratified" Integrator "sir"', [])}
TARGETS, ENOUGH, LONGEST = (1e-2, 1e-3), 8e-4, 20  # errors; error and seconds after which no longer render is begun
REFERENCES = ('Sampler "sobol" Integrator "mis" "integer samples" 64 "bool stratify" true',
              'Sampler "sobol" "integer edgesamples" 4 Integrator "sir" "string proposal" "product" '
              '"integer candidates" 256 "integer shadowrays" 32')
REFERENCE_SPP = int(os.environ.get('BENCH_RIVAL_REFERENCE', 32))


class Phong(mi.BSDF):
    """Thesis eq. 3.14, two-sided: f = ks (n+1)/(2 pi) cos^n(angle to the mirror direction) + kd/pi. Directions are
    drawn from the lobe (eq. 3.16) or by the cosine, with probabilities ks : kd. Nothing passes below the triangle."""

    def __init__(self, props):
        super().__init__(props)
        self.ks, self.kd, self.n = props['ks'], props['kd'], int(props['n'])
        self.lobes = self.ks / (self.ks + self.kd)
        self.m_components = [mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide]
        self.m_flags = self.m_components[0]

    def eval_pdf(self, ctx, si, wo, active=True):
        wi, f, pdf = si.wi, self.kd / math.pi, 0
        if self.ks:
            lobe = dr.maximum(wi.z * wo.z - wi.x * wo.x - wi.y * wo.y, 0) ** self.n * ((self.n + 1) / (2 * math.pi))
            f, pdf = f + self.ks * lobe, self.lobes * lobe
        if self.kd:
            pdf = pdf + (1 - self.lobes) / math.pi * dr.abs(wo.z)
        same = active & (wi.z * wo.z > 0)
        above = same & (dr.dot(si.n, si.to_world(wi)) * dr.dot(si.n, si.to_world(wo)) > 0)
        return dr.select(above, mi.Color3f(f * dr.abs(wo.z)), 0), dr.select(same, mi.Float(pdf), 0)

    def eval(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[1]

    def sample(self, ctx, si, u, v, active=True):
        wi, wo = si.wi, None
        if self.kd:
            wo = mi.warp.square_to_cosine_hemisphere(v)
            wo.z = dr.copysign(wo.z, wi.z)
        if self.ks:
            c = (1 - v.x) ** (1 / (self.n + 1))
            s, phi = dr.safe_sqrt(1 - c * c), 2 * math.pi * v.y
            mirror = mi.Frame3f(mi.Vector3f(-wi.x, -wi.y, wi.z))
            lobe = mirror.to_world(mi.Vector3f(s * dr.cos(phi), s * dr.sin(phi), c))
            wo = dr.select(u < self.lobes, lobe, wo) if self.kd else lobe
        value, pdf = self.eval_pdf(ctx, si, wo, active)
        b = mi.BSDFSample3f()
        b.wo, b.pdf, b.eta = wo, pdf, 1
        b.sampled_type, b.sampled_component = mi.UInt32(+self.m_components[0]), 0
        return b, dr.select(pdf > 0, value / pdf, 0)


mi.register_bsdf('thesis_phong', Phong)


def mitsuba_scene(ks, kd, n):
    """The world of bis, 5000 times as large, because Mitsuba's shadow rays start 1e-4 (1 + |p|) off the surface: in the
    mesh's own units that is a quarter of a triangle. The light's z is the world's y, as in bis_scene."""
    size = mi.ScalarTransform4f().scale(5000)
    view = mi.ScalarTransform4f().look_at(origin=list(5000 * EYE), target=list(5000 * LOOK), up=[0, 1, 0])
    return mi.load_dict({
        'type': 'scene',
        'integrator': {'type': 'direct', 'emitter_samples': 1, 'bsdf_samples': 1, 'hide_emitters': True},
        'sensor': {'type': 'perspective', 'fov': FOV, 'fov_axis': 'smaller', 'near_clip': 1, 'far_clip': 1e5,
                   'to_world': view, 'sampler': {'type': 'multijitter'},
                   'film': {'type': 'hdrfilm', 'width': WIDTH, 'height': HEIGHT, 'pixel_format': 'rgb',
                            'component_format': 'float32', 'rfilter': {'type': 'box'}}},
        'light': {'type': 'envmap', 'filename': MAP, 'to_world': mi.ScalarTransform4f().rotate([0, 1, 0], -90)},
        'dragon': {'type': 'ply', 'filename': MESH, 'to_world': size,
                   'bsdf': {'type': 'thesis_phong', 'ks': ks, 'kd': kd, 'n': n}}}, parallel=False)


def mitsuba_picture(scene, spp, seed):
    """In float64; mirrored, because the program's world is right-handed and bis's, as pbrt's, left-handed."""
    return np.array(mi.render(scene, spp=spp, seed=seed), dtype=float)[:, ::-1]


def bis_scene(name, material, lines):
    """Write the scene; its path."""
    ks, kd, n = material
    path = f'{out}/scenes/rival-{name}.txt'
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, 'w') as f:
        f.write(f'''LookAt {' '.join(str(x) for x in (*EYE, *LOOK))}  0 1 0
Camera "perspective" "float fov" {FOV}
Film "rgb" "integer xresolution" {WIDTH} "integer yresolution" {HEIGHT}
{lines}
WorldBegin
AttributeBegin
Transform [1 0 0 0  0 0 1 0  0 1 0 0  0 0 0 1]
LightSource "infinite" "string filename" "{MAP}" "bool visible" false
AttributeEnd
Material "phong" "float Ks" {ks} "float Kd" {kd} "float exponent" {n}
Shape "plymesh" "string filename" "{MESH}" "bool smooth" true
''')
    return path


def bis_picture(scene, spp, seed, options=()):
    """Picture and seconds."""
    picture, stats = out + '/rival.pfm', out + '/rival.json'
    subprocess.run([bis, scene, '--quiet', '--spp', str(spp), '--seed', str(seed), '--outfile', picture,
                    '--stats', stats,
                    *options], check=True)
    with open(stats) as f:
        s = json.load(f)
    return load(picture), s['seconds']['render']


def load(picture):
    return np.array(mi.Bitmap(picture), dtype=float)[:, :, :3]


class Reference:
    def __init__(self, name, material):
        """From OUT/ref, or made and kept there."""
        path = f'{out}/ref/rival-{name}-{REFERENCE_SPP}.npy'
        if not os.path.exists(path):
            os.makedirs(out + '/ref', exist_ok=True)
            both = [bis_picture(bis_scene('reference', material, lines), REFERENCE_SPP, 1000001 + i)[0]
                    for i, lines in enumerate(REFERENCES)]
            np.save(path, np.array(both))
        self.h, self.k = np.load(path)
        self.scale = self.k ** 2 + (0.1 * self.k.mean()) ** 2

    def error(self, a, b=None):
        return ((a - self.h) * ((a if b is None else b) - self.k) / self.scale).mean()


def ladder(render, numbers, reference):
    """render(spp, seed) gives picture and seconds. Returns seconds, errors, the floor, how far the mean is off."""
    seconds, errors, means = [], [], []
    for i, spp in enumerate(numbers):
        runs = [render(spp, 10 * i + seed) for seed in range(1 if seconds and seconds[-1] > 4 else 3)]
        seconds.append(min(s for _, s in runs))
        errors.append(np.mean([reference.error(p) for p, _ in runs]))
        means.append(np.mean([p for p, _ in runs], axis=0))
        if errors[-1] < ENOUGH or seconds[-1] > LONGEST:
            break
    return seconds, errors, reference.error(means[-1], means[-2]), means[-1].mean() / reference.k.mean() - 1


def reach(seconds, errors, target):
    """log time is linear in log error between two renders. Beyond the last the error falls as 1/time, marked *; if the
    first has reached the target, its time is given, marked <."""
    for i, e in enumerate(errors):
        if e <= target:
            if i == 0:
                return seconds[0], '<'
            t = math.log(errors[i - 1] / target) / math.log(errors[i - 1] / e)
            return seconds[i - 1] * (seconds[i] / seconds[i - 1]) ** t, ''
    return seconds[-1] * errors[-1] / target, '*'


def timed(scene):
    def render(spp, seed):
        start = time.perf_counter()
        picture = mitsuba_picture(scene, spp, seed)
        return picture, time.perf_counter() - start
    return render


def main():
    version = subprocess.run([bis, '--version'], capture_output=True, text=True, check=True).stdout.split('\n')[0]
    print(f'{version}, Mitsuba {mi.__version__}, {time.strftime("%Y-%m-%d")}, load {os.getloadavg()[0]:.1f}')
    print('scene setting    s to 1e-2  s to 1e-3  rival : bis to 1e-2, to 1e-3     floor  mean off', flush=True)
    for name, material in MATERIALS.items():
        reference = Reference(name, material)
        scene = mitsuba_scene(*material)
        mitsuba_picture(scene, 16, 99)  # compiled here
        settings = {'Mitsuba': timed(scene)}
        for setting, (lines, options) in SETTINGS.items():
            path = bis_scene(f'{name}-{setting}', material, lines)
            settings[setting] = lambda n, seed, p=path, o=(*options, '--nthreads', '1'): bis_picture(p, n, seed, o)
        rival = None
        for setting, render in settings.items():
            numbers = (4, 16, 64, 256, 1024) if rival is None else [2 ** i for i in range(13)]
            seconds, errors, floor, off = ladder(render, numbers, reference)
            reached = [reach(seconds, errors, t) for t in TARGETS]
            rival = rival or reached
            cells = ''.join(f'{s:10.3f}{mark:1s}' for s, mark in reached)
            ratios = ''.join(f'{r[0] / o[0]:13.1f}' for r, o in zip(rival, reached))
            print(f'{name:6s}{setting:9s}{cells}{ratios}{floor:14.0e}{100 * off:8.2f} %', flush=True)


main()
