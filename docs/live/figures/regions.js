/* SPDX-License-Identifier: BSD-2-Clause */
/* regions: quantisation, components and area weighting (thesis 3.4, figure 3.6). */
'use strict';
(function () {
/* A colour for each component, by its label; black pixels have none. */
function components(label) {
  const bytes = new Uint8Array(3 * label.length);
  label.forEach((l, i) => {
    if (l === 0xffffffff) return;
    const h = Math.imul(l + 1, 0x9e3779b1) >>> 8;
    for (let c = 0; c < 3; c++) bytes[3 * i + c] = 70 + (h >> 8 * c & 255) * 180 / 255;
  });
  return bytes;
}
const size = () => bisFigure.shape[0] * bisFigure.shape[1];
const peak = (out, call) => out[call][1][0], gain = (out) => peak(out, 5) / peak(out, 3);
bisFigure.define({
  name: 'regions',
  title: 'Levels, components, and the area weighting b',
  section: '3.4',
  look: 'pixels of one level that touch are one light source (figure 3.6); with b above 0 small sources lose ' +
    'importance to large ones.',
  map: true,
  controls: [
    {name: 'levels', label: 'levels', min: 1, max: 32, value: 8},
    {name: 'b', label: 'b', min: 0, max: 2, step: 0.05, value: 0.15}
  ],
  calls: (s) => [
    ['bis_flat_light_open_as', 'light', bisFigure.map, ['area_exponent=' + s.b, 'levels=' + s.levels]],
    ['bis_flat_light_regions', 'light', s.levels, s.b, size(), size(), size(), size(), 1],
    ['bis_flat_light_power', 'light'],
    ['bis_flat_light_density', 'light', size(), 1, bisFigure.shape[1]],
    ['bis_flat_light_open_as', 'light without', bisFigure.map, ['area_exponent=0']],
    ['bis_flat_light_density', 'light without', size(), 1, bisFigure.shape[1]]
  ],
  draw(s, out, wide) {
    const [W, H] = bisFigure.shape, level = out[1][1], pdf = out[3][0], hi = peak(out, 3);
    const common = {width: 340, height: 170, most: wide, columns: W, rows: H,
      x: {label: 'phi', min: 0, max: 360, ticks: [0, 180, 360]},
      y: {label: 'theta', min: 0, max: 180, ticks: [0, 90, 180]}};
    const levels = bisPlot.heat(Object.assign({title: 'The level of each pixel', text: s.levels + ' levels',
      values: [...level].map((v) => v > 254 ? -1 : v), lo: 0, hi: Math.max(1, s.levels - 1), colours: 'heat',
      label: 'level'}, common));
    const parts = bisPlot.heat(Object.assign({title: 'The components, a colour each', scale: false,
      text: out[1][4][0] + ' components', image: bisPlot.png(W, H, components(out[1][0]))}, common));
    const density = bisPlot.heat(Object.assign({title: 'The density of drawing', text: 'with b = ' + s.b, values: pdf,
      log: true, lo: hi / 1e5, hi, label: '1/sr'}, common));
    return {html: levels + parts + density, words: s.levels + ' levels make ' + out[1][4][0] +
      ' components. The largest density is ' + bisPlot.number(hi, 3) + ' per steradian; without area weighting it is ' +
      bisPlot.number(peak(out, 5), 3) + ', ' + bisPlot.number(gain(out), 3) + ' times as much.'};
  },
  tasks: [
    {ask: 'Find the smallest number of levels that makes more than 1000 components.', answer: 'levels=12',
      check: (s, out) => out[1][4][0] <= 1000 ? 'There are ' + out[1][4][0] + '.' : s.levels <= 12 ? ''
        : 'Fewer levels do, too.'},
    {ask: 'Keep 8 levels and find the smallest b that divides the largest density by 1.4 or more.',
      answer: 'levels=8;b=0.3', check: (s, out) => s.levels !== 8 ? 'Set the levels to 8.' : gain(out) < 1.4
        ? 'It is divided by ' + bisPlot.number(gain(out), 3) + '.' : s.b < 0.31 ? '' : 'A smaller b does, too.'}
  ]
});
})();
