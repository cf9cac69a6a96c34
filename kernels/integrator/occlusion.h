// Occlusion integrators. Ambient occlusion is the fraction of directions in which nothing is near the surface
// that the camera sees; reflection occlusion is the same for a lobe about the mirror direction.
// WEIGHTING_NORMALS shows normals instead. Lights and materials have no effect. Step k requests the k-th ray
// from the surface that the camera ray hit.
#ifndef PENUMBRA_INTEGRATOR_OCCLUSION_H
#define PENUMBRA_INTEGRATOR_OCCLUSION_H
#include "kernels/bsdf/phong.h"
#include "kernels/integrator/step.h"

PENUMBRA_NAMESPACE_BEGIN

/// A sample of direction kind DIRECTION_* about the unit normal n; `mirror` is the mirror direction of wo.
FN vec3 occlusion_direction(int kind, float exponent, vec3 n, vec3 mirror, float u, float v) {
  const vec3 cosine = sample_cosine_hemisphere(n, u, v), hemisphere = sample_uniform_hemisphere(n, u, v);
  const vec3 sphere = sample_uniform_sphere(u, v), lobe = sample_cosine_power(mirror, exponent, u, v);
  const vec3 about_normal = select3(kind == DIRECTION_COSINE, cosine, hemisphere);
  const vec3 elsewhere = select3(kind == DIRECTION_SPHERE, sphere, lobe);
  return select3((kind == DIRECTION_COSINE) | (kind == DIRECTION_UNIFORM), about_normal, elsewhere);
}

/// Weight of a direction over its pdf, at this cosine to the normal. The weight is cos / pi, or 1 / (2 pi),
/// above the surface. With DIRECTION_LOBE it is (n + 2) / (2 pi) cos^n alpha cos, where alpha is the angle to
/// the mirror direction and n the exponent.
FN float occlusion_weight(int kind, int weighting, float exponent, float cosine) {
  const float wanted = weighting == WEIGHTING_UNIFORM ? 0.5f : cosine;  // 1 / pi cancels
  const float density = kind == DIRECTION_COSINE ? cosine : (kind == DIRECTION_SPHERE ? 0.25f : 0.5f);
  const float of_lobe = (exponent + 2.0f) / (exponent + 1.0f) * cosine;
  return kind == DIRECTION_LOBE ? of_lobe : wanted / density;
}

/// Sets the radiance of camera rays that hit nothing to the background; with WEIGHTING_NORMALS, of the others
/// to the normal.
STAGE void add_background(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                          const PRIVATE Surfaces* RESTRICT surfaces) {
  const float background = scene->header.integrator.background;
  const int weighting = scene->header.integrator.weighting;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 black = make_vec3(0.0f, 0.0f, 0.0f);
      const vec3 normal = abs3(LOAD_LANE_vec3(surfaces->shading, j));
      const vec3 on_surface = select3(weighting == WEIGHTING_NORMALS, normal, black);
      const vec3 nothing = make_vec3(background, background, background);
      set_radiance(paths, i + j, select3(surfaces->primitive[j] >= 0, on_surface, nothing));
    }
}

STAGE void request_occlusion_rays(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                                  const PRIVATE Surfaces* RESTRICT surfaces, const PRIVATE float* RESTRICT u,
                                  const PRIVATE float* RESTRICT v) {
  const PRIVATE SceneHeader* h = &scene->header;
  const int kind = h->integrator.bsdf_sampling, weighting = h->integrator.weighting;
  const float exponent = h->integrator.exponent, length = h->integrator.ray_length;
  const float share = 1.0f / (float)h->integrator.emitter_samples;
  const PathState fields = *paths;  // see step.h
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      const vec3 mirror = sub(scale(s.shading, 2.0f * dot3(s.shading, s.wo)), s.wo);
      const vec3 wi = occlusion_direction(kind, exponent, s.shading, mirror, u[j], v[j]);
      const float cosine = dot3(s.shading, wi);
      const bool above = is_hit(s) & (cosine > 0.0f) & !is_beneath(s, wi) & (weighting != WEIGHTING_NORMALS);
      const float weight = share * occlusion_weight(kind, weighting, exponent, above ? cosine : 1.0f);
      set_shadow_origin(&fields, i + j, leave_surface(s.p, s.geometric, s.error, wi));
      set_shadow_direction(&fields, i + j, wi);
      set_shadow_radiance(&fields, i + j, make_vec3(weight, weight, weight));
      set_shadow_tmax(&fields, i + j, above ? length : -1.0f);
      set_shadow_skip(&fields, i + j, s.primitive);
    }
}

/// The k-th step.
CALLED_FN void step_occlusion(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count, int k,
                              const PRIVATE SlotState* slots) {
  const PRIVATE SceneHeader* h = &scene->header;
  const int samples = h->integrator.emitter_samples;
  Surfaces surfaces;
  float u[LANES], v[LANES];
  for (int i = 0; i < count; i += LANES) {
    if (k == 0) {
      find_surfaces(scene, paths, i, &surfaces);
      add_background(scene, paths, i, &surfaces);
    }
    if (k == 0 && samples > 1) keep_surfaces(paths, i, &surfaces);
    if (k > 0) load_kept_surfaces(paths, i, &surfaces);
    if (NEEDS(scene, INSTANCES)) keep_at_instances(paths, i, k, &surfaces);
    if (k == 0) {
      Closures closures;
      for (int j = 0; j < LANES; j++) store_closure(&closures, j, black_closure());
      if (NEEDS(scene, LAYERS)) resolve_closures(scene, &surfaces, &closures);
      record_first_hits(scene, &surfaces, &closures, paths, i, slots);
    }
    sample_pair(h->sampler.kind, sequence_length(h), nth_point(step_point(PAIR_BSDF), samples, k), paths, i,
                u, v);
    begin_steps(paths, i, &surfaces, k + 1 >= samples);
    request_occlusion_rays(scene, paths, i, &surfaces, u, v);
  }
}

PENUMBRA_NAMESPACE_END
#endif
