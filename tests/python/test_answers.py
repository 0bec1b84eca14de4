# SPDX-License-Identifier: BSD-2-Clause
"""The figures of docs/assignments/answers.md, the teacher's page, computed anew: by enumeration, by
quadrature, or by the rule that the handout asks for. What a run shows (bis pixel) is not here."""
import math
import os
import unittest

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PAGE = os.path.join(ROOT, "docs/assignments/answers.md")
HANDOUT = os.path.join(ROOT, "docs/assignments/regions.md")


def answers_of(name):
    """answers_of returns the part of the page that is about an assignment."""
    with open(PAGE, encoding="utf-8") as page:
        return page.read().split(f"\n## {name}\n")[1].split("\n## ")[0]


def count_regions(rows, sphere):
    """count_regions joins equal neighbours, on the sphere also over the seam and at the poles."""
    h, w = len(rows), len(rows[0])
    pairs = [((y, x), (y + 1, x)) for y in range(h - 1) for x in range(w)]
    pairs += [((y, x), (y, x + 1)) for y in range(h) for x in range(w - 1)]
    if sphere:
        pairs += [((y, w - 1), (y, 0)) for y in range(h)]
        pairs += [((y, a), (y, b)) for y in (0, h - 1) for a in range(w) for b in range(a)]
    label = {(y, x): y * w + x for y in range(h) for x in range(w)}
    for _ in range(h * w):
        for p, q in pairs:
            if rows[p[0]][p[1]] == rows[q[0]][q[1]]:
                label[p] = label[q] = min(label[p], label[q])
    return len(set(label.values()))


def variance_of_two(weights, F, q):
    """variance_of_two is that of h F/q, summed over one sample of each technique."""
    worth = weights * F / q
    return float((q * worth**2).sum() - ((q * worth).sum(axis=1) ** 2).sum())


class Answers(unittest.TestCase):
    """Each claim computes figures, and looks for them on the page."""

    def assert_says(self, name, *figures):
        """assert_says fails unless the answers of an assignment have all these figures."""
        text = answers_of(name)
        for figure in figures:
            self.assertIn(figure, text, name)

    def test_cdf_alias_and_envmap(self):
        C = np.cumsum([0, 0, 2, 0, 1, 5]) / 8
        items = np.searchsorted(C, [0, 0.25, 0.375, 0.9], side="right") - 1
        rest = (0.9 - C[4]) / (C[5] - C[4])
        ones = np.cumsum(np.ones(2**24 + 99, np.float32), dtype=np.float32)[-1]
        self.assert_says("cdf", ", ".join(f"{c:g}" for c in C), "Items 1, 3, 4, 4", f"{rest:.2f}",
                         f"{int(ones)}", *(f"{(n + 1) / 2:g}" for n in (4, 8, 128)))
        self.assertEqual(items.tolist(), [1, 3, 4, 4])
        self.assertEqual((1 + (1 - 3 / 8) + (1 - 3 / 4)) / 3, 5 / 8)
        self.assert_says("alias", "3/8", "3/4", "5/8", f"{2**24 // 2**16}")
        share = (1 - math.cos(math.pi / 8)) / (1 - math.cos(math.pi / 4))
        self.assert_says("envmap", f"{9 / (8 * math.pi):.3f}", f"{1 / (8 * math.pi):.4f}",
                         f"{100 * share:.0f} %", *(f"{0.5943 * n:.2g}" for n in (4, 8, 128)))

    def test_regions_of_the_handout(self):
        with open(HANDOUT, encoding="utf-8") as page:
            rows = page.read().split("```\n")[1].split("\n")[:4]
        counts = [count_regions([row.split() for row in rows], sphere) for sphere in (True, False)]
        levels = [math.floor(7 * math.log10(i / 1e-3) / 7 + 1e-9) for i in (0.5, 1, 20, 1e4)]
        self.assert_says("regions", f"1. {counts[0]}; {counts[1]}.", "2, 3, 4")
        self.assertEqual(levels, [2, 3, 4, 7])

    def test_phong_by_quadrature(self):
        angles = [math.degrees(math.acos(0.5 ** (1 / (n + 1)))) for n in (10, 100, 10000)]
        self.assert_says("phong", f"{angles[0]:.1f}, {angles[1]:.1f}, {angles[2]:.2f} degrees")
        u = (np.arange(10**6) + 0.5) / 10**6
        worth = {"lobe": u ** (1 / 11), "cosine": 5.5 * np.sqrt(u) ** 10}
        relative = {k: v.var() / v.mean() ** 2 for k, v in worth.items()}
        self.assertAlmostEqual(relative["lobe"] * 11 * 13, 1, 3)
        self.assertAlmostEqual(relative["cosine"] * 44 / 100, 1, 3)
        errors = {k: [100 * math.sqrt(v / n) for n in (4, 8, 128)] for k, v in relative.items()}
        self.assert_says("phong", "{:.0f}, {:.0f}, {:.0f} %".format(*errors["cosine"]),
                         "{:.1f}, {:.1f}, {:.2f} %".format(*errors["lobe"]))

    def test_mis_by_enumeration(self):
        F, q = np.array([9.0, 1.0]), np.array([[0.9, 0.1], [0.1, 0.9]])
        found = [variance_of_two(h, F, q) for h in (np.full((2, 2), 0.5), q / q.sum(axis=0),
                                                    q**2 / (q**2).sum(axis=0))]
        alone = [((q[t] * (F / q[t]) ** 2).sum() - 100) / 2 for t in (0, 1)]
        said = [f"{found[0]:.1f}", f"{found[1]:.2f}", f"{found[2]:.2f}", f"{alone[0]:.0f}"]
        self.assert_says("mis", "; ".join([*said, f"{alone[1]:.1f}"]))

    def test_rejection_sir_and_grid(self):
        first = sum(0.1 * 0.9 ** (t - 1) / t for t in range(1, 2000)) / 0.1
        self.assert_says("rejection", f"= {first:.2f} times",
                         ", ".join(f"{0.95**m:.2g}" for m in (4, 8, 128)))
        marks = np.ceil(1.2 - np.arange(0, 1, 1e-5))
        M, N = np.meshgrid(np.arange(1, 2001), np.arange(1, 201), indexing="ij")
        noise = np.where(M + 100 * N <= 4400, 1 / M + 1 / N, np.inf)
        best = np.unravel_index(noise.argmin(), noise.shape)
        self.assert_says("sir", f"{marks.var():.2f}; {4 * 0.3 * 0.7:.2f}",
                         f"{(best[0] + 1) / (best[1] + 1):.0f}.")
        n = (2 * 1000.0) ** (1 / 3)
        grown = [(k * n + 1000 / (k * n) ** 2) / (n + 1000 / n**2) for k in (0.5, 2)]
        self.assert_says("grid", "{:.2f} and {:.2f} times".format(*grown))


if __name__ == "__main__":
    unittest.main()
