/* SPDX-License-Identifier: BSD-2-Clause */
/* calls: the functions of bis/flat/*.h that figures call, each with its return value and its arguments, a letter each.
 * Returned: s a status, v nothing, r a double, i an int. Taken: i int, n size_t or uint32_t, r double, z text, l a list
 * of texts; d f u b an array (double, float, uint32_t, uint8_t) that is read; D F U B one that is written; I an array
 * of int that is written; h what another call has opened; O what this one opens; 0 a NULL. say and size follow where a
 * status is returned. ~ before the rest: a function of libm reaches the last bits, so the hash leaves them out, and a
 * test compares the numbers to 1e-9. */
'use strict';
var bisCalls = {
  "bis_flat_uniform": "v nnnD",
  "bis_flat_histogram": "s nddrnU",
  "bis_flat_bits": "s UUBU",
  "bis_flat_marsaglia": "s nunUU",
  "bis_flat_alias_build": "s ndDUD",
  "bis_flat_alias_stage": "s ndnUD",
  "bis_flat_alias_pmf": "s ndDD",
  "bis_flat_alias_few_bits": "s ndiDDD",
  "bis_flat_alias_sample": "s ndundU",
  "bis_flat_cdf_build": "s ndDUU",
  "bis_flat_cdf_sample": "s ndndUUU",
  "bis_flat_fit": "~s ndnuDD",
  "bis_flat_light_open_as": "s Ozl",
  "bis_flat_light_shape": "v hI",
  "bis_flat_light_pixels": "v hF",
  "bis_flat_light_power": "r h",
  "bis_flat_light_sample": "s hndFFD",
  "bis_flat_light_find": "s hnfU",
  "bis_flat_light_shrink": "s Ohi",
  "bis_flat_light_density": "s hDDD",
  "bis_flat_light_rows": "s hnurUD",
  "bis_flat_light_regions": "s hirUUDDU",
  "bis_flat_bsdf_open": "s Ozddrdd",
  "bis_flat_bsdf_sample": "s hndFB",
  "bis_flat_bsdf_look": "~s hnfFD",
  "bis_flat_bsdf_plane": "~s hdndDD",
  "bis_flat_bsdf_below": "s hnfBU",
  "bis_flat_bsdf_albedo": "~s hdiD",
  "bis_flat_stage_open": "s Ozl",
  "bis_flat_stage_at": "s hiiD",
  "bis_flat_stage_exact": "s hnD",
  "bis_flat_stage_densities": "s hiiFFFFF",
  "bis_flat_stage_candidates": "s hlnnFDUUD",
  "bis_flat_stage_find": "s hiinfU",
  "bis_flat_stage_runs": "s hlnnDD",
  "bis_flat_stage_mis": "~s hlnnD",
  "bis_flat_stage_noises": "s hlnnD",
  "bis_flat_stage_bounds": "s hD",
  "bis_flat_stage_accept": "s hznddDUU",
  "bis_flat_stage_accepted": "s hlnnD",
  "bis_flat_render": "s Ozl0",
  "bis_flat_render_with": "s Ozlh000",
  "bis_flat_picture_shape": "v hI",
  "bis_flat_picture_pass_seconds": "r h",
  "bis_flat_picture_pixels": "v hF",
  "bis_flat_compare": "~s iiffD"
};
if (typeof module !== 'undefined') module.exports = bisCalls;
