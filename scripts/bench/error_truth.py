# SPDX-License-Identifier: BSD-2-Clause
"""error_truth: is the error that `bis` prints the true one, and does --error keep its word? Prints the table of docs/budgets.md, "Error".

    error_truth.py BIS [--seeds 8] [--size 96x72] [--only NAME,...] [--out FOLDER] [--own] [SCENE...]

Needs numpy. Each scene is rendered by default, without its Sampler and Integrator lines, and with --only default,named also as it stands. --own adds scenes that are made here: maps of few
pixels, a room with a window, checkerboards, small spheres under a sun. The truth is the mean of two long renders by default with seeds of their own; half their difference tells its noise,
which is taken off. Columns: the true error at 8 samples; for n = 4, 8, 16 and 32 how many seeds print a figure within 35 % (n = 4) or 20 % of the true error of their own picture, how many say
"unknown", and the median of printed / true. E is the largest true error that a seed has at 20 samples, so that 20 is about the smallest --spp that keeps E for all seeds: how many renders by
--error E have a true error of at most E, and how many camera samples they take, over 20. References are kept in FOLDER.
"""
import argparse, concurrent.futures as cf, json, os, re, subprocess, sys, tempfile
import numpy as np

ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
ap.add_argument('bis')
ap.add_argument('scenes', nargs='*')
ap.add_argument('--own', action='store_true')
ap.add_argument('--seeds', type=int, default=8)
ap.add_argument('--size', default='96x72')
ap.add_argument('--only', default='default')
ap.add_argument('--out', default=os.path.join(tempfile.gettempdir(), 'error-truth'))
ap.add_argument('--reference', type=int, default=256, help='camera samples of each of the two references')
ap.add_argument('--jobs', type=int, default=2)
a = ap.parse_args()
os.makedirs(a.out, exist_ok=True)
SPP = (4, 8, 16, 32)


def pixels(path):
    with open(path, 'rb') as f:
        f.readline()
        width, height = map(int, f.readline().split())
        scale = float(f.readline())
        return np.frombuffer(f.read(), '<f4' if scale < 0 else '>f4').reshape(height, width, 3).astype(float)


def render(scene, seed, *options):
    """Returns the picture and the statistics, or None if the scene is refused."""
    out = os.path.join(a.out, 'p%d-%s' % (os.getpid(), abs(hash((scene, seed, options)))))
    command = ['nice', a.bis, scene, '--quiet', '--nthreads', '1', '--resolution', a.size, '--seed', str(seed), '--outfile', out + '.pfm', '--stats', out + '.json', *options]
    r = subprocess.run(command, capture_output=True, text=True)
    if r.returncode:
        print('%s: %s' % (scene, r.stderr.strip()[-200:]), file=sys.stderr)
        return None
    picture, stats = pixels(out + '.pfm'), json.load(open(out + '.json'))
    os.remove(out + '.pfm')
    os.remove(out + '.json')
    return picture, stats


def variant(scene, name):
    """Returns the path of the scene, or of a copy of it beside it in which nothing names a sampler or an integrator."""
    if name == 'named':
        return scene
    text = ''.join(line for line in open(scene) if not re.match(r'\s*(Sampler|Integrator)\b', line))
    folder, base = os.path.split(os.path.abspath(scene))
    copy = os.path.join(a.out, 'default-' + base)
    text = re.sub(r'"((?:\.\./|\./)?[\w./-]+\.(?:hdr|exr|pfm|ply|obj|inc|png|pbrt))"', lambda m: '"%s"' % os.path.normpath(os.path.join(folder, m.group(1))), text)
    open(copy, 'w').write(text)
    return copy


