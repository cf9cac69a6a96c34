// Lights that are no shapes, each with its parameters and, beside them, the light of the kernels that it
// becomes.
#pragma once

#include <algorithm>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <numbers>
#include <optional>
#include <variant>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/device/light_bounds.h"
#include "scenes/device/scene_records.h"
#include "scenes/device/to_vec3.h"
#include "scenes/image/bitmap.h"
#include "scenes/integrators.h"
#include "scenes/plugin_values.h"

namespace penumbra {

constexpr ColourWithin kEmission{0.0f, kAnyNumber};

/// What a shape that emits has beside its geometry.
struct AreaLightParameters {
  static constexpr const char* kPlugin = "area";
  static constexpr const char* kText = "the radiance of the shape that holds it, from its front";
  glm::vec3 radiance{1.0f};
  bool two_sided = false;
  EmitterSampling sampling = EmitterSampling::kAuto;

  template <typename Row>
  static void parameters(const Row& row) {
    row("radiance", &AreaLightParameters::radiance, kEmission, "radiance");
    row("two_sided", &AreaLightParameters::two_sided, TrueOrFalse{},
        "whether its back shines too; no sphere's does");
    row("sampling", &AreaLightParameters::sampling, emitter_samplings(), "density of points on it");
  }
};

/// Where emitters are.
struct EmitterPlace {
  std::function<vec3(const glm::dvec3&)> local;  ///< in the coordinates of the device scene
  double scene_radius;                           ///< of a sphere about everything
  SceneRecords& records;                         ///< for tables of a kind's own
};

struct EmitterLight {
  Light light;
  double power;  ///< by which it is chosen among others
  /// Where it shines, for the choice by contribution; none: what bounds_of_light knows of its kind.
  std::optional<LightBounds> bounds = std::nullopt;
};

inline EmitterLight emitter_light(int kind, const glm::vec3& radiance, double power_of_one) {
  Light light{};
  light.kind = kind;
  light.polygon = -1;
  light.radiance = to_vec3(radiance);
  return {light, (double(radiance.x) + radiance.y + radiance.z) / 3 * power_of_one};
}

/// Of a sky of unit radiance: what it sends through a sphere about everything.
inline double sky_power(const EmitterPlace& place) {
  const double section = std::numbers::pi * std::max(place.scene_radius * place.scene_radius, 1e-30);
  return std::numbers::pi * section;
}

/// Radiant intensity, W/sr, the same in all directions.
struct PointLight {
  static constexpr const char* kPlugin = "point";
  static constexpr const char* kText = "the same radiant intensity in all directions, from a point";
  static constexpr bool kIsSky = false;  ///< seen where there is no shape
  glm::dvec3 position{0.0};
  glm::vec3 intensity{1.0f};
  glm::dmat4 to_world{1.0};  ///< instead of a position: where it brings the origin

  template <typename Row>
  static void parameters(const Row& row) {
    row("position", &PointLight::position, AnyPoint{}, "where it is");
    row("to_world", &PointLight::to_world, AnyTransform{},
        "instead of a position: where it brings the origin");
    row("intensity", &PointLight::intensity, kEmission, "radiant intensity, W/sr");
  }
  template <typename Given>
  void complete(Findings& findings, const Given& given) {
    if (given("position") && given("to_world"))
      findings.push_back({"position", "either position or to_world, not both"});
    if (given("to_world")) position = glm::dvec3(to_world[3]) / to_world[3].w;
  }
  [[nodiscard]] bool is_black() const { return intensity == glm::vec3(0.0f); }
  [[nodiscard]] EmitterLight light(const EmitterPlace& place) const {
    EmitterLight made = emitter_light(LIGHT_POINT, intensity, 4 * std::numbers::pi);
    made.light.p0 = place.local(position);
    return made;
  }
};

/// Constant radiance from all directions that leave the scene.
struct ConstantEnvironment {
  static constexpr const char* kPlugin = "constant";
  static constexpr const char* kText = "the same radiance from all directions that leave the scene";
  static constexpr bool kIsSky = true;
  glm::vec3 radiance{1.0f};
  glm::dmat4 to_world{1.0};  ///< which it does not see

  template <typename Row>
  static void parameters(const Row& row) {
    row("radiance", &ConstantEnvironment::radiance, kEmission, "radiance");
    row("to_world", &ConstantEnvironment::to_world, AnyTransform{}, "without effect");
  }
  [[nodiscard]] bool is_black() const { return radiance == glm::vec3(0.0f); }
  [[nodiscard]] EmitterLight light(const EmitterPlace& place) const {
    return emitter_light(LIGHT_ENVIRONMENT, radiance, sky_power(place));
  }
};

/// Radiance from all directions that leave the scene, by an image of the sphere; see
/// kernels/light/envmap_grid.h for where its texels are.
struct EnvironmentMapLight {
  static constexpr const char* kPlugin = "envmap";
  static constexpr const char* kText = "radiance by an image of all directions, longitude by polar angle";
  static constexpr bool kIsSky = true;
  std::string filename;
  glm::dmat4 to_world{1.0};  ///< a rotation, mirrored or not; its lengths do not count
  float scale = 1.0f;
  std::shared_ptr<const Bitmap> image;  ///< rows from the top; whole numbers are sRGB; 2 x 2 texels or more

  template <typename Row>
  static void parameters(const Row& row) {
    row("filename", &EnvironmentMapLight::filename, FileName{}, "the image");
    row("to_world", &EnvironmentMapLight::to_world, AnyTransform{}, "turns it; as it is, y is up");
    row("scale", &EnvironmentMapLight::scale, NumberWithin{LowEnd::kClosed, 0.0f, kAnyNumber},
        "by which radiance is multiplied");
  }
  [[nodiscard]] bool is_black() const {
    return scale == 0.0f || std::ranges::all_of(image->words, [](std::uint32_t w) { return w == 0u; });
  }
  [[nodiscard]] EmitterLight light(const EmitterPlace& place) const;  ///< scenes/device/envmap_tables.cpp
};

using Emitter = std::variant<PointLight, ConstantEnvironment, EnvironmentMapLight>;
inline bool is_black(const Emitter& emitter) {
  return std::visit([](const auto& e) { return e.is_black(); }, emitter);
}
inline bool is_sky(const Emitter& emitter) {
  return std::visit([](const auto& e) { return e.kIsSky; }, emitter);
}

}  // namespace penumbra
