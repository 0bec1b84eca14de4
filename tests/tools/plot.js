/* SPDX-License-Identifier: BSD-2-Clause */
/* plot: what tests/tools/test_plot.c asks of docs/live/plot.js, under node:
 *     node plot.js numbers < FILE     "v digits" a line: printed by number, fixed, percent and duration
 *     node plot.js drawing NAME       an SVG, in which places can be worked out by hand */
'use strict';
const plot = require('../../docs/live/plot.js');
const fs = require('fs');

function numbers() {
  for (const line of fs.readFileSync(0, 'utf8').trim().split('\n')) {
    const v = +line.split(' ')[0], digits = +line.split(' ')[1];
    console.log([plot.number(v, digits), Math.abs(v) < 1e20 ? plot.fixed(v, digits) : '-', plot.percent(Math.abs(v)),
      plot.duration(Math.abs(v))].join('|'));
  }
}

/* A field of 3 x 2: 1 is the hottest, 0.01 the coldest, 0 is below. */
const field = {title: 'A <map>', columns: 3, rows: 2, width: 300, height: 200, values: [1, 0.1, 0.01, 0, 1, NaN],
  lo: 0.01, hi: 1, log: true,
  scale: false};
const drawings = {
  /* The paper's inside is [x.from, x.to] x [y.from, y.to]: the test reads it from the axis. */
  line: {title: 'A & B', text: 'falls', width: 600, height: 300, x: {log: true, min: 1, max: 100}, y: {min: 0, max: 4},
    series: [{kind: 'line', x: [1, 10, 0, 100], y: [4, 2, 1, 0], label: 'a', colour: 'em'},
      {kind: 'points', x: [10, NaN], y: [1, 1], label: 'b<'}]},
  bars: {title: 'bars', x: {min: 0, max: 4}, y: {min: 0, max: 10},
    series: [{kind: 'bars', x: [1, 3], y: [5, 10], width: 1}]},
  steps: {title: 'steps', x: {min: 0, max: 2}, y: {min: 0, max: 10},
    series: [{kind: 'steps', x: [0, 1, 2], y: [10, 5]}]},
  nothing: {title: 'nothing'},
  field: field,
  alone: {title: 'alone', standalone: true, x: {label: 'x^2'}, y: {label: 'q`L'}, marks: [{y: 2, label: 'here'}],
    series: [{kind: 'errors', x: [1, 2], y: [2, 3], lo: [1, 2], hi: [3, 4]}, {kind: 'area', x: [1, 2], y: [1, 2]}]},
};

/* Each kind of item that draw takes. */
const list = {width: 320, height: 200, items: [null, {box: [-1, 2.25, 30, 0.5], fill: '#ffffff'},
  {box: [1 / 3, 2 / 3, 1234.567, 1e-9], fill: '#000000'},
  {line: [[1, 2], [1000.5, -4]], width: 1.5, stroke: '#000000'},
  {line: [[0, 1], [10, 2], [20.5, 3]], width: 1, stroke: '#000000'},
  {disc: [3, 4, 5], fill: '#ff0000'}, {ring: [3, 4, 5], width: 2, stroke: '#0000ff'},
  {text: 'a<b & "c"', at: [30, 80], size: 18, anchor: 'start', fill: '#000000'},
  {text: 'HIH', at: [30, 80], size: 18, anchor: 'middle', fill: '#000000'},
  {text: 'A^B C`D,E`F)G^H`I^ J', at: [0, 0], size: 10, anchor: 'end', fill: '#000000'},
  {picture: 'map', size: [30, 20], png: 'data:image/png;base64,AAAA'}, {show: 'map', at: [7, 8]}]};

if (process.argv[2] === 'numbers') numbers();
else if (process.argv[3] === 'list') console.log('<!DOCTYPE html>' + plot.draw(list));
else if (process.argv[3] === 'pixels') console.log(Array.from(plot.heatPixels(field).rgb).join(' '));
else if (process.argv[3] === 'png') console.log(plot.png(3, 2, plot.heatPixels(field).rgb));
else console.log('<!DOCTYPE html>' + plot[process.argv[3] === 'field' ? 'heat' : 'chart'](drawings[process.argv[3]]));
