#include "scenes/transform.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace penumbra {
namespace {

constexpr double kSimilarityTolerance = 1e-4;
/// A transform is singular if the sine of the angle between axes, times that of the others, is below this.
constexpr double kSmallestVolume = 1e-14;

}  // namespace

glm::dmat4 translation(glm::dvec3 offset) {
  glm::dmat4 result(1.0);
  result[3] = glm::dvec4(offset, 1.0);
  return result;
}

glm::dmat4 scaling(glm::dvec3 factors) {
  glm::dmat4 result(1.0);
  for (int i = 0; i < 3; ++i) result[i][i] = factors[i];
  return result;
}

glm::dmat4 rotation(glm::dvec3 axis, double degrees) {
  const glm::dvec3 a = glm::normalize(axis);
  // Quarter turns are exact, so that rectangles placed by them stay axis-aligned.
  const double turn = std::remainder(degrees, 360.0);
  const double quarter = turn / 90.0;
  double c = std::cos(turn * std::numbers::pi / 180.0), s = std::sin(turn * std::numbers::pi / 180.0);
  if (quarter == std::round(quarter)) c = std::round(c), s = std::round(s);
  glm::dmat4 result(1.0);
  for (int column = 0; column < 3; ++column) {
    glm::dvec3 e(0.0);
    e[column] = 1.0;
    result[column] = glm::dvec4(c * e + s * glm::cross(a, e) + (1.0 - c) * a[column] * a, 0.0);
  }
  return result;
}

Expected<glm::dmat4> look_at(glm::dvec3 origin, glm::dvec3 target, std::optional<glm::dvec3> up) {
  const glm::dvec3 view = target - origin;
  if (!(glm::length(view) > 0.0)) return fail("origin and target are the same point");
  const glm::dvec3 forward = glm::normalize(view);
  glm::dvec3 upward(0.0);
  if (up) {
    upward = *up;
  } else {
    const glm::dvec3 size = glm::abs(forward);
    upward[size.x <= size.y && size.x <= size.z ? 0 : size.y <= size.z ? 1 : 2] = 1.0;
  }
  const glm::dvec3 left = glm::cross(upward, forward);
  if (!(glm::length(left) > 1e-12 * glm::length(upward))) {
    return fail("up is zero or points along the view from origin to target");
  }
  const glm::dvec3 x = glm::normalize(left);
  return glm::dmat4(glm::dvec4(x, 0.0), glm::dvec4(glm::cross(forward, x), 0.0), glm::dvec4(forward, 0.0),
                    glm::dvec4(origin, 1.0));
}

Expected<glm::dmat4> matrix_from_rows(std::span<const double> numbers) {
  if (numbers.size() != 16 && numbers.size() != 9) {
    return fail(fmt::format("a matrix has 16 numbers (or 9), row by row, not {}", numbers.size()));
  }
  const std::size_t side = numbers.size() == 16 ? 4 : 3;
  glm::dmat4 result(1.0);
  for (std::size_t row = 0; row < side; ++row) {
    for (std::size_t column = 0; column < side; ++column) {
      result[int(column)][int(row)] = numbers[row * side + column];
    }
  }
  if (result[0][3] != 0.0 || result[1][3] != 0.0 || result[2][3] != 0.0 || result[3][3] != 1.0) {
    return fail("the last row of a matrix must be 0 0 0 1");
  }
  return result;
}

bool is_singular(const glm::dmat4& transform) {
  const glm::dmat3 axes(transform);
  const double lengths[] = {glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])};
  for (const double length : lengths) {
    if (!(length > 0.0) || !std::isfinite(length)) return true;
  }
  const glm::dmat3 unit(axes[0] / lengths[0], axes[1] / lengths[1], axes[2] / lengths[2]);
  return !(std::abs(glm::determinant(unit)) > kSmallestVolume);
}

bool is_mirror(const glm::dmat4& transform) {
  const glm::dmat3 m(transform);
  return glm::dot(glm::cross(glm::normalize(m[0]), glm::normalize(m[1])), m[2]) < 0.0;
}

std::optional<double> uniform_scale(const glm::dmat4& transform, int axes) {
  const double first = glm::length(glm::dvec3(transform[0]));
  double product = 1.0;
  for (int i = 0; i < axes; ++i) {
    const glm::dvec3 a(transform[i]);
    if (std::abs(glm::length(a) - first) > kSimilarityTolerance * first) return std::nullopt;
    for (int j = 0; j < i; ++j) {
      const glm::dvec3 b(transform[j]);
      if (std::abs(glm::dot(a, b)) > kSimilarityTolerance * first * first) return std::nullopt;
    }
    product *= glm::length(a);
  }
  return axes == 2 ? std::sqrt(product) : std::cbrt(product);
}

Expected<glm::dmat4> without_scale(const glm::dmat4& transform) {
  glm::dmat4 result = transform;
  for (int i = 0; i < 3; ++i) result[i] = glm::dvec4(glm::normalize(glm::dvec3(transform[i])), 0.0);
  if (!uniform_scale(result)) return fail("the transform shears: its axes must be at right angles");
  return result;
}

Expected<glm::dmat4> camera_frame(const glm::dmat4& to_world) {
  if (is_singular(to_world)) return fail("its transform is singular");
  if (auto frame = without_scale(to_world)) return frame;
  const glm::dvec3 eye(to_world[3]);
  return look_at(eye, eye + glm::normalize(glm::dvec3(to_world[2])), glm::dvec3(to_world[1]));
}

glm::dvec3 transform_point(const glm::dmat4& transform, glm::dvec3 point) {
  return glm::dvec3(transform * glm::dvec4(point, 1.0));
}

glm::dvec3 transform_vector(const glm::dmat4& transform, glm::dvec3 vector) {
  return glm::dvec3(transform * glm::dvec4(vector, 0.0));
}

glm::dmat3 normal_matrix(const glm::dmat4& transform) {
  const glm::dmat3 m(transform);
  // The cofactors are the inverse transpose times the determinant. The axes are normalised first to avoid
  // overflow.
  const glm::dvec3 size(glm::length(m[0]), glm::length(m[1]), glm::length(m[2]));
  const glm::dvec3 a = m[0] / size.x, b = m[1] / size.y, c = m[2] / size.z;
  const double sign = is_mirror(transform) ? -1.0 : 1.0;
  const double largest = std::max({1.0 / size.x, 1.0 / size.y, 1.0 / size.z});
  return {sign / size.x / largest * glm::cross(b, c), sign / size.y / largest * glm::cross(c, a),
          sign / size.z / largest * glm::cross(a, b)};
}

}  // namespace penumbra
