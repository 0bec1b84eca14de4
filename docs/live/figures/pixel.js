/* SPDX-License-Identifier: BSD-2-Clause */
/* pixel: the densities at a pixel that one clicks in a picture (thesis 4.1, figure 4.1; eq. 4.2 to 4.4). */
'use strict';
(function () {
const W = 72, H = 36, WIDE = 120, HIGH = 80;
const peak = (out) => out[4][4][1];
const share = (out) => out[5][0][0] / out[5][0][2];
bisFigure.define({
  name: 'pixel',
  title: 'Four densities at a pixel: the map, the BRDF, their product, and what of it is seen',
  section: '4.1',
  look: 'click a pixel. The map’s density is the same everywhere but not what the pixel needs; the product is, and ' +
    'shadows take a part of it away.',
  map: true,
  controls: [
    {name: 'x', label: 'pixel x', min: 0, max: WIDE - 1, value: 22},
    {name: 'y', label: 'pixel y', min: 0, max: HIGH - 1, value: 44},
    {name: 'n', label: 'exponent of the balls', min: 1, max: 1024, log: true, value: 32}
  ],
  touch: {x: (x) => Math.floor(x * WIDE), y: (x, y) => Math.floor(y * HIGH)},
  calls: (s) => [
    ['bis_flat_render', 'picture', 'scene', ['text=' + bisScene({n: s.n, width: WIDE, height: HIGH}), 'integrator=sir',
      'candidates=64', 'shadowrays=4']],
    ['bis_flat_picture_pixels', 'picture', 4 * WIDE * HIGH],
    ...bisStage({n: s.n, width: WIDE, height: HIGH}, s.x, s.y),
    ['bis_flat_stage_densities', 'stage', W, H, W * H, W * H, W * H, W * H, 4],
    ['bis_flat_stage_exact', 'stage', 1, 4]
  ],
  draw(s, out, wide) {
    const [q_L, q_f, product, seen, peaks] = out[4];
    const picture = bisPlot.heat({title: 'The picture: click a pixel', width: 360, height: 240, most: wide,
      columns: WIDE, rows: HIGH, image: bisPlot.png(WIDE, HIGH, bisFigure.screen(out[1][0], WIDE * HIGH, 4, 1.5)),
      text: 'three balls, a wall and a floor', x: {label: 'x', min: 0, max: WIDE, ticks: [0, 40, 80, 120]},
      y: {label: 'y', min: 0, max: HIGH, ticks: [0, 40, 80]}, scale: false,
      marks: [{x: s.x + 0.5, y: s.y + 0.5, label: ''}]});
    const field = (title, values, peak, label) => bisPlot.heat({title, text: title, width: 300, height: 150, most: wide,
      columns: W, rows: H, values, log: true, lo: peak / 1e4 || 1e-9, hi: peak || 1, label,
      x: {label: 'phi', min: 0, max: 360, ticks: [0, 180, 360]},
      y: {label: 'theta', min: 0, max: 180, ticks: [0, 90, 180]}});
    return {html: picture + '<div>' + field('q_L, the map', q_L, peaks[0], '1/sr') +
      field('q_f, the BRDF', q_f, peaks[1], '1/sr') + field('f cos L, the product', product, peaks[2], 'f cos L') +
      field('f cos L V, what is seen', seen, peaks[3], 'f cos L V') + '</div>',
      words: 'At pixel (' + s.x + ', ' + s.y + ') the exact value of r + g + b is ' + bisPlot.number(out[5][0][0]) +
        '; without shadows it would be ' + bisPlot.number(out[5][0][2]) + ': ' + bisPlot.percent(share(out)) +
        ' is seen.'};
  },
  tasks: [
    {ask: 'Find a pixel that sees more than 90 % of its light.', answer: 'x=28;y=30',
      check: (s, out) => share(out) > 0.9 ? '' : 'This one sees ' + bisPlot.percent(share(out)) + '.'},
    {ask: 'Find a pixel and an exponent at which q_f has a peak above 20 per steradian.', answer: 'n=1024',
      check: (s, out) => peak(out) > 20 ? '' : 'Its peak is ' + bisPlot.number(peak(out), 3) + '.'}
  ]
});
})();
