/* SPDX-License-Identifier: BSD-2-Clause */
/* scenes: what the figures of chapter 4 look at: three balls and a wall on a floor, under the page's map or the
 * visitor's own.
 *
 * bisScene(options) returns a scene's text: integrator (a line), asprinted ("E6"), width, height, n (the
 * exponent of two balls), ks and kd (their shares), map, sampler. */
'use strict';
function bisScene(options) {
  const o = Object.assign({integrator: '', asprinted: '', width: 120, height: 80, n: 30, ks: 0.6, kd: 0.3,
    map: bisFigure.map, sampler: 'stratified'}, options);
  return (o.asprinted ? 'Option "string asprinted" ["' + o.asprinted + '"]\n' : '') +
    'Film "rgb" "integer xresolution" ' + o.width + ' "integer yresolution" ' + o.height + '\n' +
    'Sampler "' + o.sampler + '" "integer pixelsamples" 1\n' + o.integrator + '\n' +
    'Scale -1 1 1\nLookAt 0 -6 2.2  0 0 0.55  0 0 1\nCamera "perspective" "float fov" 32\nAccelerator "grid"\n' +
    'WorldBegin\n' +
    'AttributeBegin\nRotate 25 0 0 1\nLightSource "infinite" "string filename" "' + o.map + '"\nAttributeEnd\n' +
    'Material "phong" "rgb Kd" [0.45 0.42 0.38] "rgb Ks" [0.1 0.1 0.1] "float exponent" 10\n' +
    'Shape "disk" "float radius" 9\n' +
    'Material "phong" "float Kd" ' + o.kd + ' "float Ks" ' + o.ks + ' "float exponent" ' + o.n + '\n' +
    'AttributeBegin\nTranslate -1.25 0 0.7\nShape "sphere" "float radius" 0.7\nAttributeEnd\n' +
    'AttributeBegin\nTranslate 1.3 -0.2 0.6\nShape "sphere" "float radius" 0.6\nAttributeEnd\n' +
    'Material "phong" "rgb Kd" [0.5 0.2 0.12] "float Ks" 0.2 "float exponent" 200\n' +
    'AttributeBegin\nTranslate 0.1 -1.1 0.35\nShape "sphere" "float radius" 0.35\nAttributeEnd\n' +
    'Shape "trianglemesh" "point3 P" [-0.6 1 0  0.9 1.3 0  0.9 1.3 2  -0.6 1 2] "integer indices" [0 1 2 0 2 3]\n';
}
/* The calls that open this scene as a stage and go to a pixel of it. */
function bisStage(options, x, y) {
  return [['bis_flat_stage_open', 'stage', 'scene', ['text=' + bisScene(options)]],
    ['bis_flat_stage_at', 'stage', x, y, 8]];
}
/* The calls that make a map of so many columns; bisSmall is the name that they open, for bis_flat_render_with. `exact`
 * sums over all of a map at every pixel, so pictures are made under small ones. */
const bisSmall = (map, columns) => map + ', ' + columns + ' columns';
const bisShrink = (map, columns) => [['bis_flat_light_open_as', map, map, []],
  ['bis_flat_light_shrink', bisSmall(map, columns), map, columns]];
