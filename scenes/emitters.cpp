#include "scenes/emitters.h"

#include <fmt/format.h>

#include "scenes/view_angle.h"

namespace penumbra {

void SpotLight::check(Findings& findings) const {
  const bool flat = texture.texture != kNoTexture;
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
