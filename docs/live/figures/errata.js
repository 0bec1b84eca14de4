/* SPDX-License-Identifier: BSD-2-Clause */
/* errata: equations as the thesis prints them, beside the right ones (docs/errata.md). */
'use strict';
(function () {
const WIDE = 48, HIGH = 32;
const WHICH = {
  E6: ['E6: one colour for all rays', ['integrator=sir', 'candidates=64', 'shadowrays=2', 'proposal=mix', 'learn=false']],
  E21: ['E21: Zhat from other candidates', ['integrator=sir', 'candidates=16', 'shadowrays=8', 'proposal=mix', 'learn=false']],
  E22: ['E22: draw until N are accepted', ['integrator=rejection', 'candidates=256', 'shadowrays=2', 'proposal=brdf']],
  E23: ['E23: a weight without the cosine', ['integrator=sir', 'candidates=64', 'shadowrays=8', 'proposal=em', 'learn=false']],
  E29: ['E29: no ray where nothing is accepted', ['integrator=rejection', 'candidates=16', 'shadowrays=4', 'proposal=em']]
};
const scene = (s, printed) => 'text=Option "bool disablepixeljitter" true\n' + bisScene({n: s.n, width: WIDE, height: HIGH, map: 'maps/small.hdr', asprinted: printed});
const settings = (s) => WHICH[s.which][1].concat('spp=' + s.spp, 'seed=' + s.seed);
bisFigure.define({
  name: 'errata',
  title: 'The errata as switches: the printed equation and the right one',
  section: '4',
  look: 'some printed equations change the brightness for good, and no number of samples helps: the difference keeps its colour while the noise goes.',
  controls: [
    {name: 'which', label: 'equation', options: Object.fromEntries(Object.entries(WHICH).map(([k, v]) => [k, v[0]])), value: 'E6'},
    {name: 'spp', label: 'samples a pixel', min: 1, max: 64, log: true, value: 8},
    {name: 'n', label: 'exponent of the balls', min: 1, max: 1024, log: true, value: 32},
    {name: 'seed', label: 'seed', min: 1, max: 99, value: 1}
  ],
  calls: (s) => [
    ['bis_flat_render', 'exact', 'scene', [scene(s, ''), 'integrator=exact']],
    ['bis_flat_picture_pixels', 'exact', 4 * WIDE * HIGH],
    ['bis_flat_render', 'right', 'scene', [scene(s, ''), ...settings(s)]],
    ['bis_flat_picture_pixels', 'right', 4 * WIDE * HIGH],
    ['bis_flat_render', 'printed', 'scene', [scene(s, s.which), ...settings(s)]],
    ['bis_flat_picture_pixels', 'printed', 4 * WIDE * HIGH],
    ['bis_flat_compare', WIDE, HIGH, '#3.0', '#1.0', 3],
    ['bis_flat_compare', WIDE, HIGH, '#5.0', '#1.0', 3]
  ],
  draw(s, out, wide) {
    const common = {width: 230, height: 153, columns: WIDE, rows: HIGH, most: wide};
    const show = (title, pixels) => bisPlot.heat(Object.assign({title, text: title, scale: false, image: bisPlot.png(WIDE, HIGH, bisFigure.screen(pixels, WIDE * HIGH, 4, 1.5))}, common));
    const difference = (title, pixels) => bisPlot.heat(Object.assign({title, text: title, colours: 'difference', night: false, lo: -0.3, hi: 0.3, label: '',
      values: [...Array(WIDE * HIGH).keys()].map((i) => pixels[4 * i + 1] - out[1][0][4 * i + 1])}, common));
    return {html: '<div>' + show('as printed', out[5][0]) + show('right', out[3][0]) + show('exact', out[1][0]) + '</div><div>' + difference('printed - exact', out[5][0]) + difference('right - exact', out[3][0]) + '</div>',
      words: WHICH[s.which][0] + '. The printed equation is off by ' + bisPlot.number(out[7][0][2], 3) + ' in the mean (RMSE ' + bisPlot.number(out[7][0][0], 3) + '), the right one by ' + bisPlot.number(out[6][0][2], 3) + ' (RMSE ' + bisPlot.number(out[6][0][0], 3) + ').'};
  },
  tasks: [
    {ask: 'Find an equation whose printed form makes the picture brighter by more than 0.1 in the mean.', answer: 'which=E23', check: (s, out) => out[7][0][2] > 0.1 ? '' : 'This one is off by ' + bisPlot.number(out[7][0][2], 3) + '.'},
    {ask: 'Two equations belong to rejection. Find the one that is off by more than 0.03.', answer: 'which=E22', check: (s, out) => s.which !== 'E22' && s.which !== 'E29' ? 'This one belongs to sir.' : out[7][0][2] > 0.03 ? '' : 'It is off by ' + bisPlot.number(out[7][0][2], 3) + '.'}
  ]
});
})();
