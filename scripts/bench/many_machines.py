# SPDX-License-Identifier: BSD-2-Clause
"""many_machines: how long bis-mpi takes on more ranks than anybody here has, by simulation. docs/command-line.md has
the table.

    python3 scripts/bench/many_machines.py [--threads T] [--link BYTES_PER_SECOND] [--json FILE]

1, 10, 100, 1000 and 10000 threads work together, at most T (32) of them in a rank: one rank for each machine.

Simulated is what src/render/scheduler_deal.c does: rank 0 deals out batches, each rank has one at work and one waiting;
a rank gets the tiles that it had in the pass before, then those of the rank with most work left, which that rank sends
to it between two of its own tiles; costly tiles come first from the second pass on; finished tiles come back some
together, and rank 0 looks after the others alone (more than 16 ranks). Every message to rank 0 comes one after the
other. A pass is as long as its slowest rank, and then rank 0 adds it to the film. Passes of 4 camera samples are alike,
so the third of three is counted as often as one is made; those of 1 and 2 are in proportion.

Costs: those marked with m are measured with scene.txt (sir, product, learn) on one processor; the network
is assumed: 2 us from machine to machine, 10 Gbit/s at each, 1 us of software for a message."""
import heapq
import json
import math
import random
import sys

# m: milliseconds of a tile of 16 x 16 pixels in a pass of 4 camera samples, at 0, 5, ... 100 % of all tiles; mean 4.9
TILE_MS = [1.61, 3.21, 3.26, 3.29, 3.32, 3.35, 3.38, 3.45, 3.55, 3.64, 3.78, 3.94, 4.12, 4.36, 4.67, 5.39, 6.39, 7.88,
           8.95, 10.2, 28.5]
FILL = 3.3e-3          # m: pool and clusters of a pass, on every rank
TAKE = 2.1e-6          # m: rank 0 takes in a tile and sends another
KEEP = 5e-9            # m: rank 0 adds a pixel to the film
WRITE = 0.24e-6        # m: a thread of rank 0 compresses a pixel of the EXR
DISK = 1.5e-8          # m: a pixel reaches the disk, 830 MB/s
SWEEP = 7.2e-8         # m: a thread of rank 0 finds a pixel's mean and error at the end
SUM = 8e-9             # m: of these, what one thread adds up in order, and frees
START = 0.5            # m: reading the scene, the accelerator, the map, MPI_Init
EDGE = 0.3e-6          # m: the ray that looks for an outline, a pixel; shared by the ranks
BYTES = 16 * 256 + 16  # of a tile in a pass
CELL = 512             # of what a tile has learned: 16 cells, or one in pictures of more than 2^23 pixels
NAP = 1e-4             # m: a rank that waits looks for a message so often
LATENCY, MESSAGE = 2e-6, 1e-6
MOST_TILES, PIECES, TOGETHER = 32, 4, 8


def tile_seconds(n, rng):
    """Neighbours are alike: costs in runs of 8, of the measured distribution."""
    out = []
    while len(out) < n:
        x = rng.random() * (len(TILE_MS) - 1)
        i = int(x)
        ms = TILE_MS[i] + (x - i) * (TILE_MS[i + 1] - TILE_MS[i])
        out += [ms * 1e-3 * rng.uniform(0.95, 1.05) for _ in range(8)]
    return out[:n]


class Lists:
    """The tiles that are not dealt out yet: those of each rank, and nobody's (the last list)."""

    def __init__(self, seconds, owner, ranks, known):
        self.tiles = [[] for _ in range(ranks + 1)]
        order = sorted(range(len(seconds)), key=lambda t: -seconds[t]) if known else range(len(seconds))
        for t in order:
            self.tiles[owner[t]].append(t)
        self.cost = seconds if known else [1] * len(seconds)
        self.left = [sum(self.cost[t] for t in tiles) for tiles in self.tiles]
        self.total = sum(self.left)
        for tiles in self.tiles:
            tiles.reverse()                     # the next one is the last
        self.ranks, self.known = ranks, known
        self.richest = [(-left, i) for i, left in enumerate(self.left[:-1]) if self.tiles[i]]
        heapq.heapify(self.richest)

    def find(self, rank, may_move=True):
        """The list that a rank's next tiles come from, None: none."""
        for i in (rank, self.ranks):
            if self.tiles[i]:
                return i
        while may_move and self.richest:
            left, i = self.richest[0]
            if self.tiles[i] and -left <= self.left[i] * (1 + 1e-9):
                return i
            heapq.heappop(self.richest)
            if self.tiles[i]:
                heapq.heappush(self.richest, (-self.left[i], i))
        return None

    def batch(self, i, threads):
        most, n, sum_ = self.total / (PIECES * self.ranks), 0, 0.0
        tiles = self.tiles[i]
        while n < min(MOST_TILES, len(tiles)):
            sum_ += self.cost[tiles[-1 - n]]
            if n >= threads and sum_ > most:
                break
            n += 1
        return n

    def take(self, i, n):
        out = [self.tiles[i].pop() for _ in range(n)]
        spent = sum(self.cost[t] for t in out)
        self.left[i] -= spent
        self.total -= spent
        return out


