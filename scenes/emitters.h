// Emitters that are not shapes. Each has its parameters and, next to them, its conversion to a light of the
// kernels.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/cameras.h"
#include "scenes/device/light_bounds.h"
#include "scenes/device/scene_records.h"
#include "scenes/device/to_vec3.h"
#include "scenes/image/bitmap.h"
#include "scenes/integrators.h"
#include "scenes/plugin_values.h"
#include "scenes/textured.h"

namespace penumbra {

constexpr ColourWithin kEmission{0.0f, kAnyNumber};

/// The parameters of an area light, beside the geometry of its shape.
struct AreaLightParameters {
  static constexpr const char* kPlugin = "area";
  static constexpr const char* kText = "area light: the shape that holds it emits from its front";
  TexturedColour radiance{glm::vec3(1.0f)};
  bool two_sided = false;
  bool seen_by_camera = true;
  double spread = 180.0;  ///< degrees in [0.1, 180]
  EmitterSampling sampling = EmitterSampling::kAuto;

  template <typename Row>
  static void parameters(const Row& row) {
    row("radiance", &AreaLightParameters::radiance, kEmission, "radiance");
    row("two_sided", &AreaLightParameters::two_sided, TrueOrFalse{},
        "whether it also emits from its back (not for spheres)");
    row("seen_by_camera", &AreaLightParameters::seen_by_camera, TrueOrFalse{},
        "whether camera rays add its light; else they see the BSDF alone, which `null` lets them pass");
    row("spread", &AreaLightParameters::spread, AnyNumber{"number in [0.1, 180]"},
        "angle of the cone about the normal that takes all of its power, as behind a grid of slats; of flat "
        "shapes");
    row("sampling", &AreaLightParameters::sampling, emitter_samplings(), "density of points on it");
  }
};

/// The textures of lights, as the builder of a device scene collects them.
class LightTextures;

/// What an emitter needs to know of the scene to become a light of the kernels.
struct EmitterPlace {
  /// From world coordinates to the coordinates of the device scene.
  std::function<vec3(const glm::dvec3&)> local;
  double scene_radius;                      ///< of a bounding sphere of the whole scene
  SceneRecords& records;                    ///< receives tables that a kind of emitter needs
  const LightTextures* textures = nullptr;  ///< null: no light has a texture
  bool balanced = false;                    ///< light samples are weighted against BSDF samples
};

struct EmitterLight {
  Light light;
  double power;  ///< the weight with which this light is chosen among all lights
  /// Bounds of its position and emission, for choosing lights by their contribution. If absent,
  /// bounds_of_light computes them from the light's kind.
  std::optional<LightBounds> bounds = std::nullopt;
};

inline EmitterLight emitter_light(int kind, const glm::vec3& radiance, double power_of_one) {
  Light light{};
  light.kind = kind;
  light.polygon = light.texture = light.grid = -1;
  light.radiance = to_vec3(radiance);
  return {light, (double(radiance.x) + radiance.y + radiance.z) / 3 * power_of_one};
}

/// The power that an environment of unit radiance sends through a bounding sphere of the scene.
inline double sky_power(const EmitterPlace& place) {
  const double section = std::numbers::pi * std::max(place.scene_radius * place.scene_radius, 1e-30);
  return std::numbers::pi * section;
}

/// Radiant intensity, W/sr, the same in all directions.
struct PointLight {
  static constexpr const char* kPlugin = "point";
  static constexpr const char* kText = "point light";
  static constexpr bool kIsSky = false;  ///< whether rays that leave the scene see it
  glm::dvec3 position{0.0};
  glm::vec3 intensity{1.0f};
  glm::dmat4 to_world{1.0};  ///< alternative to a position: the light is at the transformed origin

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
    if (!given("to_world")) return;
    const glm::dmat4 placed = std::exchange(to_world, glm::dmat4(1.0));
    position = glm::dvec3(placed[3]) / placed[3].w;
  }
  [[nodiscard]] bool is_black() const { return intensity == glm::vec3(0.0f); }
  [[nodiscard]] EmitterLight light(const EmitterPlace& place) const {
    EmitterLight made = emitter_light(LIGHT_POINT, intensity, 4 * std::numbers::pi);
    made.light.p0 = place.local(position);
    return made;
  }
};

