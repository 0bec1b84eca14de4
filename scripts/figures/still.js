/* SPDX-License-Identifier: BSD-2-Clause */
/* still: NAME.svg beside each NAME.json that `figures` has written (docs/live.md), by docs/live/plot.js, under node; of
 * a figure of chapter 5 with rows of equal time and rays also NAME-time.svg, a part of the row of equal time.
 *     node scripts/figures/still.js FILE.json... */
'use strict';
const plot = require('../../docs/live/plot.js');
const fs = require('fs'), zlib = require('zlib'), path = require('path');

const INK = '#1f2129', FAINT = '#737885', WHITE = '#ffffff';
const COLOUR = ['#3361b8', '#e58021', '#389459', '#b8385c'], LIGHT = ['#d4d9e9', '#f6ddd4', '#d5e1d8', '#e9d5d8'];

function box(x, y, width, height, fill) { return {box: [x, y, width, height], fill: fill}; }
function line(points, width, stroke) { return {line: points, width: width, stroke: stroke}; }
function disc(x, y, r, fill) { return {disc: [x, y, r], fill: fill}; }
function text(x, y, size, anchor, fill, words) { return {text: words, at: [x, y], size: size, anchor: anchor,
  fill: fill}; }

/* ---- 3.3, 3.4: P, and what is made of it ---- */

function bars(P, x0, y0, scale) {
  const list = P.map(function (p, i) {
    const h = Math.trunc(p * scale), x = x0 + 60 * i;
    return [box(x, y0 - h, 48, h, COLOUR[i]), text(x + 24, y0 - h - 6, 11, 'middle', INK, plot.fixed(p, 1)),
      text(x + 24, y0 + 20, 11, 'middle', INK, String(i))];
  });
  return list.flat().concat(line([[x0 - 10, y0], [x0 + 60 * P.length, y0]], 1.5, INK));
}

function marsaglia(d) {
  const cells = d.list.map(function (item, i) {
    const x = 330 + 37 * i;
    return [box(x, 110, 33, 60, COLOUR[item]), text(x + 16.5, 147, 14, 'middle', WHITE, String(item)),
      text(x + 16.5, 192, 10, 'middle', FAINT, String(i + 1))];
  });
  return plot.draw({width: 720, height: 260, items: [text(30, 30, 12, 'start', INK, 'P')].concat(bars(d.P, 40, 215,
    380),
    text(330, 30, 12, 'start', INK, 'L: one integer in [1, 10] is one look-up'), cells.flat())});
}

function alias(d) {
  const y0 = 240, scale = 440, full = 160, cutoff = y0 - 0.25 * scale; /* no number touches the line */
  const bins = d.prob.map(function (prob, i) {
    const x = 370 + 66 * i, h = Math.round(full * prob), filled = h < full;
    return [filled && box(x, y0 - full, 56, full - h, LIGHT[d.alias[i]]), box(x, y0 - h, 56, h, COLOUR[i]),
      text(x + 28, y0 - h / 2 + 5, 11, 'middle', WHITE, plot.fixed(prob, 1)),
      filled && text(x + 28, y0 - full + (full - h) / 2 + 5, 13, 'middle', INK, String(d.alias[i])),
      text(x + 28, y0 + 20, 11, 'middle', INK, String(i))];
  });
  return plot.draw({width: 660, height: 290, items: [text(30, 30, 12, 'start', INK, 'P and the cutoff 1/N')].concat(
    bars(d.P, 40, y0, scale), line([[30, cutoff], [280, cutoff]], 1.5, FAINT), text(286, cutoff + 4, 10, 'start',
      FAINT, '1/N'),
    text(360, 30, 12, 'start', INK, 'prob (full) and alias (light)'), bins.flat())});
}

/* ---- 3.8, 3.9: Phong ---- */

function lobes(d) {
  const x = 240, y = 290, length = 210, diagonal = length * Math.sqrt(0.5), scale = 240 / (21 / (2 * Math.PI));
  const items = [line([[x - length, y], [x + length, y]], 2, INK), line([[x, y], [x, y - length]], 1, FAINT),
    line([[x, y], [x - diagonal, y - diagonal]], 1, FAINT), line([[x, y], [x + diagonal, y - diagonal]], 1, FAINT),
    text(x - 4, y - length - 6, 11, 'start', FAINT, 'n'), text(x - diagonal - 4, y - diagonal, 11, 'end', FAINT, 'eye'),
    text(x + 1.08 * diagonal, y - 1.08 * diagonal + 4, 11, 'start', FAINT, 'R')];
  d.lobes.forEach(function (l, i) {
    items.push(line(l.angle.map(function (a, k) { return [x + scale * l.f[k] * Math.sin(a),
      y - scale * l.f[k] * Math.cos(a)]; }),
      2, COLOUR[i]), text(420, 60 + 22 * i, 11, 'start', COLOUR[i],
        l.ks ? 'specular, n = ' + l.exponent : 'diffuse: 1/pi'));
  });
  return plot.draw({width: 560, height: 330, items: items});
}

