# SPDX-License-Identifier: BSD-2-Clause
"""error_truth: is the error that `bis` prints the true one, and does --error keep its word? Prints the table of
docs/budgets.md, "Error".

    error_truth.py BIS [SCENE...] [--own] [--seeds 8] [--size 96x72] [--only METHOD,...] [--error-seeds 8]
                   [--halves] [--out FOLDER]

Needs numpy. Each scene is rendered without its Sampler and Integrator lines: by default, or by the methods of --only.
`named` is the scene as it stands. --own adds scenes that are made here: maps of few pixels, a room with a window,
checkerboards, small spheres under a sun. The truth of a picture is the mean of the default pictures of the other seeds
with 32 samples, whose own noise is taken off: the square of what parts picture and truth, less the variance of that
mean, by the scatter of the pictures in it. Columns: the true error at 8 samples; for n = 4, 8, 16 and 32 the median of
printed / true, and in brackets, where it is not all seeds, how many print a figure within 35 % (n = 4) or 20 % of the
true error of their own picture, of how many that print one. E is the largest true error that a seed has at 20 samples,
so that 20 is about the smallest --spp that keeps E for all seeds: how many renders by --error E have a true error of at
most E, and how many camera samples they take, over 20. --halves counts the scenes of even and of odd places apart. The
films are kept in FOLDER as checkpoints. Where they are there already, only the estimate and the renders by --error are
made anew: remove them when pictures change.
"""
import argparse, concurrent.futures as cf, json, os, re, shutil, subprocess, sys, tempfile
import numpy as np

ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
ap.add_argument('bis')
ap.add_argument('scenes', nargs='*')
ap.add_argument('--own', action='store_true')
ap.add_argument('--seeds', type=int, default=8)
ap.add_argument('--size', default='96x72')
ap.add_argument('--only', default='default')
ap.add_argument('--out', default=os.path.join(tempfile.gettempdir(), 'error-truth'))
ap.add_argument('--error-seeds', type=int, help='seeds that are rendered by --error (0: none); default: all')
ap.add_argument('--halves', action='store_true')
ap.add_argument('--jobs', type=int, default=2)
a = ap.parse_args()
os.makedirs(a.out, exist_ok=True)
SPP = (4, 8, 16, 32)
LIMIT = {4: .35, 8: .2, 16: .2, 32: .2}
METHODS = {'default': (), 'named': (), 'em': ('--integrator', 'em'), 'brdf': ('--integrator', 'brdf'),
           'mis': ('--integrator', 'mis'), 'sir': ('--integrator', 'sir', '--proposal', 'product'),
           'sir-mix': ('--integrator', 'sir', '--proposal', 'mix'), 'rejection': ('--integrator', 'rejection')}


def pixels(path):
    with open(path, 'rb') as f:
        f.readline()
        width, height = map(int, f.readline().split())
        scale = float(f.readline())
        return np.frombuffer(f.read(), '<f4' if scale < 0 else '>f4').reshape(height, width, 3).astype(float)


def render(scene, seed, *options):
    """Returns the picture and its statistics; None if the scene is refused."""
    out = os.path.join(a.out, 'p%d-%s' % (os.getpid(), abs(hash((scene, seed, options)))))
    command = [a.bis, scene, '--nthreads', '1', '--resolution', a.size, '--seed', str(seed), '--outfile', out + '.pfm',
               '--stats', out + '.json', *options]
    r = subprocess.run(command, capture_output=True, text=True)
    if r.returncode:
        print('%s: %s' % (scene, r.stderr.strip()[-200:]), file=sys.stderr)
        return None
    picture, stats = pixels(out + '.pfm'), json.load(open(out + '.json'))
    os.remove(out + '.pfm')
    os.remove(out + '.json')
    return picture, stats


def film(scene, method, seed, n):
    """Does the same with n samples, by a checkpoint that is kept in FOLDER and made from that of half of the samples.
    The bits are those of one render. Where the checkpoint is there already, nothing is rendered, and the program only
    says what it now thinks of the film. The scene as it stands may have a sampler that divides the pixel by n, so it
    has no checkpoints."""
    if method == 'named':
        return render(scene, seed, '--spp', str(n))
    path = lambda n: os.path.join(a.out, 'films', '%s-%s-%s-%d-%d.bis' %
                                  (os.path.basename(scene), method, a.size, seed, n))
    before = {8: 4, 16: 8, 20: 16, 32: 16}.get(n)
    os.makedirs(os.path.dirname(path(n)), exist_ok=True)
    if before and not os.path.exists(path(n)):
        if not os.path.exists(path(before)) and film(scene, method, seed, before) is None:
            return None
        shutil.copy(path(before), path(n))
    return render(scene, seed, '--spp', str(n), '--resume', path(n), *METHODS[method])


