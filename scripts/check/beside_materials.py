# SPDX-License-Identifier: BSD-2-Clause
"""beside_materials: balls of pbrt's materials by bis, beside the same by pbrt's own formulas in Mitsuba 3.

    python3 scripts/check/beside_materials.py BIS OUT [WORD]      OUT is a folder for what is made on the way

Each material is rendered with alpha 0.05, 0.1, 0.2, 0.4 and 0.8, once in light of 1 from everywhere (the furnace) and
once under the map of a studio. For each row and all of its balls: the mean over all pixels and channels of bis over
that of the reference, less 1, and below it the root of the mean squared difference of pixels over the mean. Pictures
are rendered SEEDS times, and the square is estimated by products of the differences of two of them, in which noise
cancels. OUT/NAME.png shows the balls under the map, bis above and the reference below. WORD: only materials whose name
holds it. Exit status: 0, 1 where what the page calls exact is off by more than 0.3 %, 77 without Mitsuba."""
import os
import sys

import numpy as np

from beside_mitsuba import bis_pictures, mitsuba_pictures
from mitsuba_materials import mi

ALPHAS = [0.05, 0.1, 0.2, 0.4, 0.8]
MATERIALS = {  # name: the words, whether the page calls all of it exact
    'diffuse': ('"diffuse" "rgb reflectance" [0.5 0.4 0.3]', True),
    'metal, rgb': ('"metal" "rgb eta" [0.2 0.9 1.2] "rgb k" [3.9 2.4 2.2]', True),
    'conductor, reflectance': ('"conductor" "rgb reflectance" [0.9 0.6 0.3]', True),
    'conductor, copper': ('"conductor"', False),
    'conductor, gold': ('"conductor" "spectrum eta" "metal-Au-eta" "spectrum k" "metal-Au-k"', False),
    'plastic': ('"plastic"', True),
    'plastic, Ks 1': ('"plastic" "rgb Kd" [0.1 0.3 0.1] "rgb Ks" [1 1 1]', True),
    'uber, eta 1.8': ('"uber" "rgb Kd" [0.05 0.1 0.4] "rgb Ks" [1 1 1] "float eta" 1.8', True),
    'substrate': ('"substrate"', False),
    'substrate, Ks 0.05': ('"substrate" "rgb Kd" [0.5 0.05 0.03] "rgb Ks" [0.05 0.05 0.05]', False),
    'coateddiffuse': ('"coateddiffuse"', False),
    'coateddiffuse, dark': ('"coateddiffuse" "rgb reflectance" [0.1 0.1 0.1]', False),
}
SIDE = 48
SCENE = '''Film "rgb" "integer xresolution" {side} "integer yresolution" {side}
Sampler "sobol"
Integrator "mis" "integer samples" 16
Scale -1 1 1
LookAt 0 -9 0  0 0 0  0 0 1
Camera "orthographic" "float screenwindow" [-1.05 1.05 -1.05 1.05]
WorldBegin
LightSource "infinite" "bool visible" false {light}
Material {words}
Shape "sphere"
'''


def difference(ours, theirs):
    """Mean and root mean square of bis less the reference, over the reference's mean."""
    d = [a - b for a, b in zip(ours, theirs)]
    mean, n = np.mean(theirs), len(d)
    square = (np.mean(np.sum(d, 0) ** 2) - sum(np.mean(x ** 2) for x in d)) / (n * (n - 1))
    error = np.std([x.mean() for x in d], ddof=1) / np.sqrt(n)
    return np.mean(d) / mean, np.sqrt(max(square, 0)) / mean, error / mean


def tone(a):
    a = np.clip(a, 0, 1)
    return np.uint8(255 * np.where(a <= 0.0031308, 12.92 * a, 1.055 * a ** (1 / 2.4) - 0.055) + 0.5)


def main():
    bis, out = (os.path.abspath(p) for p in sys.argv[1:3])
    os.makedirs(out, exist_ok=True)
    scene, failed = os.path.join(out, 'ball.txt'), 0
    lights = {'furnace': '', 'map': f'"string filename" "{os.path.abspath("data/maps/studio.hdr")}"'}
    print(f'bis over pbrt\'s formulas in Mitsuba {mi.__version__}, less 1, in %, at alpha')
    print(f'{"":36s}' + ''.join(f'{a:8g}' for a in ALPHAS), flush=True)
    for name, (words, exact) in MATERIALS.items():
        if len(sys.argv) > 3 and sys.argv[3] not in name:
            continue
        alphas = ALPHAS[:1] if name == 'diffuse' else ALPHAS
        for kind, light in lights.items():
            rows, strips = [], []
            for alpha in alphas:
                rough = '' if name == 'diffuse' else f' "float {{}}roughness" {alpha} "bool remaproughness" false'
                rough = rough.format('u') + f' "float vroughness" {alpha}' if 'substrate' in name else rough.format('')
                with open(scene, 'w') as f:
                    f.write(SCENE.format(side=SIDE, light=light, words=words + rough))
                ours, theirs = bis_pictures(bis, scene, out, 32), mitsuba_pictures(scene, out, False, 1024)
                rows.append(difference(ours, theirs))
                strips.append(np.concatenate([np.mean(ours, 0), np.mean(theirs, 0)]))
                failed += exact and abs(rows[-1][0]) > 0.003 + 3 * rows[-1][2]
            for label, i in (('mean', 0), ('difference', 1), ('error of the mean', 2)):
                print(f'{name if i == 0 else "":24s}{kind if i == 0 else "":8s}{label[:4]:4s}'
                      + ''.join(f'{100 * r[i]:8.2f}' for r in rows), flush=True)
        picture = name.replace(', ', '-').replace(' ', '-') + '.png'
        mi.Bitmap(tone(np.concatenate(strips, 1))).write(os.path.join(out, picture))
    sys.exit(1 if failed else 0)


main()
