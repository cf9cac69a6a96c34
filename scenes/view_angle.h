// Angles of view of cameras and of lights that project through a rectangle.
#pragma once

#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>

#include "scenes/cameras.h"
#include "scenes/number.h"
#include "scenes/text.h"

namespace penumbra {

/// Whether the axis of a film of that width and height is its width, unless it is the diagonal.
inline bool spans_width(FovAxis axis, double width, double height) {
  return axis == FovAxis::kX || (axis == FovAxis::kSmaller && width <= height) ||
         (axis == FovAxis::kLarger && width > height);
}

/// The length of an axis of a film of that width and height.
inline double axis_length(FovAxis axis, double width, double height) {
  return axis == FovAxis::kDiagonal         ? std::hypot(width, height)
         : spans_width(axis, width, height) ? width
                                            : height;
}

/// The tangent of half the horizontal angle of view, for a rectangle of that width and height whose full
/// angle along `axis` is `fov` degrees.
inline double half_width_tangent(double fov, FovAxis axis, double width, double height) {
  const double tangent = std::tan(0.5 * fov * std::numbers::pi / 180);
  return axis == FovAxis::kDiagonal         ? tangent * width / std::hypot(width, height)
         : spans_width(axis, width, height) ? tangent
                                            : tangent * width / height;
}

/// The full diagonal angle of view in degrees of a 35 mm film (36 mm by 24 mm), for a focal length of "50mm"
/// (or "50").
inline std::optional<double> angle_of_focal_length(std::string_view text) {
  std::string_view digits = trim(text);
  if (digits.ends_with("mm")) digits.remove_suffix(2);
  const auto millimetres = parse_number(digits);
  if (!millimetres || !(*millimetres > 0.0)) return std::nullopt;
  constexpr double kFilmDiagonal = 43.266615305567875;  // in mm
  return 2.0 * std::atan(0.5 * kFilmDiagonal / *millimetres) * 180.0 / std::numbers::pi;
}

}  // namespace penumbra
