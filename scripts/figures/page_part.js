/* SPDX-License-Identifier: BSD-2-Clause */
/* page_part: a part of the page of `bis pixel --html` as a page of its own, by that page's own script under node.
 *     node scripts/figures/page_part.js pixel.html maps|samples > part.html */
'use strict';
const fs = require('fs');
const text = fs.readFileSync(process.argv[2], 'utf8');
const scripts = Array.from(text.matchAll(/<script>\n([^]*?)<\/script>/g), function (m) { return m[1]; });
const styles = Array.from(text.matchAll(/<style>\n([^]*?)<\/style>/g), function (m) { return m[1]; });
const data = text.match(/<script type="application\/json" id="data">([^]*?)<\/script>/)[1];
const places = {data: {textContent: data}, page: {}};
const document = {head: {appendChild: function (e) { styles.push(e.textContent); }},
  createElement: function () { return {}; },
  getElementById: function (id) { return places[id] || null; }};
const name = process.argv[3], part = {maps: '<div class="maps">${maps()}</div>',
  samples: '<div class="drawing many">${drawing()}</div>'}[name];
const made = '\nreturn `<p><b>${esc(document.title)}.</b> ${KEYS.' + name + '()}</p>' + part + '`';
const body = new Function('document', 'location', 'module', scripts.join('\n') + made)(document,
  {hash: '#all'}, undefined);
process.stdout.write('<!DOCTYPE html><meta charset="utf-8"/><style>' + styles.join('\n') +
  'body{padding:20px 26px}</style>' + body + '\n');
