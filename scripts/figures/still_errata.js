/* SPDX-License-Identifier: BSD-2-Clause */
/* still_errata: the drawings of docs/errata.md for items without a switch: what is printed in one colour, what is right
 * in another. Each takes the figure's object (docs/live.md) and returns a file of SVG. */
'use strict';
const plot = require('../../docs/live/plot.js'), deflate = require('zlib').deflateSync;

const PRINTED = 1, RIGHT = 0;

/* An axis. */
function linear(label, min, max, ticks) { return {label: label, min: min, max: max, ticks: ticks}; }
function log(label, min, max) { return {label: label, log: true, min: min, max: max}; }

/* A line, points, or both, of one colour. */
function curve(colour, label, x, y, more) { return Object.assign({kind: 'line', colour: colour, label: label, x: x,
  y: y}, more); }
function dotted(colour, label, x, y) { return curve(colour, label, x, y, {points: true, radius: 3}); }
function dots(colour, label, x, y) { return {kind: 'points', colour: colour, label: label, x: x, y: y, radius: 3}; }

function chart(title, x, y, series) {
  return plot.chart({title: title, width: 560, height: 320, x: x, y: Object.assign({above: true}, y), series: series,
    standalone: true});
}

function pair(title, printed, right, foot) {
  return plot.together({title: title, foot: foot, columns: [Object.assign({head: 'as printed', colour: PRINTED},
    printed),
    Object.assign({head: 'right', colour: RIGHT}, right)]});
}

function percent(share, digits) { return plot.fixed(100 * share, digits) + ' %'; }

/* The value of an axis's lowest place where v is 0, else nothing: such points are marked there. */
function floorWhereZero(v, floor) { return v.map(function (p) { return p === 0 ? floor : null; }); }

/* ---- items and their probabilities ---- */

/* Bars, the number above each, and a line where each should end. */
function bars(colour, P, wanted, first) {
  const items = P.map(function (p, i) { return first + i; }), x = [], y = [];
  wanted.forEach(function (p, i) { x.push(first + i - 0.45, first + i + 0.45, null); y.push(p, p, null); });
  return plot.chart({title: 'bars', width: 260, height: 190, x: {min: first - 0.6, max: first + P.length - 0.4,
    ticks: items, grid: false},
    y: {min: 0, max: 0.6, ticks: [0, 0.2, 0.4, 0.6]}, legend: 'none',
    series: [{kind: 'bars', x: items, y: P, colour: colour, width: 0.7}, curve('ink', 'P', x, y)],
    marks: P.map(function (p, i) { return {x: first + i, y: Math.max(p, wanted[i]) + 0.025, label: plot.fixed(p, 3),
      at: 'middle', colour: 'ink'}; })});
}

function E8(d) {
  return pair('E8: items from the CDF', {note: 'items 1 to 4, and a 0 that is none', drawings: [bars(PRINTED,
    d.printed, d.printed_P, 0)]},
    {note: 'items 0 to 3', drawings: [bars(RIGHT, d.right, d.P, 0)]}, 'bars: share of 100,000 draws; lines: P');
}

function E11(d) {
  return pair('E11: prob of those who give', {note: 'prob = 1 for all above 1/N', drawings: [bars(PRINTED, d.printed,
    d.P, 0)]},
    {note: 'a giver may fall below 1/N', drawings: [bars(RIGHT, d.right, d.P, 0)]},
      'bars: probability that the tables imply; lines: P');
}

function E10(d) {
  return chart('E10: the inverse of C, tabulated', linear('item, in the order of weight', 0, 64, [0, 16, 32, 48, 64]),
    log('P', 1e-6, 1), [
    curve(RIGHT, 'right: the table only tells where to start', d.rank, d.right),
    dots(PRINTED, 'as printed: multiples of 1/64', d.rank, d.printed),
    Object.assign(dots(PRINTED, d.never_drawn + ' of 64 items are never drawn', d.rank, floorWhereZero(d.printed,
      1e-6)), {shape: 'down'})]);
}

function E14(d) {
  return chart('E14: few bits', linear('bits of u that are left for the coin', 0, 12),
    log('share of the draws that fall into bins of impossible items', 1e-5, 1), [
    dotted(PRINTED, 'as printed: u - i > prob, impossible items are drawn', d.bits, d.printed),
    dots(RIGHT, 'right: frac < prob, none', d.bits, floorWhereZero(d.right, 1e-5))]);
}

function E15(d) {
  return chart('E15: what is left over', log('N P, from the dimmest to the brightest of 65,536 items', 1e-6, 100),
    log('worst relative error of P', 1e-16, 1e4), [
    curve(PRINTED, 'as printed, in float: one item ' + plot.fixed(d.most_printed, 0) + ' times too often', d.NP,
      d.printed),
    curve(RIGHT, 'right, in double: up to ' + plot.number(d.most_right, 1), d.NP, d.right)]);
}

