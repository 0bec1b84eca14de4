# SPDX-License-Identifier: BSD-2-Clause
"""beside_mitsuba: the means of pictures of bis beside those of Mitsuba 3, for scenes inside what both model.

    python3 scripts/check/beside_mitsuba.py BIS OUT [SCENE...]      OUT is a folder for what is made on the way

Mitsuba gets the scene from a reader of its own: this file's, which knows the format from docs/scene-format.md.
Materials (mitsuba_materials.py) and textures are formulas; rays, shapes, cameras, light and integration are Mitsuba's.
Both take the box filter of one pixel, each picture is rendered SEEDS times, and the error bar of a ratio is one
standard error of the means together. A row fails if a channel is off by more than 1 % and by more than 3 such errors.
Substrates and coats are those of that page, which are near pbrt's; a row "by pbrt", which does not judge, has pbrt's
own in their place. Where bis resamples the map, which moves edges that the camera sees, it is judged by a row with a
map of 2048 pixels, as wide as Mitsuba's. Exit status: 0, 1 where a scene fails, 77 without Mitsuba 3, numpy or LLVM
(docs/measured.md says how to get them).

Left out of data/scenes/pbrt are those that only --approximate renders: approximate-v2, -v3 and -v4 (thin lenses, point
and area lights, glass), and every-word (a dozen materials and shapes that bis replaces by others)."""
import gzip
import os
import re
import subprocess
import sys

from mitsuba_materials import NEAR, bsdf, colour, constant, dr, material, mi, np, phong_of

SCENES = ('pbrt/colours-v2 pbrt/pieces-v2 pbrt/row-v3 pbrt/spectra-v3 pbrt/textures-v4 pbrt/tiles-v4 pbrt/own-v4 '
          'pbrt/your-model trianglemesh orthographic instances louvres glossy-row '
          'steel-on-paper coloured-shadows overcast-diffuse outdoor-sun figure-5.4').split()
RESAMPLED = 'equalarea|mirrorball|cross|cubestrip'  # in the names of maps that are not lat-long
SEEDS = 4
SPP = int(os.environ.get('BESIDE_SPP', 64))
LIMIT, ERRORS = 0.01, 3


# ---- the scene's text ----

def tokens(path):
    """Words, numbers, and strings with their quotes; Include is replaced by its file, and files by their whole path."""
    text = re.sub(r'("(?:[^"\\]|\\.)*")|#[^\n]*', lambda m: m.group(1) or '', open(path).read())
    found = re.findall(r'"(?:[^"\\]|\\.)*"|\[|\]|[^\s\[\]"]+', text)
    out, i = [], 0
    while i < len(found):
        if found[i] == 'Include':
            out += tokens(os.path.join(os.path.dirname(path), found[i + 1].strip('"')))
            i += 2
            continue
        if i and out and re.fullmatch(r'"(string (filename|mapname)|spectrum \w+)"', found[i]):
            k = i + 1 + (found[i + 1] == '[')
            if found[k][0] == '"' and not found[k].startswith('"metal-'):
                found[k] = '"' + os.path.join(os.path.dirname(path), found[k].strip('"')) + '"'
        out.append(found[i])
        i += 1
    return out


class Words:
    def __init__(self, path):
        self.list, self.at = tokens(path), 0

    def more(self):
        return self.at < len(self.list)

    def peek(self):
        return self.list[self.at] if self.more() else ''

    def next(self):
        self.at += 1
        return self.list[self.at - 1]

    def numbers(self, n):
        bracket = self.peek() == '['
        self.at += bracket
        v = [float(self.next()) for _ in range(n)]
        self.at += bracket
        return v

    def name(self):
        return self.next().strip('"')

    def parameters(self):
        """{name: (type, values)}; numbers as floats."""
        found = {}
        while self.peek().startswith('"'):
            kind, name = self.name().split()
            values = []
            if self.peek() == '[':
                self.next()
                while self.peek() != ']':
                    values.append(self.next())
                self.next()
            else:
                values.append(self.next())
            if kind in ('string', 'texture', 'bool') or values[0][0] == '"':
                values = [v.strip('"') for v in values]
            else:
                values = [float(v) for v in values]
            found[name] = (kind, values)
        return found


def value(parameters, name, usual):
    return parameters[name][1][0] if name in parameters else usual


