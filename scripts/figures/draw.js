/* SPDX-License-Identifier: BSD-2-Clause */
/* draw: NAME.svg beside each NAME.json that a program of this folder has written, by docs/live/plot.js, under node.
 *     node scripts/figures/draw.js FILE.json... */
'use strict';
const plot = require('../../docs/live/plot.js'), fs = require('fs');
for (const path of process.argv.slice(2)) {
  fs.writeFileSync(path.replace(/\.json$/, '.svg'), plot.draw(JSON.parse(fs.readFileSync(path, 'utf8'))));
}