/* ---- the map ---- */

function E1(d) {
  return chart('E1: a patch that is turned away from the sky', linear('tilt from the zenith, degrees', 0, 180, [0, 45,
    90, 135, 180]),
    linear('reflected by a white patch, sky L = 1 above', 0, 1.3), [
      dotted(PRINTED, 'as printed: below the horizon, not counted', d.tilt_deg, d.printed),
      dotted(RIGHT, 'right: (1 + cos tilt)/2', d.tilt_deg, d.right)]);
}

function image(png, width, height) { return plot.heat({title: 'picture', image: png, columns: width, rows: height,
  width: width, height: height}); }

function E2(d) {
  return pair('E2: the shadow of a square, from above', {note: '6 lit pixels are 6 point lights',
    drawings: [image(d.printed, 220, 220)]},
    {note: '6 lit pixels are 6 patches', drawings: [image(d.right, 220, 220)]});
}

function E5(d) {
  return pair('E5: a white ball between a red and a blue half of the sky', {note: 'L/q is one number',
    drawings: [image(d.printed, 220, 220)]},
    {note: 'L is red, green, blue', drawings: [image(d.right, 220, 220)]});
}

function E37(d) {
  const ball = function (b) {
    return {drawings: [image(b.picture, 220, 220)], feet: [percent(b.in_own_shadow,
      1) + ' of the lit side in its own shadow']};
  };
  return pair('E37: a ball that must not shadow itself', Object.assign({note: 'shadow rays start at the point'},
    ball(d.printed)),
    Object.assign({note: 'and beyond its error bound'}, ball(d.right)));
}

/* Lines between n x m cells. */
function grid(n, m) {
  const lines = [];
  for (let k = 0; k <= n; k++) lines.push({x: [k, k], y: [0, m], colour: '#666', width: 1});
  for (let k = 0; k <= m; k++) lines.push({x: [0, n], y: [k, k], colour: '#666', width: 1});
  return lines;
}

function E4(d) {
  const pixel = function (p) {
    return {drawings: [plot.heat({title: 'look-up', deflate: deflate, columns: p.side, rows: p.side, width: 220,
      height: 220, lo: 0, hi: 1, values: p.radiance.map(Math.sqrt),
      scale: false, x: {min: 0, max: p.pixels, ticks: []}, y: {min: 0, max: p.pixels, ticks: []},
        curves: grid(p.pixels, p.pixels),
      dots: p.x.map(function (x, i) { return {x: x, y: p.y[i], radius: 1.8, colour: '#1f2129', rim: false}; })})],
    feet: ['found: ' + plot.fixed(100 * p.found, 2) + ' % of the flux']};
  };
  return pair('E4: one lit pixel, and what is drawn from it', Object.assign({note: 'bilinear look-up'},
    pixel(d.printed)),
    Object.assign({note: 'nearest pixel'}, pixel(d.right)));
}

/* Grey that dots of both colours stand out from. */
function paper(t) { return [0, 1, 2].map(function () { return Math.round(140 + 110 * t); }); }

function E12(d) {
  const map = function (p, colour) {
    return {drawings: [plot.heat({title: 'map', deflate: deflate, columns: d.width, rows: d.height, width: 260,
      height: 130, lo: 0, hi: Math.max.apply(null, d.map),
      values: d.map, colours: paper, scale: false, x: {min: 0, max: 360, ticks: []}, y: {min: 0, max: 180, ticks: []},
      dots: p.phi_deg.map(function (phi, i) { return {x: phi, y: p.theta_deg[i], radius: 1.8, colour: colour,
        rim: false}; })})],
    feet: ['error with 512 points: ' + percent(p.error_512, 2), 'with 4096: ' + percent(p.error_4096, 3)]};
  };
  return pair("E12: Sobol' points through both tables", Object.assign({note: "512 Sobol' points, alias tables"},
    map(d.printed, PRINTED)),
    Object.assign({note: "512 Sobol' points, CDFs"}, map(d.right, RIGHT)));
}

function E17(d) {
  return chart("E17: what area a light's importance is multiplied with", log('solid angle A of the light, sr', 1e-5,
    10), linear('factor of its importance; b = ' +
    d.b, 0, 3), [
    curve(PRINTED, 'as printed: no limit', d.A, d.unlimited),
    curve(PRINTED, 'as printed: 0.01 of the sphere', d.A, d.of_sphere, {dash: true}),
    curve(6, "as printed: the pixel's own dOmega", d.A, d.own_pixel),
    curve(RIGHT, 'right: min(0.01 sr, A)^b', d.A, d.right)]);
}

