/* SPDX-License-Identifier: BSD-2-Clause */
/* alias: Marsaglia's list and the alias table (thesis 3.2.2, figures 3.3 and 3.4, appendix A). */
'use strict';
bisFigure.define({
  name: 'alias',
  title: 'A discrete distribution: Marsaglia’s list, and the alias table',
  section: '3.2.2',
  look: 'whoever has more than the average gives to exactly one bin at a time, until all bins are full; the list of ' +
    'the same weights grows, the table does not.',
  controls: [
    {name: 'w', label: 'weights', values: [1, 2, 4, 3, 0, 6], min: 0, max: 9, item: (i) => 'item ' + i},
    {name: 'k', label: 'Fill a bin', add: 1, most: 6},
    {name: 'm', label: 'draws', min: 1, max: 65536, log: true, value: 1024},
    {name: 'seed', label: 'seed', min: 1, max: 99, value: 1}
  ],
  calls: (s) => [
    ['bis_flat_alias_build', 6, s.w, 6, 6, 1],
    ['bis_flat_alias_stage', 6, s.w, s.k, 6, 6],
    ['bis_flat_alias_pmf', 6, s.w, 6, 6],
    ['bis_flat_marsaglia', 6, s.w, 64, 64, 1],
    ['bis_flat_uniform', s.seed, 0, s.m, s.m],
    ['bis_flat_alias_sample', 6, '#0.0', '#0.1', s.m, '#4.0', s.m],
    ['bis_flat_fit', 6, '#2.1', s.m, '#5.0', 6, 3]
  ],
  draw(s, out, wide) {
    const [prob, alias] = out[0], [order, height] = out[1], P = out[2][1], list = out[3][0].slice(0, out[3][1][0]),
      [counts, fit] = out[6];
    const filled = new Set(order.slice(0, s.k)), bins = [...prob.keys()], series = [];
    for (const i of bins) series.push({kind: 'bars', x: [i], y: [height[i]], width: 0.8, colour: i,
      titles: ['item ' + i + ': ' + height[i]]});
    for (const i of bins.filter((j) => filled.has(j) && prob[j] < 1))
      series.push({kind: 'errors', x: [], y: []},
        {kind: 'area', x: [i - 0.4, i + 0.4], lo: [prob[i], prob[i]], hi: [1, 1], colour: alias[i]});
    const table = bisPlot.chart({title: 'The alias table after ' + s.k + (s.k === 1 ? ' step' : ' steps'),
      width: Math.min(400, wide), height: 300, series,
      text: bins.map((i) => 'item ' + i + ' has ' + bisPlot.number(height[i]) + ' of a bin').join(', '),
      x: {label: 'bin', min: -0.6, max: 5.6, ticks: bins, grid: false}, y: {label: 'N P, 1 is full', min: 0},
      marks: [{y: 1, label: 'average'}].concat(bins.filter((j) => filled.has(j) && prob[j] < 1)
        .map((j) => ({x: j, y: (1 + prob[j]) / 2, label: 'from ' + alias[j]})))});
    const histogram = bisPlot.chart({title: 'Draws against the probabilities', width: Math.min(400, wide), height: 300,
      legend: 'top',
      text: bins.map((i) => 'item ' + i + ': ' + counts[i] + ' of ' + s.m + ', P = ' + bisPlot.number(P[i])).join('; '),
      x: {label: 'item', min: -0.6, max: 5.6, ticks: bins, grid: false}, y: {label: 'share of the draws', min: 0},
      series: [{kind: 'bars', x: bins, y: [...counts].map((c) => c / s.m), label: 'drawn', colour: 0},
        {kind: 'points', x: bins, y: [...P], label: 'P', colour: 'ink', shape: 'diamond'}]});
    return {html: table + histogram, words: 'Marsaglia’s list has ' + list.length + ' entries: ' +
      (list.length > 30 ? [...list.slice(0, 30)].join(' ') + ' …' : [...list].join(' ')) +
      '. ' + s.k + ' of 6 bins are full. Chi-square of ' + s.m + ' draws is ' + bisPlot.number(fit[0], 3) + ' with ' +
      fit[1] + ' degrees of freedom, p = ' + bisPlot.number(fit[2], 3) + '.'};
  },
  tasks: [
    {ask: 'Find weights whose alias table needs no alias: every bin keeps its own item.', answer: 'w=3,3,3,3,3,3',
      check: (s, out) => out[0][0].every((p) => p === 1) ? ''
        : 'An alias is needed where an item has less than the average.'},
    {ask: 'Six different weights: find some for which Marsaglia’s list is as long as it can be here.',
      answer: 'w=4,5,6,7,8,9',
      check: (s, out) => new Set(s.w).size < 6 ? 'Two weights are the same.' : out[3][1][0] === 39 ? ''
        : 'This list has ' + out[3][1][0] + ' entries; a longer one is possible.'}
  ]
});
