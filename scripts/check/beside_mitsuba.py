"""beside_mitsuba: the means of pictures of bis beside those of Mitsuba 3, for scenes inside what both model.

    python3 scripts/check/beside_mitsuba.py BIS OUT [SCENE...]      OUT is a folder for what is made on the way

Mitsuba gets the scene from a reader of its own: this file's, which knows the format from docs/scene-format.md. Materials
(diffuse, and the thesis's Phong) and textures are formulas here; rays, shapes, cameras, light and integration are
Mitsuba's. Both take the box filter of one pixel, each picture is rendered SEEDS times, and the error bar of a ratio is
one standard error of the means together. A row fails if a channel is off by more than 1 % and by more than 3 such
errors. Exit status: 0, 1 where a scene fails, 77 without Mitsuba 3, numpy or LLVM (docs/bench.md says how to get them)."""
import gzip
import os
import re
import subprocess
import sys

try:
    import numpy as np
    import drjit as dr
    import mitsuba as mi
    mi.set_variant('llvm_ad_rgb')
    dr.eval(dr.arange(mi.Float, 4))
except Exception as e:  # whatever is missing: a module, its compiled half, LLVM
    print(f'beside_mitsuba: SKIPPED: {sys.executable} cannot use Mitsuba 3, numpy and LLVM ({e}); docs/bench.md says how to get them')
    sys.exit(77)

SCENES = ('pbrt/textures-v4 pbrt/pieces-v2 pbrt/your-model trianglemesh orthographic instances louvres glossy-row '
          'steel-on-paper coloured-shadows overcast-diffuse outdoor-sun figure-5.4').split()
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
        if i and out and re.fullmatch(r'"string (filename|mapname)"', found[i]):
            name = found[i + 2] if found[i + 1] == '[' else found[i + 1]
            k = i + 1 + (found[i + 1] == '[')
            found[k] = '"' + os.path.join(os.path.dirname(path), name.strip('"')) + '"'
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
            if kind in ('string', 'texture', 'bool'):
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


def constant_texture(c):
    c = [float(x) for x in (c * 3 if len(c) == 1 else c)]
    return lambda u, v: mi.Color3f(*c)


def image_texture(p, out):
    path = value(p, 'filename', '')
    a = read_image(path, out)
    if path.endswith('.png'):
        a = decode(a, 'linear' if value(p, 'gamma', 'true') == 'false' else value(p, 'encoding', 'sRGB'))
    h, w = a.shape[:2]
    pixels = mi.Float(np.ascontiguousarray(a[::-1]).astype(np.float32).ravel())  # row 0 at the bottom
    wrap, scale, invert, to_st = value(p, 'wrap', 'repeat'), value(p, 'scale', 1), value(p, 'invert', 'false') == 'true', mapped(p)

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
        return constant_texture(p[name][1] if name in p else [usual])

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


# ---- the material: thesis eq. 3.14, two-sided; nothing passes below the triangle ----

