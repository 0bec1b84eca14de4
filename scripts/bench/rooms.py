# SPDX-License-Identifier: BSD-2-Clause
"""rooms: squared error times seconds in rooms lit through openings, without and with portals,
beside a portal integrator in Mitsuba 3. docs/theory.md reads the table.

    python3 scripts/bench/rooms.py BIS MAPS OUT [WORD]     OUT keeps scenes; only rooms with WORD

Every method renders each room with five seeds; bis without portals, with those that it finds, and
with given ones of .99, 1 and 1.1 of the size.
All are unbiased, so the error of a method is the variance over its seeds, over
r^2 + (0.1 mean r)^2, where r is the mean of all pictures of the room. The seconds are the least of
the seeds, of rendering alone, and of the processor, because those of a clock favour the shorter
render on a busy machine. The last column is the standard error of error x seconds in per cent."""
import json
import math
import os
import resource
import subprocess
import sys
import time

import numpy as np
import drjit as dr
import mitsuba as mi

mi.set_variant('llvm_ad_rgb')
dr.set_thread_count(2)  # a pool of one hangs
bis, maps, out = (os.path.abspath(p) for p in sys.argv[1:4])
WIDTH, HEIGHT, SEEDS = 160, 120, 5
EYE, LOOK, FOV = (-1.7, -1.7, 1.6), (1, .6, .9), 70
TURNS = {'overcast': 0, 'outdoor': -200, 'studio': -100}  # degrees: sun and lamps behind the window


def box(low, high):
    """Its rectangles: each a corner and two edges."""
    low, edges = np.array(low, float), np.diag(np.subtract(high, low))
    return [(low + far * edges[i], edges[(i + 1) % 3], edges[(i + 2) % 3])
            for i in range(3) for far in (0, 1)]


def room(openings):
    """4 x 4 x 3 inside. Walls are thick, because light would leak in where two rectangles meet."""
    walls = [((-2.1, -2.1, -.1), (2.1, 2.1, 0)), ((-2.1, -2.1, 3), (2.1, 2.1, 3.1)),
             ((-2.1, -2.1, -.1), (-2, 2.1, 3.1)), ((-2.1, -2.1, -.1), (2.1, -2, 3.1))]
    for axis in (0, 1):
        a, b, low, high = next((o[1:] for o in openings if o[0] == axis), (0, 0, 0, 0))
        for a0, a1, z0, z1 in ((-2.1, a, -.1, 3.1), (b, 2.1, -.1, 3.1), (a, b, -.1, low),
                               (a, b, high, 3.1)):
            corners = np.array(((2, a0, z0), (2.1, a1, z1)))
            walls += [corners if axis == 0 else corners[:, [1, 0, 2]]] if a0 < a1 else []
    return [r for low, high in walls for r in box(low, high)]


def portal(axis, a, b, low, high):
    """The outer rectangle of an opening in the wall x = 2 (axis 0) or y = 2: the sides of the
    opening see light through it, too."""
    along = np.eye(3)[1 - axis]
    corner = 2.1 * np.eye(3)[axis] + a * along + [0, 0, low]
    return corner, (b - a) * along, np.array([0, 0, high - low])


SIDE, BACK, DOOR = (0, -.5, .5, 1, 2), (1, -.6, .6, 1, 2), (0, -.4, .5, 0, 2.1)
BLINDS = [(np.array((2, -.5, 1 + .1 * i)), np.array((0, 1, 0)), np.array((.06, 0, .06)))
          for i in range(10)]
TABLE = sum((box((x, y, 0), (x + .06, y + .06, .7)) for x in (-.2, .94) for y in (-.4, .74)),
            box((-.2, -.4, .7), (1, .8, .75)) + box((.2, 0, .75), (.5, .3, 1.1)))
ROOMS = {
    'one window, overcast': ('overcast', [SIDE], []),
    'two windows, outdoor': ('outdoor', [SIDE, BACK], []),
    'blinds, outdoor': ('outdoor', [SIDE], BLINDS),
    'door, overcast': ('overcast', [DOOR], []),
    'furniture, outdoor': ('outdoor', [SIDE], TABLE),
    'one window, studio': ('studio', [SIDE], []),
    'one window, rgb L': (None, [SIDE], [])}


def points(rectangle):
    c, a, b = rectangle
    return [c, c + a, c + a + b, c + b]


def scaled(rectangle, scale):
    corner, along, up = rectangle
    return corner + (1 - scale) / 2 * (along + up), scale * along, scale * up


def numbers(rectangle):
    return ' '.join(f'{x:g}' for p in points(rectangle) for x in p)


