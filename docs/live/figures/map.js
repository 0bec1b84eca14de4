/* SPDX-License-Identifier: BSD-2-Clause */
/* map: directions drawn by a map's importance, with sin theta and without (thesis 3.3, figure 3.5; erratum E3). */
'use strict';
(function () {
const settings = (s) => ['kind=' + s.kind, 'area_exponent=0'].concat(s.sin === 'printed' ? ['as_printed=E3'] : []);
const size = () => bisFigure.shape[0] * bisFigure.shape[1];
/* How many of the directions lie within 30 degrees of a pole, and how many should. */
const polar = (out) => out[6][1][0], due = (out) => out[6][1][1];
bisFigure.define({
  name: 'map',
  title: 'A map’s importance: where directions are drawn',
  section: '3.3',
  look: 'points crowd on the lamps. Without sin theta the rows near the poles get more than their solid angle: their ' +
    'points are too many, and the density by which estimators divide does not know it.',
  map: true,
  controls: [
    {name: 'm', label: 'directions', min: 16, max: 8192, log: true, value: 512},
    {name: 'sin', label: 'rows weigh', options: {right: 'by their solid angle',
      printed: 'all the same (as printed, E3)'}, value: 'right'},
    {name: 'kind', label: 'table', options: {alias: 'alias tables', cdf: 'CDFs'}, value: 'alias'},
    {name: 'seed', label: 'seed', min: 1, max: 99, value: 1}
  ],
  calls: (s) => [
    ['bis_flat_light_open_as', 'light', bisFigure.map, settings(s)],
    ['bis_flat_light_pixels', 'light', 3 * size()],
    ['bis_flat_light_density', 'light', size(), 1, bisFigure.shape[1]],
    ['bis_flat_uniform', s.seed, 0, 4 * s.m, 4 * s.m],
    ['bis_flat_light_sample', 'light', s.m, '#3.0', 3 * s.m, 3 * s.m, s.m],
    ['bis_flat_light_find', 'light', s.m, '#4.0', s.m],
    ['bis_flat_light_rows', 'light', s.m, '#5.0', 30, bisFigure.shape[1], 2]
  ],
  draw(s, out, wide) {
    const [W, H] = bisFigure.shape, rows = out[2][2], dots = [];
    for (const p of out[5][0])
      dots.push({x: (p % W + 0.5) * 360 / W, y: (Math.floor(p / W) + 0.5) * 180 / H, radius: 2.2, colour: '#7fe0ff',
        ring: '#05050d'});
    const field = bisPlot.heat({title: 'The map and ' + s.m + ' directions', width: 480, height: 240, most: wide,
      columns: W, rows: H, image: bisPlot.png(W, H, bisFigure.screen(out[1][0], W * H, 3, 1)),
      text: 'points stand where directions were drawn', dots,
      x: {label: 'phi', min: 0, max: 360, ticks: [0, 90, 180, 270, 360]},
      y: {label: 'theta', min: 0, max: 180, ticks: [0, 90, 180]}, scale: false});
    const edges = [...Array(H + 1).keys()].map((y) => y * 180 / H);
    const chart = bisPlot.chart({title: 'Share of each row', width: Math.min(360, wide), height: 280, legend: 'top',
      text: 'drawn against probability, by theta', x: {label: 'theta', min: 0, max: 180, ticks: [0, 45, 90, 135, 180]},
      y: {label: 'share of the directions', min: 0},
      series: [{kind: 'steps', x: edges, y: [...out[6][0]].map((c) => c / s.m), label: 'drawn', colour: 0},
        {kind: 'line', x: [...rows].map((v, y) => (y + 0.5) * 180 / H), y: [...rows], label: 'probability',
          colour: 1}]});
    return {html: field + chart, words: 'Of ' + s.m + ' directions ' + polar(out) + ' (' +
      bisPlot.percent(polar(out) / s.m) + ') lie within 30 degrees of a pole; by the density that estimators divide ' +
      'by, it should be ' + bisPlot.percent(due(out) / s.m) + '.'};
  },
  tasks: [
    {ask: 'Find the switch that draws at least twice as many directions near the poles as there should be.',
      answer: 'sin=printed;m=8192',
      check: (s, out) => polar(out) >= 2 * due(out) ? '' : 'There are ' + polar(out) + ', and should be ' +
        bisPlot.number(due(out), 3) + '.'},
    {ask: 'With the right weights, draw so few directions that less than 5 of them lie near a pole.', answer: 'm=16',
      check: (s, out) => s.sin !== 'right' ? 'Take the right weights.' : polar(out) < 5 ? ''
        : 'There are ' + polar(out) + '.'}
  ]
});
})();