# ---- matrices, as the page defines them ----

def translate(x, y, z):
    m = np.eye(4)
    m[:3, 3] = x, y, z
    return m


def rotate(degrees, *axis):
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    a, k = np.radians(degrees), np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    m = np.eye(4)
    m[:3, :3] = np.eye(3) + np.sin(a) * k + (1 - np.cos(a)) * k @ k
    return m


def look_at(v):
    """World to camera: x to the right, y up, z forward, left-handed."""
    eye, at, up = np.array(v[:3]), np.array(v[3:6]), np.array(v[6:])
    z = (at - eye) / np.linalg.norm(at - eye)
    x = np.cross(up, z)
    x /= np.linalg.norm(x)
    m = np.eye(4)
    m[:3, :3] = np.array([x, np.cross(z, x), z]).T
    m[:3, 3] = eye
    return np.linalg.inv(m)


# ---- images and textures ----

def read_bytes(path):
    data = open(path, 'rb').read()
    return gzip.decompress(data) if data[:2] == b'\x1f\x8b' else data


def read_image(path, out):
    """height x width x 3, linear; a PNG's numbers as they are, in [0,1]."""
    plain = os.path.join(out, os.path.basename(path).removesuffix('.gz'))
    data = read_bytes(path)
    with open(plain, 'wb') as f:
        f.write(data)
    a = mi.Bitmap(plain).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=plain.endswith('.png'))
    exposure = re.search(rb'\nEXPOSURE=([0-9.]+)\n', data[:200]) if plain.endswith('.hdr') else None
    return np.array(a, dtype=np.float32) / (float(exposure.group(1)) if exposure else 1)


def decode(a, encoding):
    if encoding == 'linear':
        return a
    if encoding.startswith('gamma'):
        return a ** float(encoding.split()[1])
    return np.where(a <= 0.04045, a / 12.92, ((a + 0.055) / 1.055) ** 2.4)


def mapped(p):
    su, sv, du, dv = (value(p, k, d) for k, d in (('uscale', 1), ('vscale', 1), ('udelta', 0), ('vdelta', 0)))
    return lambda u, v: (su * u + du, sv * v + dv)


def image_texture(p, out):
    path = value(p, 'filename', '')
    a = read_image(path, out)
    if path.endswith('.png'):
        a = decode(a, 'linear' if value(p, 'gamma', 'true') == 'false' else value(p, 'encoding', 'sRGB'))
    h, w = a.shape[:2]
    pixels = mi.Float(np.ascontiguousarray(a[::-1]).astype(np.float32).ravel())  # row 0 at the bottom
    wrap, scale = value(p, 'wrap', 'repeat'), value(p, 'scale', 1)
    invert, to_st = value(p, 'invert', 'false') == 'true', mapped(p)

    def texel(i, j):
        inside = dr.full(mi.Mask, True, 1)
        if wrap == 'repeat':
            i, j = i - w * mi.Int(dr.floor(mi.Float(i) / w)), j - h * mi.Int(dr.floor(mi.Float(j) / h))
        if wrap == 'black':
            inside = (i >= 0) & (i < w) & (j >= 0) & (j < h)
        at = 3 * (dr.clip(i, 0, w - 1) + w * dr.clip(j, 0, h - 1))
        c = mi.Color3f(*(dr.gather(mi.Float, pixels, mi.UInt(at + k)) for k in range(3)))
        return dr.select(inside, c, mi.Color3f(0))

    def look_up(u, v):
        s, t = to_st(u, v)
        x, y = s * w - 0.5, t * h - 0.5
        i, j = dr.floor(x), dr.floor(y)
        a, b, i, j = x - i, y - j, mi.Int(i), mi.Int(j)
        c = ((texel(i, j) * (1 - a) + texel(i + 1, j) * a) * (1 - b)
             + (texel(i, j + 1) * (1 - a) + texel(i + 1, j + 1) * a) * b) * scale
        return 1 - c if invert else c
    return look_up


