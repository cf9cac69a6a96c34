// The stages of BSDFs for one instruction set: see bsdf_stages.h.
#include "kernels/bsdf/bsdf.h"
#include "kernels/intersect/surface.h"
#include "kernels/sampler/sampler.h"

namespace penumbra {

float STAGE_FUNCTION(const Closure& closure, bool sample, int groups) {
  Surfaces surfaces;
  Closures closures;
  float wi[3 * LANES], uv[2 * LANES], choice[LANES];
  for (uint j = 0; j < LANES; j++) {
    const auto number = [&](uint k) { return unit_float(hash_uint(8 * j + k)); };
    Surface s = surface_in_medium(make_vec3(0, 0, 0));
    s.shading = s.geometric = sample_uniform_sphere(number(0), number(1));
    s.wo = sample_cosine_hemisphere(s.shading, number(2), number(3));
    store_surface(&surfaces, int(j), s);
    store_closure(&closures, int(j), closure);
    STORE_LANE_vec3(wi, j, sample_cosine_hemisphere(s.shading, number(4), number(5)));
    uv[j] = number(4), uv[LANES + j] = number(5), choice[j] = number(6);
  }
  const uint families = families_among(&closures);
  BsdfValues values;
  BsdfSamples samples;
  float sum = 0;
  for (int k = 0; k < groups; k++) {
    const int lane = k % LANES;
    uv[lane] = unit_float(hash_uint(uint(k)));
    if (sample) {
      sample_bsdfs(nullptr, families, &closures, &surfaces, uv, choice, &samples);
      sum += samples.pdf[lane];
    } else {
      eval_bsdfs(nullptr, families, &closures, &surfaces, wi, &values);
      sum += values.pdf[lane];
    }
  }
  return sum;
}

}  // namespace penumbra
