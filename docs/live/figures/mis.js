/* SPDX-License-Identifier: BSD-2-Clause */
/* mis: multiple importance sampling against its two halves, over the exponent (thesis 2.3 and 5; docs/theory.md). */
'use strict';
(function () {
const EXPONENTS = [2, 32, 512], RUNS = 400, SAMPLES = 32768, WIDE = 120, HIGH = 80;
const METHODS = [['em', 'em', []], ['brdf', 'brdf', []], ['mis', 'mis, balance', ['heuristic=balance']],
  ['mis', 'mis, power', ['heuristic=power']]];
/* The error of method k is measured; that of the best weights, the last of them, is computed, as is the mean that all
 * are shares of. */
const BEST = METHODS.length, NAMES = METHODS.map(([, words]) => words).concat('best weights');
/* What the best weights gain over the balance heuristic: computed, too. */
const gain = (out, i) => 1 - out[7 * i + 2][0][2] / out[7 * i + 2][0][1];
const errors = (out, k) => EXPONENTS.map((n, i) =>
  (k === BEST ? out[7 * i + 2][0][2] : out[7 * i + 3 + k][1][1]) / out[7 * i + 2][0][0]);
bisFigure.define({
  name: 'mis',
  title: 'Multiple importance sampling, and its heuristics',
  section: '3.5',
  look: 'the map’s samples serve dull surfaces, the BRDF’s polished ones; mis follows the better one. Compared ' +
    'is the error of one estimate of so many samples: all from the map (em), all from the BRDF (brdf), or half from ' +
    'each, weighted by the balance or the power heuristic (mis). The best weights (Kondapaneni et al. 2019) show ' +
    'what another heuristic could still gain from the same halves.',
  map: true,
  controls: [
    {name: 'N', label: 'samples', min: 2, max: 64, log: true, value: 16},
    {name: 'x', label: 'pixel x', min: 0, max: 119, value: 28},
    {name: 'y', label: 'pixel y', min: 0, max: 79, value: 30},
    {name: 'seed', label: 'seed', min: 1, max: 99, value: 1}
  ],
  touch: {x: (x) => Math.floor(x * WIDE), y: (x, y) => Math.floor(y * HIGH)},
  calls: (s) => EXPONENTS.flatMap((n) => [...bisStage({n, ks: 0.9, kd: 0.02, sampler: 'random'}, s.x, s.y),
    ['bis_flat_stage_mis', 'stage', ['integrator=mis', 'samples=' + s.N], 1, SAMPLES / s.N, 5],
    ...METHODS.map(([name, , more]) => ['bis_flat_stage_runs', 'stage',
      ['integrator=' + name, 'samples=' + s.N, ...more], s.seed, RUNS, RUNS, 3])]).concat([
    ['bis_flat_render', 'picture', 'scene', ['text=' + bisScene({n: EXPONENTS[1], ks: 0.9, kd: 0.02}), 'integrator=sir',
      'candidates=32', 'shadowrays=2', 'learn=false']],
    ['bis_flat_picture_pixels', 'picture', 4 * WIDE * HIGH]]),
  draw(s, out, wide) {
    const pixels = out[7 * EXPONENTS.length + 1][0];
    const picture = bisPlot.heat({title: 'The pixel: click another',
      text: 'three balls, a wall and a floor, at exponent ' + EXPONENTS[1], width: 300, height: 200, most: wide,
      columns: WIDE, rows: HIGH, scale: false,
      image: bisPlot.png(WIDE, HIGH, bisFigure.screen(pixels, WIDE * HIGH, 4, 1.5)), x: {min: 0, max: WIDE, ticks: []},
      y: {min: 0, max: HIGH, ticks: []}, marks: [{x: s.x + 0.5, y: s.y + 0.5, label: ''}]});
    const chart = bisPlot.chart({title: 'Error of one estimate, by the exponent', width: Math.min(640, wide),
      height: 360, text: NAMES.map((words, k) => words + ' ' + bisPlot.percent(errors(out, k)[0]) + ' to ' +
        bisPlot.percent(errors(out, k)[2])).join('; '),
      x: {label: 'exponent of the balls', log: true, ticks: EXPONENTS},
      y: {label: 'error, share of the mean', log: true},
      series: NAMES.map((label, k) => ({kind: 'line', x: EXPONENTS, y: errors(out, k), label,
        colour: k === BEST ? 'ink' : METHODS[k][0], dash: k === 3, points: true}))});
    return {html: picture + chart, words: 'At exponent 32 and ' + s.N + ' samples: ' +
      NAMES.map((words, k) => words + ' ' + bisPlot.percent(errors(out, k)[1])).join(', ') +
      ' (' + RUNS + ' estimates each, of independent samples). The best weights, computed from ' + SAMPLES +
      ' samples, have an error that is ' + bisPlot.percent(gain(out, 1)) +
      ' smaller than that of the balance heuristic.'};
  },
  tasks: [
    {ask: 'Find a pixel where the best weights make the error of the balance heuristic smaller by more than 8 % at ' +
      'exponent 512.', answer: 'x=36;y=36', check: (s, out) => gain(out, 2) > 0.08 ? ''
      : 'By ' + bisPlot.percent(gain(out, 2)) + ' here. It is rare: look at the balls.'},
    {ask: 'Find a pixel where em beats brdf at every exponent.', answer: 'x=60;y=70',
      check: (s, out) => errors(out, 0).every((e, i) => e < errors(out, 1)[i]) ? ''
        : 'At exponent 512 em has ' + bisPlot.percent(errors(out, 0)[2]) + ', brdf ' +
        bisPlot.percent(errors(out, 1)[2]) + '.'}
  ]
});
})();
