# SPDX-License-Identifier: BSD-2-Clause
"""test_web: are the figures of docs/live what they say: alive, with the bits of the native library, and for everyone?

`make test-web` calls it: python3 tests/web/test_web.py FOLDER LIBRARY [NAME...]   FOLDER: build/web, LIBRARY: libbis.so

Each figure is driven in a headless Chromium as a person would: opened by a link, moved by keys, clicked. After each
step the hash that it shows is compared with that of the same calls of the native library. The twin: one wrong bit
changes the hash. Without a Chromium it says so and ends with 0."""
import gzip
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import browser
import native

TOLERANCE = 1e-9        # of what libm has touched: its functions differ by units of the last place
AXE = "axe-core@4.10.2"


class Test:
    """Test counts claims and prints those that do not hold."""

    def __init__(self):
        self.n, self.failed = 0, 0

    def claim(self, holds, words):
        self.n += 1
        if not holds:
            self.failed += 1
            print("FAILED:", words, flush=True)
        return holds


def same_numbers(of_libm, calls, shown, own):
    """same_numbers: are the outputs of calls of these functions close?"""
    for call, a, b in zip(calls, shown, own):
        if call[0] not in of_libm:
            continue
        for x, y in zip(a, b):
            x = list(x.values()) if isinstance(x, dict) else x
            if any(abs(u - v) > TOLERANCE * max(1, abs(v)) for u, v in zip(x, y)):
                return False
    return True


def settle(page, name):
    """settle waits until the figure shows what its controls say; so long that a loaded machine does not matter."""
    return page.wait(f"bisFigure.seen['{name}'] && "
                     f"!document.querySelector('[data-figure={name}]').hasAttribute('aria-busy')", 900)


def compare(t, lib, page, name, step):
    """compare holds what the figure shows against the native library."""
    if not t.claim(settle(page, name), f"{name}, {step}: is drawn"):
        return
    seen = page.value(f"(() => {{ const s = bisFigure.seen['{name}']; return {{"
                      "calls: JSON.stringify(s.calls), hash: s.hash, error: s.error,"
                      f" out: JSON.stringify(s.out.map((o, i) => {lib.of_libm}.includes(s.calls[i][0]) ? o : []))"
                      "}; })()")
    if not t.claim(not seen["error"], f"{name}, {step}: {seen['error']}"):
        return
    calls = json.loads(seen["calls"])
    out, digest = lib.run(calls)
    t.claim(digest == seen["hash"], f"{name}, {step}: shows {seen['hash']}, native {digest}")
    t.claim(same_numbers(lib.of_libm, calls, json.loads(seen["out"]), out),
            f"{name}, {step}: p-values and the like are the native ones")
    shown = page.value(f"document.querySelector('[data-figure={name}] [data-hash]').textContent")
    t.claim(shown == seen["hash"], f"{name}, {step}: prints its hash")


CONTROLS = "[...document.querySelectorAll('[data-figure=%s] .live-controls %s')]"

# Every control has a name and can be reached, drawings have words, no id stands twice, text has a contrast of 4.5 (WCAG
# 2.2 AA).
ACCESSIBLE = r"""(() => {
  const bad = [], ids = new Set();
  for (const e of document.querySelectorAll('[id]')) { if (ids.has(e.id)) bad.push('two ids ' + e.id); ids.add(e.id); }
  for (const e of document.querySelectorAll('figure.live input, figure.live select, figure.live button, figure.live a'))
    if (!(e.labels && e.labels.length) && !e.textContent.trim() && !e.getAttribute('aria-label'))
      bad.push('no name: ' + e.outerHTML.slice(0, 80));
  for (const e of document.querySelectorAll('figure.live svg'))
    if (e.getAttribute('role') !== 'img' || !e.querySelector('title') || !e.querySelector('title').textContent)
      bad.push('a drawing without words');
  const light = (c) => {
    const v = c.match(/[\d.]+/g).slice(0, 3).map((x) => x / 255)
      .map((x) => x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);
    return 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2];
  };
  for (const e of document.querySelectorAll(
    'figure.live :is(p, label, output, button, li, a, legend)')) {
    let b = e;
    while (b && getComputedStyle(b).backgroundColor === 'rgba(0, 0, 0, 0)') b = b.parentElement;
    const back = b ? light(getComputedStyle(b).backgroundColor) : 1, ink = light(getComputedStyle(e).color);
    if ((Math.max(back, ink) + 0.05) / (Math.min(back, ink) + 0.05) < 4.5)
      bad.push('contrast: ' + e.textContent.slice(0, 40));
  }
  return bad;
})()"""


