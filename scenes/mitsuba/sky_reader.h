// Reads skies and suns. A scene may have one of each.
#pragma once

#include <optional>

#include "scenes/mitsuba/plugin.h"
#include "scenes/sky/sky_parameters.h"

namespace penumbra::mitsuba {

/// Combines a sky and a sun of a scene into one environment, as `sunsky` is. There is one SkyReader per
/// scene.
class SkyReader {
 public:
  /// Adds the emitter to the scene, or merges it into that of the other part. Problems are reported, for
  /// example a second sky.
  void add(const PluginReader& plugin, const SkyParameters& sky, SkyPart part, SceneDescription& scene);

 private:
  struct Part {
    SkyParameters parameters;
    SkyPart is;
    std::optional<std::size_t> emitter;  ///< of its environment map in the scene; none: it is black
  };
  std::optional<Part> first_;
};

}  // namespace penumbra::mitsuba
