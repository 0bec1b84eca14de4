/* SPDX-License-Identifier: BSD-2-Clause */
/* picture: small pictures by up to four methods at equal rays, pass by pass, against the exact one (thesis 5). */
'use strict';
(function () {
const WIDE = 48, HIGH = 32, RAYS = 8, MOST = 6;
const METHODS = {
  em: ['integrator=em', 'samples=' + RAYS], brdf: ['integrator=brdf', 'samples=' + RAYS],
  mis: ['integrator=mis', 'samples=' + RAYS], sir: ['integrator=sir', 'candidates=128', 'shadowrays=' + RAYS, 'proposal=mix', 'learn=false']
};
const chosen = (s) => Object.keys(METHODS).filter((m) => s.who.split('+').includes(m));
const scene = (s) => 'text=Option "bool disablepixeljitter" true\n' + bisScene({n: s.n, width: WIDE, height: HIGH, map: 'maps/small.hdr'});
const passes = (s) => [...Array(s.k + 1).keys()].map((k) => 1 << k);
/* Where a method's picture and its error stand in the answers: picture, pixels, error for each number of passes. */
const place = (s, i, k) => 2 + 3 * (i * (s.k + 1) + k);
const errorOf = (s, out, m) => { const i = chosen(s).indexOf(m); return i < 0 ? NaN : out[place(s, i, s.k) + 2][0][0]; };
bisFigure.define({
  name: 'picture',
  title: 'A small picture by several methods, at equal rays',
  section: '5',
  look: 'each pass doubles the rays, and every error falls along the same slope; what differs is where a method begins.',
  controls: [
    {name: 'k', label: 'Twice the passes', add: 1, most: MOST},
    {name: 'who', label: 'methods', options: {'em+brdf+sir': 'em, brdf, sir', 'em+brdf+mis+sir': 'all four', 'mis+sir': 'mis, sir', 'em': 'em alone'}, value: 'em+brdf+sir'},
    {name: 'n', label: 'exponent of the balls', min: 1, max: 1024, log: true, value: 32},
    {name: 'seed', label: 'seed', min: 1, max: 99, value: 1}
  ],
  calls: (s) => [
    ['bis_flat_render', 'exact', 'scene', [scene(s), 'integrator=exact']],
    ['bis_flat_picture_pixels', 'exact', 4 * WIDE * HIGH],
    ...chosen(s).flatMap((m, i) => passes(s).flatMap((spp, k) => [
      ['bis_flat_render', m + spp, 'scene', [scene(s), ...METHODS[m], 'spp=' + spp, 'seed=' + s.seed]],
      ['bis_flat_picture_pixels', m + spp, 4 * WIDE * HIGH],
      ['bis_flat_compare', WIDE, HIGH, '#' + (place(s, i, k) + 1) + '.0', '#1.0', 3]]))
  ],
  draw(s, out, wide) {
    const show = (title, pixels) => bisPlot.heat({title, text: title, width: 200, height: 133, columns: WIDE, rows: HIGH, scale: false, image: bisPlot.png(WIDE, HIGH, bisFigure.screen(pixels, WIDE * HIGH, 4, 1.5))});
    const x = passes(s).map((p) => p * RAYS);
    const chart = bisPlot.chart({title: 'Error against rays a pixel', width: wide, height: 320, text: chosen(s).map((m) => m + ' ' + bisPlot.number(errorOf(s, out, m), 3)).join(', '), x: {label: 'rays a pixel', log: true, min: RAYS / 1.2, max: 1.2 * (RAYS << MOST)}, y: {label: 'RMSE against the exact picture', log: true},
      series: chosen(s).map((m, i) => ({kind: 'line', x, y: x.map((v, k) => out[place(s, i, k) + 2][0][0]), label: m, colour: m, points: true}))});
    return {html: '<div>' + chosen(s).map((m, i) => show(m, out[place(s, i, s.k) + 1][0])).join('') + show('exact', out[1][0]) + '</div>' + chart,
      words: 'After ' + (RAYS << s.k) + ' rays a pixel the errors are: ' + chosen(s).map((m) => m + ' ' + bisPlot.number(errorOf(s, out, m), 3)).join(', ') + '.'};
  },
  tasks: [
    {ask: 'How many rays a pixel does em need for the error that sir has with 8? Show both, with so many passes for which em is below it.', answer: 'k=6',
      check: (s, out) => { const i = chosen(s).indexOf('sir'); return i < 0 || !chosen(s).includes('em') ? 'Show em and sir.' : errorOf(s, out, 'em') < out[place(s, i, 0) + 2][0][0] ? '' : 'em has ' + bisPlot.number(errorOf(s, out, 'em'), 3) + ', sir had ' + bisPlot.number(out[place(s, i, 0) + 2][0][0], 3) + '.'; }},
    {ask: 'Show all four methods, and find an exponent at which brdf has a smaller error than em.', answer: 'who=em+brdf+mis+sir;n=1024;k=2',
      check: (s, out) => { const e = ['em', 'brdf', 'mis'].map((m) => errorOf(s, out, m)); return e.some(Number.isNaN) ? 'Show all four.' : e[1] < e[0] ? '' : 'Not at this one.'; }}
  ]
});
})();
