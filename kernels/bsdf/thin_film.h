// What a thin film reflects, from tables (see FacetCurves, scenes/bsdfs/facet_albedo.h). A material's film
// has a block for each of `film_rows` thicknesses, of which `film_thickness` in [0, 1] is the place between
// the first and the last. A block has RGB curves of the reflectance over the cosine, with their means over a
// cosine-weighted hemisphere, for the dielectric; then, for FILM_METALS metals, what the film adds to their
// reflectance; then the albedos of the microfacets.
#ifndef PENUMBRA_THIN_FILM_H
#define PENUMBRA_THIN_FILM_H
#include "kernels/bsdf/families.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// The blocks of two neighbouring thicknesses.
typedef struct {
  int first, second;
  float w;
} FilmBlocks;

/// `facet_rows`: how many rows each set of curves of the material has.
FN FilmBlocks film_blocks(Closure c, int facet_rows) {
  // Lanes of other families have no film.
  const bool there = c.film_rows > 0;
  const int stride = FILM_REFLECTANCES + (there ? facet_rows : 1) * (3 * CURVE_STRIDE);
  const int start = there ? c.curve + c.curve_rows * CURVE_STRIDE : 0, last = max_i(c.film_rows - 1, 0);
  const float x = clamp_f(c.film_thickness, 0.0f, 1.0f) * (float)last;
  const int row = min_i((int)x, last);
  FilmBlocks blocks;
  blocks.first = start + row * stride;
  blocks.second = start + min_i(row + 1, last) * stride;
  blocks.w = x - (float)row;
  return blocks;
}

FN float film_number(const PRIVATE Scene* scene, FilmBlocks blocks, int at) {
  return mix_f(scene->curves[blocks.first + at], scene->curves[blocks.second + at], blocks.w);
}
FN vec3 film_numbers(const PRIVATE Scene* scene, FilmBlocks blocks, int at) {
  return make_vec3(film_number(scene, blocks, at), film_number(scene, blocks, at + 1),
                   film_number(scene, blocks, at + 2));
}

/// Where a cosine is between the knots of a film's curve, which are equidistant in its square root.
typedef struct {
  int knot;
  float w;
} FilmPlace;
FN FilmPlace film_place(float cosine) {
  const float x = SQRT(clamp_f(cosine, 0.0f, 1.0f)) * (float)(FILM_KNOTS - 1);
  FilmPlace place;
  place.knot = min_i((int)x, FILM_KNOTS - 2);
  place.w = x - (float)place.knot;
  return place;
}
/// The means of a curve are behind its knots.
FN FilmPlace film_mean(void) {
  FilmPlace place;
  place.knot = FILM_KNOTS;
  place.w = 0.0f;
  return place;
}

/// Reflectance of the film over the dielectric.
FN vec3 film_over_dielectric(const PRIVATE Scene* scene, FilmBlocks blocks, FilmPlace at) {
  const int next = min_i(at.knot + 1, FILM_KNOTS);
  return mix3(film_numbers(scene, blocks, at.knot * 3), film_numbers(scene, blocks, next * 3), at.w);
}

/// What the film adds in a channel to a metal of reflectance `base` along the normal. The metals of the table
/// are equidistant in its square root.
FN float film_on_channel(const PRIVATE Scene* scene, FilmBlocks blocks, FilmPlace at, float base,
                         int channel) {
  const float x = SQRT(clamp_f(base, 0.0f, 1.0f)) * (float)(FILM_METALS - 1);
  const int metal = min_i((int)x, FILM_METALS - 2), next = 3 * (min_i(at.knot + 1, FILM_KNOTS) - at.knot);
  const int start = (1 + metal) * FILM_CURVE + at.knot * 3 + channel;
  const float low = mix_f(film_number(scene, blocks, start), film_number(scene, blocks, start + next), at.w);
  const float high = mix_f(film_number(scene, blocks, start + FILM_CURVE),
                           film_number(scene, blocks, start + FILM_CURVE + next), at.w);
  return mix_f(low, high, x - (float)metal);
}
/// The reflectance `plain` of a metal with the film on a share `weight` of it.
FN vec3 film_over_metal(const PRIVATE Scene* scene, FilmBlocks blocks, FilmPlace at, vec3 base, vec3 plain,
                        float weight) {
  return make_vec3(clamp_f(plain.x + weight * film_on_channel(scene, blocks, at, base.x, 0), 0.0f, 1.0f),
                   clamp_f(plain.y + weight * film_on_channel(scene, blocks, at, base.y, 1), 0.0f, 1.0f),
                   clamp_f(plain.z + weight * film_on_channel(scene, blocks, at, base.z, 2), 0.0f, 1.0f));
}

PENUMBRA_NAMESPACE_END
#endif