def texture(kind, p, known, out):
    def part(name, usual):
        if name in p and p[name][0] == 'texture':
            return known[p[name][1][0]]
        return constant(colour(*p[name]) if name in p else usual)

    if kind == 'imagemap':
        return image_texture(p, out)
    if kind == 'constant':
        return part('value', 1)
    if kind == 'scale':
        a, b = (part('tex', 1), part('scale', 1)) if 'tex' in p or 'scale' in p else (part('tex1', 1), part('tex2', 1))
        return lambda u, v: a(u, v) * b(u, v)
    if kind == 'mix':
        a, b, amount = part('tex1', 0), part('tex2', 1), part('amount', 0.5)

        def mix(u, v):
            m = amount(u, v)
            m = (m.x + m.y + m.z) / 3
            return a(u, v) * (1 - m) + b(u, v) * m
        return mix
    if kind == 'checkerboard':
        a, b, to_st = part('tex1', 1), part('tex2', 0), mapped(p)

        def checks(u, v):
            s, t = to_st(u, v)
            even = (mi.Int(dr.floor(s)) + mi.Int(dr.floor(t))) & 1 == 0
            return dr.select(even, a(u, v), b(u, v))
        return checks
    raise NotImplementedError(f'Texture "{kind}"')


# ---- shapes ----

def mesh_of(points, faces, normals, uv, surface):
    props = mi.Properties()
    props['surface'] = mi.load_dict(surface)
    m = mi.Mesh('mesh', len(points), len(faces), has_vertex_normals=normals is not None,
                has_vertex_texcoords=uv is not None,
                props=props)
    t = mi.traverse(m)
    t['vertex_positions'], t['faces'] = np.ravel(points).astype(np.float32), np.ravel(faces).astype(np.uint32)
    if normals is not None:
        t['vertex_normals'] = np.ravel(normals).astype(np.float32)
    if uv is not None:
        t['vertex_texcoords'] = np.ravel(uv).astype(np.float32)
    t.update()
    return m


def moved(m, points):
    return np.asarray(points) @ m[:3, :3].T + m[:3, 3]


def turned(m, normals):
    n = np.asarray(normals) @ np.linalg.inv(m[:3, :3])
    return n / np.linalg.norm(n, axis=1, keepdims=True)


def read_mtl(path, out):
    found, name = {}, None
    for line in open(path):
        w = line.split()
        if w and w[0] == 'newmtl':
            name = w[1]
            found[name] = {'Kd': [1, 1, 1], 'Ks': [0, 0, 0], 'Ns': 1, 'map': None}
        elif w and w[0] in ('Kd', 'Ks'):
            found[name][w[0]] = [float(x) for x in w[1:4]]
        elif w and w[0] == 'Ns':
            found[name]['Ns'] = float(w[1])
        elif w and w[0] == 'map_Kd':
            found[name]['map'] = os.path.join(os.path.dirname(path), w[1])
    made = {}
    for name, m in found.items():
        kd = constant(m['Kd'])
        if m['map']:
            image = image_texture({'filename': ('string', [m['map']])}, out)
            kd = lambda u, v, a=kd, b=image: a(u, v) * b(u, v)
        made[name] = phong_of(kd, m['Ks'], m['Ns'])
    return made


def smooth_normals(points, triangles):
    """Sums of the faces' normals, weighted by their angles at the point (bis_mesh_smooth_normals says so)."""
    normals = np.zeros_like(points)
    for i in range(3):
        at, a, b = (points[triangles[:, (i + k) % 3]] for k in range(3))
        a, b = ((e - at) / np.linalg.norm(e - at, axis=1, keepdims=True) for e in (a, b))
        n = np.cross(a, b)
        size = np.linalg.norm(n, axis=1, keepdims=True)
        np.add.at(normals, triangles[:, i], n / size * np.arctan2(size, (a * b).sum(1, keepdims=True)))
    return normals


def obj_parts(path, usual, out):
    """(points, corners, normals of the points, uv of the corners, material) of an OBJ of polygons with v and vt."""
    points, uv, parts, library, present = [], [], {}, {}, None
    for line in read_bytes(path).decode().splitlines():
        w = line.split()
        if not w:
            continue
        if w[0] == 'mtllib':
            library = read_mtl(os.path.join(os.path.dirname(path), w[1]), out)
        elif w[0] == 'v':
            points.append([float(x) for x in w[1:4]])
        elif w[0] == 'vt':
            uv.append([float(x) for x in w[1:3]])
        elif w[0] == 'usemtl':
            present = w[1]
        elif w[0] == 'f':
            corners = [[int(k) - 1 for k in c.split('/')] for c in w[1:]]
            for i in range(1, len(corners) - 1):
                parts.setdefault(present, []).append([corners[0], corners[i], corners[i + 1]])
    points, uv = np.array(points), np.array(uv)
    normals = smooth_normals(points, np.concatenate([np.array(t)[:, :, 0] for t in parts.values()]))
    for name, triangles in parts.items():
        corner = np.array(triangles).reshape(-1, 2)
        yield points, corner[:, 0], normals, uv[corner[:, 1]], library.get(name, usual)


