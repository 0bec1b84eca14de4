# SPDX-License-Identifier: BSD-2-Clause
"""live_frames: a figure that lives, state by state, as a headless Chromium shows it: FOLDER/00.png, 01.png, ...

    python3 scripts/figures/live_frames.py FOLDER NAME STATE...         (after `make web`)

Each picture has the figure from its controls to its words. A state is what stands behind NAME: in a figure's link."""
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/web"))
import browser  # noqa: E402

folder, name, *states = sys.argv[1:]
WIDTH = 1010
with browser.Browser("chromium") as b:
    for i, state in enumerate(states):
        page = b.page(f"file://{ROOT}/build/web/index.html?only={name}#{name}:{state}", width=WIDTH)
        if not page.wait(f"bisFigure.seen['{name}'] && !document.querySelector('.live[aria-busy]')", 120):
            sys.exit(f"live_frames: {name}:{state} is not drawn")
        page.value("(document.querySelectorAll('.live-tasks, .live-own, .live-foot').forEach((e) => e.remove()), 0)")
        page.shot(f"{folder}/{i:02}.png", of="document.querySelector('figure.live')")
