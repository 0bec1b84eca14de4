# SPDX-License-Identifier: BSD-2-Clause
"""mitsuba_materials: pbrt's materials, the thesis's Phong, colours and spectra for Mitsuba 3, by other roads than
bis's.

A material is (base, gloss): base(uv, c_i, c_o) is the diffuse part of f, gloss a lobe or None. Formulas are those of
pbrt's books (3rd edition, chapters 8 and 9; 4th edition, chapters 9, 10 and 14): pbrt's code has the two indices of
"plastic" exchanged (its issue 210), which its authors call a mistake. The distribution of facets, Fresnel's equations,
the observer, D65 and the metals' constants are Mitsuba's. Importing this without Mitsuba 3, numpy or LLVM ends with
status 77."""
import os
import sys

try:
    import numpy as np
    import drjit as dr
    import mitsuba as mi
    mi.set_variant('llvm_ad_rgb')
    dr.eval(dr.arange(mi.Float, 4))
except Exception as e:  # whatever is missing: a module, its compiled half, LLVM
    print(f'{os.path.basename(sys.argv[0])}: SKIPPED: {sys.executable} cannot use Mitsuba 3, numpy and LLVM ({e}); '
          'docs/measured.md says how to get them')
    sys.exit(77)


# ---- spectra: sums every 5 nm ----

NM = np.arange(360, 831, 5.0)
OBSERVER = np.array([np.array(c) for c in mi.cie1931_xyz(mi.Float(NM))])
WHITE = OBSERVER * np.array(mi.cie_d65(mi.Float(NM)))


def rgb_of_xyz(xyz):
    return np.array(mi.xyz_to_srgb(mi.Color3f(*(float(v) for v in xyz)))).ravel()


def rgb_of_spectrum(values):
    """Of a reflectance at NM, under D65."""
    return rgb_of_xyz(WHITE @ values / WHITE[1].sum())


def rgb_of_blackbody(kelvin):
    xyz = OBSERVER @ (1 / (NM ** 5 * np.expm1(1.4387768775e7 / (NM * kelvin))))
    return rgb_of_xyz(xyz / xyz[1])


def spectrum(values):
    """At NM: one number, pairs, a file of pairs, or a metal's name."""
    if isinstance(values[0], str):
        path = values[0]
        if path.startswith('metal-'):
            _, metal, what = path.split('-')
            path = os.path.join(os.path.dirname(mi.__file__), 'data', 'ior', f'{metal}.{what}.spd')
        values = [float(x) for line in open(path) for x in line.split('#')[0].replace(',', ' ').split()]
    return np.full(len(NM), values[0]) if len(values) == 1 else np.interp(NM, values[::2], values[1::2])


def colour(kind, values):
    if kind == 'spectrum':
        return np.clip(rgb_of_spectrum(spectrum(values)), 0, 1)
    if kind == 'xyz':
        return np.clip(rgb_of_xyz(values), 0, 1)
    if kind == 'blackbody':
        return rgb_of_blackbody(values[0])
    return np.array(values * 3 if len(values) == 1 else values, float)


def constant(c):
    c = mi.Color3f(*(float(x) for x in np.broadcast_to(c, 3)))
    return lambda *uv: c


# ---- bases ----

def lambert(kd):
    return lambda uv, ci, co: kd(*uv) / dr.pi


def under_gloss(kd, ks):
    """Ashikhmin and Shirley 2000."""
    def through(c):
        return 1 - (1 - c / 2) ** 5
    return lambda uv, ci, co: 28 / (23 * dr.pi) * kd(*uv) * (1 - ks(*uv)) * through(ci) * through(co)


def g2(alpha, a, b):
    """Smith's masking of both directions, correlated in height."""
    def part(w):
        return (dr.sqrt(1 + alpha ** 2 * (w.x ** 2 + w.y ** 2) / w.z ** 2) - 1) / 2
    return 1 / (1 + part(a) + part(b))