def shapes_of(kind, p, ctm, surface, out):
    """Mitsuba's shapes for a Shape."""
    if kind == 'trianglemesh':
        points = np.array(p['P'][1]).reshape(-1, 3)
        normals = turned(ctm, np.array(p['N'][1]).reshape(-1, 3)) if 'N' in p else None
        uv = next((np.array(p[k][1]).reshape(-1, 2) for k in ('uv', 'st') if k in p), None)
        faces = np.array(p['indices'][1] if 'indices' in p else [0, 1, 2]).reshape(-1, 3)
        return [mesh_of(moved(ctm, points), faces, normals, uv, bsdf(surface))]
    if kind == 'sphere':
        r = value(p, 'radius', 1)
        return [mi.load_dict({'type': 'sphere', 'radius': r, 'to_world': mi.ScalarTransform4f(ctm),
                              'bsdf': bsdf(surface, kind, ctm, r)})]
    if kind == 'disk':
        r, h = value(p, 'radius', 1), value(p, 'height', 0)
        m = ctm @ translate(0, 0, h) @ np.diag([r, r, 1, 1])
        return [mi.load_dict({'type': 'disk', 'to_world': mi.ScalarTransform4f(m),
                              'bsdf': bsdf(surface, kind, ctm, r)})]
    path = value(p, 'filename', '')
    if kind == 'objmesh':
        own, smooth = (value(p, name, 'false') == 'true' for name in ('materials', 'smooth'))
        return [mesh_of(moved(ctm, points[v]), np.arange(len(v)).reshape(-1, 3),
                        turned(ctm, n[v]) if smooth else None, uv,
                        bsdf(s if own else surface)) for points, v, n, uv, s in obj_parts(path, surface, out)]
    if kind == 'plymesh':
        plain = os.path.join(out, os.path.basename(path).removesuffix('.gz'))
        with open(plain, 'wb') as f:
            f.write(read_bytes(path))
        return [mi.load_dict({'type': 'ply', 'filename': plain, 'to_world': mi.ScalarTransform4f(ctm),
                              'bsdf': bsdf(surface)})]
    raise NotImplementedError(f'Shape "{kind}"')


# ---- light ----

def face_pixel(d, side, places):
    """From directions (front, right, up) to pixels of faces: places[face] = (column, row, turned)."""
    f, r, u = d
    faces = {'front': (f, r, u), 'back': (-f, -r, u), 'right': (r, -f, u), 'left': (-r, f, u), 'up': (u, r, -f),
             'down': (-u, r, f)}
    x, y = np.zeros(f.shape, int), np.zeros(f.shape, int)
    for name, (main, a, b) in faces.items():
        on = (main > 0) & (main >= np.abs(a)) & (main >= np.abs(b))
        column, row, is_turned = places[name]
        s, t = (a / np.where(on, main, 1) + 1) / 2, (1 - b / np.where(on, main, 1)) / 2
        if is_turned:
            s, t = 1 - s, 1 - t
        px = np.clip((s * side).astype(int), 0, side - 1) + column * side
        py = np.clip((t * side).astype(int), 0, side - 1) + row * side
        x, y = np.where(on, px, x), np.where(on, py, y)
    return x, y


