/* SPDX-License-Identifier: BSD-2-Clause */
/* rejection: accepted and refused candidates, and the two bounds (thesis 4.3, figures 4.3 and 4.4). */
'use strict';
(function () {
const share = (out) => out[6][0][0] / out[6][0][1];
bisFigure.define({
  name: 'rejection',
  title: 'Rejection: candidates under a bound',
  section: '4.3',
  look: 'a candidate is accepted if a random height below the bound falls under its weight; the higher the bound ' +
    'stands above the weights, the fewer are accepted.',
  map: true,
  controls: [
    {name: 'q', label: 'candidates from', options: {brdf: 'the BRDF (bound c_brdf)', em: 'the map (bound c_em)'},
      value: 'brdf'},
    {name: 'M', label: 'candidates M', min: 16, max: 4096, log: true, value: 512},
    {name: 'n', label: 'exponent of the balls', min: 1, max: 1024, log: true, value: 4},
    {name: 'seed', label: 'seed', min: 1, max: 99, value: 1}
  ],
  calls: (s) => [
    ...bisStage({n: s.n}, 22, 44),
    ['bis_flat_stage_bounds', 'stage', 2],
    ['bis_flat_stage_candidates', 'stage', ['integrator=sir', 'candidates=' + s.M, 'shadowrays=1', 'proposal=' + s.q,
      'learn=false', 'stratify=false'], s.seed, s.M, 3 * s.M, s.M, s.M, s.M, 6],
    ['bis_flat_uniform', s.seed, 7, s.M, s.M],
    ['bis_flat_stage_accept', 'stage', s.q, s.M, '#3.1', '#4.0', s.M, s.M, 1],
    ['bis_flat_stage_accepted', 'stage', ['integrator=rejection', 'candidates=' + s.M, 'shadowrays=8',
      'proposal=' + s.q], s.seed, 200, 3]
  ],
  draw(s, out, wide) {
    const [c_em, c_brdf] = out[2][0], bound = s.q === 'em' ? c_em : c_brdf, w = out[3][1],
      [height, taken, [accepted]] = out[5], yes = [[], []], no = [[], []];
    for (let i = 0; i < s.M; i++) { const to = taken[i] ? yes : no; to[0].push(i); to[1].push(height[i]); }
    const range = {log: true, min: bound / 1e5, max: 8 * bound};
    const chart = bisPlot.chart({title: 'Heights and weights', width: wide, height: 340, legend: 'top',
      text: accepted + ' of ' + s.M + ' are accepted', x: {label: 'candidate', min: 0, max: s.M},
      y: Object.assign({label: 'weight'}, range),
      series: [{kind: 'points', x: [...w.keys()], y: [...w], label: 'weight', colour: 0, radius: 1.6, shape: 'square'},
        {kind: 'points', x: no[0], y: no[1], label: 'refused', colour: 'exact', radius: 1.2, shape: 'disc'},
        {kind: 'points', x: yes[0], y: yes[1], label: 'accepted', colour: 'rejection', radius: 3.5, shape: 'down'}],
      marks: [{y: c_em, label: 'c_em', colour: 'em'}, {y: c_brdf, label: 'c_brdf', colour: 'brdf'}]});
    return {html: chart, words: 'The bound is ' + bisPlot.number(bound, 3) + ' (the other one ' +
      bisPlot.number(s.q === 'em' ? c_brdf : c_em, 3) + '). ' + accepted + ' of ' + s.M +
      ' candidates are accepted here; over 200 estimates ' + bisPlot.percent(share(out)) + ' are.'};
  },
  tasks: [
    {ask: 'Find an exponent at which the bound c_em of the map is above c_brdf.', answer: 'n=1024',
      check: (s, out) => out[2][0][0] > out[2][0][1] ? '' : 'It is ' + bisPlot.number(out[2][0][0] / out[2][0][1], 3) +
        ' times c_brdf.'},
    {ask: 'Make at least 1 candidate in 100 accepted, over the 200 estimates.', answer: 'q=em;n=1',
      check: (s, out) => share(out) >= 0.01 ? '' : bisPlot.percent(share(out)) + ' are accepted.'}
  ]
});
})();
