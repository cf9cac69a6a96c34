// Panoramic projections in double precision, from the meaning of the settings.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <optional>

#include "scenes/scene_description.h"

namespace penumbra {

/// The unit direction of camera space (x to the left, y up, z forwards) at (u, v) of one picture, from its
/// upper left corner to (1, 1). Nothing beyond a fisheye's circle.
inline std::optional<glm::dvec3> panorama_direction(const CameraSettings& c, const Film& film, double u,
                                                    double v) {
  constexpr double kRadian = std::numbers::pi / 180;
  const auto between = [](double a, double b, double f) { return a + f * (b - a); };
  const double longitude = between(c.longitude_min, c.longitude_max, u) * kRadian;
  const double w = film.width, h = film.height;
  // To the right and up, from the film's centre, in pixels.
  const glm::dvec2 off((u - 0.5 + c.principal_point_offset_x) * w,
                       -(v - 0.5 + c.principal_point_offset_y) * h);
  const auto about_axis = [&](double angle) {
    const glm::dvec2 way = glm::length(off) > 0 ? glm::normalize(off) : glm::dvec2(0);
    return glm::dvec3(-way.x * std::sin(angle), way.y * std::sin(angle), std::cos(angle));
  };
  switch (c.projection) {
    case Projection::kEquirectangular: {
      const double latitude = between(c.latitude_max, c.latitude_min, v) * kRadian;
      return glm::dvec3(-std::sin(longitude) * std::cos(latitude), std::sin(latitude),
                        std::cos(longitude) * std::cos(latitude));
    }
    case Projection::kCylindrical:
      return glm::normalize(
          glm::dvec3(-std::sin(longitude), between(c.height_max, c.height_min, v), std::cos(longitude)));
    case Projection::kFisheyeEquidistant: {
      const double sizes[] = {w, h, std::hypot(w, h), std::min(w, h), std::max(w, h)};
      const double angle = glm::length(off) / sizes[int(c.fov_axis)] * c.fisheye_fov * kRadian;
      return angle <= 0.5 * c.fisheye_fov * kRadian ? std::optional(about_axis(angle)) : std::nullopt;
    }
    case Projection::kFisheyeEquisolid: {
      const double r = glm::length(off) * c.sensor_width / w;  // mm
      const double sine = r / (2 * c.fisheye_lens);
      if (!(sine <= std::sin(0.25 * c.fisheye_fov * kRadian))) return std::nullopt;
      return about_axis(2 * std::asin(sine));
    }
    case Projection::kEqualArea: {
      const double a = 2 * u - 1, b = 1 - 2 * v, d = 1 - std::abs(a) - std::abs(b), r = 1 - std::abs(d);
      const double turn = (r > 0 ? (std::abs(b) - std::abs(a)) / r + 1 : 1) * std::numbers::pi / 4;
      const double out = r * std::sqrt(2 - r * r);
      return glm::dvec3(-std::copysign(std::cos(turn) * out, a), std::copysign(std::sin(turn) * out, b),
                        std::copysign(1 - r * r, d));
    }
    default:
      return std::nullopt;
  }
}

}  // namespace penumbra