def walk(alpha, eta, thickness, n=1 << 15):
    """pbrt-v4's walk from above to the base, as the share t(cosine) that arrives, and from the base, whose light has no
    preferred direction, back to it: the share that returns. Each n random paths; the medium absorbs, with sigma_t 1."""
    random = mi.PCG32(n, 1)

    def facet(w):
        d = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, alpha, True)
        m, _ = d.sample(w, mi.Point2f(random.next_float32(), random.next_float32()))
        return m, d.smith_g1(w, m)
    arrives = []
    for c in COSINES:
        w = mi.Vector3f(float(np.sqrt(1 - c * c)), 0, float(c)) + dr.zeros(mi.Vector3f, n)
        m, g1 = facet(w)
        F, cos_t, _, ratio = mi.fresnel(dr.dot(w, m), eta)
        down = mi.refract(w, m, cos_t, ratio)
        kept = (1 - F) * g2(alpha, w, down) / g1 * dr.exp(-thickness / dr.abs(down.z))
        arrives.append(dr.mean(dr.select((down.z < 0) & (g1 > 0), kept, 0))[0])
    n *= 64
    random = mi.PCG32(n, 2)
    w = mi.warp.square_to_cosine_hemisphere(mi.Point2f(random.next_float32(), random.next_float32()))
    m, g1 = facet(w)
    down = mi.reflect(w, m)
    kept = mi.fresnel(dr.dot(w, m), 1 / eta)[0] * g2(alpha, w, down) / g1
    kept *= dr.exp(-thickness / w.z - thickness / dr.abs(down.z))
    return arrives, dr.mean(dr.select((down.z > 0) & (g1 > 0), kept, 0))[0]


COSINES, ALPHAS = np.linspace(0.02, 1, 50), [0.03, 0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1]


def under_coat(kd, alpha, alphas, eta, thickness, bounces):
    """The diffuse base of pbrt-v4's layers. It forgets where light came from, so that a walk is a product of shares."""
    walks = [walk(a, eta, thickness) for a in alphas]
    t, back = mi.Float(np.ravel([w[0] for w in walks])), mi.Float(np.array([w[1] for w in walks]))
    steps = mi.Float(alphas + [alphas[-1] + 1])

    def row(a):
        i = mi.Int(0)
        for k in range(1, len(alphas)):
            i = dr.select(a >= float(alphas[k]), mi.Int(min(k, max(len(alphas) - 2, 0))), i)
        low, high = dr.gather(mi.Float, steps, i), dr.gather(mi.Float, steps, i + 1)
        return i, dr.minimum(i + 1, len(alphas) - 1), dr.clip((a - low) / (high - low), 0, 1)

    def through(c, i):
        x = dr.clip((c - COSINES[0]) / (COSINES[1] - COSINES[0]), 0, len(COSINES) - 1.001)
        k = mi.Int(x)
        at = i * len(COSINES) + k
        return dr.lerp(dr.gather(mi.Float, t, at), dr.gather(mi.Float, t, at + 1), x - k)

    def f(uv, ci, co):
        i, j, s = row(alpha(*uv))
        r = kd(*uv) * dr.lerp(dr.gather(mi.Float, back, i), dr.gather(mi.Float, back, j), s)
        both = [dr.lerp(through(c, i), through(c, j), s) for c in (ci, co)]
        return kd(*uv) * both[0] * both[1] / (dr.pi * eta ** 2) * sum(r ** k for k in range(bounces))
    return f


# ---- lobes: f and its density, directions on the side of the normal ----

class Phong:
    """Thesis eq. 3.14."""
    def __init__(self, ks, n):
        self.ks, self.n = ks, n

    def f_pdf(self, uv, wi, wo):
        n = self.n(*uv)
        c = dr.maximum(wi.z * wo.z - wi.x * wo.x - wi.y * wo.y, 0)
        lobe = dr.select(c > 0, c ** n, 0) * ((n + 1) / (2 * dr.pi))
        return self.ks(*uv) * lobe, lobe

    def sample(self, uv, wi, v):
        c = (1 - v.x) ** (1 / (self.n(*uv) + 1))
        s, phi = dr.safe_sqrt(1 - c * c), 2 * dr.pi * v.y
        return mi.Frame3f(mi.Vector3f(-wi.x, -wi.y, wi.z)).to_world(mi.Vector3f(s * dr.cos(phi), s * dr.sin(phi), c))