class Surface(mi.BSDF):
    """kd: a texture; ks: numbers. uv_of: None, or (matrix from the world, radius) of a sphere or disk."""
    made = {}

    def __init__(self, props):
        super().__init__(props)
        self.kd, ks, self.n, self.kind, inverse, self.radius = Surface.made[props['key']]
        self.ks, self.inverse = mi.Color3f(*ks), None if inverse is None else mi.Transform4f(inverse)
        self.lobes = 0.5 if max(ks) > 0 else 0
        self.m_components = [mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide]
        self.m_flags = self.m_components[0]

    def uv(self, si):
        if self.inverse is None:
            return si.uv.x, si.uv.y
        p = self.inverse @ si.p
        u = dr.atan2(p.y, p.x) / (2 * dr.pi)
        u = dr.select(u < 0, u + 1, u)
        if self.kind == 'disk':
            return u, 1 - dr.sqrt(p.x ** 2 + p.y ** 2) / self.radius
        return u, 1 - dr.acos(dr.clip(p.z / self.radius, -1, 1)) / dr.pi

    def lobe(self, wi, wo):
        c = dr.maximum(wi.z * wo.z - wi.x * wo.x - wi.y * wo.y, 0)
        return dr.select(c > 0, c ** self.n, 0) * ((self.n + 1) / (2 * dr.pi))

    def eval_pdf(self, ctx, si, wo, active=True):
        wi = si.wi
        f, pdf = self.kd(*self.uv(si)) / dr.pi, (1 - self.lobes) / dr.pi * dr.abs(wo.z)
        if self.lobes:
            lobe = self.lobe(wi, wo)
            f, pdf = f + self.ks * lobe, pdf + self.lobes * lobe
        same = active & (wi.z * wo.z > 0)
        above = same & (dr.dot(si.n, si.to_world(wi)) * dr.dot(si.n, si.to_world(wo)) > 0)
        return dr.select(above, f * dr.abs(wo.z), mi.Color3f(0)), dr.select(same, pdf, 0)

    def eval(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[1]

    def sample(self, ctx, si, u, v, active=True):
        wi = si.wi
        wo = mi.warp.square_to_cosine_hemisphere(v)
        wo.z = dr.copysign(wo.z, wi.z)
        if self.lobes:
            c = (1 - v.x) ** (1 / (self.n + 1))
            s, phi = dr.safe_sqrt(1 - c * c), 2 * dr.pi * v.y
            shiny = mi.Frame3f(mi.Vector3f(-wi.x, -wi.y, wi.z)).to_world(mi.Vector3f(s * dr.cos(phi), s * dr.sin(phi), c))
            wo = dr.select(u < self.lobes, shiny, wo)
        f, pdf = self.eval_pdf(ctx, si, wo, active)
        b = mi.BSDFSample3f()
        b.wo, b.pdf, b.eta = wo, pdf, 1
        b.sampled_type, b.sampled_component = mi.UInt32(+self.m_components[0]), 0
        return b, dr.select(pdf > 0, f / pdf, mi.Color3f(0))


mi.register_bsdf('surface', Surface)


def bsdf(material, kind='mesh', to_world=None, radius=1):
    key = str(len(Surface.made))
    Surface.made[key] = (*material, kind, None if to_world is None else np.linalg.inv(to_world), radius)
    return {'type': 'surface', 'key': key}


def phong_of(kd, ks=(0, 0, 0), n=1):
    return kd, [float(k) for k in (ks if len(ks) == 3 else list(ks) * 3)], float(n)


def material(kind, p, textures):
    def colour(name, usual):
        return p[name][1] if name in p else usual

    def kd_of(name, usual):
        if name in p and p[name][0] == 'texture':
            return textures[p[name][1][0]]
        return constant_texture(colour(name, usual))
    if kind in ('matte', 'diffuse'):
        return phong_of(kd_of('reflectance' if 'reflectance' in p else 'Kd', [0.5]))
    if kind == 'phong':
        return phong_of(kd_of('Kd', [0.5]), colour('Ks', [0]), value(p, 'exponent', 50))
    raise NotImplementedError(f'Material "{kind}"')


# ---- shapes ----

def mesh_of(points, faces, normals, uv, surface):
    props = mi.Properties()
    props['surface'] = mi.load_dict(surface)
    m = mi.Mesh('mesh', len(points), len(faces), has_vertex_normals=normals is not None, has_vertex_texcoords=uv is not None,
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
        kd = constant_texture(m['Kd'])
        if m['map']:
            image = image_texture({'filename': ('string', [m['map']])}, out)
            kd = lambda u, v, a=kd, b=image: a(u, v) * b(u, v)
        made[name] = phong_of(kd, m['Ks'], m['Ns'])
    return made


def obj_parts(path, usual, out):
    """[(points, faces, uv, material)] of an OBJ of polygons with v and vt."""
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
    for name, triangles in parts.items():
        corner = np.array(triangles).reshape(-1, 2)
        yield (np.array(points)[corner[:, 0]], np.arange(len(corner)).reshape(-1, 3), np.array(uv)[corner[:, 1]],
               library.get(name, usual))


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
        return [mi.load_dict({'type': 'disk', 'to_world': mi.ScalarTransform4f(m), 'bsdf': bsdf(surface, kind, ctm, r)})]
    path = value(p, 'filename', '')
    if kind == 'objmesh':
        if value(p, 'materials', 'false') != 'true':
            raise NotImplementedError('objmesh without materials')
        return [mesh_of(moved(ctm, q), f, None, uv, bsdf(s)) for q, f, uv, s in obj_parts(path, surface, out)]
    if kind == 'plymesh':
        plain = os.path.join(out, os.path.basename(path).removesuffix('.gz'))
        with open(plain, 'wb') as f:
            f.write(read_bytes(path))
        return [mi.load_dict({'type': 'ply', 'filename': plain, 'to_world': mi.ScalarTransform4f(ctm), 'bsdf': bsdf(surface)})]
    raise NotImplementedError(f'Shape "{kind}"')


# ---- light ----

def face_pixel(d, side, places):
    """From directions (front, right, up) to pixels of faces: places[face] = (column, row, turned)."""
    f, r, u = d
    faces = {'front': (f, r, u), 'back': (-f, -r, u), 'right': (r, -f, u), 'left': (-r, f, u), 'up': (u, r, -f), 'down': (-u, r, f)}
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


def to_latlong(a, mapping, width=2048):
    """The map as bis looks it up, in small steps: the source's pixel of each direction."""
    if mapping == 'latlong':
        k = max(1, 4096 // a.shape[1])
        return a.repeat(k, 0).repeat(k, 1)
    theta, phi = np.meshgrid((np.arange(width // 2) + 0.5) * 2 * np.pi / width, (np.arange(width) + 0.5) * 2 * np.pi / width,
                             indexing='ij')
    x, y, z = np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)
    if mapping == 'equalarea':
        r = np.sqrt(1 - np.abs(z))
        q = np.arctan2(np.abs(y), np.abs(x)) * 2 / np.pi
        v = q * r
        u = r - v
        u, v = np.where(z < 0, 1 - v, u), np.where(z < 0, 1 - u, v)
        u, v = (np.copysign(u, x) + 1) / 2, (np.copysign(v, y) + 1) / 2
        n = a.shape[0]
        return a[np.minimum((v * n).astype(int), n - 1), np.minimum((u * n).astype(int), n - 1)]
    if mapping == 'verticalcross':
        places = {'up': (1, 0, 0), 'left': (0, 1, 0), 'front': (1, 1, 0), 'right': (2, 1, 0), 'down': (1, 2, 0), 'back': (1, 3, 1)}
        px, py = face_pixel((-x, -y, z), a.shape[1] // 3, places)
        return a[py, px]
    raise NotImplementedError(f'mapping {mapping}')


# Mitsuba's envmap has y up; columns begin elsewhere.
TO_MITSUBA = np.array([[0, 1, 0], [0, 0, 1], [-1, 0, 0]], float)


def light(p, ctm, out):
    factor = np.ones(3)
    for name in ('L', 'scale'):
        if name in p and p[name][0] in ('rgb', 'color', 'float'):
            factor = factor * p[name][1]
        elif name in p:
            raise NotImplementedError(f'{p[name][0]} {name}')
    if not value(p, 'visible', 'true') == 'true':
        raise NotImplementedError('a light that is not seen')
    path = value(p, 'filename', None) or value(p, 'mapname', None)
    if not path:
        return {'type': 'constant', 'radiance': {'type': 'rgb', 'value': [float(x) for x in factor]}}
    a = read_image(path, out)
    mapping = value(p, 'mapping', 'equalarea' if 'filename' in p and a.shape[0] == a.shape[1] else 'latlong')
    m = np.eye(4)
    m[:3, :3] = ctm[:3, :3] @ TO_MITSUBA.T
    bitmap = mi.Bitmap(np.ascontiguousarray(to_latlong(a * factor.astype(np.float32), mapping).astype(np.float32)))
    return {'type': 'envmap', 'bitmap': bitmap, 'to_world': mi.ScalarTransform4f(m)}


# ---- camera ----

def camera(kind, p, film, to_camera):
    """The sensor, and whether its picture is mirrored: Mitsuba's x runs to the left of the picture, pbrt's to the right."""
    w, h = int(value(film, 'xresolution', 1280)), int(value(film, 'yresolution', 720))
    screen = p['screenwindow'][1] if 'screenwindow' in p else np.array([-w, w, -h, h]) / min(w, h)
    if not np.allclose(screen, np.array([-screen[1], screen[1], -screen[1] * h / w, screen[1] * h / w])) or 'cropwindow' in film:
        raise NotImplementedError('a part of the screen')
    m = np.linalg.inv(to_camera)
    mirrored = np.linalg.det(m) > 0
    if not mirrored:
        m = m @ np.diag([-1, 1, 1, 1])
    common = {'near_clip': 1e-2, 'far_clip': 1e5, 'sampler': {'type': 'independent'},
              'film': {'type': 'hdrfilm', 'width': w, 'height': h, 'pixel_format': 'rgb', 'component_format': 'float32',
                       'rfilter': {'type': 'box'}}}
    if kind == 'orthographic':
        return {'type': kind, 'to_world': mi.ScalarTransform4f(m @ np.diag([screen[1], screen[1], 1, 1])), **common}, mirrored
    half = np.tan(np.radians(value(p, 'fov', 90)) / 2) * screen[1]
    return {'type': kind, 'to_world': mi.ScalarTransform4f(m), 'fov_axis': 'x', 'fov': float(2 * np.degrees(np.arctan(half))),
            **common}, mirrored


# ---- the scene ----

class State:
    def __init__(self):
        self.ctm, self.surface = np.eye(4), phong_of(constant_texture([0.5]))

    def copy(self):
        s = State()
        s.ctm, s.surface = self.ctm, self.surface
        return s


def read_scene(path, out):
    """Mitsuba's scene, and whether its picture is mirrored."""
    w, now, stack, systems = Words(path), State(), [], {}
    named, textures, objects, present = {}, {}, {}, None
    film, view, lamp, shapes = {}, ('perspective', {}, np.eye(4)), None, []

    def add(kind, p, ctm, surface):
        shapes.extend(shapes_of(kind, p, ctm, surface, out))

    while w.more():
        d = w.next()
        if d == 'Identity':
            now.ctm = np.eye(4)
        elif d == 'Translate':
            now.ctm = now.ctm @ translate(*w.numbers(3))
        elif d == 'Scale':
            now.ctm = now.ctm @ np.diag(w.numbers(3) + [1])
        elif d == 'Rotate':
            now.ctm = now.ctm @ rotate(*w.numbers(4))
        elif d == 'LookAt':
            now.ctm = now.ctm @ look_at(w.numbers(9))
        elif d == 'Transform':
            now.ctm = np.array(w.numbers(16)).reshape(4, 4).T
        elif d == 'ConcatTransform':
            now.ctm = now.ctm @ np.array(w.numbers(16)).reshape(4, 4).T
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
                add(kind, p, now.ctm @ ctm, surface)
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
            lamp = light(w.parameters(), now.ctm, out)
        elif d == 'Texture':
            name, _, kind = w.name(), w.name(), w.name()
            textures[name] = texture(kind, w.parameters(), textures, out)
        elif d == 'Material':
            now.surface = material(w.name(), w.parameters(), textures)
        elif d == 'MakeNamedMaterial':
            name, p = w.name(), w.parameters()
            named[name] = material(p['type'][1][0], p, textures)
        elif d == 'NamedMaterial':
            now.surface = named[w.name()]
        elif d == 'Shape':
            kind, p = w.name(), w.parameters()
            if present is None:
                add(kind, p, now.ctm, now.surface)
            else:
                present.append((kind, p, now.ctm, now.surface))
        elif d in ('Sampler', 'Integrator', 'PixelFilter', 'Accelerator', 'ColorSpace'):
            w.name()
            w.parameters()
        elif d not in ('WorldEnd', 'ReverseOrientation'):
            raise NotImplementedError(d)
    sensor, mirrored = camera(*view[:2], film, view[2])
    parts = {f'shape{i}': s for i, s in enumerate(shapes)}
    return mi.load_dict({'type': 'scene', 'integrator': {'type': 'direct', 'emitter_samples': 2, 'bsdf_samples': 2},
                         'sensor': sensor, 'light': lamp, **parts}, parallel=False), mirrored


# ---- both pictures ----

def bis_picture(bis, path, out, seed):
    picture = os.path.join(out, 'beside.pfm')
    subprocess.run([bis, path, '--quiet', '--spp', str(SPP), '--seed', str(seed), '--outfile', picture], check=True)
    return np.array(mi.Bitmap(picture), dtype=float)[:, :, :3]


def mitsuba_picture(scene, mirrored, seed):
    a = np.array(mi.render(scene, spp=SPP, seed=seed), dtype=float)
    return a[:, ::-1] if mirrored else a


def mean_and_error(pictures):
    means = np.array([p.mean((0, 1)) for p in pictures])
    return means.mean(0), means.std(0, ddof=1) / np.sqrt(len(means))


def worst_tile(a, b):
    """The largest difference of an eighth of the picture's width and height, in per cent."""
    a, b = (np.mean(x, axis=(0, 3)) for x in (a, b))
    return 100 * max(abs(p.mean() / q.mean() - 1) for s, t in zip(np.array_split(a, 4), np.array_split(b, 4))
                     for p, q in zip(np.array_split(s, 4, 1), np.array_split(t, 4, 1)))


def compare(bis, path, out):
    scene, mirrored = read_scene(path, out)
    ours = [bis_picture(bis, path, out, 100 + i) for i in range(SEEDS)]
    theirs = [mitsuba_picture(scene, mirrored, 1000 + i) for i in range(SEEDS)]
    (a, ea), (b, eb) = mean_and_error(ours), mean_and_error(theirs)
    ratio, error = a / b - 1, np.hypot(ea / a, eb / b)
    fails = bool(np.any((np.abs(ratio) > LIMIT) & (np.abs(ratio) > ERRORS * error)))
    cells = ''.join(f'{100 * r:+8.2f} +-{100 * e:5.2f}' for r, e in zip(ratio, error))
    return cells + f'{worst_tile(ours, theirs):8.1f}' + ('   FAILED' if fails else ''), fails


def main():
    bis, out = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    os.makedirs(out, exist_ok=True)
    failed = 0
    print(f'bis beside Mitsuba {mi.__version__}: mean of bis over mean of Mitsuba, less 1, in %; worst of 4 x 4 tiles')
    print(f'{"scene":24s}{"red":>12s}{"green":>16s}{"blue":>16s}{"tile":>12s}', flush=True)
    for path in sys.argv[3:] or [f'data/scenes/{s}.txt' for s in SCENES]:
        name = os.path.splitext(os.path.basename(path))[0]
        try:
            row, fails = compare(bis, path, out)
        except NotImplementedError as e:
            row, fails = f'  left out: {e} is not known here', False
        print(f'{name:22s}{row}', flush=True)
        failed += fails
    sys.exit(1 if failed else 0)


main()
