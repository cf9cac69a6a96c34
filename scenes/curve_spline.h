// Uniform cubic B-splines with a radius.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>

#include "scenes/curves.h"

namespace penumbra {

constexpr int kMostPieces = 64;  ///< per segment

/// A point of a curve and its derivatives by the parameter.
struct CurveSample {
  glm::dvec3 position, first, second;  ///< position, first and second derivative
  double radius, radius_slope;
  double v;
};

/// Evaluates a segment of a uniform cubic B-spline, given by four points, at t in [0, 1].
inline CurveSample bspline_at(const ControlPoint* points, double t) {
  const double s = 1 - t;
  const std::array<double, 4> w = {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6,
                                   (-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6, t * t * t / 6};
  const std::array<double, 4> d = {-s * s / 2, (3 * t * t - 4 * t) / 2, (-3 * t * t + 2 * t + 1) / 2,
                                   t * t / 2};
  const std::array<double, 4> dd = {s, 3 * t - 2, 1 - 3 * t, t};
  CurveSample sample{glm::dvec3(0), glm::dvec3(0), glm::dvec3(0), 0, 0, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    sample.position += w[i] * points[i].position;
    sample.first += d[i] * points[i].position;
    sample.second += dd[i] * points[i].position;
    sample.radius += w[i] * points[i].radius;
    sample.radius_slope += d[i] * points[i].radius;
  }
  return sample;
}

inline double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  const double lengths = glm::length(a) * glm::length(b);
  return lengths > 0 ? std::acos(std::clamp(glm::dot(a, b) / lengths, -1.0, 1.0)) : 0.0;
}

/// The number of pieces for which the chords are within `chord_error` radii of the curve, also on the
/// outside of bends, where a turn by an angle moves them by the square of the angle over 8.
inline int pieces_of(const ControlPoint* points, double chord_error) {
  const CurveSample begin = bspline_at(points, 0), middle = bspline_at(points, 0.5),
                    end = bspline_at(points, 1);
  // The second derivative is linear, so it is largest at an end. A chord over h deviates by |C''| h^2 / 8.
  const double bend = std::max(glm::length(begin.second), glm::length(end.second));
  const double radius = std::max(middle.radius, 1e-30), error = 8 * chord_error;
  const double turn = angle_between(begin.first, middle.first) + angle_between(middle.first, end.first);
  const double pieces = std::max(std::sqrt(bend / (error * radius)), turn / std::sqrt(error));
  return int(std::clamp(std::ceil(pieces), 1.0, double(kMostPieces)));
}

inline glm::dvec3 direction(const glm::dvec3& vector, const glm::dvec3& otherwise) {
  const double length = glm::length(vector);
  return length > 0 ? vector / length : otherwise;
}

}  // namespace penumbra
