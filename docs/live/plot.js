/* SPDX-License-Identifier: BSD-2-Clause */
/* plot: the one place that draws. A classic script without a DOM: numbers in, a text of SVG out, in a browser and under
 * node alike. It defines one global, bisPlot (and module.exports under node). What is drawn was computed by the C
 * program.
 *
 * bisPlot.chart(spec) returns a chart with two axes, as a text of SVG.
 *   title, text     what it is, and what one sees in it: for people who do not see it; title is required
 *   width, height   in pixels (720 x 420)
 *   x, y            an axis: {label, log, min, max, ticks, format, grid}. Absent min and max are those of the data,
 *                   made round. ticks: [numbers] or [{at, text}]; format(v) is the text at a tick; grid false: no
 *                   lines; above true: the label of y stands above the axis, where a long one has room
 *   series          in the order of drawing, each {kind, x, y, lo, hi, label, colour, ...}, x and y of one length:
 *       kind        'line'; 'points'; 'errors' (points with bars from lo to hi); 'steps' (a histogram's outline: y[i]
 *                   from x[i] to x[i + 1], so x may have one more); 'bars' (x is the middle); 'area' (lo to hi, or from
 *                   the axis to y)
 *       colour      a number (0 to 7), a method (em, brdf, mis, rejection, sir, exact), or any colour of CSS
 *       shape       of points: disc, square, diamond, up, down; methods have their own, so no one needs the colours
 *       titles      a text for each point, shown by a browser under the pointer
 *       thin, dash, broad    true: how a line looks; points: true marks the points of a line, too
 *       radius, width        of a point in pixels; of a bar in units of x
 *   marks           what is no series, drawn below all of them: {x} or {y} (a line across), {x0, y0, x1, y1} (a line),
 *                   each with label and colour if wanted; {x, y, label} is a text there
 *   legend          'end' (names at the right, where the curves end), 'top', 'none'; 'top' where two series have
 *                   labels. A label may be followed by note, a second line in small letters ('end' alone)
 *   standalone      true: a file of its own, with its style sheet and its paper
 *   A value that is not finite, or not positive on a logarithmic axis, is left out, and a line has a gap there.
 *
 * bisPlot.heat(spec) returns a field of columns x rows values as a text of SVG: directions on a map, pixels of a
 * picture.
 *   title, text, width, height, standalone    as above; width and height are those of the field without its
 *                                             surroundings
 *   most            of pixels across for all of it: a wider field becomes smaller, its texts do not
 *   columns, rows, values    row after row, the first at the top; absent values: image is shown instead
 *   image           the address of a picture (data:...), drawn below everything else
 *   lo, hi, log     the values of both ends of the colours; log: their logarithms count. What is below lo is night, or
 *                   the lowest colour where night is false
 *   colours         'heat', 'grey', 'difference' (blue below the middle, red above) or a function of t in [0,1]
 *   label           of the scale of colours; scale: false leaves it out
 *   x, y            {label, min, max, ticks, format}: what the left and right, the top and bottom edge stand for
 *   dots            [{x, y, radius, colour, ring, title, data, rim}] in units of x and y; data becomes data-i of the
 *                   element; rim false: without a dark rim, for many on a pale ground
 *   marks           [{x, y, label, below, left}], each a cross, open in the middle
 *   curves          [{x, y, colour}], lines through places
 *
 * bisPlot.together({title, text, columns, foot}) returns drawings side by side, as a file of SVG of its own. A column:
 *   {head, colour, note, drawings, feet}: its name, a line below it, what chart and heat have returned, from the top
 *   down, and lines of text below all of them. foot: a line below all columns.
 *
 * bisPlot.draw({width, height, items}) returns a drawing whose places are given, as a file of SVG on white paper. Items
 *   lie above those before them; null is none. Places and sizes are in pixels from the upper left corner, y downwards:
 *     {box: [x, y, width, height], fill}            {line: [[x, y], ...], width, stroke}
 *     {disc: [x, y, radius], fill}                  {ring: [x, y, radius], width, stroke}
 *     {text, at: [x, y], size, anchor, fill}        size: of a capital; anchor: start, middle, end
 *     {picture: name, size: [width, height], png}   a picture, not shown yet
 *     {show: name, at: [x, y]}                      the picture of that name, any number of times
 *
 * bisPlot.heatPixels(spec) returns {columns, rows, rgb}: the field's colours, three bytes a value (for a canvas).
 * bisPlot.png(columns, rows, rgb, deflate) returns a PNG as an address (data:...). deflate(bytes) compresses as zlib
 *   does; without it nothing is compressed.
 * bisPlot.linearTicks(min, max, n) returns about n round numbers in [min, max].
 * bisPlot.logTicks(min, max) returns [{at, main}]: 1, 2 and 5 of each decade; main: those that get a text.
 * bisPlot.number(v, digits) returns v as printf's %.{digits}g (4); bisPlot.fixed(v, digits) as %.{digits}f.
 * bisPlot.duration(seconds) returns "42 ms", "3.1 s", "6.5 min"; bisPlot.percent(share) "0.034%", "3.4%", "170%": both
 *   as the C program prints them (src/base/text.c).
 * bisPlot.power(k) returns "10⁻³" for k = -3.
 * bisPlot.escape(text) returns text for HTML and SVG. bisPlot.rich(text, size) the same for a text of SVG, in which
 *   what stands behind ^ is raised and what stands behind ` is lowered, up to the next blank, comma or parenthesis.
 * bisPlot.colour(c) returns the CSS of a series' colour; bisPlot.heatColour(t) and bisPlot.greyColour(t) [r, g, b],
 *   0 to 255.
 * bisPlot.css is the style sheet that a page with charts puts into itself once. Its variables (--plot-ink, --plot-em
 *   ...) may be set by the page; it has values for light and for dark. */
