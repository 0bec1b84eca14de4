/* SPDX-License-Identifier: BSD-2-Clause */
/* page: what a page of bis looks like when its script has run, without a browser: a document that has the page's data
 * and takes what the script makes of them. Prints a page of its own, which the tests read.
 *     node tests/tools/page.js 'build/.../report.html#part' */
'use strict';
const [path, hash] = process.argv[2].split('#'), text = require('fs').readFileSync(path, 'utf8');
const scripts = Array.from(text.matchAll(/<script>\n([^]*?)<\/script>/g), function (m) { return m[1]; });
const data = text.match(/<script type="application\/json" id="data">([^]*?)<\/script>/)[1];
const places = {data: {textContent: data}, page: {innerHTML: ''}}, sheets = [];
const document = {head: {appendChild: function (e) { sheets.push(e.textContent); }},
  createElement: function () { return {}; },
  getElementById: function (id) { return places[id] || null; }};
new Function('document', 'location', 'module', scripts.join('\n'))(document, {hash: hash ? '#' + hash : ''}, undefined);
process.stdout.write('<!DOCTYPE html><html><head><title>' + document.title.replace(/[&<>]/g, '_') +
  '</title></head><body>' +
  places.page.innerHTML + '</body></html>\n');
