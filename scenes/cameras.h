// The camera, with one row for every parameter that is a number or a choice. A new parameter is a member here
// and a row below: --set, scene files, messages, the table of all settings and the copy for the kernels
// follow from the row.
#pragma once

#include <glm/glm.hpp>
#include <limits>

#include "kernels/scene_types.h"
#include "scenes/setting_values.h"

namespace penumbra {

enum class FovAxis { kX, kY, kDiagonal, kSmaller, kLarger };

inline OneOf<FovAxis> fov_axes() {
  return {{{"x", FovAxis::kX},
           {"y", FovAxis::kY},
           {"diagonal", FovAxis::kDiagonal},
           {"smaller", FovAxis::kSmaller},
           {"larger", FovAxis::kLarger}}};
}

/// Camera space looks along +z with +y up and +x to the left of the image (Mitsuba's convention).
struct PerspectiveCamera {
  glm::dmat4 to_world{1.0};  ///< camera to world; a scale has no effect on directions
  double fov =
      50.0;  ///< full angle, degrees, in (0, 180), along `fov_axis`, of the whole film (not of the crop)
  FovAxis fov_axis = FovAxis::kX;
  double near_clip = 1e-2;  ///< distances along +z; nothing outside is seen by the camera
  double far_clip = 1e4;
};

/// Calls row(name, member, values, text[, member of the kernels' camera that it is copied to]) for each.
template <typename Row>
void camera_parameters(const Row& row) {
  using C = PerspectiveCamera;
  constexpr double kFar = std::numeric_limits<float>::max();
  row("fov", &C::fov, Number<double>{LowEnd::kOpen, 0.0, 180.0}, "full angle of the whole film, degrees");
  row("fov_axis", &C::fov_axis, fov_axes(), "what the angle spans");
  row("near_clip", &C::near_clip, Number<double>{LowEnd::kOpen, 0.0, kFar},
      "nothing nearer along the view is seen", &Camera::near_clip);
  row("far_clip", &C::far_clip, Number<double>{LowEnd::kOpen, 0.0, kFar},
      "nothing farther along the view is seen", &Camera::far_clip);
}

}  // namespace penumbra
