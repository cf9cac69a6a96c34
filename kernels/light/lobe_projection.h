// Sampling of triangle lights for glossy closures with control lobes (bsdf/control_lobes.h). The Lambert lobe
// uses projected solid angle; the linearly transformed cosine uses projected solid angle in the space where
// it is a cosine, which samples the lobe's density clipped to the light. Either covers all of the light that
// the receiver sees, so any mixture of both is valid. The mixture is weighted by the closed forms of what the
// two lobes receive.
#ifndef PENUMBRA_LOBE_PROJECTION_H
#define PENUMBRA_LOBE_PROJECTION_H
#include "kernels/bsdf/control_lobes.h"
#include "kernels/light/projected_light.h"

PENUMBRA_NAMESPACE_BEGIN

// clang-format off
#define RECEIVER_LOBES_FIELDS(F, a)                                           \
  F(a, vec3, normal)    /* unit, shading normal */                            \
  F(a, vec3, wo)        /* unit, towards the camera or the previous vertex */ \
  F(a, vec3, matrix)    /* width_x, width_y, shift: see Ltc */                \
  F(a, float, specular) /* fraction of the transformed cosine in the albedo; 0: no lobe */
// clang-format on
LANE_RECORD(ReceiverLobes, ReceiverLobesLanes, receiver_lobes, RECEIVER_LOBES_FIELDS)

/// A closure without control lobes is treated as Lambert. If the normal is 0, there is no projection.
FN ReceiverLobes receiver_lobes(vec3 normal, vec3 wo, ControlLobes c) {
  const float diffuse = (c.diffuse.x + c.diffuse.y) + c.diffuse.z;
  const float specular = (c.specular.x + c.specular.y) + c.specular.z, sum = diffuse + specular;
  const bool leans = (c.width_x > 0.0f) & (specular > 0.0f) & (dot3(normal, normal) > 0.0f);
  ReceiverLobes r;
  r.normal = normal;
  r.wo = wo;
  r.matrix = select3(leans, make_vec3(c.width_x, c.width_y, c.shift), make_vec3(1.0f, 1.0f, 0.0f));
  r.specular = leans ? specular / sum : 0.0f;
  return r;
}
FN Ltc ltc_of_receiver(ReceiverLobes r) {
  Ltc ltc;
  ltc.width_x = r.matrix.x;
  ltc.width_y = r.matrix.y;
  ltc.shift = r.matrix.z;
  return ltc;
}

/// The axes of the cosine's space as functions of a world-space vector, in double: x and y scale by the
/// inverse width of a narrow lobe, which loses digits.
typedef struct {
  vec3d x, y, z;
} CosineAxes;

FN CosineAxes cosine_axes(ReceiverLobes r) {
  const vec3 wo = to_frame(r.normal, r.wo), along = to_lobe_frame(wo, make_vec3(1.0f, 0.0f, 0.0f));
  // The lobe's frame is rotated about the normal; this is the rotation from the normal's frame.
  const vec3d s = widen3(from_frame(r.normal, 1.0f, 0.0f, 0.0f)),
              t = widen3(from_frame(r.normal, 0.0f, 1.0f, 0.0f));
  const double c = along.x, n = along.y;
  const vec3d tangent = add_scaled_d(scale_d(s, c), -n, t), across = add_scaled_d(scale_d(s, n), c, t);
  CosineAxes axes;
  axes.z = widen3(r.normal);
  axes.x = scale_d(add_scaled_d(tangent, -(double)r.matrix.z, axes.z), 1.0 / (double)r.matrix.x);
  axes.y = scale_d(across, 1.0 / (double)r.matrix.y);
  return axes;
}
FN vec3d in_axes(CosineAxes axes, vec3d v) {
  return make_vec3d(dot3_d(axes.x, v), dot3_d(axes.y, v), dot3_d(axes.z, v));
}
FN vec3 narrow3(vec3d v) { return make_vec3((float)v.x, (float)v.y, (float)v.z); }

/// Integral of the transformed cosine's density over a triangle light as seen from the point, times pi, in
/// double; 0 for other kinds.
FN double light_lobe(Light light, double px, double py, double pz, CosineAxes axes) {
  const vec3d p = make_vec3d(px, py, pz);
  const vec3d q0 = widen3(light.p0), q1 = widen3(light.p1), q2 = widen3(light.p2);
  const double e = corners_irradiance(in_axes(axes, sub_d(q0, p)), in_axes(axes, sub_d(q1, p)),
                                      in_axes(axes, sub_d(q2, p)), in_axes(axes, sub_d(q1, q0)),
                                      in_axes(axes, sub_d(q2, q1)), in_axes(axes, sub_d(q0, q2)),
                                      make_vec3d(0.0, 0.0, 1.0), light.two_sided != 0);
  return light.kind == LIGHT_TRIANGLE ? e : 0.0;
}

/// A light as both lobes see it.
typedef struct {
  ProjectedPolygon diffuse, specular;  ///< the latter in the cosine's space
  float diffuse_area, specular_area;   ///< more precise areas, see light_irradiance and light_lobe
  float share;  ///< probability of the specular lobe; negative: neither lobe can be used
} LobeProjection;