function draws(d) {
  const y = 170, radius = 120, titles = ['diffuse', 'specular, n = 50', 'k`s = k`d = 0.5'];
  const items = d.materials.map(function (m, i) {
    const x = 145 + 275 * i;
    return [{ring: [x, y, radius], width: 1.5, stroke: INK}, disc(x, y, 2.5, INK)].concat(
      m.x.map(function (v, k) { return disc(x + radius * v, y - radius * m.y[k], 2.2,
        COLOUR[m.is_specular[k] ? 3 : 0]); }),
      text(x, 32, 12, 'middle', INK, titles[i]),
      text(x, 312, 9, 'middle', FAINT, m.specular + ' specular, ' + m.diffuse + ' diffuse, ' + m.below + ' below'));
  });
  return plot.draw({width: 840, height: 330, items: items.flat()});
}

/* ---- 4.3 to 4.5: one dimension ---- */

const X0 = 50, W = 620, H = 250, Y0 = 300;

function curve(values, factor, top, width, stroke) {
  return line(values.map(function (v, i) { return [X0 + W * i / (values.length - 1), Y0 - H * v * factor / top]; }),
    width, stroke);
}

function ground() { return line([[X0, Y0], [X0 + W, Y0]], 1.5, INK); }

function rejection(d) {
  const top = 1.05 * d.most_of_brdf * d.most_of_map;
  return plot.draw({width: 720, height: 350, items: d.x.map(function (x, i) {
    return disc(X0 + W * x, Y0 - H * d.y[i] / top, 2, d.accepted[i] ? COLOUR[2] : '#d4a5ad');
  }).concat(curve(d.map, d.most_of_brdf, top, 2, FAINT), curve(d.product, 1, top, 2.5, COLOUR[2]), ground(),
    text(X0, 24, 11, 'start', FAINT, 'c q(x)'), text(X0 + 60, 24, 11, 'start', COLOUR[2], 'p(x)'),
    text(X0 + 120, 24, 11, 'start', INK, plot.fixed(100 * d.share,
      0) + '% of ' + d.candidates + ' candidates accepted; integrated: ' +
      plot.fixed(100 * d.integrated, 0) + '%'))});
}

function bounds(d) {
  const top = 1.02 * d.most_of_brdf * d.most_of_map;
  return plot.draw({width: 720, height: 350, items: [curve(d.brdf, d.most_of_map, top, 2, COLOUR[3]),
    curve(d.map, d.most_of_brdf, top, 2, COLOUR[0]), curve(d.product, 1, top, 2.5, COLOUR[2]), ground(),
    text(X0, 24, 11, 'start', COLOUR[3], 'L`max f: ' + plot.fixed(100 * d.accepted_from_brdf, 0) + '% accepted'),
    text(X0 + 230, 24, 11, 'start', COLOUR[0], 'f`max L: ' + plot.fixed(100 * d.accepted_from_map, 0) + '% accepted'),
    text(X0 + 460, 24, 11, 'start', COLOUR[2], 'f L')]});
}

function resampling(d) {
  const top = 1.02 * Math.max(d.most_of_product, 1);
  const marks = d.x.map(function (x, i) {
    const colour = COLOUR[d.times[i] ? 3 : 0], at = X0 + W * x;
    return [disc(at, Y0 + 20, 2.2 * Math.sqrt(d.weight[i]), colour),
      d.times[i] > 0 && line([[at, Y0 + 12], [at, Y0 - H * d.at_product[i] / top]], 1.5, colour)];
  });
  return plot.draw({width: 720, height: 350, items: [curve(d.brdf, 1, top, 2, FAINT), curve(d.product, 1, top, 2.5,
    COLOUR[2]),
    ground()].concat(marks.flat(), text(X0, 24, 11, 'start', INK,
      d.candidates + ' candidates from q`f, areas by weight; ' + d.chosen +
    ' chosen for rays'), text(X0 + 480, 24, 11, 'start', FAINT, 'q`f'), text(X0 + 530, 24, 11, 'start', COLOUR[2],
      'f L'))});
}

/* ---- chapter 5: a column for each method, below each picture its relative error in false colours ---- */

const GAP = 6, HEAD = 58, LINE = 44, FOOT = 10;
const ROWS = {printed: 'as printed', time: 'equal time', rays: 'equal rays'};
const HEAT = {lo: 0.01, hi: 10, log: true, night: false}; /* 0.01 or less is dark, 10 or more pale */

