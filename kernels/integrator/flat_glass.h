// Flat glass: plates with a thickness, like windows. Light that passes two parallel boundaries goes on in the
// direction that it came from. So light from infinity arrives behind a plate from where it arrives before it,
// dimmed. Shadow rays to such light pass, refracted at both boundaries. Directions that BSDFs sample are
// weighed against them (MIS) by the pdfs at the surface that the path left, as if the plate were not there.
// Whether two boundaries are parallel is seen from the directions, for both kinds of rays alike. All other
// paths through glass are found by directions alone.
#ifndef PENUMBRA_FLAT_GLASS_H
#define PENUMBRA_FLAT_GLASS_H
#include "kernels/bsdf/fresnel.h"
#include "kernels/integrator/step.h"

PENUMBRA_NAMESPACE_BEGIN

// Where a path is, since it left a surface that is not flat glass.
#define GLASS_OUTSIDE 0  // it has met nothing since, or only plates, and is behind them
#define GLASS_WITHIN 1   // within a plate
#define GLASS_LOST 2     // it has met another delta surface, or a boundary that is not parallel

/// Whether the unit directions differ by less than 1e-4, which is far above their rounding errors.
FN bool is_parallel(vec3 a, vec3 b) {
  const vec3 d = sub(a, b);
  return dot3(d, d) < 1e-8f;
}

FN bool is_flat_glass(const PRIVATE Scene* scene, int material) {
  return scene->materials[material].flat_glass != 0;
}

/// Camera rays have no pdf to be weighed.
STAGE void start_without_glass(const PRIVATE PathState* paths, int i) {
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) set_glass(paths, j, GLASS_LOST);
}

/// Follows the next rays of paths that have scattered. Behind a plate, `direction_pdf` is that of the surface
/// before it, with a minus sign.
STAGE void follow_through_glass(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                                const PRIVATE Surfaces* RESTRICT surfaces) {
  const PathState fields = *paths;  // see step.h
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      const vec3 direction = get_ray_direction(&fields, i + j), first = get_glass_direction(&fields, i + j);
      const float pdf = get_direction_pdf(&fields, i + j), first_pdf = get_glass_pdf(&fields, i + j);
      const int before = get_glass(&fields, i + j);
      const bool scatters = pdf != DELTA_PDF;
      const bool crosses = is_flat_glass(scene, s.material) & (dot3(s.geometric, direction) < 0.0f);
      const bool enters = crosses & (before == GLASS_OUTSIDE);
      const bool leaves = crosses & (before == GLASS_WITHIN) & is_parallel(direction, first);
      const int after = enters ? GLASS_WITHIN : (leaves ? GLASS_OUTSIDE : GLASS_LOST);
      set_glass(&fields, i + j, scatters ? GLASS_OUTSIDE : after);
      set_glass_direction(&fields, i + j, select3(scatters, direction, first));
      set_glass_pdf(&fields, i + j, scatters ? pdf : first_pdf);
      set_direction_pdf(&fields, i + j, (leaves & !scatters) ? -first_pdf : pdf);
    }
}

/// Shadow rays towards light from infinity may pass plates. `shadow_glass` is the number of boundaries that
/// they have passed; -1: they pass none.
STAGE void request_through_glass(const PRIVATE PathState* paths, int i,
                                 const PRIVATE LightSamples* RESTRICT lights) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const LightSample light = load_light_sample(lights, j);
      set_shadow_glass(paths, i + j, ((light.tmax >= NO_LIMIT) & !light.delta) ? 0 : -1);
    }
}

/// The shares of light that pass flat glass, and that light in colour, for shadow rays that hit these
/// surfaces. Refracts the rays. Each boundary counts for the depth, as it does for paths.
STAGE void pass_glass(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                      const PRIVATE Surfaces* RESTRICT surfaces, PRIVATE float* RESTRICT shares,
                      PRIVATE PaneTints* RESTRICT light) {
  const int max_depth = scene->header.integrator.max_depth;
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      const vec3 direction = get_ray_direction(&fields, i + j);
      const vec3 first = get_shadow_direction(&fields, i + j);
      const int passed = get_shadow_glass(&fields, i + j), depth = get_depth(&fields, i + j);
      const float before = get_shadow_transmittance(&fields, i + j), plain = shares[j];
      const bool under_way = get_ray_tmax(&fields, i + j) > 0.0f, hit = s.primitive >= 0;
      const bool within = (passed > 0) & ((passed & 1) != 0);
      const int material = hit ? s.material : 0;
      const bool glass = hit & is_flat_glass(scene, material);
      const float ior = glass ? scene->materials[material].ior : 1.0f;
      const vec3 colour = load3(&scene->materials[material].transmitted);

      const float cosine = dot3(s.shading, s.wo);
      const DielectricFresnel f = dielectric_fresnel(max_f(cosine, 0.0f), ior);
      const vec3 along = add_scaled(negate(s.wo), cosine, s.shading);
      const vec3 refracted = add_scaled(scale(along, 1.0f / ior), -f.cosine, s.shading);
      const bool leaves = is_parallel(refracted, first) & (depth + passed + 1 < max_depth);
      const bool passes = glass & (passed >= 0) & (leaves | !within);

      const float share = passes ? 1.0f - f.reflectance : 0.0f;
      const bool other = !(glass | within);
      PaneTint tint = load_pane_tint(light, j);
      tint.colour = select3(other, tint.colour, scale(colour, share));
      store_pane_tint(light, j, tint);
      shares[j] = other ? plain : share;
      // A ray that hits nothing has reached the light, unless it is still within a plate.
      set_shadow_transmittance(&fields, i + j, (under_way & !hit & within) ? 0.0f : before);
      set_shadow_glass(&fields, i + j, (under_way & passes) ? passed + 1 : passed);
      const vec3 next = select3(within, first, refracted);
      set_ray_direction(&fields, i + j, select3(under_way & passes, next, direction));
    }
}

PENUMBRA_NAMESPACE_END
#endif
