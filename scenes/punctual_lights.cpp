#include "scenes/punctual_lights.h"

#include <fmt/format.h>

namespace penumbra {

void add_punctual_light(const PunctualLight& light, SourceLocation location, ReaderReport& report,
                        SceneDescription& scene) {
  if (light.kind == PunctualKind::kPoint) {
    PointLight point;
    point.position = light.position;
    point.intensity = light.strength;
    scene.emitters.emplace_back(point);
    return;
  }
  report.unsupported(
      location,
      fmt::format("{} lights are not read", light.kind == PunctualKind::kSpot ? "spot" : "directional"),
      "it is left out");
}

}  // namespace penumbra
