/* SPDX-License-Identifier: BSD-2-Clause */
/* errata: equations as the thesis prints them, beside the right ones (docs/errata.md). */
'use strict';
(function () {
/* COLUMNS of the map: `exact` sums over all its pixels at every pixel of the picture */
const WIDE = 48, HIGH = 32, COLUMNS = 32;
const WHICH = {
  E6: ['E6: one colour for all rays', ['integrator=sir', 'candidates=64', 'shadowrays=2', 'proposal=mix',
    'learn=false'], 'maps/lamps.hdr', 0.1],
  E14: ['E14: u - i > prob in the alias table'],
  E21: ['E21: Zhat from other candidates', ['integrator=sir', 'candidates=16', 'shadowrays=8', 'proposal=mix',
    'learn=false']],
  E22: ['E22: draw until N are accepted', ['integrator=rejection', 'candidates=256', 'shadowrays=2', 'proposal=brdf']],
  E23: ['E23: a weight without the cosine', ['integrator=sir', 'candidates=64', 'shadowrays=8', 'proposal=em',
    'learn=false']],
  E29: ['E29: no ray where nothing is accepted',
    ['integrator=rejection', 'candidates=16', 'shadowrays=4', 'proposal=em']]
};

/* ---- E14: a table of 256 items, of which every other one has weight 0, and u of few bits ---- */

const ITEMS = 256, ITEM_BITS = 8, COIN = [0, 1, 2, 3, 4, 5, 6, 7, 8];
const weights = [...Array(ITEMS).keys()].map((i) => i % 2);
const table = COIN.map((k) => ['bis_flat_alias_few_bits', ITEMS, weights, ITEM_BITS + k, ITEMS, ITEMS, 2]);
function drawTable(out, wide) {
  const shares = (way) => out.map((o) => o[2][way]);
  const chart = bisPlot.chart({title: 'Draws of impossible items', width: wide, height: 320, legend: 'top',
    text: bisPlot.percent(shares(0)[2]) + ' as printed with two bits left, right ' + bisPlot.percent(shares(1)[2]),
    x: {label: 'bits of u that are left for the coin', min: 0, max: COIN.length - 1, ticks: COIN},
    y: {label: 'share of the draws in their bins', min: 0, max: 1},
    series: [{kind: 'line', x: COIN, y: shares(0), label: 'as printed: u - i > prob', colour: 'em', points: true},
      {kind: 'line', x: COIN, y: shares(1), label: 'right: frac < prob', colour: 'sir', points: true, dash: true}]});
  return {html: chart, words: WHICH.E14[0] + '. Every other of ' + ITEMS +
    ' items has weight 0, and u takes all values of so many bits: ' + ITEM_BITS + ' choose the bin, the others are a ' +
    'coin. Where the coin is 0 the printed test draws the impossible item: ' +
    'in all draws without a bit for the coin, in ' + bisPlot.percent(shares(0)[8]) +
    ' with 8 bits. The right test never does. Tables have no picture here, so the sliders change nothing.'};
}

/* ---- the others: three pictures ---- */

const mapOf = (s) => bisFigure.map === 'maps/own' ? bisFigure.map : WHICH[s.which][2] || bisFigure.map;
const scene = (s, printed) => 'text=Option "bool disablepixeljitter" true\n' +
  bisScene({n: s.n, width: WIDE, height: HIGH, asprinted: printed});
const settings = (s) => WHICH[s.which][1].concat('spp=' + s.spp, 'seed=' + s.seed);
function pictures(s) {
  const map = mapOf(s), small = bisSmall(map, COLUMNS);
  return [
    ...bisShrink(map, COLUMNS),
    ['bis_flat_render_with', 'exact', 'scene', [scene(s, ''), 'integrator=exact'], small],
    ['bis_flat_picture_pixels', 'exact', 4 * WIDE * HIGH],
    ['bis_flat_render_with', 'right', 'scene', [scene(s, ''), ...settings(s)], small],
    ['bis_flat_picture_pixels', 'right', 4 * WIDE * HIGH],
    ['bis_flat_render_with', 'printed', 'scene', [scene(s, s.which), ...settings(s)], small],
    ['bis_flat_picture_pixels', 'printed', 4 * WIDE * HIGH],
    ['bis_flat_compare', WIDE, HIGH, '#5.0', '#3.0', 3],
    ['bis_flat_compare', WIDE, HIGH, '#7.0', '#3.0', 3]
  ];
}
/* What the shares of red, green and blue are off by, root mean square: E6 has the right sum. */
const redShare = (p, i) => p[4 * i] / Math.max(p[4 * i] + p[4 * i + 1] + p[4 * i + 2], 1e-30);
function colours(pixels, exact) {
  let all = 0;
  for (let i = 0; i < WIDE * HIGH; i++) {
    const sum = (p) => Math.max(p[4 * i] + p[4 * i + 1] + p[4 * i + 2], 1e-30), a = sum(pixels), b = sum(exact);
    for (let c = 0; c < 3; c++) all += Math.pow(pixels[4 * i + c] / a - exact[4 * i + c] / b, 2);
  }
  return Math.sqrt(all / (3 * WIDE * HIGH));
}
/* Of the printed equation. */
const bias = (out) => out[9][0][2];
bisFigure.define({
  name: 'errata',
  map: true,
  title: 'The errata as switches: the printed equation and the right one',
  section: '4',
  look: 'a printed equation changes the picture for good, and no number of samples helps: its difference stays while ' +
    'the noise goes. E23 is far too bright; E6 has the right brightness and wrong colours.',
  controls: [
    {name: 'which', label: 'equation', options: Object.fromEntries(Object.entries(WHICH).map(([k, v]) => [k, v[0]])),
      value: 'E23'},
    {name: 'spp', label: 'samples a pixel', min: 1, max: 64, log: true, value: 8},
    {name: 'n', label: 'exponent of the balls', min: 1, max: 1024, log: true, value: 32},
    {name: 'seed', label: 'seed', min: 1, max: 99, value: 1}
  ],
  calls: (s) => s.which === 'E14' ? table : pictures(s),
  draw(s, all, wide) {
    if (s.which === 'E14') return drawTable(all, wide);
    const out = all.slice(2); /* behind the map's two calls */
    const most = WHICH[s.which][3] || 0.3, common = {width: 230, height: 153, columns: WIDE, rows: HIGH, most: wide};
    const show = (title, pixels) => bisPlot.heat(Object.assign({title, text: title, scale: false,
      image: bisPlot.png(WIDE, HIGH, bisFigure.screen(pixels, WIDE * HIGH, 4, 1.5))}, common));
    const isE6 = s.which === 'E6', of = isE6 ? redShare : (p, i) => p[4 * i + 1];
    const difference = (title, pixels) => bisPlot.heat(Object.assign({
      title: title + (isE6 ? ', share of red' : ', green'), text: title,
      colours: 'difference', night: false, lo: -most, hi: most, label: '',
      values: [...Array(WIDE * HIGH).keys()].map((i) => of(pixels, i) - of(out[1][0], i))}, common));
    const judged = isE6 ? 'The shares of red, green and blue are off by ' +
        bisPlot.number(colours(out[5][0], out[1][0]), 3) + ' as printed, by ' +
        bisPlot.number(colours(out[3][0], out[1][0]), 3) + ' where it is right: more samples lower the second alone. ' +
        'The sum of the three is the same, so the mean and the RMSE show nothing.'
      : 'The printed equation is off by ' + bisPlot.number(out[7][0][2], 3) + ' in the mean (RMSE ' +
        bisPlot.number(out[7][0][0], 3) + '), the right one by ' + bisPlot.number(out[6][0][2], 3) + ' (RMSE ' +
        bisPlot.number(out[6][0][0], 3) + ').';
    return {html: '<div>' + show('as printed', out[5][0]) + show('right', out[3][0]) + show('exact', out[1][0]) +
      '</div><div>' + difference('printed - exact', out[5][0]) + difference('right - exact', out[3][0]) + '</div>',
      words: WHICH[s.which][0] + '. ' + judged};
  },
  tasks: [
    {ask: 'One printed equation leaves the mean right to 0.01 and spoils the colours. Show it with so many samples ' +
      'that the shares of the colours are off by twice as much as where it is right.', answer: 'which=E6;spp=64',
      check(s, out) {
        if (s.which === 'E14') return 'This one has no picture.';
        if (Math.abs(bias(out)) > 0.01) return 'Its mean is off by ' + bisPlot.number(bias(out), 3) + '.';
        const ratio = colours(out[7][0], out[3][0]) / colours(out[5][0], out[3][0]);
        return ratio >= 2 ? '' : 'They are off by ' + bisPlot.number(ratio, 3) + ' times as much.';
      }},
    {ask: 'Two equations belong to rejection. Find the one that is off by more than 0.03.', answer: 'which=E22',
      check: (s, out) => s.which !== 'E22' && s.which !== 'E29' ? 'This one does not belong to rejection.'
        : bias(out) > 0.03 ? '' : 'It is off by ' + bisPlot.number(bias(out), 3) + '.'}
  ]
});
})();