'use strict';
var bisPlot = (function () {

/* ---- numbers as printf prints them ---- */

/* [digits, exponent] of v > 0 rounded to p digits, ties to even as in C: toPrecision rounds them up. */
function rounded(v, p) {
  const text = v.toExponential(Math.min(p - 1, 100)), exact = v.toExponential(100);
  let digits = text.slice(0, text.indexOf('e')).replace('.', ''), exponent = +text.slice(text.indexOf('e') + 1);
  const all = exact.slice(0, exact.indexOf('e')).replace('.', '');
  if (/^50*$/.test(all.slice(p)) && +all[p - 1] % 2 === 0) {
    digits = all.slice(0, p);
    exponent = +exact.slice(exact.indexOf('e') + 1);
  }
  return [digits, exponent];
}

function number(v, digits) {
  if (v === null || Number.isNaN(v)) return 'nan';
  if (!Number.isFinite(v)) return v < 0 ? '-inf' : 'inf';
  if (v === 0) return Object.is(v, -0) ? '-0' : '0';
  const p = digits || 4, sign = v < 0 ? '-' : '';
  const [all, e] = rounded(Math.abs(v), p), d = all.replace(/0+$/, '');
  if (e < -4 || e >= p) {
    const power = Math.abs(e) < 10 ? '0' + Math.abs(e) : String(Math.abs(e));
    return sign + d[0] + (d.length > 1 ? '.' + d.slice(1) : '') + 'e' + (e < 0 ? '-' : '+') + power;
  }
  if (e < 0) return sign + '0.' + '0'.repeat(-e - 1) + d;
  const whole = d.slice(0, e + 1).padEnd(e + 1, '0'), rest = d.slice(e + 1);
  return sign + whole + (rest ? '.' + rest : '');
}

function fixed(v, digits) {
  const exact = Math.abs(v).toFixed(100), at = exact.indexOf('.') + 1, last = exact.slice(0, at + digits).replace('.',
    '').slice(-1);
  if (!/^50*$/.test(exact.slice(at + digits)) || last % 2) return v.toFixed(digits);
  return (v < 0 ? '-' : '') + exact.slice(0, digits ? at + digits : at - 1); /* a tie, to even as in C */
}

function duration(seconds) {
  if (seconds > 0 && seconds < 0.0995) return number(1e3 * seconds, 2) + ' ms';
  if (seconds < 9.95) return number(seconds, 2) + ' s';
  if (seconds < 99.5) return fixed(seconds, 0) + ' s';
  if (seconds < 5400) return fixed(seconds / 60, seconds < 597 ? 1 : 0) + ' min';
  if (seconds < 48 * 3600) return fixed(seconds / 3600, 1) + ' h';
  return number(seconds / 86400, 3) + ' days';
}

function percent(share) {
  const p = 100 * share;
  if (p > 0 && p < 1e-4) return 'below 0.0001%';
  if (p < 9.95) return number(p, 2) + '%';
  return p > 1e6 ? 'over 1000000%' : fixed(p, 0) + '%';
}

function power(k) {
  const high = {'-': '⁻', 0: '⁰', 1: '¹', 2: '²', 3: '³', 4: '⁴', 5: '⁵', 6: '⁶', 7: '⁷', 8: '⁸', 9: '⁹'};
  return '10' + String(k).split('').map(function (c) { return high[c]; }).join('');
}

/* ---- text ---- */

function escape(text) {
  const names = {'&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;', "'": '&#39;'};
  return String(text).replace(/[&<>"']/g, function (c) { return names[c]; });
}

/* A span is moved from the line of the one before it: dy adds up. */
function rich(text, size) {
  let out = '', before = 0;
  for (const part of String(text).match(/[\^`][^\^` ,)]*|[^\^`]+/g) || []) {
    const mark = part[0], lift = mark === '^' ? 0.396 * size : mark === '`' ? -0.18 * size : 0;
    const plain = escape(mark === '^' || mark === '`' ? part.slice(1) : part);
    if (lift === 0 && before === 0) out += plain;
    else out += '<tspan dy="' + place(before - lift) + '"' + (lift ? ' font-size="' + place(0.7 * size) + '"' : '') +
      '>' +
      plain + '</tspan>';
    before = lift;
  }
  return out;
}

/* A place in the drawing: a hundredth of a pixel is enough. */
function place(v) { return String(Math.round(100 * v) / 100); }

/* How wide a text is, about, without a font at hand. */
function textWidth(text, size) { return 0.56 * size * String(text).replace(/[\^`]/g, '').length; }

/* ---- colours ---- */

const METHODS = {em: 'up', brdf: 'square', mis: 'diamond', rejection: 'down', sir: 'disc', exact: 'square'};
const LIGHT = {ink: '#1d2129', soft: '#5d6470', line: '#e3e1da', paper: '#ffffff', em: '#a86a00', brdf: '#0b7d73',
  mis: '#7a52cc', rejection: '#c8436d', sir: '#1c64d9', exact: '#3f4652', 0: '#1c64d9', 1: '#a86a00', 2: '#0b7d73',
  3: '#c8436d', 4: '#7a52cc', 5: '#5d7d1a', 6: '#8a4b2d', 7: '#3f4652'};
const DARK = {ink: '#e8e6e1', soft: '#9aa1ad', line: '#30343c', paper: '#1c1f25', em: '#e5a93c', brdf: '#3cc4b6',
  mis: '#ac8df0', rejection: '#f07d9f', sir: '#6ba3ff', exact: '#c3cad6', 0: '#6ba3ff', 1: '#e5a93c', 2: '#3cc4b6',
  3: '#f07d9f', 4: '#ac8df0', 5: '#a9c95c', 6: '#d99a78', 7: '#c3cad6'};

function variables(of) {
  return Object.keys(of).map(function (k) { return '--plot-' + k + ':' + of[k]; }).join(';');
}

const css = ':root{' + variables(LIGHT) + '}\n@media(prefers-color-scheme:dark){:root{' + variables(DARK) + '}}\n' +
  '.bis-plot{max-width:100%;height:auto;font:12px system-ui,-apple-system,"Segoe UI",Roboto,sans-serif}\n' +
  '.bis-plot text{fill:var(--plot-soft)}.bis-plot .p-name{font-weight:600}.bis-plot .p-strong{fill:var(--plot-ink)}\n' +
  '.bis-plot .p-grid{stroke:var(--plot-line);stroke-width:.8}.bis-plot .p-axis{fill:none;stroke:var(--plot-soft)}\n' +
  '.bis-plot .p-on{fill:#fff;stroke:#05050d;stroke-width:3.5;paint-order:stroke}\n' +
  '.bis-plot .p-line{fill:none;stroke-linejoin:round;stroke-linecap:round}.bis-plot image{image-rendering:pixelated}\n';

function colour(c) {
  if (c === undefined || c === null) c = 0;
  if (typeof c === 'number') c %= 8;
  return c in LIGHT ? 'var(--plot-' + c + ',' + LIGHT[c] + ')' : escape(c);
}

/* Linear between stops that lie evenly on [0,1]; each is lighter than the one before: reads in grey print, too. */
function between(stops, t) {
  const at = Math.min(Math.max(t, 0), 1) * (stops.length - 1), i = Math.min(Math.floor(at), stops.length - 2);
  return [0, 1, 2].map(function (k) { return Math.round(255 * (stops[i][k] + (at - i) * (stops[i +
    1][k] - stops[i][k]))); });
}

function heatColour(t) {
  return between([[0.05, 0.03, 0.20], [0.25, 0.07, 0.43], [0.53, 0.13, 0.42], [0.80, 0.24, 0.30], [0.95, 0.47, 0.12],
    [0.98, 0.76, 0.22], [1.0, 0.99, 0.80]], t);
}

function greyColour(t) { return between([[0.05, 0.05, 0.09], [0.77, 0.78, 0.85]], t); }
function differenceColour(t) { return between([[0.13, 0.35, 0.75], [0.95, 0.95, 0.93], [0.78, 0.16, 0.2]], t); }

function colourFunction(name) {
  if (typeof name === 'function') return name;
  return name === 'grey' ? greyColour : name === 'difference' ? differenceColour : heatColour;
}

/* ---- axes ---- */

function linearTicks(min, max, n) {
  if (!(max > min)) return [min];
  const rough = (max - min) / (n || 6), unit = Math.pow(10, Math.floor(Math.log10(rough)));
  const step = [1, 2, 5, 10].map(function (s) { return s * unit; }).find(function (s) { return s >= 0.999 * rough; });
  const list = [];
  for (let i = Math.ceil(min / step - 1e-9); i <= max / step + 1e-9;
    i++) /* 1e-9 of a step: the ends themselves count */
    list.push(+(i * step).toPrecision(12));
  return list;
}

function logTicks(min, max) {
  const decades = Math.log10(max / min), list = [], every = Math.ceil(decades / 13); /* so many texts have room */
  for (let k = Math.floor(Math.log10(min)); k <= Math.ceil(Math.log10(max)); k++) {
    for (const s of decades > 6 ? [1] : [1, 2, 5]) {
      const at = +(s + 'e' + k);
      if (at >= min && at <= max) list.push({at: at, main: decades < 2.6 || (s === 1 && k % every === 0)});
    }
  }
  return list;
}

function usable(axis, v) { return typeof v === 'number' && Number.isFinite(v) && (!axis.log || v > 0); }

function defaultFormat(axis) {
  return function (v) {
    if (!axis.log) return number(v, 6);
    const k = Math.round(Math.log10(v));
    return Math.abs(k) > 3 && Math.abs(v / Math.pow(10, k) - 1) < 1e-9 ? power(k) : number(v, 4);
  };
}

/* An axis of the spec with its ends, from data where it has none, its ticks, and where a value lies in [from, to]. */
function makeAxis(given, values) {
  const axis = Object.assign({label: '', log: false, grid: true}, given), known = values.filter(function (v) {
    return usable(axis, v);
  });
  let lo = Infinity, hi = -Infinity;
  for (const v of known) { lo = Math.min(lo, v); hi = Math.max(hi, v); }
  if (!(lo <= hi)) { lo = axis.log ? 0.1 : 0; hi = 1; }
  if (axis.log) { lo /= 1.2; hi *= 1.2; }
  else if (lo === hi) { lo -= Math.abs(lo) / 2 || 1; hi += Math.abs(hi) / 2 || 1; }
  else {
    const ticks = linearTicks(lo, hi), step = ticks.length > 1 ? ticks[1] - ticks[0] : hi - lo;
    lo = Math.floor(lo / step + 1e-9) * step;
    hi = Math.ceil(hi / step - 1e-9) * step;
  }
  axis.min = usable(axis, axis.min) ? axis.min : lo;
  axis.max = usable(axis, axis.max) ? axis.max : hi;
  if (axis.min === axis.max) axis.max += Math.abs(axis.max) || 1;
  axis.at = function (v) {
    const t = axis.log ? Math.log(v / axis.min) / Math.log(axis.max / axis.min) :
      (v - axis.min) / (axis.max - axis.min);
    return axis.from + t * (axis.to - axis.from);
  };
  axis.list = axisTicks(axis);
  return axis;
}

function axisTicks(axis) {
  const format = axis.format || defaultFormat(axis), lo = Math.min(axis.min, axis.max), hi = Math.max(axis.min,
    axis.max);
  const list = axis.ticks || (axis.log ? logTicks(lo, hi) : linearTicks(lo, hi));
  return list.map(function (t) {
    if (typeof t === 'number') return {at: t, text: format(t)};
    return {at: t.at, text: t.text !== undefined ? t.text : t.main ? format(t.at) : ''};
  }).filter(function (t) { return usable(axis, t.at) && t.at >= lo && t.at <= hi; });
}

/* ---- the pieces of a drawing ---- */

/* A name of its own for a drawing's title, the same each time: FNV-1a. */
function idOf(text) {
  let h = 0x811c9dc5;
  for (let i = 0; i < text.length; i++) h = Math.imul(h ^ text.charCodeAt(i), 0x01000193) >>> 0;
  return 'p' + h.toString(16);
}

function wrap(spec, width, height, body) {
  const id = idOf(spec.title + '\n' + (spec.text || '') + '\n' + body), alone = spec.standalone;
  return '<svg' + (alone ? ' xmlns="http://www.w3.org/2000/svg"' : '') +
    ' class="bis-plot" role="img" aria-labelledby="' + id +
    (spec.text ? ' ' + id + 'd' : '') + '" width="' + width + '" height="' + height + '" viewBox="0 0 ' + width + ' ' +
      height +
    '">\n<title id="' + id + '">' + escape(spec.title) + '</title>\n' +
    (spec.text ? '<desc id="' + id + 'd">' + escape(spec.text) + '</desc>\n' : '') +
    (alone ? '<style>' + escape(css).replace(/&quot;/g, '"') + '</style>\n<rect width="100%" height="100%" fill="' +
      colour('paper') + '"/>\n' : '') + body + '</svg>\n';
}

/* at: start, middle or end. */
function text(x, y, at, words, more) {
  const size = more && more.size || 12;
  return '<text x="' + place(x) + '" y="' + place(y) + '"' + (at === 'start' ? '' : ' text-anchor="' + at + '"') +
    (size === 12 ? '' : ' font-size="' + size + '"') + (more && more.kind ? ' class="' + more.kind + '"' : '') +
    (more && more.fill ? ' style="fill:' + more.fill + '"' : '') +
    (more && more.turn ? ' transform="rotate(-90 ' + place(x) + ' ' + place(y) + ')"' : '') + '>' + rich(words, size) +
      '</text>\n';
}

function path(d, stroke, width, more) {
  return '<path class="p-line" d="' + d + '" stroke="' + stroke + '" stroke-width="' + width + '"' + (more || '') +
    '/>\n';
}

function shapeAt(x, y, shape, r) {
  const at = 'M' + place(x) + ' ' + place(y), a = place(r), w = place(2 * r), b = place(1.15 * r), s = place(0.9 * r);
  if (shape === 'up') return at + 'm0 -' + b + 'l' + b + ' ' + place(2 * r) + 'h-' + place(2.3 * r) + 'z';
  if (shape === 'down') return at + 'm0 ' + b + 'l' + b + ' -' + place(2 * r) + 'h-' + place(2.3 * r) + 'z';
  if (shape === 'square') return at + 'm-' + s + ' -' + s + 'h' + place(1.8 * r) + 'v' + place(1.8 * r) + 'h-' +
    place(1.8 * r) + 'z';
  if (shape === 'diamond') return at + 'm0 -' + b + 'l' + b + ' ' + b + 'l-' + b + ' ' + b + 'l-' + b + ' -' + b + 'z';
  return at + 'm-' + a + ' 0a' + a + ' ' + a + ' 0 1 0 ' + w + ' 0a' + a + ' ' + a + ' 0 1 0 -' + w + ' 0';
}

/* ---- a chart ---- */

function shapeOf(s) { return s.shape || METHODS[s.colour] || 'disc'; }
function length(s) { return Math.min((s.x || []).length, (s.y || s.hi || []).length); }

/* All values that an axis must reach. */
function valuesOf(spec, name) {
  let list = [];
  for (const s of spec.series || []) {
    list = list.concat(s[name] || []);
    if (name === 'y') list = list.concat(s.lo || [], s.hi || []);
    if (name === 'y' && (s.kind === 'bars' || s.kind === 'steps' || (s.kind === 'area' && !s.lo))) list.push(0);
    if (name === 'x' && s.kind === 'bars') for (const v of s.x) list.push(v - barWidth(s) / 2, v + barWidth(s) / 2);
  }
  return list;
}

function barWidth(s) { return s.width || (s.x.length > 1 ? 0.8 * Math.abs(s.x[1] - s.x[0]) : 0.8); }

/* "Mx yLx y", with a gap where a value is unusable. */
function linePath(x, y, xs, ys) {
  let d = '', pen = 'M';
  for (let i = 0; i < Math.min(xs.length, ys.length); i++) {
    if (!usable(x, xs[i]) || !usable(y, ys[i])) { pen = 'M'; continue; }
    d += pen + place(x.at(xs[i])) + ' ' + place(y.at(ys[i]));
    pen = 'L';
  }
  return d;
}

/* The lowest place of the y axis that a bar may stand on. */
function groundOf(y) { return y.log ? y.min : Math.min(Math.max(0, Math.min(y.min, y.max)), Math.max(y.min, y.max)); }

function drawSteps(s, x, y) {
  const ground = place(y.at(groundOf(y))), n = s.y.length;
  let d = '';
  for (let i = 0; i < n; i++) {
    const end = i + 1 < s.x.length ? s.x[i + 1] : 2 * s.x[i] - s.x[i - 1];
    if (!usable(x, s.x[i]) || !usable(x, end)) continue;
    const top = usable(y, s.y[i]) ? place(y.at(s.y[i])) : ground;
    d += (d ? 'L' : 'M' + place(x.at(s.x[i])) + ' ' + ground + 'L') + place(x.at(s.x[i])) + ' ' + top + 'H' +
      place(x.at(end));
  }
  if (!d) return '';
  d += 'V' + ground;
  return '<path d="' + d + '" fill="' + colour(s.colour) + '" fill-opacity=".16" stroke="none"/>\n' +
    path(d, colour(s.colour), s.thin ? 1 : 1.8);
}

function drawBars(s, x, y) {
  const w = barWidth(s), ground = y.at(groundOf(y));
  let out = '';
  for (let i = 0; i < length(s); i++) {
    if (!usable(x, s.x[i]) || !usable(y, s.y[i])) continue;
    const left = x.at(s.x[i] - w / 2), right = x.at(s.x[i] + w / 2), top = y.at(s.y[i]);
    out += '<rect x="' + place(Math.min(left, right)) + '" y="' + place(Math.min(top, ground)) + '" width="' +
      place(Math.abs(right - left)) + '" height="' + place(Math.abs(ground - top)) + '" fill="' + colour(s.colour) +
      '" fill-opacity=".8" data-i="' + i + '">' + (s.titles ? '<title>' + escape(s.titles[i]) + '</title>' : '') +
        '</rect>\n';
  }
  return out + drawErrors(s, x, y);
}

function drawArea(s, x, y) {
  const lo = s.lo || s.x.map(function () { return groundOf(y); }), hi = s.hi || s.y, forth = [], back = [];
  for (let i = 0; i < s.x.length; i++) {
    if (!usable(x, s.x[i]) || !usable(y, hi[i])) continue;
    forth.push(place(x.at(s.x[i])) + ' ' + place(y.at(hi[i])));
    back.unshift(place(x.at(s.x[i])) + ' ' + place(y.at(usable(y, lo[i]) ? lo[i] : y.min)));
  }
  if (!forth.length) return '';
  return '<path d="M' + forth.concat(back).join('L') + 'z" fill="' + colour(s.colour) + '" fill-opacity=".18"/>\n';
}

/* Bars from lo to hi, where both are given. */
function drawErrors(s, x, y) {
  let d = '';
  for (let i = 0; s.lo && s.hi && i < s.x.length; i++) {
    if (!usable(x, s.x[i]) || !usable(y, s.hi[i])) continue;
    const lo = usable(y, s.lo[i]) ? Math.max(s.lo[i], Math.min(y.min, y.max)) : y.min;
    const at = x.at(s.x[i]), top = place(y.at(s.hi[i])), bottom = place(y.at(lo));
    d += 'M' + place(at - 3.5) + ' ' + top + 'h7M' + place(at - 3.5) + ' ' + bottom + 'h7M' + place(at) + ' ' + top +
      'V' + bottom;
  }
  return d && path(d, s.kind === 'bars' ? colour('ink') : colour(s.colour), 1.2);
}

function drawPoints(s, x, y) {
  const shape = shapeOf(s), r = s.radius || 4;
  let out = '';
  for (let i = 0; i < length(s); i++) {
    if (!usable(x, s.x[i]) || !usable(y, s.y[i])) continue;
    out += '<path d="' + shapeAt(x.at(s.x[i]), y.at(s.y[i]), shape, r) + '" fill="' + (s.kind === 'points' ?
      colour(s.colour) :
      colour('paper')) + '" stroke="' + colour(s.colour) + '" stroke-width="' + (r < 3 ? 1 : 1.8) + '" data-i="' + i +
        '">' +
      (s.titles ? '<title>' + escape(s.titles[i]) + '</title>' : '') + '</path>\n';
  }
  return out;
}

function drawLine(s, x, y) {
  const more = (s.dash ? ' stroke-dasharray="6 4"' : '') + (s.broad ? ' stroke-opacity=".14"' : s.thin ?
    ' stroke-opacity=".4"' : '');
  const d = linePath(x, y, s.x, s.y);
  return (d && path(d, colour(s.colour), s.broad ? 13 : s.thin ? 1.2 : 2.2, more)) + drawErrors(s, x, y) +
    (s.points ? drawPoints(s, x, y) : '');
}

function drawSeries(s, i, x, y) {
  const draw = {steps: drawSteps, bars: drawBars, area: drawArea, line: drawLine}[s.kind];
  return '<g data-series="' + i + '">' + (s.label && s.thin ? '<title>' + escape(s.label) + '</title>' : '') +
    (draw ? draw(s, x, y) : drawErrors(s, x, y) + drawPoints(s, x, y)) + '</g>\n';
}

function drawMark(m, x, y) {
  const stroke = m.colour === undefined ? colour('soft') : colour(m.colour), dash = ' stroke-dasharray="' + (m.dots ?
    '1 5' : '6 4') + '"';
  if (m.x0 !== undefined) {
    return path('M' + place(x.at(m.x0)) + ' ' + place(y.at(m.y0)) + 'L' + place(x.at(m.x1)) + ' ' + place(y.at(m.y1)),
      stroke, 1, dash);
  }
  if (m.x !== undefined && m.y !== undefined) return text(x.at(m.x), y.at(m.y), m.at || 'start', m.label,
    {fill: stroke});
  const across = m.y !== undefined, v = across ? y.at(m.y) : x.at(m.x);
  return path(across ? 'M' + x.from + ' ' + place(v) + 'H' + x.to : 'M' + place(v) + ' ' + y.from + 'V' + y.to, stroke,
    1.2, dash) +
    (!m.label ? '' : across ? text(x.from + 8, v - 5, 'start', m.label, {fill: stroke}) :
      text(v + 5, y.to + 12, 'start', m.label, {fill: stroke}));
}

function drawAxes(x, y, width) {
  let out = '';
  for (const t of x.list) {
    const at = place(x.at(t.at));
    if (x.grid) out += '<path class="p-grid" d="M' + at + ' ' + y.from + 'V' + y.to + '"/>';
    out += text(x.at(t.at), y.from + 18, 'middle', t.text);
  }
  for (const t of y.list) {
    if (y.grid) out += '<path class="p-grid" d="M' + x.from + ' ' + place(y.at(t.at)) + 'H' + x.to + '"/>';
    out += text(x.from - 8, y.at(t.at) + 4, 'end', t.text);
  }
  out += '<path class="p-axis" d="M' + x.from + ' ' + y.to + 'V' + y.from + 'H' + x.to + '"/>\n';
  if (x.label) out += text((x.from + x.to) / 2, y.from + 40, 'middle', x.label, {kind: 'p-strong'});
  if (y.label && y.above) out += text(8, y.to - 10, 'start', y.label, {kind: 'p-strong'});
  else if (y.label) out += text(16, (y.from + y.to) / 2, 'middle', y.label, {kind: 'p-strong', turn: true});
  return out;
}

/* Names at the right, in the order of the curves' ends, far enough from one another to be read. */
function drawEndLabels(named, x, y) {
  const step = function (s) { return s.note ? 30 : 17; };
  const list = named.map(function (s) {
    let i = s.y.length - 1;
    while (i >= 0 && !(usable(x, s.x[i]) && usable(y, s.y[i]))) i--;
    return {s: s, at: i < 0 ? y.from : y.at(s.y[i])};
  }).sort(function (a, b) { return a.at - b.at; });
  for (let i = 1; i < list.length; i++) list[i].at = Math.max(list[i].at, list[i - 1].at + step(list[i - 1].s));
  let floor = y.from;
  for (let i = list.length - 1; i >= 0; i--) {
    list[i].at = Math.min(list[i].at, floor - (list[i].s.note ? 13 : 0));
    floor = list[i].at - (i ? step(list[i - 1].s) - (list[i - 1].s.note ? 13 : 0) : 0);
  }
  return list.map(function (l) {
    return text(x.to + 12, l.at + 4, 'start', l.s.label, {kind: 'p-name', fill: colour(l.s.colour), size: 13}) +
      (l.s.note ? text(x.to + 12, l.at + 17, 'start', l.s.note, {size: 11}) : '');
  }).join('');
}

/* Rows of [line and shape, name]: their number of pixels, and the drawing. */
function drawTopLegend(named, left, right) {
  let x = left, y = 16, out = '';
  for (const s of named) {
    const w = 34 + textWidth(s.label, 12);
    if (x > left && x + w > right) { x = left; y += 18; }
    if (s.kind === 'line' || s.kind === 'steps') out += path('M' + place(x) + ' ' + (y - 4) + 'h20', colour(s.colour),
      2.2, s.dash ? ' stroke-dasharray="6 4"' : '');
    else if (s.kind === 'bars' || s.kind === 'area')
      out += '<rect x="' + place(x + 3) + '" y="' + (y - 11) + '" width="14" height="12" fill="' + colour(s.colour) +
        '" fill-opacity=".6"/>';
    if (s.kind === 'points' || s.kind === 'errors' || s.points)
      out += '<path d="' + shapeAt(x + 10, y - 4, shapeOf(s), 4) + '" fill="' + colour(s.colour) + '"/>';
    out += text(x + 26, y, 'start', s.label, {kind: 'p-strong'});
    x += w + 10;
  }
  return {height: named.length ? y + 12 : 12, body: out};
}

function chart(spec) {
  const width = spec.width || 720, height = spec.height || 420, series = spec.series || [];
  const x = makeAxis(spec.x, valuesOf(spec, 'x')), y = makeAxis(spec.y, valuesOf(spec, 'y'));
  const named = series.filter(function (s) { return s.label && !s.thin; });
  const legend = spec.legend || (named.length > 1 ? 'top' : 'none');
  const widest = function (list, size) { return list.reduce(function (w, t) { return Math.max(w, textWidth(t, size));
    }, 0); };
  x.from = Math.round(widest(y.list.map(function (t) { return t.text; }), 12) + 16 + (y.label && !y.above ? 20 : 0));
  x.to = width - (legend === 'end' ? Math.round(Math.max(widest(named.map(function (s) { return s.label; }), 14),
    widest(named.map(function (s) { return s.note || ''; }), 11))) + 20 : 18);
  const top = legend === 'top' ? drawTopLegend(named, x.from, x.to) : {height: 12, body: ''};
  y.from = height - (x.label ? 50 : 28);
  y.to = top.height + (y.label && y.above ? 20 : 0);
  let body = drawAxes(x, y, width) + top.body;
  for (const m of spec.marks || []) body += drawMark(m, x, y);
  const id = idOf(spec.title + body);
  body += '<clipPath id="' + id + 'c"><rect x="' + (x.from - 6) + '" y="' + (y.to - 6) + '" width="' + (x.to - x.from +
    12) + '" height="' +
    (y.from - y.to + 12) + '"/></clipPath>\n<g clip-path="url(#' + id + 'c)">';
  series.forEach(function (s, i) { body += drawSeries(s, i, x, y); });
  body += '</g>\n';
  if (legend === 'end') body += drawEndLabels(named, x, y);
  return wrap(spec, width, height, body);
}

/* ---- pictures ---- */

function crc(bytes) {
  let c = -1;
  for (let i = 0; i < bytes.length; i++) {
    c ^= bytes[i];
    for (let k = 0; k < 8; k++) c = c >>> 1 ^ (c & 1 ? 0xedb88320 : 0);
  }
  return ~c >>> 0;
}

function word(v) { return [v >>> 24 & 255, v >>> 16 & 255, v >>> 8 & 255, v & 255]; }

/* zlib's format (RFC 1950) with stored blocks. */
function stored(bytes) {
  const out = [0x78, 1];
  let a = 1, b = 0;
  for (let i = 0; i < bytes.length; i++) { a = (a + bytes[i]) % 65521; b = (b + a) % 65521; }
  for (let at = 0; at < bytes.length; at += 65535) {
    const n = Math.min(65535, bytes.length - at);
    out.push(at + n === bytes.length ? 1 : 0, n & 255, n >> 8, ~n & 255, ~n >> 8 & 255);
    for (let i = 0; i < n; i++) out.push(bytes[at + i]);
  }
  return out.concat(word((b << 16 | a) >>> 0));
}

function base64(bytes) {
  const digits = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/';
  let out = '';
  for (let i = 0; i < bytes.length; i += 3) {
    const v = bytes[i] << 16 | (bytes[i + 1] || 0) << 8 | (bytes[i + 2] || 0);
    out += digits[v >> 18] + digits[v >> 12 & 63] + (i + 1 < bytes.length ? digits[v >> 6 & 63] : '=') +
      (i + 2 < bytes.length ? digits[v & 63] : '=');
  }
  return out;
}

function png(columns, rows, rgb, deflate) {
  const raw = new Uint8Array(rows * (3 * columns + 1));
  for (let y = 0; y < rows; y++)
    for (let i = 0; i < 3 * columns; i++) raw[y * (3 * columns + 1) + 1 + i] = rgb[y * 3 * columns + i];
  const chunk = function (name, data) {
    const body = Array.from(name, function (c) { return c.charCodeAt(0); }).concat(Array.from(data));
    return word(data.length).concat(body, word(crc(body)));
  };
  const file = [0x89, 0x50, 0x4e, 0x47, 13, 10, 26, 10].concat(chunk('IHDR', word(columns).concat(word(rows), [8, 2, 0,
    0, 0])),
    chunk('IDAT', deflate ? deflate(raw) : stored(raw)), chunk('IEND', []));
  return 'data:image/png;base64,' + base64(file);
}

/* ---- a field ---- */

function heatPixels(spec) {
  const of = colourFunction(spec.colours), rgb = new Uint8Array(3 * spec.columns * spec.rows), table = [];
  const lo = spec.log ? Math.log(spec.lo) : spec.lo, hi = spec.log ? Math.log(spec.hi) : spec.hi;
  for (let i = 0; i <= 256; i++) table.push(of(i / 256));
  for (let i = 0; i < spec.columns * spec.rows; i++) {
    const v = spec.values[i], t = hi > lo ? ((spec.log ? Math.log(v) : v) - lo) / (hi - lo) : 1;
    const c = t >= 0 || spec.night === false ? table[Math.round(256 * Math.min(Math.max(t, 0) || 0, 1))] : [5, 5, 13];
    rgb.set(c, 3 * i);
  }
  return {columns: spec.columns, rows: spec.rows, rgb: rgb};
}

/* The scale of colours at the right, from [left, top] with the field's height: its drawing, and its width in pixels. */
function drawScale(spec, left, top, height) {
  const of = colourFunction(spec.colours), axis = makeAxis({log: spec.log, min: spec.lo, max: spec.hi,
    format: spec.format}, []);
  let out = '';
  axis.from = top + height;
  axis.to = top;
  for (let i = 0; i < 64; i++) {
    const h = height / 64;
    out += '<rect x="' + left + '" y="' + place(top + i * h) + '" width="16" height="' + place(h + 0.5) +
      '" fill="rgb(' +
      of(1 - (i + 0.5) / 64).join() + ')"/>';
  }
  for (const t of axis.list) {
    if (!t.text) continue;
    out += '<path class="p-axis" d="M' + (left + 16) + ' ' + place(axis.at(t.at)) + 'h5"/>' + text(left + 25,
      axis.at(t.at) + 4, 'start', t.text);
  }
  out += spec.label ? text(left + 8, top + height + 19, 'start', spec.label) : '';
  const texts = axis.list.map(function (t) {
    return 25 + textWidth(t.text || '', 12);
  }).concat(8 + textWidth(spec.label || '', 12));
  return {body: out, width: Math.max(58, Math.ceil(Math.max.apply(null, texts)) + 4)};
}

/* On a dark disc that sets it off from the ground. */
function drawDot(d, i, x, y) {
  const r = d.radius || 3.6, at = ' cx="' + place(x.at(d.x)) + '" cy="' + place(y.at(d.y)) + '"', c = colour(d.colour);
  return '<g' + (d.data === undefined ? '' : ' data-i="' + escape(d.data) + '"') + '>' + (d.title ? '<title>' +
    escape(d.title) + '</title>' : '') +
    (d.rim === false ? '' : '<circle' + at + ' r="' + place(r + 1.2) + '" fill="#05050d"/>') + '<circle' + at + ' r="' +
    place(d.ring ? r - 0.6 :
      r) + '" ' +
    (d.ring ? 'fill="none" stroke-width="1.7" stroke' : 'fill') + '="' + c + '"/>' +
    (d.chosen ? '<circle' + at + ' r="' + place(r + 3) + '" fill="none" stroke="#fff" stroke-width="1.5"/>' : '') +
      '</g>\n';
}

function drawCross(m, x, y) {
  const at = 'M' + place(x.at(m.x)) + ' ' + place(y.at(m.y)), d = at + 'm4 0h5' + at + 'm-4 0h-5' + at + 'm0 4v5' +
    at + 'm0 -4v-5';
  return path(d, '#05050d', 4) + path(d, '#fff', 1.5) +
    (m.label ? text(x.at(m.x) + (m.left ? -6 : 8), y.at(m.y) + (m.below ? 17 : -7), m.left ? 'end' : 'start', m.label,
      {kind: 'p-on'}) : '');
}

function heat(spec) {
  const scale = spec.scale !== false && spec.values;
  const x = makeAxis(Object.assign({min: 0, max: spec.columns || 1, ticks: []}, spec.x), []);
  const y = makeAxis(Object.assign({min: 0, max: spec.rows || 1, ticks: []}, spec.y), []);
  const left = y.list.length || y.label ? 34 + (y.label ? 20 : 0) : 2;
  /* the label stands below the texts of the ticks, if there are any */
  const bottom = (x.list.length ? 22 : 2) + (x.label ? 20 : 0);
  const top = y.list.length || scale ? 8 : 2, asked = spec.width || 480;
  const w = Math.min(asked, (spec.most || Infinity) - left - (scale ? 86 : 14)),
    h = Math.round((spec.height || 240) * w / asked);
  x.from = left, x.to = left + w, y.from = top, y.to = top + h;
  const pixels = spec.values && heatPixels(spec);
  const href = pixels ? png(pixels.columns, pixels.rows, pixels.rgb, spec.deflate) : spec.image;
  let body = '';
  if (spec.image && pixels) body += '<image x="' + left + '" y="' + top + '" width="' + w + '" height="' + h +
    '" preserveAspectRatio="none" href="' + escape(spec.image) + '"/>\n';
  if (href) body += '<image x="' + left + '" y="' + top + '" width="' + w + '" height="' + h +
    '" preserveAspectRatio="none" href="' + escape(href) + '"/>\n';
  for (const t of x.list) body += '<path class="p-axis" d="M' + place(x.at(t.at)) + ' ' + (y.to + 1) + 'v4"/>' +
    text(x.at(t.at), y.to + 18, 'middle', t.text);
  for (const t of y.list) body += '<path class="p-axis" d="M' + (x.from - 5) + ' ' + place(y.at(t.at)) + 'h4"/>' +
    text(x.from - 8, y.at(t.at) + 4, 'end', t.text);
  if (x.label) body += text((x.from + x.to) / 2, y.to + bottom - 4, 'middle', x.label);
  if (y.label) body += text(14, (y.from + y.to) / 2, 'middle', y.label, {turn: true});
  for (const c of spec.curves || []) body += path(linePath(x, y, c.x, c.y), colour(c.colour), c.width || 1.6);
  (spec.dots || []).forEach(function (d, i) { body += drawDot(d, i, x, y); });
  for (const m of spec.marks || []) body += drawCross(m, x, y);
  const colours = scale && drawScale(spec, left + w + 14, top, h);
  if (scale) body += colours.body;
  return wrap(spec, left + w + (scale ? 14 + colours.width : x.list.length ? 14 : 2), top + h + Math.max(bottom, scale ?
    24 : 0), body);
}

/* ---- drawings side by side ---- */

/* The part of a column from (left, top): {body, width, height}. */
function drawColumn(c, left, top) {
  const parts = c.drawings.map(function (d) {
    const m = d.match(/^<svg[^>]*? width="([0-9.]+)" height="([0-9.]+)"[^>]*>/);
    return {width: +m[1], height: +m[2], inside: d.slice(m[0].length, d.lastIndexOf('</svg>'))};
  });
  const width = Math.max.apply(null, parts.map(function (p) { return p.width; })), middle = left + width / 2;
  let at = top, body = '';
  const say = function (words, more) { at += 17; body += text(middle, at, 'middle', words, more); };
  if (c.head) say(c.head, {kind: 'p-name', fill: colour(c.colour), size: 13});
  if (c.note) say(c.note);
  at += at > top ? 10 : 0;
  for (const p of parts) {
    body += '<g transform="translate(' + place(left + (width - p.width) / 2) + ' ' + place(at) + ')">' + p.inside +
      '</g>\n';
    at += p.height;
  }
  for (const f of c.feet || []) say(f, {fill: colour(c.colour)});
  return {body: body, width: width, height: at - top};
}

function together(spec) {
  let left = 10, height = 0, body = '';
  for (const c of spec.columns) {
    const column = drawColumn(c, left, 6);
    body += column.body;
    left += column.width + 20;
    height = Math.max(height, column.height);
  }
  if (spec.foot) body += text((left - 10) / 2, height + 26, 'middle', spec.foot);
  return wrap(Object.assign({standalone: true}, spec), left - 10, height + (spec.foot ? 38 : 18), body);
}

/* ---- a list of shapes ---- */

/* One item as an element. Of a font without serifs, capitals are about .72 of its size high. */
function drawItem(i) {
  const size = i.size / 0.72, pen = ' stroke="' + i.stroke + '" stroke-width="' + place(i.width) + '" fill="none"/>\n';
  const points = function (list, join) { return list.map(function (p) { return place(p[0]) + join + place(p[1]); }); };
  const circle = function (c) { return '<circle cx="' + place(c[0]) + '" cy="' + place(c[1]) + '" r="' + place(c[2]) +
    '"'; };
  if (i.box) {
    return '<rect x="' + place(i.box[0]) + '" y="' + place(i.box[1]) + '" width="' + place(i.box[2]) + '" height="' +
      place(i.box[3]) + '" fill="' + i.fill + '"/>\n';
  }
  if (i.line && i.line.length === 2) return '<path d="M' + points(i.line, ' ').join('L') + '"' + pen;
  if (i.line) return '<polyline points="' + points(i.line, ',').join(' ') + '"' + pen;
  if (i.disc) return circle(i.disc) + ' fill="' + i.fill + '"/>\n';
  if (i.ring) return circle(i.ring) + pen;
  if (i.show) return '<use href="#' + escape(i.show) + '" x="' + place(i.at[0]) + '" y="' + place(i.at[1]) + '"/>\n';
  if (i.picture) {
    return '<defs><image id="' + escape(i.picture) + '" width="' + i.size[0] + '" height="' + i.size[1] +
      '" preserveAspectRatio="none" style="image-rendering:pixelated" href="' + i.png + '"/></defs>\n';
  }
  return '<text x="' + place(i.at[0]) + '" y="' + place(i.at[1]) + '" font-size="' + place(size) + '"' +
    (i.anchor === 'start' ? '' : ' text-anchor="' + i.anchor + '"') + ' fill="' + i.fill + '">' + rich(i.text, size) +
      '</text>\n';
}

function draw(list) {
  const size = list.width + ' ' + list.height;
  return '<svg xmlns="http://www.w3.org/2000/svg" width="' + list.width + '" height="' + list.height +
    '" viewBox="0 0 ' + size +
    '" font-family="sans-serif" stroke-linecap="round" stroke-linejoin="round" xml:space="preserve">\n' +
    '<rect width="100%" height="100%" fill="#ffffff"/>\n' + list.items.filter(Boolean).map(drawItem).join('') +
      '</svg>\n';
}

return {chart: chart, heat: heat, together: together, draw: draw, heatPixels: heatPixels, png: png,
  linearTicks: linearTicks,
  logTicks: logTicks, number: number,
  fixed: fixed, duration: duration, percent: percent, power: power, escape: escape, rich: rich, colour: colour,
  heatColour: heatColour, greyColour: greyColour, css: css};
})();
if (typeof module !== 'undefined') module.exports = bisPlot;
