# SPDX-License-Identifier: BSD-2-Clause
"""A second renderer, by brute force, to hold bis against. It was written from docs/scene-format.md,
docs/integrators.md, docs/guide.md (which way a map's columns run) and the formulas at the head of
include/bis/thesis/phong.h and include/bis/beyond/microfacet.h alone, and shares no line with bis: rays against every
shape, and a sum over small cells of every pixel of a small map. Doubles throughout.

A scene is a dict: eye, look, up, fov, width, height; light (rotation 3x3, pixels (h, w, 3), row 0 at the top); shapes,
each a dict with kind (sphere, disk, mesh), matrix 4x4, its own numbers, and material; a material is a dict with kind
(phong, microfacet), Kd, Ks, exponent or roughness, and perhaps checks: a pair of colours that take the place of Kd, and
how often they repeat."""
import numpy as np

UNSEEN = np.inf


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


# ---- rays against shapes: distances (n,) of rays o + t d, and what is hit at one point ----

def to_own(shape, o, d):
    """Rays in the shape's own space. d is not made unit there, so that t is the same in both."""
    inverse = np.linalg.inv(shape["matrix"])
    return o @ inverse[:3, :3].T + inverse[:3, 3], d @ inverse[:3, :3].T


def distances(shape, o, d, least):
    """Of many rays the nearest hits beyond `least`, inf for none."""
    o, d = to_own(shape, o, d)
    o = np.broadcast_to(o, d.shape)
    with np.errstate(divide="ignore", invalid="ignore"):
        if shape["kind"] == "sphere":
            a, b, c = (d * d).sum(1), (o * d).sum(1), (o * o).sum(1) - shape["radius"] ** 2
            root = np.sqrt(b * b - a * c)
            near, far = (-b - root) / a, (-b + root) / a
            return np.where(near > least, near, np.where(far > least, far, UNSEEN))  # NaN: no hit, compares false
        if shape["kind"] == "disk":
            t = (shape["height"] - o[:, 2]) / d[:, 2]
            p = o + t[:, None] * d
            return np.where((t > least) & (p[:, 0] ** 2 + p[:, 1] ** 2 <= shape["radius"] ** 2), t, UNSEEN)
        best = np.full(len(d), UNSEEN)
        for a, b, c in shape["P"][shape["indices"]]:  # Cramer's rule
            p = np.cross(d, c - a)
            det = p @ (b - a)
            u = (p * (o - a)).sum(1) / det
            q = np.cross(o - a, b - a)
            v, t = (q * d).sum(1) / det, q @ (c - a) / det
            best = np.where((u >= 0) & (v >= 0) & (u + v <= 1) & (t > least) & (t < best), t, best)
        return best


def surface(shape, o, d, t):
    """Point, normal (in the world, of either side) and (u, v) where the ray hits."""
    own_o, own_d = to_own(shape, o, d)
    p = own_o + t * own_d
    if shape["kind"] == "mesh":
        for k in range(len(shape["indices"])):
            one = dict(shape, indices=shape["indices"][k:k + 1])
            if abs(distances(one, o, d[None], 0)[0] - t) <= 1e-9 * t:
                break
        i = shape["indices"][k]
        a, b, c = shape["P"][i]
        n = np.cross(b - a, c - a)
        v, w = np.linalg.lstsq(np.stack([b - a, c - a], 1), p - a, rcond=None)[0]
        uv = np.array([1 - v - w, v, w]) @ shape["uv"][i]
    else:
        u = np.arctan2(p[1], p[0]) / (2 * np.pi) % 1
        if shape["kind"] == "sphere":
            n, uv = p, (u, 1 - np.arccos(np.clip(p[2] / shape["radius"], -1, 1)) / np.pi)
        else:
            n, uv = np.array([0, 0, 1.0]), (u, 1 - np.hypot(p[0], p[1]) / shape["radius"])
    return o + t * d, unit(np.linalg.inv(shape["matrix"])[:3, :3].T @ n), uv


# ---- light ----

