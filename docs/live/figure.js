/* SPDX-License-Identifier: BSD-2-Clause */
/* figure: what all figures that live share: sliders, keys, links, hash, tasks, words for people who do not see them.
 *
 * bisFigure.define(spec) adds a figure. The page has <figure class="live" data-figure="NAME"> where it shall stand.
 *   name, title, section     section: of the thesis, '3.2.2'
 *   look           one sentence: what to look for
 *   controls       in their order; each is one value of the state, by name, with label and (first) value:
 *       {name, label, min, max, step, value, log}   a slider; log: it moves on powers of 2
 *       {name, label, values: [...], value}         weights, one slider each
 *       {name, label, options: {key: words}, value} a choice
 *       {name, label, add, most}                    a button that adds to a number, from 0; above most it begins again
 *       {name, hidden: true, values: [...], min, max}   no control: what before() finds out, kept in links
 *   before(state, ask)   if there, runs before calls() and may change hidden values; ask(calls) is the worker
 *   map            true: the visitor's own map may take the place of the page's
 *   calls(state)   the calls of docs/live/engine.js; the map is the file bisFigure.map of bisFigure.shape,
 *                  [width, height]
 *   draw(state, out, wide)   {html, words}: drawings by bisPlot, and one or two sentences with the numbers that they
 *                  show; wide: how many pixels a drawing across the page may take. A drawing's title stands above it
 *   touch          {name of a control: (x, y) => value}: a click on the first drawing's field, x and y in [0,1]
 *   tasks          [{ask, check(state, out), answer}]; check returns '' if it is solved, else a hint; answer is a
 *                  link's state that solves it, for tests
 *
 * A link to a state is #NAME:w=1,2,3;seed=4. A page's address may say ?only=NAME. Everything that a visitor sees is a
 * function of it, and of an own map. bisFigure.seen[NAME] is {state, calls, hash, out, seconds, error}: what is shown,
 * for tests. */