def own_scenes(folder):
    """Writes the scenes of --own and returns their paths."""
    os.makedirs(folder, exist_ok=True)
    rng = np.random.default_rng(1)

    def write_map(name, picture):
        with open(os.path.join(folder, name), 'wb') as f:
            f.write(b'PF\n%d %d\n-1.0\n' % (picture.shape[1], picture.shape[0]) + picture[::-1].astype('<f4').tobytes())

    def sky(height, sun):
        elevation = (np.arange(height) + .5) / height
        turn = np.arange(2 * height) / (2 * height)
        m = (.2 + np.maximum(0, .5 - elevation))[:, None, None] * np.array([.8, .9, 1.2]) * (1 + .5 * np.cos(2 * np.pi * turn))[None, :, None]
        m[height // 4:height // 4 + height // 32, height // 2:height // 2 + height // 32] += sun
        return m

    sizes = ((1, 1), (2, 1), (4, 2), (8, 4))
    write_map('sky.pfm', sky(64, 200))
    write_map('sun.pfm', sky(256, 2e4))
    for w, h in sizes:
        write_map('map%dx%d.pfm' % (w, h), rng.uniform(.1, 2, (h, w, 3)))
    head = ('Film "rgb" "integer xresolution" 240 "integer yresolution" 180\nScale -1 1 1\nLookAt %s\nCamera "perspective" "float fov" %g\nWorldBegin\n'
            'LightSource "infinite" "string filename" "%s" "bool visible" false\n')
    dull = 'Material "phong" "rgb Kd" [.6 .6 .6] "rgb Ks" [0 0 0]\n'
    glossy = 'Material "phong" "rgb Kd" [.4 .2 .1] "rgb Ks" [.3 .3 .3] "float exponent" 60\n'
    checks = ('Texture "t" "spectrum" "checkerboard" "rgb tex1" [.8 .3 .2] "rgb tex2" [.2 .3 .6] "float uscale" %d "float vscale" %d\n'
              'Material "phong" "texture Kd" "t" "float Ks" 0.2 "float exponent" 60\n')
    walls = [[(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)], [(-2, -2, 3), (2, -2, 3), (2, 2, 3), (-2, 2, 3)], [(-2, -2, 0), (-2, 2, 0), (-2, 2, 3), (-2, -2, 3)],
             [(-2, -2, 0), (2, -2, 0), (2, -2, 3), (-2, -2, 3)], [(-2, 2, 0), (2, 2, 0), (2, 2, 3), (-2, 2, 3)]]
    walls += [[(2, p, r), (2, q, r), (2, q, s), (2, p, s)] for p, q, r, s in ((-2, 2, 0, 1), (-2, 2, 2, 3), (-2, -.5, 1, 2), (.5, 2, 1, 2))]
    room = ''.join('Shape "trianglemesh" "point3 P" [%s] "integer indices" [0 1 2 0 2 3]\n' % ' '.join('%g' % c for p in q for c in p) for q in walls)
    ball = 'AttributeBegin\nTranslate %g %g %g\nShape "sphere" "float radius" %g\nAttributeEnd\n'
    floor = 'Shape "disk" "float radius" 30\n'
    inside, over = '-1.7 -1.7 1.6  1 0.6 0.9  0 0 1', '0 -9 4  0 0 0.2  0 0 1'
    row = ''.join(ball % (x, 0, .8, .8) for x in (-2, 0, 2))
    beads = ''.join(ball % (*rng.uniform(-3, 3, 2), rng.uniform(.1, 1), rng.uniform(.05, .2)) for _ in range(300))
    scenes = {'room-sky': head % (inside, 70, 'sky.pfm') + dull + room + glossy + ball % (.4, .2, .5, .5), 'room-sun': head % (inside, 70, 'sun.pfm') + dull + room + glossy + ball % (.4, .2, .5, .5),
              'checks-coarse': head % (over, 40, 'sky.pfm') + checks % (16, 16) + floor + glossy + row, 'checks-fine': head % (over, 40, 'sky.pfm') + checks % (200, 200) + floor + glossy + row,
              'beads': head % (over, 40, 'sun.pfm') + dull + floor + glossy + beads}
    for w, h in sizes:
        scenes['map-%dx%d' % (w, h)] = head % (over, 40, 'map%dx%d.pfm' % (w, h)) + dull + floor + glossy + row
    for name, text in scenes.items():
        with open(os.path.join(folder, name + '.txt'), 'w') as f:
            f.write(text)
    return [os.path.join(folder, name + '.txt') for name in scenes]


def reference(scene):
    path = os.path.join(a.out, '%s-%s-%d.npy' % (os.path.basename(scene), a.size, a.reference))
    if not os.path.exists(path):
        two = [render(scene, seed, '--spp', str(a.reference)) for seed in (100001, 100002)]
        if None in two:
            return None
        np.save(path, np.stack([p for p, _ in two]))
    r = np.load(path)
    mean = r.mean(0)
    scale = mean ** 2 + mean.mean() ** 2 / 100
    return mean, scale, ((r[0] - r[1]) ** 2 / 4 / scale).mean()


def row(scene, name):
    path = variant(scene, name)
    truth = reference(variant(scene, 'default'))
    if truth is None:
        return None
    mean, scale, noise = truth
    error = lambda p: np.sqrt(max(0, ((p - mean) ** 2 / scale).mean() - noise))
    cells, curve, good = [], {}, {}
    for n in SPP:
        runs = [render(path, seed, '--spp', str(n)) for seed in range(1, a.seeds + 1)]
        true = np.array([error(p) for p, _ in runs])
        curve[n] = np.sqrt((true ** 2).mean())
        printed = np.array([np.nan if s['estimated_relative_rmse'] is None else s['estimated_relative_rmse'] for _, s in runs])
        known = ~np.isnan(printed)
        ratio = printed[known] / np.maximum(true[known], 1e-12)
        within = int((np.abs(ratio - 1) <= (.35 if n == 4 else .2)).sum())
        good[n] = (within, int(known.sum()), a.seeds, list(np.round(ratio, 2)))
        cells.append('%d of %d%s, %s' % (within, known.sum(), ', %d unknown' % (~known).sum() if not known.all() else '', '%.2f' % np.median(ratio) if known.any() else '-'))
    E = max(error(render(path, seed, '--spp', '20')[0]) for seed in range(1, a.seeds + 1))
    kept, samples = 0, []
    for seed in range(1, a.seeds + 1):
        p, s = render(path, seed, '--error', '%.6g' % E)
        kept += error(p) <= E
        samples.append(s['spp'])
    title = os.path.basename(scene).rsplit('.', 1)[0] + (', default' if name == 'default' else '')
    print('| %s | %.1f %% | %s | %d of %d | %.2f |' % (title, 100 * curve[8], ' | '.join(cells), kept, a.seeds, np.mean(samples) / 20), flush=True)
    if os.environ.get('VERBOSE'):
        print(good, samples, flush=True)
    return good, kept, np.mean(samples) / 20


scenes = a.scenes + (own_scenes(os.path.join(a.out, 'own')) if a.own else [])
print('| scene | true(8) | 4 | 8 | 16 | 32 | E kept | samples / 20 |\n| --- | --- | --- | --- | --- | --- | --- | --- |')
with cf.ThreadPoolExecutor(a.jobs) as pool:
    rows = [r for r in pool.map(lambda t: row(*t), [(s, v) for s in scenes for v in a.only.split(',')]) if r]
for n in SPP:
    within, known, runs = (sum(r[0][n][i] for r in rows) for i in range(3))
    print('%d samples: %d of %d figures within %d %% (%.1f %%), %d of %d unknown' % (n, within, known, 35 if n == 4 else 20, 100 * within / max(known, 1), runs - known, runs))
print('--error: kept in %d of %d; samples over 20: median %.2f, mean %.2f, largest %.2f' % (sum(r[1] for r in rows), a.seeds * len(rows), np.median([r[2] for r in rows]), np.mean([r[2] for r in rows]), max(r[2] for r in rows)))
