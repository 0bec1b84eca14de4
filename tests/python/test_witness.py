# SPDX-License-Identifier: BSD-2-Clause
"""bis against another renderer (witness.py): 100 random scenes, every integrator.

A scene has a small map, a few spheres, disks and triangles under random matrices, and both materials, some with
textures. Compared is the mean of the picture, over pixels and channels, with N_SEEDS seeds. For each scene and
integrator: Student's t beyond what the witness's own sum may miss (the change from half as many cells a side). For each
integrator: t of the relative differences of all scenes, which finds small errors that all scenes share: with standard
errors of 0.03 % (unoccluded) to 0.15 % (em), 0.3 % to 1.1 % are found with 99 % power. Both kinds of tests together
reject what is right with probability ALPHA (Sidak). The twins are witnesses with a mistake; each must be rejected."""
import os
import sys
import tempfile
import unittest
import unittest.mock

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts", "python"))
import bis  # noqa: E402
import witness  # noqa: E402

ALPHA, SEED, N_SCENES, N_SEEDS, CELLS = 1e-3, 20100, 100, 8, 24
METHODS = {  # settings; whether shadows are seen
    "em": ({"integrator": "em", "samples": 8}, True),
    "brdf": ({"integrator": "brdf", "samples": 8}, True),
    "mis": ({"integrator": "mis", "samples": 8}, True),
    # the default estimator is a ratio, whose bias docs/integrators.md states
    "rejection": ({"integrator": "rejection", "estimator": "plain", "proposal": "em", "candidates": 64,
                   "shadowrays": 8}, True),
    "sir": ({"integrator": "sir", "candidates": 32, "shadowrays": 4}, True),
    "sir product": ({"integrator": "sir", "proposal": "product", "candidates": 32, "shadowrays": 4}, True),
    "exact": ({"integrator": "exact", "perpatch": 1}, True),
    "unoccluded": ({"integrator": "unoccluded", "candidates": 32}, False),
}
N_TESTS = len(METHODS) * (N_SCENES + 1)


def t_bound(dof, alpha):
    """The t that |t| exceeds with probability alpha: Student's density is summed in s = atan(t / sqrt(dof)), where it
    is cos^(dof-1)."""
    s = np.linspace(0, np.pi / 2, 2000001)
    tail = np.cumsum(np.cos(s[::-1]) ** (dof - 1))
    return np.sqrt(dof) * np.tan(s[::-1][np.searchsorted(tail, alpha * tail[-1])])


# ---- random scenes ----

def random_rotation(r):
    q, R = np.linalg.qr(r.normal(size=(3, 3)))
    return q * np.sign(np.diag(R)) * r.choice([-1, 1], size=(1, 3))  # reflections, too


def random_matrix(r, where):
    m = np.eye(4)
    m[:3, :3] = random_rotation(r) @ np.diag(r.uniform(0.5, 1.3, 3)) @ random_rotation(r)
    m[:3, 3] = where
    return m


def random_material(r):
    Kd = r.uniform(0, 0.6, 3)
    m = {"Kd": Kd, "Ks": r.uniform(0, 0.4, 3) if r.random() < 0.8 else np.zeros(3)}
    if r.random() < 0.5:
        m.update(kind="phong", exponent=float(np.exp(r.uniform(0, 3.5))))
    else:
        m.update(kind="microfacet", roughness=float(r.uniform(0.4, 1)))
    if r.random() < 0.4:
        m["checks"] = (r.uniform(0, 0.6, 3), r.uniform(0, 0.6, 3), int(r.integers(2, 7)))
    return m


def random_scene(seed):
    r = np.random.default_rng([SEED, seed])
    pixels = (r.random((4, 8, 3)) ** 4 * 3).astype(np.float32)
    shapes = []
    for k in range(r.integers(2, 5)):
        kind = ["sphere", "disk", "mesh"][r.integers(3)]
        s = {"kind": kind, "matrix": random_matrix(r, r.normal(0, 0.7, 3)), "material": random_material(r)}
        s.update(radius=r.uniform(0.5, 1.2), height=r.uniform(-0.5, 0.5))
        if kind == "mesh":
            s.update(P=r.normal(0, 1, (4, 3)), indices=np.array([[0, 1, 2], [0, 2, 3]]), uv=r.uniform(0, 1, (4, 2)))
        shapes.append(s)
    shapes.append({"kind": "disk", "matrix": random_matrix(r, [0, 0, -1.5]), "radius": 4.0, "height": 0.0,
                   "material": random_material(r)})
    return {"eye": witness.unit(r.normal(size=3)) * 5, "look": r.normal(0, 0.2, 3), "up": r.normal(size=3),
            "fov": r.uniform(25, 50),
            "width": 4, "height": 3, "shapes": shapes,
            "light": {"rotation": random_rotation(r), "pixels": pixels.astype(np.float64)}}


# ---- the same as text ----

def numbers(a):
    return "[%s]" % " ".join(repr(float(x)) for x in np.ravel(a))


