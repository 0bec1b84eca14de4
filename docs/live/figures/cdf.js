/* SPDX-License-Identifier: BSD-2-Clause */
/* cdf: inverting a cumulative distribution function, with a guide table for the search (thesis 3.2.2, figure 3.2). */
'use strict';
(function () {
const N = 8, item = (out) => out[1][0][0], part = (out) => out[1][1][0], start = (out) => out[1][2][0];
bisFigure.define({
  name: 'cdf',
  title: 'Inverting a CDF, and where the search begins',
  section: '3.2.2',
  look: 'a number u on the left meets the step of its item; a high step is met often, and an item of weight 0 has ' +
    'none. The guide says where the search begins.',
  controls: [
    {name: 'w', label: 'weights', values: [1, 5, 2, 0, 7, 3, 1, 4], min: 0, max: 9, item: (i) => 'item ' + i},
    {name: 'u', label: 'u', min: 0, max: 0.99, step: 0.01, value: 0.3},
    {name: 'm', label: 'draws', min: 1, max: 65536, log: true, value: 512},
    {name: 'seed', label: 'seed', min: 1, max: 99, value: 1}
  ],
  calls: (s) => [
    ['bis_flat_cdf_build', N, s.w, N + 1, 2 * N + 2, 1],
    ['bis_flat_cdf_sample', N, s.w, 1, [s.u], 1, 1, 1],
    ['bis_flat_uniform', s.seed, 0, s.m, s.m],
    ['bis_flat_cdf_sample', N, s.w, s.m, '#2.0', s.m, s.m, s.m],
    ['bis_flat_alias_pmf', N, s.w, N, N],
    ['bis_flat_fit', N, '#4.1', s.m, '#3.0', N, 3]
  ],
  draw(s, out, wide) {
    const [c, guide, [n]] = out[0], i = item(out), [counts, fit] = out[5], items = [...Array(N).keys()], P = out[4][1];
    const steps = bisPlot.chart({title: 'The CDF, u and its item', width: Math.min(420, wide), height: 300,
      text: 'u = ' + s.u + ' gives item ' + i,
      x: {label: 'item', min: 0, max: N, ticks: items.map((k) => ({at: k + 0.5, text: String(k)})), grid: false},
      y: {label: 'C', min: 0, max: 1},
      series: [{kind: 'steps', x: items.concat(N), y: [...c.slice(1)], colour: 0},
        {kind: 'line', x: [0, i + 0.5, i + 0.5], y: [s.u, s.u, 0], colour: 1},
        {kind: 'points', x: [start(out) + 0.5], y: [part(out) / n], colour: 3, shape: 'square'}],
      marks: items.slice(0, n).map((g) => ({y: g / n}))});
    const histogram = bisPlot.chart({title: 'Draws against the probabilities', width: Math.min(400, wide), height: 300,
      legend: 'top', text: 'chi-square ' + bisPlot.number(fit[0], 3),
      x: {label: 'item', min: -0.6, max: N - 0.4, ticks: items, grid: false}, y: {label: 'share of the draws', min: 0},
      series: [{kind: 'bars', x: items, y: [...counts].map((v) => v / s.m), label: 'drawn', colour: 0},
        {kind: 'points', x: items, y: [...P], label: 'P', colour: 'ink', shape: 'diamond'}]});
    return {html: steps + histogram, words: 'u = ' + s.u + ' lies in part ' + part(out) + ' of the guide’s ' + n +
      '; the search begins at item ' + start(out) + ' (square) and ends at item ' + i +
      ' after ' + (i - start(out)) + (i - start(out) === 1 ? ' step.' : ' steps.') + ' Chi-square of ' + s.m +
      ' draws is ' + bisPlot.number(fit[0], 3) + ' with ' + fit[1] + ' degrees of freedom, p = ' +
      bisPlot.number(fit[2], 3) + '.'};
  },
  tasks: [
    {ask: 'With the first weights, find a u whose search takes two steps or more.', answer: 'u=0.49',
      check: (s, out) => item(out) - start(out) >= 2 ? '' : 'This one takes ' + (item(out) - start(out)) + '.'},
    {ask: 'Find weights and a u for which item 7 has a probability of more than 1/2 and is drawn.',
      answer: 'w=0,0,0,0,0,0,0,9;u=0.9',
      check: (s, out) => out[4][1][7] <= 0.5 ? 'Its probability is ' + bisPlot.number(out[4][1][7], 3) + '.'
        : item(out) === 7 ? '' : 'Now u gives item ' + item(out) + '.'}
  ]
});
})();
