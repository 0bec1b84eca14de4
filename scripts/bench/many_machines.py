"""many_machines: how long bis-mpi takes on more ranks than anybody here has, by simulation. docs/many-machines.md has the
table.

    python3 scripts/bench/many_machines.py [--threads T] [--link BYTES_PER_SECOND] [--svg FILE]

Simulated is what src/render/team.c does: rank 0 deals out batches, each rank has one at work and one waiting, costly
tiles come first from the second pass on, finished tiles come back one by one, and rank 0 looks after the others alone
(more than 16 ranks). Every message passes rank 0, one after the other. A pass is as long as its slowest rank, and then
rank 0 adds it to the film. Passes of 4 camera samples are alike, so one of them is simulated and counted as often as it
is made; those of 1 and 2 are in proportion.

Costs: those marked with m are measured with scene.txt (sir, product, learn) on one processor, see the page; the network
is assumed: 2 us from machine to machine, 10 Gbit/s at rank 0, 1 us of software for a message."""
import heapq
import math
import random
import sys

# m: milliseconds of a tile of 16 x 16 pixels in a pass of 4 camera samples, at 0, 5, ... 100 % of all tiles; mean 4.9
TILE_MS = [1.61, 3.21, 3.26, 3.29, 3.32, 3.35, 3.38, 3.45, 3.55, 3.64, 3.78, 3.94, 4.12, 4.36, 4.67, 5.39, 6.39, 7.88,
           8.95, 10.2, 28.5]
FILL = 3.3e-3          # m: pool and clusters of a pass, on every rank
TAKE = 2.1e-6          # m: rank 0 takes in a tile and sends another
KEEP = 5e-9            # m: rank 0 adds a pixel to the film
WRITE = 0.43e-6        # m: rank 0 writes a pixel of the EXR
START = 0.5            # m: reading the scene, the accelerator, the map, MPI_Init
EDGE = 0.3e-6          # m: the ray that looks for an outline, a pixel; shared by the ranks
BYTES = 16 + 16 + 256 * 16 + 8  # of a tile in a pass, both ways, beside what it has learned:
CELL = 2 * 512                  # 16 cells of a tile, or one in pictures of more than 2^23 pixels
LATENCY, MESSAGE = 2e-6, 1e-6
MOST_TILES, PIECES = 32, 4


def tile_seconds(n, rng):
    """Neighbours are alike: costs in runs of 8, of the measured distribution."""
    out = []
    while len(out) < n:
        x = rng.random() * (len(TILE_MS) - 1)
        i = int(x)
        ms = TILE_MS[i] + (x - i) * (TILE_MS[i + 1] - TILE_MS[i])
        out += [ms * 1e-3 * rng.uniform(0.95, 1.05) for _ in range(8)]
    return out[:n]


def simulate(seconds, ranks, threads, link, tile_bytes):
    """One pass: its length, and how long rank 0 was busy with messages. seconds[]: of the tiles, as dealt out."""
    n, at = len(seconds), 0
    until = [0.0]
    for s in seconds:
        until.append(until[-1] + s)
    each = max(TAKE + 2 * MESSAGE, tile_bytes / link)
    server = busy = end = 0.0
    leader_renders = ranks <= 16
    first = 0 if leader_renders else 1          # rank 0 takes a tile when it has a thread, without a message
    held = [0] * ranks
    queue = [[] for _ in range(ranks)]          # of (time of arrival, tile)
    idle = [threads] * ranks
    events = []                                 # (time a tile is done, rank)

    def batch():
        most = (until[n] - until[at]) * threads / (PIECES * ranks * threads)
        k = threads
        while k < MOST_TILES and at + k < n and until[at + k + 1] - until[at] <= most:
            k += 1
        return min(k, MOST_TILES)

    def begin(w, now):
        nonlocal at
        while idle[w] and (queue[w] or (w == 0 and at < n)):
            if w == 0:
                there, t, at = now, at, at + 1
            else:
                there, t = queue[w].pop()
            idle[w] -= 1
            heapq.heappush(events, (max(now, there) + seconds[t], w))

    def deal(w):
        nonlocal at, server
        k = min(batch(), n - at)
        if k <= 0:
            return
        server += MESSAGE
        queue[w] = [(server + LATENCY, t) for t in range(at + k - 1, at - 1, -1)] + queue[w]
        at += k
        held[w] += k

    for _ in range(2):
        for w in range(1, ranks):
            deal(w)
    for w in range(first, ranks):
        begin(w, 0.0)
    while events:
        now, w = heapq.heappop(events)
        idle[w] += 1
        if w > 0:
            server = max(server, now + LATENCY) + each
            busy += each
            held[w] -= 1
            if held[w] <= batch():
                deal(w)
        begin(w, now)
        end = max(end, server, now)
    return end, busy