'use strict';
var bisFigure = (function () {
  const WIDE = 760; /* pixels of a drawing across the page, where there is room */
  /* columns of an own map: its values are drawn one by one */
  const OURS = {map: 'maps/interior.hdr', shape: [128, 64]}, MOST = 2048;
  const specs = {}, seen = {};
  let client = null, nextId = 0;

  function element(name, attributes, ...inside) {
    const e = document.createElement(name);
    for (const [k, v] of Object.entries(attributes || {})) if (v !== null && v !== undefined) e.setAttribute(k, v);
    e.append(...inside.filter((x) => x !== null));
    return e;
  }

  /* ---- state and links ---- */

  const first = (c) => c.values ? c.values.slice() : c.add ? 0 : c.value;
  function parse(c, text) {
    const numbers = text.split(',').map(Number), ok = numbers.every(Number.isFinite);
    if (c.options) return Object.prototype.hasOwnProperty.call(c.options, text) ? text : first(c);
    if (c.values) return ok && numbers.length === c.values.length
      ? numbers.map((v) => Math.min(Math.max(v, c.min), c.max)) : first(c);
    if (!ok) return first(c);
    return c.add ? Math.min(Math.max(numbers[0], 0), c.most) : Math.min(Math.max(numbers[0], c.min), c.max);
  }
  function stateOf(spec, link) {
    const state = {}, given = {};
    const [name, rest] = decodeURIComponent(link.replace(/^#/, '')).split(':');
    if (name === spec.name && rest) for (const part of rest.split(';')) {
      const [k, v] = part.split('=');
      given[k] = v;
    }
    for (const c of spec.controls) state[c.name] = given[c.name] === undefined ? first(c) : parse(c, given[c.name]);
    return state;
  }
  const linkOf = (spec, state) => '#' + spec.name + ':' + spec.controls.map((c) => c.name + '=' + state[c.name])
    .join(';');

  /* ---- controls ---- */

  function slider(f, c, label, get, set) {
    const id = 'live' + nextId++, isLog = c.log;
    const to = (v) => isLog ? Math.round(Math.log2(v)) : v, from = (v) => isLog ? Math.pow(2, v) : v;
    const input = element('input', {type: 'range', id, min: to(c.min), max: to(c.max), step: isLog ? 1 : c.step || 1});
    const output = element('output', {for: id});
    input.addEventListener('input', () => { set(from(+input.value)); f.changed(); });
    f.shows.push(() => {
      input.value = to(get());
      output.textContent = c.words ? c.words(get()) : get();
      input.setAttribute('aria-valuetext', output.textContent);
    });
    return element('div', {class: 'live-control'}, element('label', {for: id}, label), input, output);
  }
  function control(f, c) {
    const s = f.state;
    if (c.values) return element('fieldset', {class: 'live-weights'}, element('legend', {}, c.label),
      ...c.values.map((v, i) => slider(f, c, c.item ? c.item(i) : String(i), () => s[c.name][i], (w) => {
        s[c.name][i] = w;
      })));
    if (c.options) {
      const id = 'live' + nextId++, select = element('select', {id},
        ...Object.entries(c.options).map(([k, w]) => element('option', {value: k}, w)));
      select.addEventListener('change', () => { s[c.name] = select.value; f.changed(); });
      f.shows.push(() => { select.value = s[c.name]; });
      return element('div', {class: 'live-control'}, element('label', {for: id}, c.label), select);
    }
    if (c.add) {
      const button = element('button', {type: 'button'}, c.label),
        back = element('button', {type: 'button', 'aria-label': 'Back to 0: ' + c.label}, 'Back to 0');
      button.addEventListener('click', () => {
        s[c.name] = s[c.name] + c.add > c.most ? 0 : s[c.name] + c.add;
        f.changed();
      });
      back.addEventListener('click', () => { s[c.name] = 0; f.changed(); });
      return element('div', {class: 'live-control live-buttons'}, button, back);
    }
    return slider(f, c, c.label, () => s[c.name], (v) => { s[c.name] = v; });
  }

  /* ---- tasks, own maps ---- */

  function task(f, t, i) {
    const says = element('span', {role: 'status'}),
      button = element('button', {type: 'button', 'data-task': i}, 'Check');
    button.addEventListener('click', () => {
      const hint = seen[f.spec.name].out ? t.check(f.state, seen[f.spec.name].out) : 'Wait until the figure is drawn.';
      says.textContent = hint ? ' Not yet. ' + hint : ' Right.';
      says.className = hint ? 'live-no' : 'live-yes';
    });
    return element('li', {}, t.ask + ' ', button, says);
  }
  function dropZone(f) {
    const id = 'live' + nextId++, input = element('input', {type: 'file', id, accept: '.hdr,.pfm,.gz'});
    const take = async (file) => {
      if (!file) return;
      try {
        if (file.size > bisMostBytes) throw new Error('this file has more than ' + (bisMostBytes >> 20) + ' MiB');
        await f.client().put('maps/own', new Uint8Array(await file.arrayBuffer()));
        const [, [shape]] = (await f.client().ask([['bis_flat_light_open_as', 'own light', 'maps/own', []],
          ['bis_flat_light_shape', 'own light', 2]])).out;
        if (shape[0] > MOST) throw new Error('this map has ' + shape[0] + ' columns; a page takes ' + MOST +
          ' at most: bis envmap MAP --to latlong --width ' + MOST);
        Object.assign(bisFigure, {map: 'maps/own', shape: [...shape]});
      } catch (e) {
        failed(f, e);
        return;
      }
      for (const other of Object.values(figures)) if (other.spec.map && other.began) other.changed();
    };
    input.addEventListener('change', () => take(input.files[0]));
    f.box.addEventListener('dragover', (e) => e.preventDefault());
    f.box.addEventListener('drop', (e) => { e.preventDefault(); take(e.dataTransfer.files[0]); });
    return element('p', {class: 'live-own'}, element('label', {for: id},
      'Your own map (.hdr or .pfm, lat-long; it stays on your machine): '), input);
  }

  /* ---- a figure ---- */

  const figures = {};
  /* One below the heading of the page under which a figure stands. */
  function level(box) {
    const above = [...document.querySelectorAll(':is(h1, h2, h3, h4, h5):not(.live-title)')]
      .filter((h) => h.compareDocumentPosition(box) & Node.DOCUMENT_POSITION_FOLLOWING);
    return above.length ? +above.pop().tagName[1] + 1 : 2;
  }
  function enter(f) {
    f.box.focus({preventScroll: true});
    f.box.scrollIntoView();
  }
  function build(box, spec) {
    const id = 'live' + nextId++;
    const f = {spec, box, state: stateOf(spec, location.hash), shows: [], began: false, busy: false, again: false};
    f.client = () => client || (client = bisClient(bisAssets));
    f.picture = element('div', {class: 'live-picture'});
    f.words = element('p', {class: 'live-words', role: 'status'}, 'The figure starts when it is seen.');
    f.foot = element('p', {class: 'live-foot'});
    f.reset = element('button', {type: 'button'}, 'Start again');
    f.reset.addEventListener('click', () => {
      Object.assign(f.state, stateOf(spec, ''));
      Object.assign(bisFigure, OURS);
      f.changed();
    });
    box.setAttribute('role', 'group');
    box.setAttribute('aria-labelledby', id);
    box.setAttribute('tabindex', -1); /* a link leads the keyboard here; the next Tab goes to the first control */
    box.replaceChildren(element('h' + level(box), {class: 'live-title', id}, spec.title),
      element('p', {class: 'live-look'}, 'Look: ' + spec.look),
      element('div', {class: 'live-controls'}, ...spec.controls.filter((c) => !c.hidden).map((c) => control(f, c)),
        f.reset), f.picture, f.words,
      element('ol', {class: 'live-tasks', 'aria-label': 'Tasks'}, ...spec.tasks.map((t, i) => task(f, t, i))),
      spec.map ? dropZone(f) : '', f.foot);
    f.changed = () => changed(f);
    f.picture.addEventListener('click', (e) => touched(f, e));
    figures[spec.name] = f;
    f.shows.forEach((show) => show());
    const watch = new IntersectionObserver((entries) => {
      if (!entries.some((e) => e.isIntersecting)) return;
      watch.disconnect();
      f.began = true;
      changed(f);
    }, {rootMargin: '200px'});
    watch.observe(box);
  }

  /* A click on a field: where it lies in the drawing that says data-field="x0 y0 width height". */
  function touched(f, e) {
    const svg = e.target.closest && e.target.closest('svg');
    if (!f.spec.touch || !svg || svg !== f.picture.querySelector('svg')) return;
    const at = svg.querySelector('image') || svg, r = at.getBoundingClientRect();
    const x = (e.clientX - r.left) / r.width, y = (e.clientY - r.top) / r.height;
    if (!(x >= 0 && x < 1 && y >= 0 && y < 1)) return;
    for (const [name, value] of Object.entries(f.spec.touch)) f.state[name] = value(x, y);
    f.changed();
  }

  /* While the worker computes, only the last change waits; what is shown stays until the next is there. */
  async function changed(f) {
    f.shows.forEach((show) => show());
    if (f.busy) { f.again = true; return; }
    f.busy = true;
    do {
      f.again = false;
      const began = performance.now();
      f.box.setAttribute('aria-busy', 'true');
      try {
        if (f.spec.before) await f.spec.before(f.state, f.client().ask);
        const state = JSON.parse(JSON.stringify(f.state));
        const calls = f.spec.calls(state), answer = await f.client().ask(calls);
        show(f, state, calls, answer, (performance.now() - began) / 1e3);
      } catch (e) {
        failed(f, e);
      }
      f.box.removeAttribute('aria-busy');
    } while (f.again);
    f.busy = false;
  }

  function failed(f, e) {
    seen[f.spec.name] = Object.assign({}, seen[f.spec.name], {error: e.message});
    f.words.textContent = 'This did not work: ' + e.message;
  }

  function show(f, state, calls, answer, seconds) {
    const drawing = f.spec.draw(state, answer.out, Math.min(WIDE, f.picture.clientWidth)), link = linkOf(f.spec, state);
    seen[f.spec.name] = {state, calls, hash: answer.hash, out: answer.out, seconds, error: null};
    f.picture.innerHTML = drawing.html;
    /* a title inside a drawing is for people who do not see it */
    for (const svg of f.picture.querySelectorAll('svg')) {
      const box = element('div', {class: 'live-drawing'},
        element('div', {class: 'live-caption', 'aria-hidden': 'true'}, svg.querySelector('title').textContent));
      svg.replaceWith(box);
      box.append(svg);
    }
    f.words.textContent = drawing.words;
    f.foot.replaceChildren('These numbers have the hash ', element('code', {'data-hash': answer.hash}, answer.hash),
      ' and took ' + bisPlot.duration(answer.seconds) + '. ', element('a', {href: link}, 'A link to this state'));
    f.box.dataset.hash = answer.hash;
  }

  function begin() {
    document.head.append(element('style', {}, bisPlot.css));
    const only = new URLSearchParams(location.search).get('only');
    for (const box of document.querySelectorAll('figure.live')) {
      if (only && box.dataset.figure !== only) box.remove();
      else if (specs[box.dataset.figure]) build(box, specs[box.dataset.figure]);
    }
    const at = location.hash.slice(1).split(':')[0];
    const list = document.querySelector('.live-list');
    if (list) list.append(element('ol', {}, ...Object.values(figures).map((f) => element('li', {},
      element('a', {href: '#' + f.spec.name}, f.spec.title)))));
    if (list) list.addEventListener('click', (e) => { /* also where the address is already that of the link */
      const f = figures[(e.target.hash || '').slice(1)];
      if (f) setTimeout(() => enter(f));
    });
    if (figures[at]) enter(figures[at]);
    window.addEventListener('hashchange', () => {
      const f = figures[location.hash.slice(1).split(':')[0]];
      if (!f) return;
      Object.assign(f.state, stateOf(f.spec, location.hash));
      f.began = true;
      f.changed();
      enter(f);
    });
  }
  if (typeof document !== 'undefined') document.addEventListener('DOMContentLoaded', begin);

  /* bisFigure.screen(rgb) returns the picture of radiances [n][stride] as bytes for a screen: L/(1 + L), then a power
   * of 1/2.2. */
  function screen(values, n, stride, exposure) {
    const bytes = new Uint8Array(3 * n);
    for (let i = 0; i < n; i++) for (let k = 0; k < 3; k++) {
      const v = Math.max(0, values[stride * i + k]) * exposure;
      bytes[3 * i + k] = Math.round(255 * Math.pow(v / (1 + v), 1 / 2.2));
    }
    return bytes;
  }
  return {define(spec) { specs[spec.name] = spec; }, specs, seen, screen, map: OURS.map, shape: OURS.shape};
})();
if (typeof module !== 'undefined') module.exports = bisFigure;
