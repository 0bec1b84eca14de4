/* SPDX-License-Identifier: BSD-2-Clause */
/* noises: the noise of the candidates (of Zhat) and that of the rays (of V), as M and N move (thesis 4.4; errata
 * E31). */
'use strict';
(function () {
const STEPS = [1, 2, 4, 8, 16, 32, 64], RUNS = 200;
const settings = (M, N) => ['integrator=sir', 'candidates=' + M, 'shadowrays=' + N, 'proposal=mix', 'learn=false'];
const pair = (s, k) => s.axis === 'N' ? [s.M, k] : [16 * k, s.N];
const at = (s, out) => {
  const i = STEPS.indexOf(s.axis === 'N' ? s.N : s.M / 16);
  return i < 0 ? null : out[i + 3][0].map((v) => v / out[2][0][0]);
};
bisFigure.define({
  name: 'noises',
  title: 'Two noises: of Zhat, which more candidates lower, and of V, which more rays lower',
  section: '4.4',
  look: 'along N only the noise of V falls; where the curve of all noise flattens, that of the candidates (of Zhat) ' +
    'is left, and only more of them help.',
  map: true,
  controls: [
    {name: 'axis', label: 'along', options: {N: 'shadow rays N', M: 'candidates M'}, value: 'N'},
    {name: 'M', label: 'M', min: 16, max: 1024, log: true, value: 64},
    {name: 'N', label: 'N', min: 1, max: 64, log: true, value: 4},
    {name: 'n', label: 'exponent of the balls', min: 1, max: 1024, log: true, value: 32},
    {name: 'seed', label: 'seed', min: 1, max: 99, value: 1}
  ],
  calls: (s) => [...bisStage({n: s.n}, 22, 44), ['bis_flat_stage_exact', 'stage', s.seed, 4],
    ...STEPS.map((k) => ['bis_flat_stage_noises', 'stage', settings(...pair(s, k)), s.seed, RUNS, 5])],
  draw(s, out, wide) {
    const exact = out[2][0][0], x = STEPS.map((k) => pair(s, k)[s.axis === 'N' ? 1 : 0]),
      of = (j) => STEPS.map((k, i) => out[i + 3][0][j] / exact), now = at(s, out);
    const chart = bisPlot.chart({title: 'Noise of one estimate', width: wide, height: 360,
      text: 'error over the exact value, by ' + s.axis, x: {label: s.axis, log: true, ticks: x},
      y: {label: 'noise, share of the exact value', log: true},
      series: [{kind: 'line', x, y: of(1), label: 'all', colour: 'sir', points: true, shape: 'disc'},
        {kind: 'line', x, y: of(3), label: 'of V', colour: 'rejection', points: true, shape: 'down'},
        {kind: 'line', x, y: of(2), label: 'of Zhat', colour: 'em', points: true, shape: 'up'}],
      marks: [{x: s.axis === 'N' ? s.N : s.M, label: s.axis + ' = ' + (s.axis === 'N' ? s.N : s.M)}]});
    return {html: chart, words: 'With M = ' + s.M + ' and N = ' + s.N + ' one estimate has the noise ' +
      bisPlot.percent(now[1]) + ': ' + bisPlot.percent(now[2]) + ' of Zhat and ' + bisPlot.percent(now[3]) + ' of V (' +
      RUNS + ' estimates, ' + bisPlot.number(now[4] * exact, 3) + ' rays each).'};
  },
  tasks: [
    {ask: 'Find M and N at which the noise of Zhat is more than half of that of V.', answer: 'M=16;N=64',
      check: (s, out) => at(s, out)[2] > at(s, out)[3] / 2 ? '' : 'Few candidates and many rays.'},
    {ask: 'With N = 4, find an M at which the noise of V is more than ten times that of Zhat.', answer: 'M=1024;N=4',
      check: (s, out) => s.N !== 4 ? 'Set N to 4.' : at(s, out)[3] > 10 * at(s, out)[2] ? ''
        : 'It is ' + bisPlot.number(at(s, out)[3] / at(s, out)[2], 3) + ' times.'}
  ]
});
})();
