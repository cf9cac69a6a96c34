// Linearly transformed cosines (Heitz, Dupuy, Hill and Neubelt 2016): densities of directions that
// approximate glossy reflections. In another space they are cosines, so that closed forms and sampling of
// polygons are possible there.
//
// The frame is that of the normal, with the x axis towards the mirror direction. The matrix from cosines to
// the lobe has the rows (width_x, 0, shift), (0, width_y, 0), (0, 0, 1). It maps the horizon to itself:
// nothing is lost below it, one clipping serves both spaces, and near the horizon the density is proportional
// to the cosine, as for reflections.
#ifndef PENUMBRA_LTC_H
#define PENUMBRA_LTC_H
#include "kernels/math/math.h"
#include "kernels/math/vec3.h"

PENUMBRA_NAMESPACE_BEGIN

/// The matrix.
STRUCT(Ltc) { float width_x, width_y, shift; };

/// The matrix from the fields of a cell, see LTC_CELL_FIELDS, for roughness alpha > 0 and a wo at `cosine` in
/// [0, 1].
FN Ltc make_ltc(float lean, float width_x, float width_y, float alpha, float cosine) {
  const float c = max_f(cosine, 1e-6f), s = safe_sqrt((1.0f - c) * (1.0f + c));
  const float sine = s * lean, upright = safe_sqrt(1.0f - sine * sine);
  Ltc ltc;
  ltc.shift = (s * upright - c * sine) / (c * upright + s * sine);
  ltc.width_x = 2.0f * alpha * width_x * (1.0f + ltc.shift * ltc.shift);
  ltc.width_y = 2.0f * alpha * width_y;
  return ltc;
}

/// Rotates a unit direction from the normal's frame to the frame of the lobe of `wo`, both in the normal's
/// frame. If wo is the normal, any axis will do: the lobe is round.
FN vec3 to_lobe_frame(vec3 wo, vec3 w) {
  const float s2 = wo.x * wo.x + wo.y * wo.y;
  const bool leans = s2 > 0.0f;
  const float inverse = 1.0f / SQRT(leans ? s2 : 1.0f);
  const float x = leans ? -wo.x * inverse : 1.0f, y = leans ? -wo.y * inverse : 0.0f;
  return make_vec3(x * w.x + y * w.y, x * w.y - y * w.x, w.z);
}
FN vec3 from_lobe_frame(vec3 wo, vec3 w) {
  const float s2 = wo.x * wo.x + wo.y * wo.y;
  const bool leans = s2 > 0.0f;
  const float inverse = 1.0f / SQRT(leans ? s2 : 1.0f);
  const float x = leans ? -wo.x * inverse : 1.0f, y = leans ? -wo.y * inverse : 0.0f;
  return make_vec3(x * w.x - y * w.y, y * w.x + x * w.y, w.z);
}

/// From the lobe's frame to the space of cosines, and back; the results are not normalised.
FN vec3 to_cosine_space(Ltc ltc, vec3 w) {
  return make_vec3((w.x - ltc.shift * w.z) / ltc.width_x, w.y / ltc.width_y, w.z);
}
FN vec3 from_cosine_space(Ltc ltc, vec3 w) {
  return make_vec3(ltc.width_x * w.x + ltc.shift * w.z, ltc.width_y * w.y, w.z);
}

/// Pdf per solid angle of the unit direction w in the lobe's frame, over the cosine w.z. Widths must be above
/// 0.
FN float ltc_density_over_cosine(Ltc ltc, vec3 w) {
  const vec3 c = to_cosine_space(ltc, w);
  const float d2 = dot3(c, c);
  return INV_PI_F / (ltc.width_x * ltc.width_y * (d2 * d2));
}

PENUMBRA_NAMESPACE_END
#endif