function E18(d) {
  const sky = function (s) {
    return plot.heat({title: 'levels', deflate: deflate, columns: s.width, rows: s.height, width: 240, height: 120,
      lo: 0, hi: s.levels - 1, values: s.level, scale: false});
  };
  const used = function (s) { return new Set(s.level).size + ' of ' + s.levels; };
  const column = function (list, note) {
    return {note: note, drawings: list.map(sky), feet: ['levels above: ' +
      used(list[0]) + ', below: ' + used(list[1])]};
  };
  return pair('E18: levels of a sky, as it is and in another exposure', column(d.printed,
    'nothing said of the steps: log(1 + I)'),
    column(d.right, 'equal steps of log I'), 'above: a sky; below: the same, exposed 1000 times shorter');
}

function E19(d) {
  const seam = function (s, first, second) {
    const middle = s.columns / 2, colours = [[217, 217, 217], first, second];
    return {drawings: [plot.heat({title: 'seam', deflate: deflate, columns: s.columns, rows: s.rows, width: 240,
      height: 172, lo: 0, hi: 2, values: s.light,
      colours: function (t) { return colours[Math.round(2 * t)]; }, scale: false,
      curves: grid(s.columns, s.rows).concat({x: [middle, middle], y: [0, s.rows], colour: '#000', width: 3})})],
    feet: [s.lights + (s.lights === 1 ? ' light of ' : ' lights of ') + plot.fixed(s.solid_angle, 4) + ' sr',
      'importance x ' + plot.fixed(s.factor, 3)]};
  };
  return pair('E19: a sun on the seam', Object.assign({note: 'the map ends at its edge'}, seam(d.printed, [217, 97,
    10], [240, 178, 130])),
    Object.assign({note: 'its edges are joined'}, seam(d.right, [33, 92, 184], [140, 170, 220])));
}

/* ---- estimators ---- */

function E9(d) {
  return chart('E9: error against N', log('N', 1, 1024), log('relative error', 1e-3, 3), [
    curve(PRINTED, 'as printed: N^-2', d.N, d.printed), curve(RIGHT, 'right: N^-1/2', d.N, d.right), dots(RIGHT,
      'measured', d.N, d.measured)]);
}

function E24(d) {
  return chart('E24: which f, and where w stands', linear('tilt of a patch, degrees', 0, 160, [0, 40, 80, 120, 160]),
    linear('mean estimate of what a patch reflects', 0, 2, [0, 0.5, 1, 1.5, 2]), [
      curve(PRINTED, 'eq. 4.9 with the f of eq. 4.8: F w', d.tilt_deg, d.printed_times),
      curve(PRINTED, 'the line before it: F/(w q)', d.tilt_deg, d.printed_over, {dash: true}),
      dotted(RIGHT, 'right: F w/phat, resampled', d.tilt_deg, d.right)]);
}

function E25(d) {
  return chart('E25: sets without weight', linear('M', 0.5, 8.5, d.M), linear('light of a white patch under L = 1', 0,
    2.2), [
    dotted(PRINTED, '0/0 as printed; such sets left out of the mean: 1/(1 - 2^-M)', d.M, d.printed),
    dotted(RIGHT, 'right: they count as 0', d.M, d.right)]);
}

function E26(d) {
  return chart('E26: which proposal', log('exponent n', 1, 1e4),
    log('relative error, 15 rays of 256 candidates, sun and sky', 1e-3, 30), [
    curve(PRINTED, 'from the map', d.exponent, d.from_map), curve(PRINTED, 'from the BRDF', d.exponent, d.from_brdf,
      {dash: true}),
    curve(RIGHT, 'right: from both', d.exponent, d.right), dots(RIGHT, 'measured', d.exponent, d.measured)]);
}

function E28(d) {
  return chart('E28: candidates for one accepted', linear('angle between the normal and the sun, degrees', 0, 90, [0,
    30, 60, 90]),
    log('candidates for one accepted; one lit pixel', 100, 1e5), [
      curve(PRINTED, 'as printed: 1/dOmega = ' + plot.fixed(d.printed[0], 0), d.angle_deg, d.printed),
      curve(RIGHT, 'right: pi/(cos dOmega)', d.angle_deg, d.right), dots(RIGHT, 'measured', d.angle_deg, d.measured)]);
}

function E30(d) {
  const n = d.right;
  return chart('E30: how many are accepted', log('exponent n', 1, 1e4), log('accepted of 800 candidates from the map',
    0.01, 1000), [
    curve(PRINTED, 'as printed: 15 of 800', d.exponent, d.printed),
    dotted(RIGHT, 'measured: ' + plot.fixed(n[0], 0) + ' to ' + plot.number(n[n.length - 1], 2), d.exponent, n)]);
}