class Pass:
    """One pass: its end, how long rank 0's link was busy with messages, how many tiles moved. seconds[]: of the tiles.
    owner[]: the ranks that had them in the pass before, `ranks`: nobody; receives the new ones. learned: bytes of a
    tile."""

    def __init__(self, seconds, owner, known, ranks, threads, link, learned):
        self.lists, self.seconds, self.owner = Lists(seconds, owner, ranks, known), seconds, owner
        self.ranks, self.threads, self.link, self.learned = ranks, threads, link, learned
        self.server = self.busy = self.end = 0.0
        self.moved = 0
        self.held, self.work = [0] * ranks, [0.0] * ranks     # tiles, and their seconds
        self.queue = [[] for _ in range(ranks)]               # of (time of arrival, tile)
        self.idle = [threads] * ranks
        self.leader_renders = ranks <= 16
        if not self.leader_renders:
            self.idle[0] -= 1
        self.working = [[] for _ in range(ranks)]             # when the tiles at work will be done
        self.unsent, self.unsent_work = [0] * ranks, [0.0] * ranks
        self.events = []                                      # (time a tile is done, rank, tile)
        for w in list(range(1, ranks)) * 2:
            self.deal(w, 0.0)
        for w in range(ranks):
            self.begin(w, 0.0)
        while self.events:
            now, w, tile = heapq.heappop(self.events)
            self.finish(now, w, tile)
            self.end = max(self.end, self.server, now)

    def begin(self, w, now):
        queue, lists = self.queue[w], self.lists
        while self.idle[w] and (queue or (w == 0 and lists.find(0, False) is not None)):
            if queue:
                there, t = queue.pop()
                if there > now:
                    there += NAP / 2
            else:
                there, t = now, lists.take(lists.find(0, False), 1)[0]
                self.owner[t] = 0
            self.idle[w] -= 1
            done = max(now, there) + self.seconds[t]
            self.working[w].append(done)
            heapq.heappush(self.events, (done, w, t))

    def deal(self, w, now):
        lists, held = self.lists, self.held[w]
        i = lists.find(w)
        if i is None:
            return
        k = lists.batch(i, self.threads)
        if held > k if self.leader_renders else (
                held >= self.threads and self.work[w] > lists.total / (PIECES * self.ranks)):
            return
        tiles = lists.take(i, k)
        self.server = max(self.server, now) + MESSAGE
        there = self.server + LATENCY
        if i not in (w, self.ranks):            # they move, when the owner has time
            if i > 0:
                there = max(there, min(self.working[i], default=there) if not self.idle[i] else there)
            there += MESSAGE + LATENCY + k * self.learned / self.link
            self.moved += k
        self.queue[w] = [(there, t) for t in reversed(tiles)] + self.queue[w]
        for t in tiles:
            self.owner[t] = w
        self.held[w] += k
        self.work[w] += sum(lists.cost[t] for t in tiles)

    def finish(self, now, w, tile):
        self.idle[w] += 1
        self.working[w].remove(now)
        start = now
        if w > 0:
            self.unsent[w] += 1
            self.unsent_work[w] += self.lists.cost[tile]
            if self.unsent[w] >= min(TOGETHER, len(self.queue[w])):
                taken = self.unsent[w] * max(TAKE, BYTES / self.link)
                self.busy += MESSAGE + taken
                self.server = max(self.server, now + LATENCY) + MESSAGE + taken
                self.held[w] -= self.unsent[w]
                self.work[w] -= self.unsent_work[w]
                self.unsent[w], self.unsent_work[w] = 0, 0.0
                had_none = not self.queue[w]
                self.deal(w, self.server)
                if had_none:
                    start = max(now, self.server)
        elif self.lists.find(0, False) is None and len(self.queue[0]) < self.threads:
            self.held[0], self.work[0] = 0, 0.0
            self.deal(0, now)
        self.begin(w, start)


