// Skies and suns, of which a scene has one each.
#pragma once

#include <optional>

#include "scenes/mitsuba/plugin.h"
#include "scenes/sky/sky_parameters.h"

namespace penumbra::mitsuba {

/// Joins a sky and a sun to what `sunsky` is. One for a scene.
class SkyReader {
 public:
  /// Adds its light to the scene, or changes that of the other part. What is wrong is reported, a second sky
  /// for example.
  void add(const PluginReader& plugin, const SkyParameters& sky, SkyPart part, SceneDescription& scene);

 private:
  struct Part {
    SkyParameters parameters;
    SkyPart is;
    std::optional<std::size_t> emitter;  ///< its place in the scene; none: it is black
  };
  std::optional<Part> first_;
};

}  // namespace penumbra::mitsuba
