// The work of rendering, counted instead of timed, so that it is the same on every machine.
#pragma once

#include "kernels/block/path_state.h"
#include "kernels/scene_types.h"

namespace penumbra {

/// Work in units of one path vertex of a small scene: its ray and its material. The weights are fits to CPU
/// times of some 27 scenes, which they meet within a factor of about 1.5.
struct WorkWeights {
  double vertex = 1, shadow_ray = 0, photon_ray = 0;
};
WorkWeights work_weights(const SceneHeader& header);

/// Of camera paths, without photons.
double path_work(const TracedRays& traced, const WorkWeights& weights);
/// Of the photons' rays, and of building their maps.
double photon_work(const TracedRays& traced, const WorkWeights& weights);

}  // namespace penumbra
