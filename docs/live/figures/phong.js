/* SPDX-License-Identifier: BSD-2-Clause */
/* phong: the energy-preserving Phong lobe, and what of it lies below the horizon (thesis 3.5, figures 3.8 and 3.9;
 * E33). */
'use strict';
(function () {
const degrees = [...Array(181).keys()].map((i) => i - 90), UP = [0, 0, 1];
/* Where the eye is: rounded, because browsers may differ in the last bits of a sine. */
const eye = (a) => [Math.sin(-a * Math.PI / 180), 0, Math.cos(a * Math.PI / 180)].map((v) => Math.round(v * 1e9) / 1e9);
const lost = (out) => out[4][0][2];
bisFigure.define({
  name: 'phong',
  title: 'Phong’s lobe: exponent, angle, and what is lost',
  section: '3.5',
  look: 'a higher exponent makes the lobe narrower; towards grazing angles a part of it dips below the horizon, and ' +
    'the material reflects less.',
  controls: [
    {name: 'n', label: 'exponent', min: 1, max: 4096, log: true, value: 16},
    {name: 'a', label: 'angle of the eye', min: 0, max: 89, value: 45, words: (v) => v + '°'},
    {name: 'kd', label: 'diffuse share', min: 0, max: 1, step: 0.05, value: 0},
    {name: 'm', label: 'directions', min: 16, max: 4096, log: true, value: 512},
    {name: 'seed', label: 'seed', min: 1, max: 99, value: 1}
  ],
  calls: (s) => [
    ['bis_flat_bsdf_open', 'bsdf', 'phong', [s.kd, s.kd, s.kd], [1 - s.kd, 1 - s.kd, 1 - s.kd], s.n, UP, eye(s.a)],
    ['bis_flat_bsdf_plane', 'bsdf', UP, 181, degrees, 181, 181],
    ['bis_flat_uniform', s.seed, 0, 3 * s.m, 3 * s.m],
    ['bis_flat_bsdf_sample', 'bsdf', s.m, '#2.0', 3 * s.m, s.m],
    ['bis_flat_bsdf_albedo', 'bsdf', UP, 400, 3],
    ['bis_flat_bsdf_below', 'bsdf', s.m, '#3.0', s.m, 1]
  ],
  draw(s, out, wide) {
    const [f, pdf] = out[1].map((v) => [...v]), wi = out[3][0], [isBelow, [lower]] = out[5], above = [[], []],
      below = [[], []];
    for (let i = 0; i < s.m; i++) {
      const to = isBelow[i] ? below : above;
      to[0].push(wi[3 * i]);
      to[1].push(wi[3 * i + 1]);
    }
    const lobe = bisPlot.chart({title: 'Density and f cos in the plane of the eye', width: Math.min(430, wide),
      height: 300, legend: 'top', text: 'exponent ' + s.n + ', eye at ' + s.a + ' degrees',
      x: {label: 'angle to the normal', min: -90, max: 90, ticks: [-90, -45, 0, 45, 90]},
      y: {label: 'per steradian', min: 0},
      series: [{kind: 'line', x: degrees, y: pdf, label: 'density', colour: 'brdf'},
        {kind: 'line', x: degrees, y: f, label: 'f cos', colour: 'sir', dash: true}],
        marks: [{x: s.a, label: 'mirror'}]});
    const top = bisPlot.chart({title: 'Directions from above', width: Math.min(320, wide), height: 300, legend: 'top',
      text: lower + ' of ' + s.m + ' lie below the horizon', x: {label: 'x', min: -1, max: 1},
      y: {label: 'y', min: -1, max: 1},
      series: [{kind: 'points', x: above[0], y: above[1], label: 'above', colour: 'brdf', radius: 1.6, shape: 'disc'},
        {kind: 'points', x: below[0], y: below[1], label: 'below', colour: 3, radius: 1.8, shape: 'square'}]});
    return {html: lobe + top, words: 'The material reflects ' + bisPlot.percent(out[4][0][0]) +
      ' of the light that comes from the eye’s side; ' + bisPlot.percent(Math.max(0, lost(out))) +
      ' of the directions are drawn below the horizon and lost.'};
  },
  tasks: [
    {ask: 'Without a diffuse share and with the eye at 60 degrees: find the smallest exponent at which less than 1 % ' +
      'is lost.', answer: 'a=60;n=32',
      check: (s, out) => s.a !== 60 || s.kd !== 0 ? 'Set the angle to 60 and the diffuse share to 0.'
        : lost(out) >= 0.01 ? bisPlot.percent(lost(out)) + ' is lost.' : s.n <= 32 ? ''
        : 'A smaller exponent does, too.'},
    {ask: 'Find an angle at which exponent 64 loses more than a quarter.', answer: 'n=64;a=88',
      check: (s, out) => s.n !== 64 ? 'Set the exponent to 64.' : lost(out) > 0.25 ? ''
        : bisPlot.percent(Math.max(0, lost(out))) + ' is lost.'}
  ]
});
})();
