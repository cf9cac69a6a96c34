// Lights that are no shapes, each with its parameters and, beside them, the light of the kernels that it
// becomes.
#pragma once

#include <algorithm>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <numbers>
#include <variant>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/device/scene_records.h"
#include "scenes/device/to_vec3.h"

namespace penumbra {

/// Where emitters are.
struct EmitterPlace {
  std::function<vec3(const glm::dvec3&)> local;  ///< in the coordinates of the device scene
  double scene_radius;                           ///< of a sphere about everything
  SceneRecords& records;                         ///< for tables of a kind's own
};

/// Linear Rec. 709, row by row from the top, W x H.
struct EnvironmentImage {
  int width = 0, height = 0;
  std::vector<glm::vec3> texels;  ///< finite, 0 or more
};

struct EmitterLight {
  Light light;
  double power;  ///< by which it is chosen among others
};

inline EmitterLight emitter_light(int kind, const glm::vec3& radiance, double power_of_one) {
  Light light{};
  light.kind = kind;
  light.polygon = -1;
  light.radiance = to_vec3(radiance);
  return {light, (double(radiance.x) + radiance.y + radiance.z) / 3 * power_of_one};
}

/// Radiant intensity, W/sr, the same in all directions.
struct PointLight {
  static constexpr bool kIsSky = false;  ///< seen where there is no shape
  glm::dvec3 position{0.0};
  glm::vec3 intensity{1.0f};
  [[nodiscard]] bool is_black() const { return intensity == glm::vec3(0.0f); }
  [[nodiscard]] EmitterLight light(const EmitterPlace& place) const {
    EmitterLight made = emitter_light(LIGHT_POINT, intensity, 4 * std::numbers::pi);
    made.light.p0 = place.local(position);
    return made;
  }
};

/// Constant radiance from all directions that leave the scene.
struct ConstantEnvironment {
  static constexpr bool kIsSky = true;
  glm::vec3 radiance{1.0f};
  [[nodiscard]] bool is_black() const { return radiance == glm::vec3(0.0f); }
  [[nodiscard]] EmitterLight light(const EmitterPlace& place) const {
    const double section = std::numbers::pi * std::max(place.scene_radius * place.scene_radius, 1e-30);
    return emitter_light(LIGHT_ENVIRONMENT, radiance, std::numbers::pi * section);
  }
};

/// Radiance from all directions that leave the scene, by an image of the sphere; see
/// kernels/light/envmap_grid.h for where its texels are.
struct EnvironmentMapLight {
  static constexpr bool kIsSky = true;
  std::shared_ptr<const EnvironmentImage> image;
  glm::dmat3 to_world{1.0};  ///< a rotation, or one with a mirror
  double scale = 1.0;
  [[nodiscard]] bool is_black() const;
  [[nodiscard]] EmitterLight light(const EmitterPlace& place) const;
};

using Emitter = std::variant<PointLight, ConstantEnvironment, EnvironmentMapLight>;
inline bool is_black(const Emitter& emitter) {
  return std::visit([](const auto& e) { return e.is_black(); }, emitter);
}
inline bool is_sky(const Emitter& emitter) {
  return std::visit([](const auto& e) { return e.kIsSky; }, emitter);
}

}  // namespace penumbra