/// Constant radiance from all directions, seen by rays that leave the scene.
struct ConstantEnvironment {
  static constexpr const char* kPlugin = "constant";
  static constexpr const char* kText = "constant environment";
  static constexpr bool kIsSky = true;
  glm::vec3 radiance{1.0f};
  glm::dmat4 to_world{1.0};  ///< has no effect on a constant

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

/// An environment map: radiance from all directions, given by an image of the sphere and seen by rays that
/// leave the scene. kernels/light/envmap_grid.h defines the positions of its texels.
struct EnvironmentMapLight {
  static constexpr const char* kPlugin = "envmap";
  static constexpr const char* kText = "environment map: an image, longitude by polar angle";
  static constexpr bool kIsSky = true;
  std::string filename;
  glm::dmat4 to_world{1.0};  ///< a rotation that may mirror; the lengths of its axes have no effect
  float scale = 1.0f;
  /// Rows from the top; integer texels are sRGB-encoded; at least 2 x 2 texels.
  std::shared_ptr<const Bitmap> image;
  /// Whether channels below 0 are meant, as those of colours outside the gamut are; else they become 0, as
  /// resampling makes them beside bright texels. The sum of a texel's channels is at least 0.
  bool has_wide_gamut = false;

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
  /// Defined in scenes/device/envmap_tables.cpp.
  [[nodiscard]] EmitterLight light(const EmitterPlace& place) const;
};

enum class SpotFalloff { kLinear = SPOT_LINEAR, kSmoothstep = SPOT_SMOOTHSTEP, kSquared = SPOT_SQUARED };

/// A spot light: radiant intensity about the z axis of its frame; see kernels/light/delta_lights.h.
struct SpotLight {
  static constexpr const char* kPlugin = "spot";
  static constexpr const char* kText = "spot light: a cone about the z axis";
  static constexpr bool kIsSky = false;
  glm::vec3 intensity{1.0f};
  TexturedColour texture{glm::vec3(1.0f)};
  double cutoff_angle = 20.0;  ///< degrees from the axis, beyond which there is no light
  double beam_width = 15.0;    ///< degrees from the axis, up to which the intensity is full
  double radius = 0.0;         ///< scene units, see kernels/light/round_spot_light.h
  SpotFalloff falloff = SpotFalloff::kLinear;
  glm::dmat4 to_world{1.0};

  template <typename Row>
  static void parameters(const Row& row) {
    row("intensity", &SpotLight::intensity, kEmission, "radiant intensity within the beam, W/sr");
    row("texture", &SpotLight::texture, kEmission,
        "multiplies the intensity: an image across the beam, as wide as the cutoff angle");
    row("cutoff_angle", &SpotLight::cutoff_angle, AnyNumber{"number in (0, 180]"},
        "beyond it there is no light, degrees from the axis");
    row("beam_width", &SpotLight::beam_width, AnyNumber{"number in [0, cutoff_angle]"},
        "within it intensity is constant, degrees from the axis; unless given 3/4 of the cutoff angle");
    row("radius", &SpotLight::radius, AnyNumber{"number from 0 on"},
        "of the sphere that shines; it softens shadows, and neither the camera nor mirrors show it");
    row("falloff", &SpotLight::falloff,
        OneOf<SpotFalloff>{{{"linear", SpotFalloff::kLinear},
                            {"smoothstep", SpotFalloff::kSmoothstep},
                            {"squared", SpotFalloff::kSquared}}},
        "between both: linear in the angle, as Mitsuba's; of its cosine 3t² - 2t³, as pbrt's, or t², as "
        "glTF's");
    row("to_world", &SpotLight::to_world, AnyTransform{}, "brings the origin to it and the z axis along it");
  }
  template <typename Given>
  void complete(Findings& findings, const Given& given) {
    if (!given("beam_width")) beam_width = 0.75 * cutoff_angle;
    check(findings);
  }
  void check(Findings& findings) const;
  [[nodiscard]] bool is_black() const { return intensity == glm::vec3(0.0f) || !texture.is_lit(); }
  /// Defined in scenes/device/beam_lights.cpp.
  [[nodiscard]] EmitterLight light(const EmitterPlace& place) const;
};

/// Light from outside the scene, parallel or from a disk. Its strength is the irradiance on a surface
/// perpendicular to it.
struct DirectionalLight {
  static constexpr const char* kPlugin = "directional";
  static constexpr const char* kText = "directional light, or a sun";
  static constexpr bool kIsSky = false;
  glm::vec3 irradiance{1.0f};
  glm::dvec3 direction{0.0, 0.0, 1.0};  ///< in which the light travels; any length above 0
  glm::dmat4 to_world{1.0};    ///< alternative to a direction: the light travels along the transformed z axis
  double angle = 0.0;          ///< degrees in [0, 180], across the disk
  bool seen_by_camera = true;  ///< only with an angle