def drive(t, lib, b, folder, name):
    """drive uses one figure."""
    address = f"file://{folder}/index.html"
    page = b.page(f"{address}?only={name}#{name}")
    compare(t, lib, page, name, "first picture")
    before = page.value(f"bisFigure.seen['{name}'].hash")
    page.value(f"(({CONTROLS % (name, 'input')}[0]).focus(), 0)")
    page.key("ArrowRight")
    page.wait(f"bisFigure.seen['{name}'].hash !== '{before}'", 20)
    compare(t, lib, page, name, "after a key")
    t.claim(page.value(f"bisFigure.seen['{name}'].hash") != before, f"{name}: a key changes what is shown")
    for i in range(page.value(f"{CONTROLS % (name, 'button')}.length - 1")):
        page.click(f"{CONTROLS % (name, 'button')}[{i}]")
        compare(t, lib, page, name, f"after a click on button {i}")
    if page.value(f"!!bisFigure.specs['{name}'].touch"):
        x, y = page.place(f"document.querySelector('[data-figure={name}] svg image')")
        page.click_at(x + 20, y + 10)
        compare(t, lib, page, name, "after a click into the picture")
    for i, control in enumerate(page.value(f"bisFigure.specs['{name}'].controls")):
        for option in list(control.get("options", {}))[1:]:
            page.value(f"(location.hash = '#{name}:{control['name']}={option}', 0)")
            page.wait(f"bisFigure.seen['{name}'].state['{control['name']}'] === '{option}'", 60)
            compare(t, lib, page, name, f"with {control['name']}={option}")
    link = page.value(f"document.querySelector('[data-figure={name}] .live-foot a').getAttribute('href')")
    twin = b.page(f"{address}?only={name}{link}")
    of_name = f"bisFigure.seen['{name}'].hash"
    t.claim(settle(twin, name) and twin.value(of_name) == page.value(of_name),
            f"{name}: its link shows the same")
    t.claim(page.value(f"document.querySelectorAll('[data-figure={name}] h2').length") == 1, f"{name}: has a heading")
    tasks = page.value(f"document.querySelectorAll('[data-figure={name}] [data-task]').length")
    t.claim(tasks == 2, f"{name}: has two tasks")
    for i in range(tasks):
        page.click(f"document.querySelectorAll('[data-figure={name}] [data-task]')[{i}]")
        t.claim(page.value(f"document.querySelectorAll('[data-figure={name}] "
                           f"[data-task] + span')[{i}].textContent.length > 3"), f"{name}: task {i} answers")
    solve(t, b, address, name, page)
    for dark in (False, True):
        look = b.page(f"{address}?only={name}#{name}", width=390, dark=dark)
        settle(look, name)
        for words in look.value(ACCESSIBLE):
            t.claim(False, f"{name}, {'dark' if dark else 'light'}: {words}")
        t.claim(look.value("document.documentElement.scrollWidth") <= 390, f"{name}: fits a telephone")
        axe(t, look, name)
        look.shot(f"{folder}/test_{name}_{'dark' if dark else 'light'}.png")
    others = [r for r in page.requests if not r.startswith((f"file://{folder}/", "blob:", "data:", "about:"))]
    t.claim(not others, f"{name}: fetches {others}")
    t.claim(page.requests, f"{name}: requests are seen at all")


def solve(t, b, address, name, page):
    """solve opens each task's answer and checks that it is one."""
    for i, state in enumerate(page.value(f"bisFigure.specs['{name}'].tasks.map((t) => t.answer)")):
        answer = b.page(f"{address}?only={name}#{name}:{state}")
        t.claim(settle(answer, name), f"{name}, the answer {state}: is drawn")
        answer.click(f"document.querySelectorAll('[data-figure={name}] [data-task]')[{i}]")
        said = answer.value(f"document.querySelectorAll('[data-figure={name}] [data-task] + span')[{i}].textContent")
        t.claim(said.strip() == "Right.", f"{name}: the answer {state} of task {i} says{said}")


def by_keyboard(t, b, folder):
    """by_keyboard goes from the list to a figure: Enter on its link, then Tab is at its first control."""
    page = b.page(f"file://{folder}/index.html")
    links = page.value("[...document.querySelectorAll('.live-list a')].map((a) => a.hash.slice(1))")
    t.claim(links == page.value("Object.keys(bisFigure.specs)"), f"the list has {links}")
    for name in links[-1:] * 2 + links[:1]:     # the same link again has to lead there, too
        page.value(f"(document.querySelector('.live-list a[href=\"#{name}\"]').focus(), 0)")
        page.key("Enter")
        inside = f"document.activeElement.closest('[data-figure={name}]')"
        t.claim(page.wait(f"!!{inside}", 20), f"{name}: its link leads the keyboard to it")
        page.key("Tab")
        t.claim(page.wait(f"document.activeElement.matches('[data-figure={name}] :is(input, select, button)')", 20),
                f"{name}: then Tab leads to its first control")


