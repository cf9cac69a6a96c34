// Interiors of materials: homogeneous media inside of surfaces that refract or scatter light below them,
// which scenes do not declare. The surface blocks shadow rays, so that paths take no light samples inside;
// what they meet there they find by their directions alone.
//
// Subsurface scattering is a random walk (Chiang, Kutz and Burley 2016): light that the layers of an OpenPBR
// surface leave goes evenly into the interior, scatters there, and leaves it evenly at the first surface of
// the interior that it meets, where light is sampled. `exit` of the medium is the material of that: a sheet
// that transmits everything. Way in, walk and way out count as one scattering for the limit of depths;
// Russian roulette alone ends walks.
#ifndef PENUMBRA_INTERIORS_H
#define PENUMBRA_INTERIORS_H
#include "kernels/integrator/path_stages.h"

PENUMBRA_NAMESPACE_BEGIN

/// Notes which paths scatter inside a material, and how often they did.
STAGE void note_inner(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                      PRIVATE StepLanes* RESTRICT step) {
  const PathState fields = *paths;  // see step.h
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int interior = scene->media[innermost(get_media(&fields, i + j))].interior;
      step->inner[j] = get_inner(&fields, i + j);
      step->within[j] = ((get_hit(&fields, i + j) == IN_MEDIUM) & (interior != 0)) ? 1 : 0;
    }
}

/// The families of the closures that are not inside a material.
FN ulong lit_families(const PRIVATE StepLanes* step) {
  ulong families = 0u;
  for (int j = 0; j < LANES; j++)
    families |= step->within[j] != 0 ? 0u : (ulong)1 << step->closures.family[j];
  return families & step->families;
}

/// Drops samples of lights inside materials.
STAGE void drop_inner_samples(PRIVATE StepLanes* RESTRICT step) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const float tmax = step->lights.tmax[j];
      step->lights.tmax[j] = step->within[j] != 0 ? -1.0f : tmax;
    }
}

/// The single-scattering albedo for the colour of a medium's surface. The curve is that of
/// HalfSpace (scenes/bsdfs/half_space.h): the square root of the albedo's complement by equidistant colours.
FN float albedo_of_colour(const PRIVATE Scene* scene, int curve, float colour) {
  const float x = clamp_f(colour, 0.0f, 1.0f) * (float)(CURVE_KNOTS - 1);
  const int knot = min_i((int)x, CURVE_KNOTS - 2);
  const float root = mix_f(scene->curves[curve + knot], scene->curves[curve + knot + 1], x - (float)knot);
  return 1.0f - root * root;
}

/// Stores by which albedo paths that go in scatter inside: 1 is a factor that changes nothing.
STAGE void note_albedos(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                        const PRIVATE StepLanes* RESTRICT step, const PRIVATE int* RESTRICT goes_in) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int curve = scene->media[innermost(get_beyond(&fields, i + j))].albedo_curve;
      const int from = curve >= 0 ? curve : 0;
      const vec3 colour = LOAD_LANE_vec3(step->closures.subsurface, j);
      const vec3 albedo =
          make_vec3(albedo_of_colour(scene, from, colour.x), albedo_of_colour(scene, from, colour.y),
                    albedo_of_colour(scene, from, colour.z));
      const vec3 own = select3(curve >= 0, albedo, make_vec3(1.0f, 1.0f, 1.0f));
      set_inner_albedo(&fields, i + j, select3(goes_in[j] != 0, own, get_inner_albedo(&fields, i + j)));
    }
}

/// For sampled directions inside of materials, and into them: no light sample could have found what they
/// meet. A direction in which light goes in is on the inner side of the surface's plane, too: elsewhere there
/// is no medium to scatter it.
STAGE void turn_inside(const PRIVATE PathState* paths, int i, PRIVATE StepLanes* RESTRICT step,
                       PRIVATE int* RESTRICT goes_in) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const bool inside = step->within[j] != 0;
      const float pdf = step->samples.pdf[j];
      const vec3 wi = LOAD_LANE_vec3(step->samples.wi, j), n = LOAD_LANE_vec3(step->surfaces.geometric, j);
      const bool layered = ((OPENPBRS_LAYERED >> step->closures.family[j]) & 1u) != 0u;
      const bool into = layered & (pdf == DELTA_PDF);
      const float height = max_f(dot3(wi, n), 0.0f);
      STORE_LANE_vec3(step->samples.wi, j, select3(into, add_scaled(wi, -2.0f * height, n), wi));
      step->samples.pdf[j] = (inside & (pdf > 0.0f)) ? DELTA_PDF : pdf;
      step->within[j] = (inside | into) ? 1 : 0;
      set_inner(&fields, i + j, step->inner[j] + step->within[j]);
      goes_in[j] = into ? 1 : 0;
    }
}

/// After directions are sampled.
FN void go_inside(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                  PRIVATE StepLanes* step) {
  int goes_in[LANES];
  turn_inside(paths, i, step, goes_in);
  if (scene->header.tables.curves.count > 0) note_albedos(scene, paths, i, step, goes_in);
}

PENUMBRA_NAMESPACE_END
#endif
