// Dispersion: the refractive index of glass differs between colours. At such a surface a path goes on with
// one colour channel, chosen in proportion to its throughput, whose weight is the inverse of its probability.
// At the next one it carries no other channel, so nothing is left to choose.
#ifndef PENUMBRA_DISPERSION_H
#define PENUMBRA_DISPERSION_H
#include "kernels/integrator/step.h"

PENUMBRA_NAMESPACE_BEGIN

/// One of three channels.
typedef struct {
  int channel;
  float probability;  ///< with which it was chosen
  float rest;         ///< what is left of the random number that chose it, uniform in [0, 1)
} ChannelChoice;

/// Chooses a channel in proportion to `throughput` >= 0 by a random number in [0, 1).
FN ChannelChoice choose_channel(vec3 throughput, float number) {
  const float sum = throughput.x + throughput.y + throughput.z, inverse = 1.0f / (sum > 0.0f ? sum : 1.0f);
  const float first = throughput.x * inverse, second = throughput.y * inverse;
  const bool is_first = number < first, is_second = (number < first + second) | !(throughput.z > 0.0f);
  const float before = is_first ? 0.0f : (is_second ? first : first + second);
  ChannelChoice choice;
  choice.channel = is_first ? 0 : (is_second ? 1 : 2);
  choice.probability = channel_of(throughput, choice.channel) * inverse;
  const float within = (number - before) / (choice.probability > 0.0f ? choice.probability : 1.0f);
  choice.rest = clamp_f(within, 0.0f, ONE_MINUS_EPSILON);
  return choice;
}

/// The closures of LANES paths from lane i on that are at dispersing surfaces become those of one channel,
/// and so do the throughputs. `carries`: the paths have had a throughput; else it is 1.
STAGE void disperse(const PRIVATE Scene* scene, bool carries, const PRIVATE PathState* paths, int i,
                    PRIVATE StepLanes* RESTRICT step) {
  const PathState fields = *paths;  // see step.h
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      GLOBAL const Material* material = scene->materials + step->surfaces.material[j];
      const vec3 index = load3(&material->channel_ior);
      const bool disperses = index.x > 0.0f;
      const vec3 one = make_vec3(1.0f, 1.0f, 1.0f);
      const vec3 carried = select3(carries, get_throughput(&fields, i + j), one);
      const float number = lane_number(step, DIM_LOBE_CHOICE, j);
      const ChannelChoice choice = choose_channel(carried, number);
      const float weight = choice.probability > 0.0f ? 1.0f / choice.probability : 0.0f;
      const vec3 kept =
          with_channel(make_vec3(0.0f, 0.0f, 0.0f), make_vec3(weight, weight, weight), choice.channel);
      const float ior = step->closures.ior[j], of_channel = channel_of(index, choice.channel);
      step->closures.ior[j] = disperses ? of_channel : ior;
      step->u[DIM_LOBE_CHOICE * LANES + j] = disperses ? choice.rest : number;
      set_throughput(&fields, i + j, select3(disperses, mul(carried, kept), carried));
    }
}

PENUMBRA_NAMESPACE_END
#endif