# What each figure says of one state: (name, state, what is in its words, how many drawings).
SAYS = [
    ("errata", "", ("E23", "off by 0.27"), 5),
    ("errata", "which=E6;spp=64", ("shares of red, green and blue are off by 0.07", "right: more samples"), 5),
    ("regions", "", ("547 components",), 3),
    ("sir", "M=4096;N=1", (" +- ", "so here only more rays help"), 2),
    ("sir", "M=1;N=64", ("so here only more candidates help",), 2),
]


def says(t, b, folder):
    """says looks at the words and drawings of SAYS, and at what mis compares."""
    for name, state, words, drawings in SAYS:
        page = b.page(f"file://{folder}/index.html?only={name}#{name}{state and ':' + state}")
        settle(page, name)
        said = page.value("document.querySelector('.live-words').textContent")
        t.claim(all(word in said for word in words), f"{name}:{state} says {said}")
        t.claim(page.value("document.querySelectorAll('.live-picture svg').length") == drawings,
                f"{name}:{state} has {drawings} drawings")
    page = b.page(f"file://{folder}/index.html?only=mis#mis")
    t.claim("Compared is the error of one estimate" in page.value("document.querySelector('.live-look').textContent"),
            "mis says what it compares")


# An engine whose instances tell what they claim and free, and stop at a call when they are told to.
TRAP = """(async () => {
  const unpack = (base64) => new Response(new Blob([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))]).stream()
    .pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
  const wasm = await WebAssembly.compile(await unpack(bisAssets['bis.wasm.gz'])), Real = WebAssembly.Instance;
  const wrong = [];
  let stop = false, n = 0;
  WebAssembly.Instance = function (...given) {
    const real = new Real(...given).exports, claimed = new Set(), me = n++;
    let dead = false;
    return {exports: Object.assign({}, real, {
      malloc(bytes) { const at = real.malloc(bytes); claimed.add(at); return at; },
      free(at) { if (dead || !claimed.delete(at)) wrong.push(me + ' frees ' + at); else real.free(at); },
      bis_flat_alias_build(...values) {
        if (!stop) return real.bis_flat_alias_build(...values);
        dead = true;
        throw new WebAssembly.RuntimeError('unreachable');
      }})};
  };
  const call = [['bis_flat_alias_build', 2, [1, 2], 2, 2, 1]], engine = bisEngine(wasm, {});
  const before = engine.run(call).hash;
  stop = true;
  try { engine.run(call); wrong.push('no error'); } catch (e) { if (!/started again/.test(e)) wrong.push(String(e)); }
  stop = false;
  if (engine.run(call).hash !== before) wrong.push('another hash');
  WebAssembly.Instance = Real;
  return n === 2 ? wrong : wrong.concat('instances: ' + n);
})()"""


axe_source = None


def fetch_axe():
    """fetch_axe gets the pinned checker from npm, in a folder of its own; None where there is no npm or no network."""
    global axe_source
    with tempfile.TemporaryDirectory() as folder:
        npm = shutil.which("npm")
        if npm and subprocess.run([npm, "pack", "--silent", AXE], cwd=folder, capture_output=True).returncode == 0:
            subprocess.run(["tar", "xzf", next(pathlib.Path(folder).glob("*.tgz"))], cwd=folder, check=True)
            axe_source = (pathlib.Path(folder) / "package/axe.min.js").read_text()
        else:
            print(f"make test-web: {AXE} SKIPPED: no npm here, or no network")


def axe(t, page, name):
    """axe runs axe-core on the figure."""
    if not axe_source:
        return
    page.value(axe_source + "; 0")
    bad = page.value("axe.run('figure.live').then((r) => r.violations.map((v) => v.id + ': ' + v."
                     "nodes.map((n) => n.html.slice(0, 80)).join(' | ')))")
    t.claim(not bad, f"{name}: axe-core says {bad}")


