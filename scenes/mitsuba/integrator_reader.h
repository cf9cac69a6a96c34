// <integrator>.
#pragma once

#include <string_view>
#include <vector>

#include "scenes/mitsuba/plugin.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

/// Sets the integrator; what is wrong is reported. Of those that only wrap another, the other counts. For
/// Mitsuba's other ways to compute what `path` computes, `path` stands in, with a warning; or `volpath`, if
/// the scene has media and they see them. `path` and its like see nothing of media, in every version of
/// Mitsuba.
void read_integrator(const Context& context, const Object& object, SceneDescription& scene);

/// Another integrator of Mitsuba's.
struct OtherIntegrator {
  std::string_view name;
  std::string_view rendered_by;  ///< path, also for those that are volpath where there are media; empty: the
                                 ///< integrator that it holds
  bool warns = false;            ///< the image is not the same sample by sample
};
std::vector<OtherIntegrator> other_integrators();

}  // namespace penumbra::mitsuba