def third_pass(pixels, tiles, ranks, threads, link, cache={}):
    """Of three passes over a picture the last one, and the work in it."""
    key = tiles, ranks, threads, link
    if key not in cache:
        rng = random.Random(1)
        seconds, owner = tile_seconds(tiles, rng), [ranks] * tiles
        learned = CELL * (16 if pixels <= 1 << 23 else 1)
        for number in range(3):
            noisy = [s * rng.uniform(0.95, 1.05) for s in seconds]
            done = Pass(noisy, owner, number > 0, ranks, threads, link, learned)
        cache[key] = done.end, done.busy, done.moved, sum(seconds)
    return cache[key]


def render(width, height, spp, ranks, threads, link):
    """Seconds in all, and of each of its parts."""
    pixels, tiles = width * height, math.ceil(width / 16) * math.ceil(height / 16)
    n_passes = (spp - 4) / 4                    # of 4; before them 1 + 1 + 2
    if ranks == 1:
        rng = random.Random(1)
        work = sum(tile_seconds(tiles, rng))
        length, busy, moved = work / threads, 0.0, 0
    else:
        length, busy, moved, work = third_pass(pixels, tiles, ranks, threads, link)
    fixed = FILL / threads + KEEP * pixels / threads + math.log2(ranks) * (LATENCY + NAP / 2)
    short = 1.0                                 # the three first passes have as many samples as one of 4
    parts = {
        "rendering": (n_passes + short) * work / (ranks * threads),
        "messages": (n_passes + 3) * busy,
        "film": (n_passes + 3) * KEEP * pixels / threads,
        "pools": (n_passes + 3) * FILL / threads,
        "start": START + EDGE * pixels / (ranks * threads),
        "writing": ((WRITE + SWEEP) / threads + DISK + SUM) * pixels,
    }
    # each of the three first passes has all messages, and a share of the work
    parts["last tiles, waiting"] = max(0.0, (n_passes + short) * (length - max(work / (ranks * threads), busy)))
    total = n_passes * (length + fixed) + length + 2 * busy + 3 * fixed + parts["start"] + parts["writing"]
    return total, parts, moved / tiles


def curves_of(rows):
    """Speed-up against threads, for scripts/figures/still.js (docs/live.md)."""
    most = rows[0][1][-1][0]
    return {"title": "Speed-up against threads, simulated", "x": "threads", "y": "speed-up", "diagonal": [1, most],
            "curves": [{"label": title, "x": [p[0] for p in points], "y": [p[1] for p in points]}
                       for title, points in rows]}


def main(arguments):
    options = {"--threads": "32", "--link": "1.25e9", "--json": ""}
    if len(arguments) % 2 or any(a not in options for a in arguments[::2]):
        sys.exit(__doc__)
    options.update(zip(arguments[::2], arguments[1::2]))
    most, link = int(options["--threads"]), float(options["--link"])
    print("| picture | samples | ranks x threads | seconds | speed-up | efficiency | the rest of the time "
          "| tiles that move |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    curves = []
    for width, height in ((1920, 1080), (16384, 8192)):
        for spp in (16, 1024):
            points = []
            for wanted in (1, 10, 100, 1000, 10000):
                ranks = math.ceil(wanted / most)
                threads = wanted // ranks
                total, parts, moved = render(width, height, spp, ranks, threads, link)
                n = ranks * threads
                if n == 1:
                    alone = total
                speed = alone / total
                points.append((n, speed))
                rest = sorted(((v, k) for k, v in parts.items() if k != "rendering"), reverse=True)[:2]
                names = ", ".join(f"{k} {100 * v / total:.0f} %" for v, k in rest if v > 0.02 * total)
                print(f"| {width} x {height} | {spp} | {ranks} x {threads} | {total:.3g} | {speed:.3g} | "
                      f"{100 * speed / n:.0f} % "
                      f"| {names} | {f'{100 * moved:.1f} %' if ranks > 1 else ''} |", flush=True)
            curves.append((f"{width} x {height}, {spp} samples", points))
    if options["--json"]:
        with open(options["--json"], "w") as out:
            json.dump(curves_of(curves), out)


if __name__ == "__main__":
    main(sys.argv[1:])