class Facets:
    """GGX. blend: over the quotient of Ashikhmin and Shirley, in the place of masking."""
    def __init__(self, alpha, fresnel, blend=False):
        self.alpha, self.fresnel, self.blend = alpha, fresnel, blend

    def of(self, uv):
        return mi.MicrofacetDistribution(mi.MicrofacetType.GGX, mi.Float(self.alpha(*uv)), True)

    def f_pdf(self, uv, wi, wo):
        h, facets = dr.normalize(wi + wo), self.of(uv)
        c, D = dr.dot(wi, h), facets.eval(h)
        quotient = 1 / (c * dr.maximum(wi.z, wo.z)) if self.blend else g2(self.alpha(*uv), wi, wo) / (wi.z * wo.z)
        return self.fresnel(uv, c) * (D * quotient / 4), facets.pdf(wi, h) / (4 * c)

    def sample(self, uv, wi, v):
        return mi.reflect(wi, self.of(uv).sample(wi, v)[0])


def schlick(ks):
    return lambda uv, c: ks(*uv) + (1 - ks(*uv)) * (1 - c) ** 5


def dielectric(ks, eta):
    return lambda uv, c: ks(*uv) * mi.fresnel(c, eta)[0]


def conductor(eta, k):
    """Colours, or spectra at NM: then a table over the cosine."""
    if len(eta) == 3:
        return lambda uv, c: mi.Color3f(*(mi.fresnel_conductor(c, mi.Complex2f(float(n), float(a)))
                                          for n, a in zip(eta, k)))
    size, table = 512, []
    for c in np.arange(513) / 512:
        s = np.sqrt((eta + 1j * k) ** 2 - (1 - c * c))
        r_s = (c - s) / (c + s)
        r_p = r_s * (c * s - (1 - c * c)) / (c * s + (1 - c * c))
        table.append(rgb_of_spectrum((abs(r_s) ** 2 + abs(r_p) ** 2) / 2))
    flat = mi.Float(np.ravel(table))

    def look_up(uv, c):
        x = dr.clip(c * size, 0, size - 0.001)
        i = mi.Int(x)
        return mi.Color3f(*(dr.lerp(dr.gather(mi.Float, flat, 3 * i + j),
                                    dr.gather(mi.Float, flat, 3 * i + 3 + j), x - i)
                            for j in range(3)))
    return look_up


def conductor_of(reflectance):
    def fresnel(uv, c):
        r = reflectance(*uv)
        k = 2 * dr.sqrt(r / (1 - r))
        return mi.Color3f(*(mi.fresnel_conductor(c, mi.Complex2f(mi.Float(1), k[j])) for j in range(3)))
    return fresnel


# ---- a scene's words ----

def near(kd, ks, alpha):
    """bis's "microfacet"."""
    return under_gloss(kd, ks), Facets(alpha, schlick(ks))


def phong_of(kd, ks=(0, 0, 0), n=1):
    """kd: a texture; ks and n: numbers."""
    return lambert(kd), Phong(constant(ks), lambda *uv: float(n)) if max(ks) > 0 else None


def alpha_v3(r):
    x = dr.log(dr.maximum(r, 1e-3))
    return 1.62142 + 0.819955 * x + 0.1734 * x ** 2 + 0.0171201 * x ** 3 + 0.000640711 * x ** 4


NEAR = ('substrate', 'coateddiffuse')  # what bis replaces by "microfacet"