def bis_scene(sky, openings, things, scale):
    """The text. Its portals are `scale` as wide and as high as the openings; 0: none; None: bis
    looks for them."""
    light = f'"string filename" "{maps}/{sky}.hdr"' if sky else '"rgb L" [1 1 1]'
    lights = [f'LightSource "infinite" {light} "bool visible" false {words}' for words in (
        [f'"point3 portal" [{numbers(scaled(portal(*o), scale))}]' for o in openings]
        if scale else [''] if scale is None else ['"bool windows" false'])]
    shapes = [f'Shape "trianglemesh" "point3 P" [{numbers(r)}] "integer indices" [0 1 2 0 2 3]'
              for r in room(openings) + things]
    return '\n'.join([
        'Scale -1 1 1', 'LookAt ' + ' '.join(map(str, (*EYE, *LOOK, 0, 0, 1))),
        f'Camera "perspective" "float fov" {FOV}',
        f'Film "rgb" "integer xresolution" {WIDTH} "integer yresolution" {HEIGHT}', 'WorldBegin',
        'AttributeBegin', f'Rotate {TURNS.get(sky, 0)} 0 0 1', *lights, 'AttributeEnd',
        'Material "diffuse" "rgb reflectance" [.5 .5 .5]', *shapes, ''])


class Portals(mi.SamplingIntegrator):
    """One sample of direct light: through a portal, uniform in its solid angle (Urena et al. 2013),
    or with probability 1 - weight of the map. Its density is that of the mixture."""

    def __init__(self, props):
        super().__init__(props)
        self.weight, self.portals = props['weight'], PORTALS.copy()

    def sample(self, scene, sampler, ray, medium=None, active=True):
        w, light, si = self.weight, scene.environment(), scene.ray_intersect(ray, active)
        found, which, u = si.is_valid(), sampler.next_1d(), sampler.next_2d()
        views = [View(si.p, *p) for p in self.portals]
        ds = light.sample_direction(si, u, found)[0] if w < 1 else dr.zeros(mi.DirectionSample3f)
        for k, v in enumerate(views):
            mine = (which * len(views) >= k * w) & (which * len(views) < (k + 1) * w)
            ds.d = dr.select(mine, v.sample(u), ds.d)
        q = sum(v.pdf(ds.d) for v in views) * (w / len(views))
        q += (1 - w) * light.pdf_direction(si, ds, found) if w < 1 else 0
        sky = dr.zeros(mi.SurfaceInteraction3f)
        sky.wi = -ds.d
        seen = found & (q > 0) & ~scene.ray_test(si.spawn_ray(ds.d), found)
        f = si.bsdf().eval(mi.BSDFContext(), si, si.to_local(ds.d), seen)
        return dr.select(seen, f * light.eval(sky) / q, 0), found, []


mi.register_integrator('portals', Portals)
PORTALS = []


class View:
    """A rectangle as p sees it."""

    def __init__(self, p, corner, along, up):
        a, b = (dr.normalize(mi.Vector3f(*map(float, e))) for e in (along, up))
        c, d = dr.cross(a, b), mi.Point3f(*map(float, corner)) - p
        self.c = c * dr.sign(dr.dot(c, d))
        self.a, self.b, self.z = a, b, dr.dot(self.c, d)
        self.x, self.y = dr.dot(a, d), dr.dot(b, d)
        self.X, self.Y = self.x + float(np.linalg.norm(along)), self.y + float(np.linalg.norm(up))
        sides = (self.x, self.X, self.y, self.Y)
        x, X, y, Y = (t * dr.rsqrt(t * t + self.z * self.z) for t in sides)
        self.low, self.high = y, Y
        self.turn = 2 * math.pi - dr.acos(Y * x) - dr.acos(-x * y)
        self.angle = dr.asin(X * Y) + dr.asin(x * y) - dr.asin(X * y) - dr.asin(x * Y)

    def sample(self, u):
        s, c = dr.sincos(u.x * self.angle + self.turn)
        f = (-c * self.low - self.high) / s
        c = dr.minimum(dr.rsqrt(f * f + self.low * self.low), 1 - 1e-7)
        x = dr.clip(dr.copysign(c * self.z * dr.rsqrt(1 - c * c), f), self.x, self.X)
        d = dr.sqrt(x * x + self.z * self.z)
        h, H = (y * dr.rsqrt(d * d + y * y) for y in (self.y, self.Y))
        h += u.y * (H - h)
        return dr.normalize(x * self.a + h * d * dr.rsqrt(1 - h * h) * self.b + self.z * self.c)

    def pdf(self, d):
        t = self.z / dr.dot(d, self.c)
        x, y = t * dr.dot(d, self.a), t * dr.dot(d, self.b)
        inside = (t > 0) & (x >= self.x) & (x <= self.X) & (y >= self.y) & (y <= self.Y)
        return dr.select(inside & (self.angle > 1e-6), 1 / self.angle, 0)