def own_maps(t, lib, b, folder):
    """own_maps gives a figure a damaged map, then a right one: the worker survives, the page says what was wrong."""
    page = b.page(f"file://{folder}/index.html?only=sir#sir")
    settle(page, "sir")
    whole = (pathlib.Path(lib.folder) / "maps/interior.hdr").read_bytes()
    choose = "document.querySelector('[data-figure=sir] input[type=file]')"
    for kind, data in (("cut off", whole[:9000]), ("of noise", bytes(range(256)) * 40),
                       ("OpenEXR", b"v/1\x01" + bytes(99)), ("empty", b""),
                       ("gigantic", gzip.compress(bytes(70 << 20), 1)), ("huge", bytes(70 << 20))):
        path = pathlib.Path(lib.folder) / f"damaged_{kind[0]}.hdr"     # of another name each: else nothing has changed
        path.write_bytes(data)
        page.value("(bisFigure.seen.sir.error = null, 0)")
        node = page.send("Runtime.evaluate", expression=choose)["result"]["objectId"]
        page.send("DOM.setFileInputFiles", files=[str(path)], objectId=node)
        t.claim(page.wait("!!bisFigure.seen.sir.error", 20), f"a map that is {kind} is an error")
        t.claim(("64 MiB" if len(whole) < len(data) or kind == "gigantic" else "cannot read")
                in page.value("bisFigure.seen.sir.error || ''"),
                f"{kind}: {page.value('bisFigure.seen.sir.error')}")
        path.unlink()
    os.makedirs(pathlib.Path(lib.folder) / "maps", exist_ok=True)
    own = pathlib.Path(lib.folder) / "maps/own"
    own.write_bytes(whole[:200].split(b"\n\n")[0] + b"\n\n" + whole.split(b"\n\n", 1)[1])
    node = page.send("Runtime.evaluate", expression=choose)["result"]["objectId"]
    page.send("DOM.setFileInputFiles", files=[str(own)], objectId=node)
    page.wait("!bisFigure.seen.sir.error", 30)
    compare(t, lib, page, "sir", "with a map of one's own, after damaged ones")
    own.write_bytes((pathlib.Path(lib.folder) / "maps/lamps.hdr").read_bytes())
    for name in ("picture", "errata"):      # which make it smaller first
        page = b.page(f"file://{folder}/index.html?only={name}#{name}:which=E21")
        settle(page, name)
        before = page.value(f"bisFigure.seen['{name}'].hash")
        node = page.send("Runtime.evaluate", expression=choose.replace("sir", name))["result"]["objectId"]
        page.send("DOM.setFileInputFiles", files=[str(own)], objectId=node)
        t.claim(page.wait(f"bisFigure.seen['{name}'].hash !== '{before}'", 60), f"{name}: takes a map of one's own")
        compare(t, lib, page, name, "with a map of one's own")
    own.unlink()


def bits(t, lib, b, folder):
    """bits: `bis verify --bits` in the browser."""
    page = b.page(f"file://{folder}/index.html?only=alias#alias")
    settle(page, "alias")
    code = ("bisClient(bisAssets).ask([['bis_flat_bits', 32, 32, 1024, 1]]).then((a) => { "
            "const [h, e, n, k] = a.out[0];"
            " return [...Array(k[0]).keys()].filter((i) => h[2 * i] !== e[2 * i] || h[2 * i + 1] !== e[2 * i + 1])"
            ".map((i) => new TextDecoder().decode(n.subarray(64 * i, 64 * i + 64)).replace(/\\0.*/, '')); })")
    wrong = page.value(TRAP)
    t.claim(not wrong, f"after a trap: {wrong}")
    different = page.value(code)
    t.claim(not different, f"bits that differ: {different}")


def main():
    folder, library = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    program = next((p for p in [os.environ.get("CHROMIUM"), "chromium", "chromium-browser", "google-chrome"]
                    if p and shutil.which(p)), None)
    if not program:
        print("make test-web: SKIPPED: no chromium here; scripts/setup.sh --web installs one, CHROMIUM=path names one")
        return 0
    t, lib = Test(), native.Library(library, folder)
    _, a = lib.run([["bis_flat_alias_build", 2, [1, 2], 2, 2, 1]])
    _, c = lib.run([["bis_flat_alias_build", 2, [1, 2 + 2.0 ** -51], 2, 2, 1]])
    t.claim(a != c, "a hash sees the last bit")
    fetch_axe()
    with browser.Browser(program) as b:
        page = b.page(f"file://{folder}/index.html")
        names = sys.argv[3:] or page.value("Object.keys(bisFigure.specs)")
        for name in names:
            drive(t, lib, b, folder, name)
        by_keyboard(t, b, folder)
        says(t, b, folder)
        own_maps(t, lib, b, folder)
        bits(t, lib, b, folder)
    print(f"make test-web: {t.n - t.failed} of {t.n} claims hold, {len(names)} figures ({program}); see "
          f"{folder}/test_*.png")
    return t.failed > 0


if __name__ == "__main__":
    sys.exit(main())