def material(kind, p, textures, by_page):
    """From a Material's parameters {name: (type, values)}; textures: {name: function of u and v}. by_page: those of
    NEAR as docs/scene-format.md says that bis makes them, and not as pbrt's books do."""
    def part(name, usual):
        if name in p and p[name][0] == 'texture':
            return textures[p[name][1][0]]
        return constant(colour(*p[name]) if name in p else usual)

    def number(name, usual):
        texture = part(name, usual)
        return lambda *uv: sum(texture(*uv)[j] for j in range(3)) / 3

    def facets(usual, remap):
        rough = number('uroughness' if 'uroughness' in p else 'roughness', usual)
        remaps = 'remaproughness' not in p or p['remaproughness'][1][0] == 'true'
        return lambda *uv: remap(rough(*uv)) if remaps else rough(*uv)

    if kind in ('matte', 'diffuse'):
        return lambert(part('reflectance' if 'reflectance' in p else 'Kd', 0.5)), None
    if kind == 'phong':
        ks = part('Ks', 0)
        return lambert(part('Kd', 0.5)), Phong(ks, number('exponent', 50)) if 'Ks' in p else None
    if kind == 'microfacet':
        r = number('roughness', 0.5)
        return near(part('Kd', 0), part('Ks', 0.9), lambda *uv: r(*uv) ** 2)
    if kind == 'conductor' and 'reflectance' in p:
        return lambert(constant(0)), Facets(facets(0, dr.sqrt), conductor_of(part('reflectance', 0)))
    if kind in ('conductor', 'metal'):
        eta, k = (p.get(x, ('spectrum', [f'metal-Cu-{x}'])) for x in ('eta', 'k'))
        eta, k = (spectrum(v) if t == 'spectrum' else colour(t, v) for t, v in (eta, k))
        alpha = facets(0, dr.sqrt) if kind == 'conductor' else facets(0.01, alpha_v3)
        return lambert(constant(0)), Facets(alpha, conductor(eta, k))
    if kind in ('plastic', 'uber'):
        eta = p.get('eta', p.get('index', (0, [1.5])))[1][0]
        return lambert(part('Kd', 0.25)), Facets(facets(0.1, alpha_v3), dielectric(part('Ks', 0.25), eta))
    if kind == 'substrate':
        ks = part('Ks', 0.5)
        return under_gloss(part('Kd', 0.5), ks), Facets(facets(0.1, alpha_v3), schlick(ks), blend=not by_page)
    if kind == 'coateddiffuse':
        eta, thickness = (p[k][1][0] if k in p else usual for k, usual in (('eta', 1.5), ('thickness', 0.01)))
        # a walk of 10 steps meets the base 5 times
        bounces = int(p['maxdepth'][1][0] + 1) // 2 if 'maxdepth' in p else 5
        r, alpha = part('reflectance', 0.5), facets(0, dr.sqrt)
        is_texture = 'roughness' in p and p['roughness'][0] == 'texture'
        alphas = ALPHAS if is_texture else [np.array(mi.Float(alpha(0.5, 0.5))).item()]
        gloss = Facets(alpha, dielectric(constant(1), eta))
        if by_page:
            t, back = walk(1e-3 if is_texture else alphas[0], eta, thickness)
            t = np.trapezoid(2 * COSINES * np.ravel(t), COSINES) / eta
            return lambert(lambda *uv: r(*uv) * t ** 2 / (1 - r(*uv) * back)), gloss
        return under_coat(r, alpha, alphas, eta, thickness, bounces), gloss
    raise NotImplementedError(f'Material "{kind}"')


# ---- the surface: two-sided; nothing passes below the triangle ----

class Surface(mi.BSDF):
    """made: (base, gloss, kind of shape, matrix from the world to a sphere or disk or None, radius)."""
    made = {}

    def __init__(self, props):
        super().__init__(props)
        self.base, self.gloss, self.kind, inverse, self.radius = Surface.made[props['key']]
        self.inverse = None if inverse is None else mi.Transform4f(inverse)
        self.share = 0.5 if self.gloss else 0
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

    def eval_pdf(self, ctx, si, wo, active=True):
        side = mi.Vector3f(1, 1, dr.sign(si.wi.z))
        wi, out, uv = si.wi * side, wo * side, self.uv(si)
        f, pdf = self.base(uv, wi.z, out.z), (1 - self.share) / dr.pi * out.z
        if self.gloss:
            lobe, density = self.gloss.f_pdf(uv, wi, out)
            f, pdf = f + lobe, pdf + self.share * density
        same = active & (wi.z > 0) & (out.z > 0)
        above = same & (dr.dot(si.n, si.to_world(si.wi)) * dr.dot(si.n, si.to_world(wo)) > 0)
        return dr.select(above, f * out.z, mi.Color3f(0)), dr.select(same, pdf, 0)

    def eval(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[1]

    def sample(self, ctx, si, u, v, active=True):
        side = mi.Vector3f(1, 1, dr.sign(si.wi.z))
        wo = mi.warp.square_to_cosine_hemisphere(v)
        if self.gloss:
            wo = dr.select(u < self.share, self.gloss.sample(self.uv(si), si.wi * side, v), wo)
        wo *= side
        f, pdf = self.eval_pdf(ctx, si, wo, active)
        b = mi.BSDFSample3f()
        b.wo, b.pdf, b.eta = wo, pdf, 1
        b.sampled_type, b.sampled_component = mi.UInt32(+self.m_components[0]), 0
        return b, dr.select(pdf > 0, f / pdf, mi.Color3f(0))


mi.register_bsdf('surface', Surface)


def bsdf(made, kind='mesh', to_world=None, radius=1):
    key = str(len(Surface.made))
    Surface.made[key] = (*made, kind, None if to_world is None else np.linalg.inv(to_world), radius)
    return {'type': 'surface', 'key': key}