def cells(light, k):
    """Directions in the world, solid angles and radiance of k x k cells of each pixel; row 0 of the map is at +z of its
    frame."""
    h, w, _ = light["pixels"].shape
    edges = np.cos(np.pi * np.arange(k * h + 1) / (k * h))
    theta = np.arccos((edges[:-1] + edges[1:]) / 2)  # the middle of a cell by area
    phi = 2 * np.pi * (np.arange(k * w) + 0.5) / (k * w)
    t, p = np.meshgrid(theta, phi, indexing="ij")
    wi = np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], -1).reshape(-1, 3) @ light["rotation"].T
    omega = np.repeat((edges[:-1] - edges[1:]) * 2 * np.pi / (k * w), k * w)
    return wi, omega, np.repeat(np.repeat(light["pixels"], k, 0), k, 1).reshape(-1, 3)


# ---- materials: f (n, 3) of directions wi above the surface ----

def colour(material, uv):
    if "checks" not in material:
        return material["Kd"]
    first, second, times = material["checks"]
    return first if (np.floor(uv[0] * times) + np.floor(uv[1] * times)) % 2 == 0 else second


def f_phong(m, Kd, wi, wo, n):
    mirror = 2 * (n @ wo) * n - wo
    lobe = (m["exponent"] + 1) / (2 * np.pi) * np.maximum(0, wi @ mirror) ** m["exponent"]
    return m["Ks"] * lobe[:, None] + Kd / np.pi


def f_microfacet(m, Kd, wi, wo, n):
    a, c_i, c_o = m["roughness"] ** 2, wi @ n, wo @ n
    half = unit(wi + wo)
    c_h, c_d = half @ n, half @ wo
    D = a**2 / (np.pi * c_h**4 * (a**2 + (1 - c_h**2) / c_h**2) ** 2)  # Walter et al. 2007
    smith = [(np.sqrt(1 + a**2 * (1 - c**2) / c**2) - 1) / 2 for c in (c_i, c_o)]
    G2 = 1 / (1 + smith[0] + smith[1])  # Heitz 2014
    F = m["Ks"] + (1 - m["Ks"]) * ((1 - c_d) ** 5)[:, None]  # Schlick 1994
    F = np.where(m["Ks"] > 0, F, 0)
    coat = [1 - (1 - c / 2) ** 5 for c in (c_i, c_o)]
    below = 28 / (23 * np.pi) * Kd * (1 - m["Ks"]) * (coat[0] * coat[1])[:, None]
    return F * (D * G2 / (4 * c_i * c_o))[:, None] + below


MODELS = {"phong": f_phong, "microfacet": f_microfacet}


# ---- the picture ----

def shade(scene, light, p, wo, n, uv, material):
    """Reflected radiance with and without shadows."""
    wi, omega, Le = light
    n = n if n @ wo > 0 else -n
    up = wi @ n > 0
    wi, weight = wi[up], (omega[up] * (wi[up] @ n))[:, None] * Le[up]
    F = MODELS[material["kind"]](material, colour(material, uv), wi, wo, n) * weight
    seen = np.all([np.isinf(distances(s, p, wi, 1e-6)) for s in scene["shapes"]], 0)
    return F[seen].sum(0), F.sum(0)


def radiance(scene, d, eye, light, k):
    hits = [distances(s, eye, d[None], 0)[0] for s in scene["shapes"]]
    i = int(np.argmin(hits))
    if np.isinf(hits[i]):
        own = scene["light"]["rotation"].T @ d
        h, w, _ = scene["light"]["pixels"].shape
        row, column = np.arccos(np.clip(own[2], -1, 1)) / np.pi * h, np.arctan2(own[1], own[0]) / (2 * np.pi) % 1 * w
        Le = scene["light"]["pixels"][min(int(row), h - 1), min(int(column), w - 1)]
        return Le, Le
    shape = scene["shapes"][i]
    return shade(scene, light, *(lambda p, n, uv: (p, -d, n, uv))(*surface(shape, eye, d, hits[i])), shape["material"])


def render(scene, k):
    """Two pictures (height, width, 3), with and without shadows: what rays through the pixels' centres see, with k x k
    cells in a pixel of the map."""
    W, H = scene["width"], scene["height"]
    forward = unit(scene["look"] - scene["eye"])
    right = unit(np.cross(scene["up"], forward))  # the world is left-handed: x right, y up, z forward
    up = np.cross(forward, right)
    scale = np.tan(np.radians(scene["fov"]) / 2) / min(W, H)
    light, out = cells(scene["light"], k), np.empty((2, H, W, 3))
    for y in range(H):
        for x in range(W):
            d = unit((2 * x + 1 - W) * scale * right + (H - 2 * y - 1) * scale * up + forward)
            out[:, y, x] = radiance(scene, d, scene["eye"], light, k)
    return out
