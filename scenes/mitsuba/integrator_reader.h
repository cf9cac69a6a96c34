// Reads <integrator>.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scenes/mitsuba/plugin.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

/// Sets the integrator; problems are reported. For an integrator that only wraps another, the inner one is
/// used, and the layers that `aov` asks for are added to the film's. Mitsuba's other integrators for the
/// light transport of `path` are replaced by `path`, with a warning, or by `volpath` if the scene has media
/// and they support them. `path` itself ignores media, as in every version of Mitsuba.
void read_integrator(const Context& context, const Object& object, SceneDescription& scene);

/// The value of the parameter `aovs` that asks for these layers; empty: none of them has a name there.
std::string aovs_of(const std::vector<AskedLayer>& layers);

/// An integrator of Mitsuba that is rendered by another one.
struct OtherIntegrator {
  std::string_view name;
  /// `path`, also for those that become `volpath` if there are media; empty: the nested integrator.
  std::string_view rendered_by;
  bool warns = false;  ///< whether to warn: individual samples differ from those of Mitsuba's integrator
};
std::vector<OtherIntegrator> other_integrators();

}  // namespace penumbra::mitsuba