def variant(scene, name):
    """Returns the path of the scene, or of a copy of it beside it in which nothing names a sampler or an integrator."""
    if name == 'named':
        return scene
    text = ''.join(line for line in open(scene) if not re.match(r'\s*(Sampler|Integrator)\b', line))
    folder, base = os.path.split(os.path.abspath(scene))
    copy = os.path.join(a.out, 'default-' + base)
    text = re.sub(r'"((?:\.\./|\./)?[\w./-]+\.(?:hdr|exr|pfm|ply|obj|inc|png|pbrt))"',
                  lambda m: '"%s"' % os.path.normpath(os.path.join(folder, m.group(1))), text)
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
        m = ((.2 + np.maximum(0, .5 - elevation))[:, None, None] * np.array([.8, .9, 1.2]) *
             (1 + .5 * np.cos(2 * np.pi * turn))[None, :, None])
        m[height // 4:height // 4 + height // 32, height // 2:height // 2 + height // 32] += sun
        return m

    sizes = ((1, 1), (2, 1), (4, 2), (8, 4))
    write_map('sky.pfm', sky(64, 200))
    write_map('sun.pfm', sky(256, 2e4))
    for w, h in sizes:
        write_map('map%dx%d.pfm' % (w, h), rng.uniform(.1, 2, (h, w, 3)))
    head = ('Film "rgb" "integer xresolution" 240 "integer yresolution" 180\nScale -1 1 1\nLookAt %s\n'
            'Camera "perspective" "float fov" %g\nWorldBegin\n'
            'LightSource "infinite" "string filename" "%s" "bool visible" false\n')
    dull = 'Material "phong" "rgb Kd" [.6 .6 .6] "rgb Ks" [0 0 0]\n'
    glossy = 'Material "phong" "rgb Kd" [.4 .2 .1] "rgb Ks" [.3 .3 .3] "float exponent" 60\n'
    checks = ('Texture "t" "spectrum" "checkerboard" "rgb tex1" [.8 .3 .2] "rgb tex2" [.2 .3 .6] "float uscale" %d '
              '"float vscale" %d\n'
              'Material "phong" "texture Kd" "t" "float Ks" 0.2 "float exponent" 60\n')
    walls = [[(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)], [(-2, -2, 3), (2, -2, 3), (2, 2, 3), (-2, 2, 3)],
             [(-2, -2, 0), (-2, 2, 0), (-2, 2, 3), (-2, -2, 3)],
             [(-2, -2, 0), (2, -2, 0), (2, -2, 3), (-2, -2, 3)], [(-2, 2, 0), (2, 2, 0), (2, 2, 3), (-2, 2, 3)]]
    walls += [[(2, p, r), (2, q, r), (2, q, s), (2, p, s)]
              for p, q, r, s in ((-2, 2, 0, 1), (-2, 2, 2, 3), (-2, -.5, 1, 2), (.5, 2, 1, 2))]
    room = ''.join('Shape "trianglemesh" "point3 P" [%s] "integer indices" [0 1 2 0 2 3]\n' %
                   ' '.join('%g' % c for p in q for c in p) for q in walls)
    ball = 'AttributeBegin\nTranslate %g %g %g\nShape "sphere" "float radius" %g\nAttributeEnd\n'
    floor = 'Shape "disk" "float radius" 30\n'
    inside, over = '-1.7 -1.7 1.6  1 0.6 0.9  0 0 1', '0 -9 4  0 0 0.2  0 0 1'
    row = ''.join(ball % (x, 0, .8, .8) for x in (-2, 0, 2))
    beads = ''.join(ball % (*rng.uniform(-3, 3, 2), rng.uniform(.1, 1), rng.uniform(.05, .2)) for _ in range(300))
    scenes = {'room-sky': head % (inside, 70, 'sky.pfm') + dull + room + glossy + ball % (.4, .2, .5, .5),
              'room-sun': head % (inside, 70, 'sun.pfm') + dull + room + glossy + ball % (.4, .2, .5, .5),
              'checks-coarse': head % (over, 40, 'sky.pfm') + checks % (16, 16) + floor + glossy + row,
              'checks-fine': head % (over, 40, 'sky.pfm') + checks % (200, 200) + floor + glossy + row,
              'beads': head % (over, 40, 'sun.pfm') + dull + floor + glossy + beads}
    for w, h in sizes:
        scenes['map-%dx%d' % (w, h)] = head % (over, 40, 'map%dx%d.pfm' % (w, h)) + dull + floor + glossy + row
    for name, text in scenes.items():
        with open(os.path.join(folder, name + '.txt'), 'w') as f:
            f.write(text)
    return [os.path.join(folder, name + '.txt') for name in scenes]


def truths(scene):
    """Returns, for each seed, a function that tells the true error of its pictures."""
    long = [film(scene, 'default', seed, max(SPP)) for seed in range(1, a.seeds + 1)]
    if None in long:
        return None
    long = np.stack([p[0] for p in long])

    def of(seed):
        others = np.delete(long, seed - 1, 0)
        mean = others.mean(0)
        scale = mean ** 2 + mean.mean() ** 2 / 100
        noise = (((others - mean) ** 2).sum(0) / (len(others) - 1) / len(others) / scale).mean()
        return lambda p: np.sqrt(max(0, ((p - mean) ** 2 / scale).mean() - noise))
    return {seed: of(seed) for seed in range(1, a.seeds + 1)}


def row(scene, method, error):
    """Prints a row and returns its counts: for each n (within, known, runs), renders by --error that kept E, all of
    them, their samples over 20."""
    path = variant(scene, method)
    cells, curve, counts = [], {}, {}
    for n in SPP:
        runs = [film(path, method, seed, n) for seed in error]
        true = np.array([error[seed](r[0]) for seed, r in zip(error, runs)])
        curve[n] = np.sqrt((true ** 2).mean())
        printed = np.array([np.nan if r[1]['estimated_relative_rmse'] is None else r[1]['estimated_relative_rmse']
                            for r in runs])
        known = ~np.isnan(printed)
        ratio = printed[known] / np.maximum(true[known], 1e-12)
        within = int((np.abs(ratio - 1) <= LIMIT[n]).sum())
        counts[n] = np.array([within, known.sum(), len(runs)])
        share = ' (%d of %d)' % (within, known.sum()) if within < len(runs) else ''
        cells.append('%.2f%s' % (np.median(ratio), share) if known.any() else 'unknown')
        if os.environ.get('VERBOSE'):
            print(scene, method, n, np.round(ratio, 2), flush=True)
    samples, kept = [], 0
    for seed in list(error)[:a.error_seeds]:
        if not samples:
            E = max(error[seed](film(path, method, seed, 20)[0]) for seed in error)
        p, s = render(path, seed, '--error', '%.6g' % E, *METHODS[method])
        kept += error[seed](p) <= E
        samples.append(s['spp'] / 20)
    title = os.path.basename(scene).rsplit('.', 1)[0] + (', ' + method if a.only != 'default' else '')
    print('| %s | %.1f %% | %s |%s' % (title, 100 * curve[8], ' | '.join(cells),
                                       ' %d of %d | %.2f |' % (kept, len(samples), np.mean(samples))
                                       if samples else ''), flush=True)
    return counts, kept, samples


def rows_of(scene):
    error = truths(variant(scene, 'default'))
    return [row(scene, method, error) for method in a.only.split(',')] if error else []


def tell(what, rows):
    for n in SPP:
        within, known, runs = sum(r[0][n] for r in rows)
        print('%s%d samples: %d of %d figures within %d %% (%.1f %%), %d of %d unknown' %
              (what, n, within, known, round(100 * LIMIT[n]), 100 * within / max(known, 1), runs - known, runs))
    rows = [r for r in rows if r[2]]
    if rows:
        over = np.array([np.mean(r[2]) for r in rows])
        print('%s--error: kept in %d of %d; samples over 20, means of scenes: median %.2f, quartiles %.2f and %.2f, '
              'nine of ten at most %.2f, largest %.2f' %
              (what, sum(r[1] for r in rows), sum(len(r[2]) for r in rows), np.median(over),
               *np.quantile(over, (.25, .75, .9)), over.max()))


scenes = a.scenes + (own_scenes(os.path.join(a.out, 'own')) if a.own else [])
print('| scene | true(8) | 4 | 8 | 16 | 32 | E kept | samples / 20 |\n'
      '| --- | --- | --- | --- | --- | --- | --- | --- |')
with cf.ThreadPoolExecutor(a.jobs) as pool:
    of_scenes = list(pool.map(rows_of, scenes))
tell('', sum(of_scenes, []))
for first in range(2) if a.halves else ():
    tell('%s places: ' % ('even', 'odd')[first], sum(of_scenes[first::2], []))