def shape_text(k, s):
    m, out = s["material"], []
    Kd = '"rgb Kd" ' + numbers(m["Kd"])
    if "checks" in m:
        first, second, times = m["checks"]
        out.append('Texture "t%d" "spectrum" "checkerboard" "rgb tex1" %s "rgb tex2" %s "float uscale" %d '
                   '"float vscale" %d'
                   % (k, numbers(first), numbers(second), times, times))
        Kd = '"texture Kd" "t%d"' % k
    width = '"float exponent" %r' % m["exponent"] if m["kind"] == "phong" else '"float roughness" %r' % m["roughness"]
    out.append('Material "%s" %s "rgb Ks" %s %s' % (m["kind"], Kd, numbers(m["Ks"]), width))
    out.append("AttributeBegin Transform " + numbers(s["matrix"].T))  # column by column
    if s["kind"] == "mesh":
        out.append('Shape "trianglemesh" "point3 P" %s "integer indices" [%s] "point2 uv" %s'
                   % (numbers(s["P"]), " ".join(map(str, s["indices"].ravel())), numbers(s["uv"])))
    else:
        out.append('Shape "%s" "float radius" %r' % (s["kind"], float(s["radius"])))
        out[-1] += ' "float height" %r' % float(s["height"]) if s["kind"] == "disk" else ""
    return out + ["AttributeEnd"]


def write(scene, folder):
    h, w, _ = scene["light"]["pixels"].shape
    with open(os.path.join(folder, "map.pfm"), "wb") as f:
        f.write(b"PF\n%d %d\n-1.0\n" % (w, h) + scene["light"]["pixels"][::-1].astype("<f4").tobytes())
    turn = np.eye(4)
    turn[:3, :3] = scene["light"]["rotation"]
    lines = ['Film "rgb" "integer xresolution" %d "integer yresolution" %d' % (scene["width"], scene["height"]),
             'Sampler "random" "integer pixelsamples" 8', 'Option "bool disablepixeljitter" true',
             "LookAt " + numbers([scene["eye"], scene["look"], scene["up"]])[1:-1],
             'Camera "perspective" "float fov" %r' % float(scene["fov"]),
             "WorldBegin", "AttributeBegin Transform " + numbers(turn.T),
             'LightSource "infinite" "string filename" "map.pfm"', "AttributeEnd"]
    path = os.path.join(folder, "scene.txt")
    with open(path, "w") as f:
        f.write("\n".join(lines + [line for k, s in enumerate(scene["shapes"]) for line in shape_text(k, s)]) + "\n")
    return path


# ---- the comparison ----

def measure():
    """For each method the means of bis (scenes, seeds)."""
    means = {name: np.empty((N_SCENES, N_SEEDS)) for name in METHODS}
    for i in range(N_SCENES):
        with tempfile.TemporaryDirectory() as folder:
            path = write(random_scene(i), folder)
            for name, (settings, _) in METHODS.items():
                for k in range(N_SEEDS):
                    means[name][i, k] = bis.render(path, seed=1000 * i + k, threads=1,
                                                   **settings).rgb.mean(dtype=np.float64)
    return means


def truths():
    """The witness's means (scenes, 2) with and without shadows, and how far they may be off: the change from half as
    many cells a side."""
    fine, coarse = ([witness.render(random_scene(i), k).mean((1, 2, 3)) for i in range(N_SCENES)]
                    for k in (CELLS, CELLS // 2))
    return np.array(fine), np.abs(np.array(fine) - np.array(coarse))


def rejected(means, truth, slack):
    """What differs, as texts."""
    level, found = -np.expm1(np.log1p(-ALPHA) / N_TESTS), []
    of_one, of_all = t_bound(N_SEEDS - 1, level), t_bound(len(truth) - 1, level)
    for name, (_, sees) in METHODS.items():
        expected, may_miss = truth[:, 0 if sees else 1], slack[:, 0 if sees else 1]
        m = means[name]
        mean, se = m.mean(1), m.std(1, ddof=1) / np.sqrt(N_SEEDS)
        off = np.abs(mean - expected) - may_miss - 1e-6 * expected  # floats
        found += ["%s, scene %d: %.6g, expected %.6g, standard error %.2g" % (name, i, mean[i], expected[i], se[i])
                  for i in np.flatnonzero(off > of_one * se)]
        d = (mean - expected) / expected
        t = d.mean() / (d.std(ddof=1) / np.sqrt(len(d)))
        if abs(t) > of_all:
            found.append("%s, all scenes: %+.3f %%, t = %.1f" % (name, 100 * d.mean(), t))
        if os.environ.get("WITNESS_SHOWS"):
            print("%-12s %+.4f %% +- %.4f %%" % (name, 100 * d.mean(), 100 * d.std(ddof=1) / np.sqrt(len(d))))
    return found


class Witness(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.means = measure()

    def test_every_integrator_agrees_with_the_witness(self):
        self.assertEqual(rejected(self.means, *truths()), [])

    def test_a_witness_with_a_mistake_is_rejected(self):
        def exponent_off(m, Kd, wi, wo, n):  # n for n + 1
            return phong({**m, "Ks": m["Ks"] * m["exponent"] / (m["exponent"] + 1)}, Kd, wi, wo, n)

        def lambert_base(m, Kd, wi, wo, n):
            return facets(m, 0 * Kd, wi, wo, n) + Kd * (1 - m["Ks"]) / np.pi

        phong, facets = witness.f_phong, witness.f_microfacet
        for wrong in ({"phong": exponent_off}, {"microfacet": lambert_base}):
            with self.subTest(wrong=wrong), unittest.mock.patch.dict(witness.MODELS, wrong):
                self.assertNotEqual(rejected(self.means, *truths()), [])

    def test_t_bound(self):
        """Published: t of 10 degrees of freedom, two-sided 5 %, is 2.228; of one degree, 50 %, is 1."""
        self.assertAlmostEqual(t_bound(10, 0.05), 2.228, places=3)
        self.assertAlmostEqual(t_bound(1, 0.5), 1, places=3)


if __name__ == "__main__":
    unittest.main()