  template <typename Row>
  static void parameters(const Row& row) {
    row("irradiance", &DirectionalLight::irradiance, kEmission, "of a surface across the direction, W/m²");
    row("direction", &DirectionalLight::direction, AnyPoint{}, "in which the light travels");
    row("to_world", &DirectionalLight::to_world, AnyTransform{},
        "instead of a direction: where it brings the z axis");
    row("angle", &DirectionalLight::angle, AnyNumber{"number in [0, 180]"},
        "across the disk that shines, degrees; rays that leave the scene see it. Below 0.01 the light is "
        "parallel");
    row("seen_by_camera", &DirectionalLight::seen_by_camera, TrueOrFalse{},
        "whether camera rays see the disk");
  }
  template <typename Given>
  void complete(Findings& findings, const Given& given) {
    if (!(angle >= 0.0 && angle <= 180.0))
      findings.push_back({"angle", fmt::format("angle must be a number in [0, 180], not {}", angle)});
    if (given("direction") && given("to_world"))
      findings.push_back({"direction", "either direction or to_world, not both"});
    if (given("to_world")) direction = glm::dvec3(std::exchange(to_world, glm::dmat4(1.0))[2]);
    const double length = glm::length(direction);
    if (!(length > 0.0 && length < 1e150))
      findings.push_back({given("to_world") ? "to_world" : "direction",
                          "the direction must have a length above 0, and one that is a number"});
  }
  [[nodiscard]] bool is_black() const { return irradiance == glm::vec3(0.0f); }
  [[nodiscard]] EmitterLight light(const EmitterPlace& place) const;
};

/// A projector: it projects an image that is in focus at every distance; see kernels/light/delta_lights.h.
struct ProjectorLight {
  static constexpr const char* kPlugin = "projector";
  static constexpr const char* kText = "projects an image from a point, in focus at every distance";
  static constexpr bool kIsSky = false;
  TexturedColour irradiance{glm::vec3(1.0f)};
  float scale = 1.0f;
  double fov = 50.0;  ///< degrees; 0 < fov < 180
  FovAxis fov_axis = FovAxis::kX;
  std::string focal_length = "50mm";
  glm::dmat4 to_world{1.0};

  template <typename Row>
  static void parameters(const Row& row) {
    row("irradiance", &ProjectorLight::irradiance, kEmission,
        "the image: radiance of a white surface across the beam at distance 1");
    row("scale", &ProjectorLight::scale, NumberWithin{LowEnd::kClosed, 0.0f, kAnyNumber},
        "by which it is multiplied");
    row("fov", &ProjectorLight::fov, AnyNumber{"number in (0, 180)"}, "full angle of the image, degrees");
    row("fov_axis", &ProjectorLight::fov_axis, fov_axes(), "what the angle spans");
    row("focal_length", &ProjectorLight::focal_length, AnyText{"length such as 50mm"},
        "instead of an angle: of a lens before 36 mm by 24 mm");
    row("to_world", &ProjectorLight::to_world, AnyTransform{},
        "brings the origin to it and the z axis along it");
  }
  template <typename Given>
  void complete(Findings& findings, const Given& given) {
    if (given("fov") && given("focal_length"))
      findings.push_back({"focal_length", "either fov or focal_length, not both"});
    if (!given("fov")) use_focal_length(findings);
    check(findings);
  }
  void use_focal_length(Findings& findings);
  void check(Findings& findings) const;
  [[nodiscard]] bool is_black() const { return scale == 0.0f || !irradiance.is_lit(); }
  /// Defined in scenes/device/beam_lights.cpp.
  [[nodiscard]] EmitterLight light(const EmitterPlace& place) const;
};

using Emitter = std::variant<PointLight, ConstantEnvironment, EnvironmentMapLight, SpotLight,
                             DirectionalLight, ProjectorLight>;
inline bool is_black(const Emitter& emitter) {
  return std::visit([](const auto& e) { return e.is_black(); }, emitter);
}
inline bool is_sky(const Emitter& emitter) {
  return std::visit([](const auto& e) { return e.kIsSky; }, emitter);
}

}  // namespace penumbra