FN LobeProjection project_lobes(Light light, vec3 from, ReceiverLobes r) {
  const CosineAxes axes = cosine_axes(r);
  const vec3d p = widen3(from);
  const vec3 p0 = light.p0, p1 = light.p1, p2 = light.p2;
  const vec3 q0 = sub(p0, from), q1 = sub(p1, from), q2 = sub(p2, from);
  const bool behind = (light.two_sided != 0) & (dot3(cross3(sub(q1, q0), sub(q2, q0)), q0) > 0.0f);
  const vec3 a = narrow3(in_axes(axes, sub_d(widen3(p0), p)));
  const vec3 b = narrow3(in_axes(axes, sub_d(widen3(p1), p)));
  const vec3 c = narrow3(in_axes(axes, sub_d(widen3(p2), p)));
  LobeProjection l;
  l.diffuse = project_light(light, from, r.normal);
  l.specular = project_triangle(a, select3(behind, c, b), select3(behind, b, c));
  const double diffuse = light_irradiance(light, from.x, from.y, from.z, r.normal.x, r.normal.y, r.normal.z);
  const double specular = light_lobe(light, from.x, from.y, from.z, axes);
  l.diffuse_area = (float)diffuse;
  l.specular_area = (float)specular;
  const bool projected = (light.kind == LIGHT_TRIANGLE) & (light.sampling == EMITTER_PROJECTED);
  const bool by_diffuse = projected & (r.specular < 1.0f) & (l.diffuse.area > 0.0f) & (l.diffuse_area > 0.0f);
  const bool by_specular =
      projected & (r.specular > 0.0f) & (l.specular.area > 0.0f) & (l.specular_area > 0.0f);
  const float d = by_diffuse ? (1.0f - r.specular) * l.diffuse_area : 0.0f;
  const float s = by_specular ? r.specular * l.specular_area : 0.0f, sum = d + s;
  l.share = sum > 0.0f ? s / (sum > 0.0f ? sum : 1.0f) : -1.0f;
  return l;
}

/// Pdf of the mixture over the cosine of wi, a unit world-space direction to the light.
FN float lobes_density_over_cosine(LobeProjection l, ReceiverLobes r, vec3 wi) {
  const vec3 w = to_lobe_frame(to_frame(r.normal, r.wo), to_frame(r.normal, wi));
  const float share = max_f(l.share, 0.0f);
  const float diffuse = (1.0f - share) / (share < 1.0f ? l.diffuse_area : 1.0f);
  const float lobe = PI_F * ltc_density_over_cosine(ltc_of_receiver(r), w);
  return diffuse + share * lobe / (share > 0.0f ? l.specular_area : 1.0f);
}

FN ProjectedEdge select_edge(bool c, ProjectedEdge a, ProjectedEdge b) {
  ProjectedEdge e;
  e.from = select3(c, a.from, b.from);
  e.to = select3(c, a.to, b.to);
  e.g = select3(c, a.g, b.g);
  e.arc = c ? a.arc : b.arc;
  e.winding = c ? a.winding : b.winding;
  return e;
}
FN ProjectedPolygon select_projected(bool c, ProjectedPolygon a, ProjectedPolygon b) {
  ProjectedPolygon p;
  p.e0 = select_edge(c, a.e0, b.e0);
  p.e1 = select_edge(c, a.e1, b.e1);
  p.e2 = select_edge(c, a.e2, b.e2);
  p.e3 = select_edge(c, a.e3, b.e3);
  p.area = c ? a.area : b.area;
  return p;
}

/// Like sample_projected_light, by the mixture.
FN void sample_lobes_light(Light light, LightReceiver r, ReceiverLobes lobes, bool own, float u, float v,
                           PRIVATE LightSamplings* samplings, int j) {
  const LobeProjection l = project_lobes(light, r.p, lobes);
  const bool some = r.has_normal & !own & (l.share >= 0.0f);
  const float share = max_f(l.share, 0.0f);
  const bool specular = u < share;
  const float rest = specular ? share : 1.0f - share;
  const float left = min_f((specular ? u : u - share) / (rest > 0.0f ? rest : 1.0f), ONE_MINUS_EPSILON);
  const vec3 w = sample_projected_polygon(select_projected(specular, l.specular, l.diffuse), left, v);
  const vec3 wo = to_frame(lobes.normal, lobes.wo);
  const vec3 turned = from_lobe_frame(wo, unit3(from_cosine_space(ltc_of_receiver(lobes), w)));
  const vec3 at = select3(specular, turned, w);
  const vec3 wi = from_frame(lobes.normal, at.x, at.y, at.z);
  STORE_LANE_vec3(samplings->wi, j, wi);
  samplings->scale[j] = some ? lobes_density_over_cosine(l, lobes, wi) : -1.0f;
}

/// Like projected_density, for the mixture.
FN float lobes_density(Light light, FoundLight found, ReceiverLobes lobes) {
  const LobeProjection l = project_lobes(light, found.from, lobes);
  const bool some = (found.light >= 0) & (l.share >= 0.0f);
  const float cosine = max_f(dot3(lobes.normal, found.wi), 0.0f);
  return some ? cosine * lobes_density_over_cosine(l, lobes, found.wi) : -1.0f;
}

PENUMBRA_NAMESPACE_END
#endif
