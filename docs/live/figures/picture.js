/* SPDX-License-Identifier: BSD-2-Clause */
/* picture: small pictures by up to four methods at equal rays or in equal time, pass by pass, against the exact one
 * (thesis 5). */
'use strict';
(function () {
const WIDE = 48, HIGH = 32, RAYS = 8, MOST = 6, COLUMNS = 48; /* of the map */
const METHODS = {
  em: ['integrator=em', 'samples=' + RAYS], brdf: ['integrator=brdf', 'samples=' + RAYS],
  mis: ['integrator=mis', 'samples=' + RAYS], sir: ['integrator=sir', 'candidates=128', 'shadowrays=' + RAYS,
    'proposal=mix', 'learn=false']
};
const NAMES = Object.keys(METHODS), chosen = (s) => NAMES.filter((m) => s.who.split('+').includes(m)),
  steps = (s) => [...Array(s.k + 1).keys()];
const map = () => bisSmall(bisFigure.map, COLUMNS);
const render = (s, m, name, spp) => ['bis_flat_render_with', name, 'scene',
  ['text=Option "bool disablepixeljitter" true\n' + bisScene({n: s.n, width: WIDE, height: HIGH}), ...m,
    ...(spp ? ['spp=' + spp, 'seed=' + s.seed] : [])], map()];

/* ---- how many passes ---- */

/* s.cost has the microseconds of a pass of each method, measured where the state was made. In equal time each makes as
 * many passes as fit into one pass of the slowest, then into two, four ... */
const cost = (s, m) => s.cost[NAMES.indexOf(m)];
const passes = (s, m, k) => s.by === 'rays' ? 1 << k : Math.round((1 << k) * Math.max(...s.cost) / cost(s, m));
const used = (s, m, k) => passes(s, m, k) * (s.by === 'rays' ? RAYS : cost(s, m) / 1e6);
const unit = (s) => s.by === 'rays' ? 'rays a pixel' : 'seconds';
async function before(s, ask) {
  if (s.by === 'rays' || s.cost.every((c) => c > 0)) return;
  const measure = async (m, spp) =>
    (await ask([...bisShrink(bisFigure.map, COLUMNS), render(s, METHODS[m], 'timed', spp),
      ['bis_flat_picture_pass_seconds', 'timed']])).out[3][0];
  /* the least of four: the browser compiles what runs often, and other programs only take time away */
  for (const m of NAMES) {
    let least = Infinity;
    for (let i = 0; i < 4; i++) least = Math.min(least, await measure(m, 4 + i));
    s.cost[NAMES.indexOf(m)] = Math.max(1, Math.round(1e6 * least));
  }
}

/* Where a method's picture and its error stand in the answers: picture, pixels, error for each number of passes. */
const EXACT = 3, place = (s, i, k) => EXACT + 1 + 3 * (i * (s.k + 1) + k);
const errorAt = (s, out, m, k) => {
  const i = chosen(s).indexOf(m);
  return i < 0 ? NaN : out[place(s, i, k) + 2][0][0];
};
const errorOf = (s, out, m) => errorAt(s, out, m, s.k);
bisFigure.define({
  name: 'picture',
  title: 'A small picture by several methods, at equal rays or in equal time',
  section: '5',
  look: 'each step doubles the rays (or the time), and every error falls along the same slope; what differs is where ' +
    'a method begins.',
  map: true,
  before,
  controls: [
    {name: 'k', label: 'Twice as much', add: 1, most: MOST},
    {name: 'who', label: 'methods', options: {'em+brdf+sir': 'em, brdf, sir', 'em+brdf+mis+sir': 'all four',
      'mis+sir': 'mis, sir', 'em': 'em alone'}, value: 'em+brdf+sir'},
    {name: 'by', label: 'equal', options: {rays: 'rays', time: 'time, as measured here'}, value: 'rays'},
    {name: 'n', label: 'exponent of the balls', min: 1, max: 1024, log: true, value: 32},
    {name: 'seed', label: 'seed', min: 1, max: 99, value: 1},
    {name: 'cost', hidden: true, values: [0, 0, 0, 0], min: 0, max: 1e8}
  ],
  calls: (s) => [
    ...bisShrink(bisFigure.map, COLUMNS),
    render(s, ['integrator=exact'], 'exact'),
    ['bis_flat_picture_pixels', 'exact', 4 * WIDE * HIGH],
    ...chosen(s).flatMap((m, i) => steps(s).flatMap((k) => [
      render(s, METHODS[m], m + ' ' + k, passes(s, m, k)),
      ['bis_flat_picture_pixels', m + ' ' + k, 4 * WIDE * HIGH],
      ['bis_flat_compare', WIDE, HIGH, '#' + (place(s, i, k) + 1) + '.0', '#' + EXACT + '.0', 3]]))
  ],
  draw(s, out, wide) {
    const show = (title, pixels) => bisPlot.heat({title, text: title, width: 200, height: 133, columns: WIDE,
      rows: HIGH, scale: false, image: bisPlot.png(WIDE, HIGH, bisFigure.screen(pixels, WIDE * HIGH, 4, 1.5))});
    const first = Math.min(...chosen(s).map((m) => used(s, m, 0))),
      last = Math.max(...chosen(s).map((m) => used(s, m, MOST)));
    const chart = bisPlot.chart({title: 'Error against ' + unit(s), width: wide, height: 320,
      text: chosen(s).map((m) => m + ' ' + bisPlot.number(errorOf(s, out, m), 3)).join(', '),
      x: {label: unit(s), log: true, min: first / 1.2, max: 1.2 * last},
      y: {label: 'RMSE against the exact picture', log: true},
      series: chosen(s).map((m) => ({kind: 'line', x: steps(s).map((k) => used(s, m, k)),
        y: steps(s).map((k) => errorAt(s, out, m, k)), label: m, colour: m, points: true}))});
    const spent = s.by === 'rays' ? (RAYS << s.k) + ' rays a pixel'
      : bisPlot.duration((1 << s.k) * Math.max(...s.cost) / 1e6) + ' (' +
      chosen(s).map((m) => m + ' ' + passes(s, m, s.k)).join(', ') + ' passes of ' + RAYS + ' rays a pixel)';
    return {html: '<div>' + chosen(s).map((m, i) => show(m, out[place(s, i, s.k) + 1][0])).join('') +
      show('exact', out[EXACT][0]) + '</div>' + chart,
      words: 'After ' + spent + ' the errors are: ' + chosen(s)
        .map((m) => m + ' ' + bisPlot.number(errorOf(s, out, m), 3)).join(', ') + '.'};
  },
  tasks: [
    {ask: 'How many rays a pixel does em need for the error that sir has with 8? Show both at equal rays, with so ' +
      'many passes for which em is below it.', answer: 'k=6',
      check: (s, out) => {
        const e = errorOf(s, out, 'em'), b = errorAt(s, out, 'sir', 0);
        return s.by !== 'rays' ? 'Choose equal rays.' : Number.isNaN(e + b) ? 'Show em and sir.' : e < b ? ''
          : 'em has ' + bisPlot.number(e, 3) + ', sir had ' + bisPlot.number(b, 3) + '.';
      }},
    {ask: 'Show all four methods, and find an exponent at which brdf has a smaller error than em.',
      answer: 'who=em+brdf+mis+sir;n=1024;k=2',
      check: (s, out) => {
        const e = ['em', 'brdf', 'mis'].map((m) => errorOf(s, out, m));
        return e.some(Number.isNaN) ? 'Show all four.' : e[1] < e[0] ? '' : 'Not at this one.';
      }}
  ]
});
})();
