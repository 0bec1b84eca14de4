/* SPDX-License-Identifier: BSD-2-Clause */
/* sir: sampling-importance resampling at one point (thesis 4.4, eq. 4.8 and 4.9, figure 4.5). */
'use strict';
(function () {
const W = 72, H = 36, MOST = 4096, REPEATS = 400, NOISES = 100, CELLS = 40, TOP = 2.5;
const settings = (s) => ['integrator=sir', 'candidates=' + s.M, 'shadowrays=' + s.N, 'proposal=' + s.q, 'learn=false'];
const error = (out) => out[6][1][1] / out[2][0][0];
/* The standard error of that error: of the mean of the squares, over twice its root. */
function doubt(out) {
  const [mean] = out[6][1], squares = [...out[6][0]].map((L) => (L - mean) * (L - mean)),
    m = squares.reduce((a, b) => a + b) / REPEATS, v = squares.reduce((a, b) => a + (b - m) * (b - m), 0) / REPEATS;
  return m > 0 ? Math.sqrt(v / REPEATS / m) / 2 / out[2][0][0] : 0;
}
/* Two noises (docs/errata.md E31): of the candidates, which more rays leave, and of which of them are chosen. */
const noise = (out, k) => out[8][0][k] / out[2][0][0];
function helps(out) {
  const share = Math.pow(noise(out, 2), 2) / (Math.pow(noise(out, 2), 2) + Math.pow(noise(out, 3), 2) || 1);
  return share < 0.2 ? 'only more rays help' : share > 0.8 ? 'only more candidates help'
    : 'more rays help, and more candidates do, too';
}
const apart = (s) => s.n !== 32 || s.seed !== 1 || s.q !== 'mix'
  ? 'Press "Start again" first: the task is for exponent 32, seed 1, mix.' : '';

bisFigure.define({
  name: 'sir',
  title: 'Sampling-importance resampling: candidates, weights, rays, estimates',
  section: '4.4',
  look: 'the candidates lie where their proposal is large, the chosen ones where the product is; the estimates ' +
    'gather around the exact value for every M and N.',
  map: true,
  controls: [
    {name: 'M', label: 'candidates M', min: 1, max: MOST, log: true, value: 128},
    {name: 'N', label: 'shadow rays N', min: 1, max: 64, log: true, value: 8},
    {name: 'q', label: 'proposal', options: {mix: 'map and BRDF (mix)', em: 'the map (em)', brdf: 'the BRDF (brdf)'},
      value: 'mix'},
    {name: 'n', label: 'exponent of the balls', min: 1, max: 1024, log: true, value: 32},
    {name: 'seed', label: 'seed', min: 1, max: 99, value: 1}
  ],
  calls: (s) => [
    ...bisStage({n: s.n}, 22, 44),
    ['bis_flat_stage_exact', 'stage', 1, 4],
    ['bis_flat_stage_densities', 'stage', W, H, W * H, W * H, W * H, W * H, 4],
    ['bis_flat_stage_candidates', 'stage', settings(s), s.seed, MOST, 3 * MOST, MOST, MOST, MOST, 6],
    ['bis_flat_stage_find', 'stage', 720, 360, MOST, '#4.0', MOST],
    ['bis_flat_stage_runs', 'stage', settings(s), s.seed, REPEATS, REPEATS, 3],
    ['bis_flat_histogram', REPEATS, '#6.0', '#2.0', TOP, CELLS, CELLS],
    ['bis_flat_stage_noises', 'stage', settings(s), s.seed, NOISES, 5]
  ],
  draw(s, out, wide) {
    const exact = out[2][0], product = out[3][2], most = out[3][4][2], [, w, chosen, kind, sum] = out[4],
      cell = out[5][0], stats = out[6][1];
    const dots = [], largest = Math.max(...w);
    for (let i = 0; i < s.M; i++) {
      if (!(w[i] > 0)) continue;
      const at = {x: (cell[i] % 720 + 0.5) / 2, y: (Math.floor(cell[i] / 720) + 0.5) / 2};
      dots.push(Object.assign(at, {radius: chosen[i] ? 3 + Math.min(chosen[i], 6) / 2
        : 0.8 + 2.2 * Math.sqrt(w[i] / largest),
        colour: chosen[i] ? (kind[i] & 2 ? '#7fe0ff' : '#05050d') : kind[i] & 1 ? '#e5a93c' : '#3cc4b6',
        ring: chosen[i] ? '#fff' : undefined}));
    }
    const field = bisPlot.heat({title: 'The product p and the candidates', width: 360, height: 180, most: wide,
      columns: W, rows: H, values: product, log: true, lo: most / 1e4, hi: most || 1,
      text: s.M + ' candidates, ' + s.N + ' rays; ' + bisPlot.number(sum[2], 3) + ' effective candidates',
      dots: dots.sort((a, b) => a.radius - b.radius),
      x: {label: 'phi', min: 0, max: 360, ticks: [0, 90, 180, 270, 360]},
      y: {label: 'theta', min: 0, max: 180, ticks: [0, 90, 180]}, label: 'f cos L'});
    const hi = Math.max(TOP * exact[0], 1e-9), edges = [...Array(CELLS + 1).keys()].map((i) => i * hi / CELLS);
    const histogram = bisPlot.chart({title: REPEATS + ' estimates', width: Math.min(400, wide), height: 260,
      text: 'mean ' + bisPlot.number(stats[0]) + ', exact ' + bisPlot.number(exact[0]),
      x: {label: 'estimate of r + g + b (the last cell: all above)', min: 0, max: hi}, y: {label: 'how many', min: 0},
      series: [{kind: 'steps', x: edges, y: [...out[7][0]], colour: 'sir'}],
      marks: [{x: exact[0], label: 'exact', colour: 'exact'}]});
    return {html: field + histogram, words: 'Of M = ' + sum[0] + ' candidates as many count as ' +
      bisPlot.number(sum[2], 3) + ' equal ones (the effective sample size). ' + REPEATS + ' estimates have the mean ' +
      bisPlot.number(stats[0]) + ' and the error ' + bisPlot.percent(error(out)) +
      ' +- ' + bisPlot.percent(doubt(out)) + ' each; the exact value is ' + bisPlot.number(exact[0]) +
      '. The candidates bring ' + bisPlot.percent(noise(out, 2)) + ', the choice of rays ' +
      bisPlot.percent(noise(out, 3)) + ', so here ' + helps(out) + '. One estimate casts ' +
      bisPlot.number(stats[2], 3) + ' rays. Gold: from the map; green: from the BRDF; ringed: chosen, blue where the ' +
      'light is seen, else black.'};
  },
  tasks: [
    {ask: 'With N = 1 ray, find the smallest M (a power of 2) at which the error of one estimate is below 125 %.',
      answer: 'M=16;N=1',
      check: (s, out) => apart(s) || (s.N !== 1 ? 'Set N to 1.' : error(out) >= 1.25
        ? 'The error is ' + bisPlot.percent(error(out)) + '.' : s.M <= 16 ? '' : 'A smaller M does, too.')},
    {ask: 'With M = 128 candidates, find the smallest N at which the error is below 10 %.', answer: 'M=128;N=32',
      check: (s, out) => apart(s) || (s.M !== 128 ? 'Set M to 128.' : error(out) >= 0.1
        ? 'The error is ' + bisPlot.percent(error(out)) + '.' : s.N <= 32 ? '' : 'A smaller N does, too.')}
  ]
});
})();