/* Small pictures are enlarged, for the words above them to fit. */
function sizeOf(d) {
  const zoom = d.width < 150 ? 2 : 1;
  return [zoom * d.width, zoom * d.height];
}

function picture(name, size, x, y, png) { return [{picture: name, size: size, png: png}, {show: name, at: [x, y]}]; }

function errors(d, values) {
  const pixels = plot.heatPixels(Object.assign({columns: d.width, rows: d.height, values: values}, HEAT));
  return plot.png(d.width, d.height, pixels.rgb, zlib.deflateSync);
}

function scaleOfErrors(x, y) {
  const height = 150, items = [text(x, y + 12, 8, 'start', FAINT, 'relative error')];
  for (let i = 0; i < height; i += 2) items.push(box(x, y + 30 + i, 16, 2,
    'rgb(' + plot.heatColour(1 - (i + 1) / height).join() + ')'));
  for (const v of [0.01, 0.1, 1, 10]) {
    const at = y + 30 + height * (1 - Math.log(v / HEAT.lo) / Math.log(HEAT.hi / HEAT.lo));
    items.push(line([[x + 16, at], [x + 20, at]], 1, FAINT), text(x + 25, at + 4, 8, 'start', FAINT, String(v)));
  }
  return items;
}

function reference(d, row, y) {
  const size = sizeOf(d);
  return [text(GAP, y + 16, 10, 'start', INK, ROWS[row]), text(GAP, y + 34, 7, 'start', FAINT, 'converged')].concat(
    picture('converged-' + row, size, GAP, y + LINE, d.reference), scaleOfErrors(GAP, y + LINE + size[1] + GAP));
}

function trial(d, m, t, x, y) {
  const size = sizeOf(d), name = m.method + '-' + t.row, number = plot.number;
  return picture(name, size, x, y + LINE, t.picture).concat(picture(name + '-errors', size, x, y + LINE + size[1],
    errors(d, t.errors)),
    text(x, y + 16, 9, 'start', INK, m.method + ' ' + t.N + (t.M ? '/' + t.M : '')), text(x, y + 34, 7, 'start', FAINT,
      number(t.us, 3) +
    ' us, ' + number(t.rays, 3) + ' rays, ' + (t.relmse < 10 ? number(t.relmse, 2) : plot.fixed(t.relmse, 0))));
}

/* The rows of these names from `top`, with these methods. */
function rowsOf(d, rows, methods, top) {
  const size = sizeOf(d), step = 2 * size[1] + LINE + GAP;
  return rows.map(function (row, r) {
    return reference(d, row, top + r * step).concat(methods.map(function (m, c) {
      const t = m.trials.find(function (t) { return t.row === row; });
      return trial(d, m, t, GAP + (c + 1) * (size[0] + GAP), top + r * step);
    }).flat());
  }).flat();
}

function sheet(d) {
  const size = sizeOf(d), rows = d.methods[0].trials.map(function (t) { return t.row; });
  return plot.draw({width: GAP + (1 + d.methods.length) * (size[0] + GAP),
    height: HEAD + rows.length * (2 * size[1] + LINE + GAP) + FOOT,
    items: [text(GAP, 24, 13, 'start', INK, d.title), text(GAP, 46, 8, 'start', FAINT,
      'us and rays a shaded pixel, relMSE; below each picture, its error')].concat(rowsOf(d, rows, d.methods, HEAD))});
}

function strip(d) {
  const size = sizeOf(d), methods = d.methods.filter(function (m) { return m.in_strip; });
  return plot.draw({width: GAP + (1 + methods.length) * (size[0] + GAP), height: LINE + 2 * size[1] + FOOT,
    items: rowsOf(d, ['time'], methods, 0)});
}

/* ---- README's panel: pictures of 400 x 300, two in a row, each above its words ---- */

function panel(d) {
  return plot.draw({width: 812, height: 684, items: d.pictures.map(function (p, i) {
    const x = 412 * (i % 2), y = 346 * Math.floor(i / 2);
    return picture(p.name, [400, 300], x, y, p.png).concat(text(x + 4, y + 322, 11, 'start', '#1c1f25', p.words));
  }).flat()});
}

const drawings = {3.3: marsaglia, 3.4: alias, 3.8: lobes, 3.9: draws, 4.3: rejection, 4.4: bounds, 4.5: resampling,
  methods: panel};
for (const file of process.argv.slice(2)) {
  const d = JSON.parse(fs.readFileSync(file, 'utf8')), base = file.replace(/\.json$/, '');
  fs.writeFileSync(base + '.svg', (d.methods ? sheet : drawings[path.basename(base)])(d));
  if (d.methods && d.methods[0].trials.length > 1) fs.writeFileSync(base + '-time.svg', strip(d));
}