function E31(d) {
  const last = d.N.length - 1;
  return chart('E31: the second term', log('N rays of M = 64 candidates; at N = 256 it is ' +
    plot.fixed(d.measured[last] / d.printed[last], 0) + ' times as printed', 1, 256),
    log('variance / L^2', 1e-3, 3), [
      curve(PRINTED, 'as printed: that of the rays, L`ns^2  var(V)/N', d.N, d.printed),
      curve(RIGHT, 'right: plus that of the candidates', d.N, d.right), dots(RIGHT, 'measured', d.N, d.measured)]);
}

function E32(d) {
  const intervals = function (s, colour) {
    const n = s.mean.map(function (m, k) { return k; });
    const part = function (holds, colour) {
      const of = function (f) { return s.mean.map(function (m,
        k) { return Math.abs(m - d.truth) <= s.half[k] === holds ? f(m, s.half[k]) : null; }); };
      return {kind: 'errors', colour: colour, radius: 2.5, x: n, y: of(function (m) { return m; }), lo: of(function (m,
        h) { return m - h; }),
        hi: of(function (m, h) { return m + h; })};
    };
    return {drawings: [plot.chart({title: 'intervals', width: 270, height: 220, legend: 'none', x: {min: -1,
      max: n.length, ticks: [], grid: false},
      y: {min: 0, max: 2 * d.truth, ticks: [0, 0.5, 1, 1.5].filter(function (v) { return v <= 2 * d.truth; })},
      series: [part(true, colour), part(false, 'ink')], marks: [{y: d.truth, colour: 'ink'}]})],
    feet: [percent(s.held, 1) + ' of ' + s.intervals + ' hold the truth']};
  };
  return pair('E32: error bars', Object.assign({note: '95 % from 16 rays of one set'}, intervals(d.printed, PRINTED)),
    Object.assign({note: '95 % from 16 sets of one ray'}, intervals(d.right, RIGHT)));
}

/* ---- surfaces ---- */

function E33(d) {
  return chart('E33: what a white surface reflects', linear('angle of wo to the normal, degrees', 0, 90, [0, 30, 60,
    90]),
    linear('reflected under L = 1 (cannot be above 1)', 0, 2.2, [0, 0.5, 1, 1.5, 2]), [
      curve(PRINTED, 'eq. 3.13 as printed, diffuse: ' + plot.fixed(d.printed_diffuse[0], 3), d.angle_deg,
        d.printed_diffuse),
      curve(PRINTED, 'lobe of n = 10: ' + plot.fixed(d.printed_lobe[0], 3), d.angle_deg, d.printed_lobe, {dash: true}),
      curve(RIGHT, 'right, diffuse: ' + plot.fixed(d.right_diffuse[0], 3), d.angle_deg, d.right_diffuse),
      curve(RIGHT, 'lobe of n = 10: ' + plot.fixed(d.right_lobe[0], 3) + ' = 11/12', d.angle_deg, d.right_lobe,
        {dash: true})]);
}

function E35(d) {
  return chart('E35: the two lobes', linear('angle of wi to the normal, degrees', 0, 90, [0, 30, 60, 90]),
    linear('draws per degree, ks = kd = 0.5, n = 50, wo at 40', 0, 0.036, [0, 0.01, 0.02, 0.03]), [
      curve('ink', 'density of the mixture', d.angle_deg, d.density), dots(PRINTED, 'nothing printed: uniform, say',
        d.angle_deg, d.printed),
      dots(RIGHT, 'right: diffuse by cosine', d.angle_deg, d.right)]);
}

function E36(d) {
  return chart('E36: large exponents, float and double', log('exponent n', 1, 1e8), log('relative error', 1e-12, 10), [
    curve(PRINTED, 'the obvious forms, in float: density', d.exponent, d.printed_pdf), dots(PRINTED, 'mean of 1 - cos',
      d.exponent, d.printed_mean),
    curve(RIGHT, 'right, expm1 and log1p: density', d.exponent, d.right_pdf), dots(RIGHT, 'mean of 1 - cos',
      d.exponent, d.right_mean)]);
}

module.exports = {E1: E1, E2: E2, E4: E4, E5: E5, E8: E8, E9: E9, E10: E10, E11: E11, E12: E12, E14: E14, E15: E15,
  E17: E17, E18: E18, E19: E19,
  E24: E24, E25: E25, E26: E26, E28: E28, E30: E30, E31: E31, E32: E32, E33: E33, E35: E35, E36: E36, E37: E37};