def to_latlong(a, mapping, width=2048, parts=4):
    """The map as bis looks it up, in small steps: the mean of the source's pixels of parts x parts directions each."""
    if mapping == 'latlong':
        k = max(1, 4096 // a.shape[1])
        return a.repeat(k, 0).repeat(k, 1)
    step, offsets = 2 * np.pi / width, (np.arange(parts) + 0.5) / parts
    total = np.zeros((width // 2, width, 3))
    for i in offsets:
        for j in offsets:
            theta, phi = np.meshgrid((np.arange(width // 2) + i) * step, (np.arange(width) + j) * step, indexing='ij')
            total += looked_up(a, mapping, np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta))
    return total / parts ** 2


def looked_up(a, mapping, x, y, z):
    if mapping == 'equalarea':
        r = np.sqrt(1 - np.abs(z))
        q = np.arctan2(np.abs(y), np.abs(x)) * 2 / np.pi
        v = q * r
        u = r - v
        u, v = np.where(z < 0, 1 - v, u), np.where(z < 0, 1 - u, v)
        u, v = (np.copysign(u, x) + 1) / 2, (np.copysign(v, y) + 1) / 2
        n = a.shape[0]
        return a[np.minimum((v * n).astype(int), n - 1), np.minimum((u * n).astype(int), n - 1)]
    if mapping == 'mirrorball':
        n, r = a.shape[0], np.sqrt((1 + x) / 2) / np.maximum(np.hypot(y, z), 1e-9)  # the sine of half the angle from -x
        return a[np.clip((1 - r * z) * n / 2, 0, n - 1).astype(int), np.clip((1 - r * y) * n / 2, 0, n - 1).astype(int)]
    if mapping == 'verticalcross':
        places = {'up': (1, 0, 0), 'left': (0, 1, 0), 'front': (1, 1, 0), 'right': (2, 1, 0), 'down': (1, 2, 0),
                  'back': (1, 3, 1)}
        px, py = face_pixel((-x, -y, z), a.shape[1] // 3, places)
        return a[py, px]
    if mapping == 'cubestrip':
        side = min(a.shape[:2])
        places = {name: (i, 0, 0) if a.shape[1] > side else (0, i, 0)
                  for i, name in enumerate(('right', 'left', 'up', 'down', 'front', 'back'))}
        px, py = face_pixel((-x, -y, z), side, places)
        return a[py, px]
    raise NotImplementedError(f'mapping {mapping}')


# Mitsuba's envmap has y up; columns begin elsewhere.
TO_MITSUBA = np.array([[0, 1, 0], [0, 0, 1], [-1, 0, 0]], float)


def light(p, ctm, out):
    factor = np.ones(3)
    for name in ('L', 'scale'):
        if name in p:
            factor = factor * colour(*p[name])
    path = value(p, 'filename', None) or value(p, 'mapname', None)
    if not path:
        return {'type': 'constant', 'radiance': {'type': 'rgb', 'value': [float(x) for x in factor]}}
    a = read_image(path, out)
    m = np.eye(4)
    m[:3, :3] = ctm[:3, :3] @ TO_MITSUBA.T
    mapping = value(p, 'mapping', 'equalarea' if 'filename' in p and a.shape[0] == a.shape[1] else 'latlong')
    bitmap = mi.Bitmap(np.ascontiguousarray(to_latlong(a * factor.astype(np.float32), mapping).astype(np.float32)))
    return {'type': 'envmap', 'bitmap': bitmap, 'to_world': mi.ScalarTransform4f(m)}


# ---- camera ----

def camera(kind, p, film, to_camera):
    """The sensor, and what makes bis's picture of Mitsuba's, whose x runs to the left where pbrt's runs to the
    right."""
    w, h = int(value(film, 'xresolution', 1280)), int(value(film, 'yresolution', 720))
    screen = p['screenwindow'][1] if 'screenwindow' in p else np.array([-w, w, -h, h]) / min(w, h)
    if not np.allclose(screen, np.array([-screen[1], screen[1], -screen[1] * h / w, screen[1] * h / w])):
        raise NotImplementedError('a part of the screen')
    m = np.linalg.inv(to_camera)
    mirrored = np.linalg.det(m) > 0
    if not mirrored:
        m = m @ np.diag([-1, 1, 1, 1])
    x0, x1, y0, y1 = (int(np.ceil(c * n)) for c, n in zip(film.get('cropwindow', (0, [0, 1, 0, 1]))[1], (w, w, h, h)))

    def finish(a):
        return (a[:, ::-1] if mirrored else a)[y0:y1, x0:x1]
    common = {'near_clip': 1e-2, 'far_clip': 1e5, 'sampler': {'type': 'independent'},
              'film': {'type': 'hdrfilm', 'width': w, 'height': h, 'pixel_format': 'rgb', 'component_format': 'float32',
                       'rfilter': {'type': 'box'}}}
    if kind == 'orthographic':
        return {'type': kind, 'to_world': mi.ScalarTransform4f(m @ np.diag([screen[1], screen[1], 1, 1])),
                **common}, finish
    half = np.tan(np.radians(value(p, 'fov', 90)) / 2) * screen[1]
    return {'type': kind, 'to_world': mi.ScalarTransform4f(m), 'fov_axis': 'x',
            'fov': float(2 * np.degrees(np.arctan(half))),
            **common}, finish


# ---- the scene ----

class State:
    def __init__(self):
        self.ctm, self.surface = np.eye(4), phong_of(constant(0.5))

    def copy(self):
        s = State()
        s.ctm, s.surface = self.ctm, self.surface
        return s


# What a directive makes of the transformation.
MOVES = {
    'Identity': lambda ctm, w: np.eye(4),
    'Translate': lambda ctm, w: ctm @ translate(*w.numbers(3)),
    'Scale': lambda ctm, w: ctm @ np.diag(w.numbers(3) + [1]),
    'Rotate': lambda ctm, w: ctm @ rotate(*w.numbers(4)),
    'LookAt': lambda ctm, w: ctm @ look_at(w.numbers(9)),
    'Transform': lambda ctm, w: np.array(w.numbers(16)).reshape(4, 4).T,
    'ConcatTransform': lambda ctm, w: ctm @ np.array(w.numbers(16)).reshape(4, 4).T,
}


def surface_of(d, w, named, textures, by_page):
    """What a directive of materials speaks of; kept in named[] if it has a name."""
    name = w.name()
    if d == 'NamedMaterial':
        return named[name]
    p = w.parameters()
    if d == 'Material':
        return material(name, p, textures, by_page)
    named[name] = material(p['type'][1][0], p, textures, by_page)


def scene_of(shapes, lamp, seen, view, film):
    sensor, finish = camera(*view[:2], film, view[2])
    parts = {f'shape{i}': s for i, s in enumerate(shapes)}
    integrator = {'type': 'direct', 'emitter_samples': 2, 'bsdf_samples': 2, 'hide_emitters': not seen}
    return mi.load_dict({'type': 'scene', 'integrator': integrator, 'sensor': sensor, 'light': lamp, **parts},
                        parallel=False), finish


def read_scene(path, out, by_page=True):
    """Mitsuba's scene, and what to do with its picture."""
    w, now, stack, systems = Words(path), State(), [], {}
    named, textures, objects, present = {}, {}, {}, None
    film, view, lamp, shapes, seen = {}, ('perspective', {}, np.eye(4)), None, [], True

    while w.more():
        d = w.next()
        if d in MOVES:
            now.ctm = MOVES[d](now.ctm, w)
        elif d == 'CoordinateSystem':
            systems[w.name()] = now.ctm
        elif d == 'CoordSysTransform':
            now.ctm = systems[w.name()]
        elif d in ('AttributeBegin', 'TransformBegin'):
            stack.append(now.copy())
        elif d in ('AttributeEnd', 'TransformEnd', 'ObjectEnd'):
            surface = now.surface
            now = stack.pop()
            if d == 'TransformEnd':
                now.surface = surface
            if d == 'ObjectEnd':
                present = None
        elif d == 'ObjectBegin':
            stack.append(now.copy())
            present = objects[w.name()] = []
        elif d == 'ObjectInstance':
            for kind, p, ctm, surface in objects[w.name()]:
                shapes.extend(shapes_of(kind, p, now.ctm @ ctm, surface, out))
        elif d == 'WorldBegin':
            now.ctm = systems['world'] = np.eye(4)
        elif d == 'Camera':
            view = w.name(), w.parameters(), now.ctm
            systems['camera'] = np.linalg.inv(now.ctm)
        elif d == 'Film':
            w.name()
            film = w.parameters()
        elif d == 'LightSource':
            assert w.name() == 'infinite'
            p = w.parameters()
            lamp, seen = light(p, now.ctm, out), value(p, 'visible', 'true') == 'true'
        elif d == 'Texture':
            name, _, kind = w.name(), w.name(), w.name()
            textures[name] = texture(kind, w.parameters(), textures, out)
        elif d in ('Material', 'NamedMaterial', 'MakeNamedMaterial'):
            now.surface = surface_of(d, w, named, textures, by_page) or now.surface
        elif d == 'Shape':
            kind, p = w.name(), w.parameters()
            if present is None:
                shapes.extend(shapes_of(kind, p, now.ctm, now.surface, out))
            else:
                present.append((kind, p, now.ctm, now.surface))
        elif d in ('Sampler', 'Integrator', 'PixelFilter', 'Accelerator', 'ColorSpace'):
            w.name()
            w.parameters()
        elif d not in ('WorldEnd', 'ReverseOrientation'):
            raise NotImplementedError(d)
    return scene_of(shapes, lamp, seen, view, film)


# ---- both pictures ----

def bis_pictures(bis, path, out, spp=SPP):
    picture, found = os.path.join(out, 'beside.pfm'), []
    for i in range(SEEDS):
        subprocess.run([bis, path, '--quiet', '--spp', str(spp), '--seed', str(100 + i), '--outfile', picture],
                       check=True)
        found.append(np.array(mi.Bitmap(picture), dtype=float)[:, :, :3])
    return found


def with_wide_map(path, out):
    """A copy of the scene, whose map bis resamples to as many pixels as the reference has."""
    copy, light = os.path.join(out, 'wide.txt'), 'LightSource "infinite"'
    text = re.sub(r'"integer width" (\d+|\[ \d+ \])', '', ' '.join(tokens(path)))
    with open(copy, 'w') as f:
        f.write(text.replace(light, light + ' "integer width" 2048'))
    return copy


def mitsuba_pictures(path, out, by_page, spp=SPP):
    scene, finish = read_scene(path, out, by_page)
    return [finish(np.array(mi.render(scene, spp=spp, seed=1000 + i), dtype=float)) for i in range(SEEDS)]


def mean_and_error(pictures):
    means = np.array([p.mean((0, 1)) for p in pictures])
    return means.mean(0), means.std(0, ddof=1) / np.sqrt(len(means))


def worst_tile(a, b):
    """The largest difference of an eighth of the picture's width and height, in per cent."""
    a, b = (np.mean(x, axis=(0, 3)) for x in (a, b))
    return 100 * max(abs(p.mean() / q.mean() - 1) for s, t in zip(np.array_split(a, 4), np.array_split(b, 4))
                     for p, q in zip(np.array_split(s, 4, 1), np.array_split(t, 4, 1)))


def row(ours, theirs):
    (a, ea), (b, eb) = mean_and_error(ours), mean_and_error(theirs)
    ratio, error = a / b - 1, np.hypot(ea / a, eb / b)
    fails = bool(np.any((np.abs(ratio) > LIMIT) & (np.abs(ratio) > ERRORS * error)))
    return ''.join(f'{100 * r:+8.2f} +-{100 * e:5.2f}'
                   for r, e in zip(ratio, error)) + f'{worst_tile(ours, theirs):8.1f}', fails


def main():
    bis, out = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    os.makedirs(out, exist_ok=True)
    failed = 0
    print(f'bis beside Mitsuba {mi.__version__}: mean of bis over mean of Mitsuba, less 1, in %; worst of 4 x 4 tiles')
    print(f'{"scene":24s}{"red":>12s}{"green":>16s}{"blue":>16s}{"tile":>12s}', flush=True)
    for path in map(os.path.abspath, sys.argv[3:] or [f'data/scenes/{s}.txt' for s in SCENES]):
        name, words = os.path.splitext(os.path.basename(path))[0], set(tokens(path))
        resampled = any(re.search(RESAMPLED, w) for w in words)
        try:
            ours, theirs = bis_pictures(bis, path, out), mitsuba_pictures(path, out, True)
            cells, fails = row(ours, theirs)
            print(f'{name:22s}{cells}' + ('   FAILED' if fails and not resampled else ''), flush=True)
            if resampled:
                cells, fails = row(bis_pictures(bis, with_wide_map(path, out), out), theirs)
                print(f'{"  map 2048 wide":22s}{cells}' + ('   FAILED' if fails else ''), flush=True)
            if {f'"{n}"' for n in NEAR} & words:
                print(f'{"  by pbrt":22s}{row(ours, mitsuba_pictures(path, out, False))[0]}', flush=True)
        except NotImplementedError as e:
            print(f'{name:22s}  left out: {e} is not known here', flush=True)
            fails = False
        failed += fails
    sys.exit(1 if failed else 0)


if __name__ == '__main__':
    main()