def mitsuba_render(sky, openings, things, integrator):
    """A function of samples and seed that returns a picture and seconds."""
    quads = room(openings) + things
    with open(out + '/room.ply', 'w') as f:
        f.write(f'ply\nformat ascii 1.0\nelement vertex {4 * len(quads)}\nproperty float x\n'
                f'property float y\nproperty float z\nelement face {2 * len(quads)}\n'
                'property list uchar int vertex_indices\nend_header\n')
        f.writelines('%g %g %g\n' % tuple(p) for q in quads for p in points(q))
        for i in range(0, 4 * len(quads), 4):
            f.write(f'3 {i} {i + 1} {i + 2}\n3 {i} {i + 2} {i + 3}\n')
    world = mi.ScalarTransform4f()
    unit = mi.ScalarTransform4f([[0, 0, -1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    PORTALS[:] = [portal(*o) for o in openings]
    scene = mi.load_dict({
        'type': 'scene', 'integrator': integrator,
        'light': {'type': 'envmap', 'filename': f'{maps}/{sky}.hdr',
                  'to_world': world.rotate([0, 0, 1], TURNS[sky]) @ unit
                  } if sky else {'type': 'constant'},
        'sensor': {'type': 'perspective', 'fov': FOV, 'fov_axis': 'smaller',
                   'to_world': world.look_at(origin=list(EYE), target=list(LOOK), up=[0, 0, 1]),
                   'sampler': {'type': 'multijitter'},
                   'film': {'type': 'hdrfilm', 'width': WIDTH, 'height': HEIGHT,
                            'pixel_format': 'rgb', 'component_format': 'float32',
                            'rfilter': {'type': 'box'}}},
        'room': {'type': 'ply', 'filename': out + '/room.ply', 'face_normals': True,
                 'bsdf': {'type': 'twosided', 'side': {'type': 'diffuse', 'reflectance': .5}}}})

    def render(spp, seed):
        start = time.process_time()
        picture = np.array(mi.render(scene, spp=spp, seed=seed), dtype=float)
        return picture, time.process_time() - start
    render(4, 0)  # compiled here
    return render


def children_time():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def bis_render(name, text):
    """The same."""
    scene, picture, stats = (f'{out}/{name}{end}' for end in ('.txt', '.pfm', '.json'))
    with open(scene, 'w') as f:
        f.write(text)

    def render(spp, seed):
        start = children_time()
        subprocess.run([bis, scene, '--quiet', '--spp', str(spp), '--seed', str(seed),
                        '--nthreads', '1', '--outfile', picture, '--stats', stats], check=True)
        with open(stats) as f:
            seconds = json.load(f)['seconds']
        seconds = (children_time() - start) * seconds['render'] / seconds['total']
        return np.array(mi.Bitmap(picture), dtype=float)[:, :, :3], seconds
    return render


def measure(name, sky, openings, things):
    """Print a line for each method."""
    mixture = [{'type': 'portals', 'weight': w} for w in (1, .5)]
    direct = {'type': 'direct', 'emitter_samples': 1, 'bsdf_samples': 1, 'hide_emitters': True}
    sizes = {'bis': 0, 'bis, found': None, 'bis, portals': 1, 'bis, portals .99': .99,
             'bis, portals 1.1': 1.1}
    methods = {
        **{how: (16, bis_render(f'room{size}', bis_scene(sky, openings, things, size)))
           for how, size in sizes.items()},
        **{f'Mitsuba, {how}': (n, mitsuba_render(sky, openings, things, i)) for how, n, i in (
            ('direct', 121, direct), ('portals', 64, mixture[0]),
            ('portals and map', 64, mixture[1]))}}
    runs = {m: [] for m in methods}
    for seed in range(1, SEEDS + 1):
        for m, (spp, render) in methods.items():
            runs[m].append(render(spp, seed))
    pictures = {m: np.array([p for p, _ in r]) for m, r in runs.items()}
    mean = np.mean([p.mean(0) for p in pictures.values()], axis=0)
    scale = mean ** 2 + (.1 * mean.mean()) ** 2
    for m, p in pictures.items():
        errors = ((p - p.mean(0)) ** 2 / scale).mean((1, 2, 3)) * SEEDS / (SEEDS - 1)
        error, seconds = errors.mean(), min(t for _, t in runs[m])
        doubt = 100 * errors.std(ddof=1) / error / SEEDS ** .5
        print(f'"{name}","{m}",{methods[m][0]},{p.mean():.5g},{error:.3g},{seconds:.3g},'
              f'{error * seconds:.3g},{doubt:.0f}', flush=True)


print('room,method,samples,mean,error,seconds,error x seconds,standard error in per cent')
for room_name, parts in ROOMS.items():
    if len(sys.argv) < 5 or sys.argv[4] in room_name:
        measure(room_name, *parts)