def render(width, height, spp, ranks, threads, link):
    """Seconds in all, and of each of its parts."""
    pixels, tiles = width * height, math.ceil(width / 16) * math.ceil(height / 16)
    rng = random.Random(1)
    seconds = tile_seconds(tiles, rng)
    work = sum(seconds)
    n_passes = (spp - 4) / 4                    # of 4; before them 1 + 1 + 2
    if ranks == 1:
        length, busy = work / threads, 0.0
    else:
        tile_bytes = BYTES + CELL * (16 if pixels <= 1 << 23 else 1)
        length, busy = simulate(sorted(seconds, reverse=True), ranks, threads, link, tile_bytes)
    fixed = FILL / threads + KEEP * pixels / threads + math.log2(ranks + 1) * LATENCY
    short = 1.0                                 # the three first passes have as many samples as one of 4
    parts = {
        "rendering": (n_passes + short) * work / (ranks * threads),
        "messages": (n_passes + 3) * busy,
        "film": (n_passes + 3) * KEEP * pixels / threads,
        "pools": (n_passes + 3) * FILL / threads,
        "start": START + EDGE * pixels / (ranks * threads),
        "writing": WRITE * pixels,
    }
    # each of the three first passes has all messages, and a share of the work
    parts["last tiles, waiting"] = max(0.0, (n_passes + short) * (length - work / (ranks * threads) - busy))
    total = n_passes * (length + fixed) + length + 2 * busy + 3 * fixed + parts["start"] + parts["writing"]
    return total, parts


def svg(rows, name):
    """Speed-up against ranks, both axes logarithmic."""
    colours = ["#1b6ca8", "#c0392b", "#2e8b57", "#8e44ad"]
    lines = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 520 360" font-family="sans-serif" font-size="11">',
             '<rect width="520" height="360" fill="white"/>']

    def place(ranks, speed):
        return 50 + 105 * math.log10(ranks), 320 - 70 * math.log10(max(speed, 1))

    for k in range(5):
        x, y = place(10 ** k, 10 ** k)
        lines.append(f'<path d="M{x} 40V320M50 {y}H470" stroke="#ddd"/><text x="{x}" y="336" text-anchor="middle">{10 ** k}'
                     f'</text><text x="44" y="{y + 4}" text-anchor="end">{10 ** k}</text>')
    lines.append('<path d="M50 320L470 40" stroke="#999" stroke-dasharray="4 3"/>'
                 '<text x="260" y="354" text-anchor="middle">ranks</text><text x="50" y="24">speed-up</text>')
    for i, (title, points) in enumerate(rows):
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in (place(*p) for p in points))
        lines.append(f'<polyline points="{path}" fill="none" stroke="{colours[i]}" stroke-width="2"/>'
                     f'<text x="62" y="{56 + 15 * i}" fill="{colours[i]}">{title}</text>')
    with open(name, "w") as out:
        out.write("\n".join(lines) + "\n</svg>\n")


def main(arguments):
    options = {"--threads": "1", "--link": "1.25e9", "--svg": ""}
    if len(arguments) % 2 or any(a not in options for a in arguments[::2]):
        sys.exit(__doc__)
    options.update(zip(arguments[::2], arguments[1::2]))
    threads, link = int(options["--threads"]), float(options["--link"])
    print("| picture | samples | ranks | seconds | speed-up | efficiency | the rest of the time |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    curves = []
    for width, height in ((1920, 1080), (16384, 8192)):
        for spp in (16, 1024):
            points = []
            for ranks in (1, 10, 100, 1000, 10000):
                total, parts = render(width, height, spp, ranks, threads, link)
                if ranks == 1:
                    alone = total
                speed = alone / total
                points.append((ranks, speed))
                rest = sorted(((v, k) for k, v in parts.items() if k != "rendering"), reverse=True)[:2]
                names = ", ".join(f"{k} {100 * v / total:.0f} %" for v, k in rest if v > 0.02 * total)
                print(f"| {width} x {height} | {spp} | {ranks} | {total:.3g} | {speed:.3g} | {100 * speed / ranks:.0f} % "
                      f"| {names} |")
            curves.append((f"{width} x {height}, {spp} samples", points))
    if options["--svg"]:
        svg(curves, options["--svg"])


if __name__ == "__main__":
    main(sys.argv[1:])
