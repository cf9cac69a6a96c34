#include "scenes/emitters.h"

#include <fmt/format.h>

#include <cmath>

#include "scenes/view_angle.h"

namespace penumbra {

void SpotLight::check(Findings& findings) const {
  const bool flat = texture.texture != kNoTexture;
  if (!(radius >= 0.0 && radius < double(kAnyNumber)))
    findings.push_back({"radius", fmt::format("radius must be a number from 0 on, not {}", radius)});
  if (!(cutoff_angle > 0.0 && cutoff_angle <= 180.0))
    findings.push_back(
        {"cutoff_angle", fmt::format("cutoff_angle must be a number in (0, 180], not {}", cutoff_angle)});
  else if (flat && !(cutoff_angle < 90.0))
    findings.push_back({"cutoff_angle", fmt::format("the cutoff_angle of a spot with a texture must be below "
                                                    "90 degrees, not {}: no image is as wide",
                                                    cutoff_angle)});
  else if (!(beam_width >= 0.0 && beam_width <= cutoff_angle))
    findings.push_back({"beam_width", fmt::format("beam_width must be a number between 0 and the "
                                                  "cutoff_angle {}, not {}",
                                                  cutoff_angle, beam_width)});
}

// Single precision does not resolve thinner disks, in degrees.
constexpr double kLeastAngle = 0.01;

EmitterLight DirectionalLight::light(const EmitterPlace& place) const {
  const double scene_radius = std::max(place.scene_radius, 1e-15);
  const double section = std::numbers::pi * scene_radius * scene_radius;
  const glm::dvec3 along = glm::normalize(direction);
  const bool is_disk = angle >= kLeastAngle;
  const double half_angle = is_disk ? angle * std::numbers::pi / 360 : 0.0, sine = std::sin(half_angle);
  const double half_sine = std::sin(half_angle / 2);
  EmitterLight made = emitter_light(LIGHT_DIRECTIONAL, irradiance, section);
  made.light.p1 = to_vec3(along);
  made.bounds = LightBounds{.axis = along, .spread = half_angle, .intensity = made.power > 0 ? 1.0 : 0.0};
  if (is_disk) {
    made.light.kind = LIGHT_SUN;
    made.light.radiance = to_vec3(irradiance / float(std::numbers::pi * sine * sine));
    made.light.area = float(2 * half_sine * half_sine);
    made.light.unseen = seen_by_camera ? 0 : UNSEEN_BY_CAMERA;
  }
  return made;
}

void ProjectorLight::use_focal_length(Findings& findings) {
  fov_axis = FovAxis::kDiagonal;
  const auto angle = angle_of_focal_length(focal_length);
  if (angle)
    fov = *angle;
  else
    findings.push_back(
        {"focal_length", fmt::format("'{}' is not a focal length such as 50mm", focal_length)});
}

void ProjectorLight::check(Findings& findings) const {
  if (!(fov > 0.0 && fov < 180.0))
    findings.push_back({"fov", fmt::format("fov must be a number in (0, 180), not {}", fov)});
}

}  // namespace penumbra
