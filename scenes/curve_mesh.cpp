#include "scenes/curve_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scenes/angles.h"
#include "scenes/curve_spline.h"

namespace penumbra {
namespace {

/// Levels of tessellation. Meshes with fewer rings get a finer one.
struct Fineness {
  int sides;           ///< of the polygon that replaces the circular cross section
  double chord_error;  ///< largest distance between a curve and its chords, in radii
  std::size_t most_rings;
};
constexpr Fineness kFineness[] = {{32, 0.004, 20'000}, {16, 0.02, 250'000}, {8, 0.2, SIZE_MAX}};
constexpr std::size_t kMostTriangles = std::size_t{1} << 27;

/// The finest level for which the number of rings, `rings(fineness)`, is within the level's limit.
template <typename Rings>
const Fineness& fineness_for(const Rings& rings) {
  for (const Fineness& each : kFineness)
    if (rings(each) <= each.most_rings) return each;
  return std::end(kFineness)[-1];
}

/// Two unit vectors across a tangent: where u = 0, and a quarter turn further.
struct Across {
  glm::dvec3 n, b;
};
Across across(const glm::dvec3& tangent) {
  const glm::dvec2 flat(-tangent.y, tangent.x);
  const double length = glm::length(flat);
  const glm::dvec3 n =
      length > 1e-9 ? glm::dvec3(flat / length, 0.0) : glm::dvec3(tangent.z < 0 ? -1 : 1, 0, 0);
  return {n, glm::cross(tangent, n)};
}

class TubeBuilder {
 public:
  explicit TubeBuilder(const Fineness& fineness) {
    result_.sides = fineness.sides;
    const double half = kPi / result_.sides;
    // The mean width of a polygon is its perimeter over pi (Cauchy).
    widened_ = half / std::sin(half);
    result_.error = 1.0 - widened_ * std::cos(half) + fineness.chord_error;
  }

  [[nodiscard]] int sides() const { return result_.sides; }

  /// Adds a circle. `normal` computes each point's normal from its direction from the centre.
  template <typename Normal>
  void ring(const glm::dvec3& center, const glm::dvec3& tangent, double radius, double v,
            const Normal& normal) {
    Mesh& mesh = result_.mesh;
    const Across frame = across(tangent);
    for (int k = 0; k <= sides(); ++k) {
      const double angle = 2 * kPi * (k % sides()) / sides();
      const glm::dvec3 out = std::cos(angle) * frame.n + std::sin(angle) * frame.b;
      mesh.positions.push_back(center + radius * widened_ * out);
      mesh.normals.emplace_back(glm::normalize(normal(out)));
      mesh.texcoords.emplace_back(float(k) / float(sides()), float(v));
    }
    last_ = before_;
    before_ = {tangent, radius};
  }

  /// Joins the last two rings with triangles; the second one is `along` the tangent of the first. Points are
  /// matched by the shortest rotation from one tangent to the other.
  void join() {
    const int n = sides();
    const std::uint32_t to = std::uint32_t(result_.mesh.positions.size()) - std::uint32_t(n + 1),
                        from = to - std::uint32_t(n + 1);
    const Across a = across(last_.tangent), b = across(before_.tangent);
    const glm::dvec3 moved = turned(a.n, last_.tangent, before_.tangent);
    const double twist = std::atan2(glm::dot(moved, b.b), glm::dot(moved, b.n));
    const int shift = (int(std::lround(twist * n / (2 * kPi))) % n + n) % n;
    for (int k = 0; k < n; ++k) {
      const std::uint32_t p = from + std::uint32_t(k), q = p + 1;
      const std::uint32_t r = to + std::uint32_t((k + shift) % n), s = r + 1;
      if (last_.radius > 0) result_.mesh.triangles.emplace_back(p, q, r);
      if (before_.radius > 0) result_.mesh.triangles.emplace_back(q, s, r);
    }
  }

  CurveMesh take() { return std::move(result_); }

 private:
  struct Ring {
    glm::dvec3 tangent{0, 0, 1};
    double radius = 0;
  };

  /// Applies the shortest rotation from one unit vector to the other to `vector`.
  static glm::dvec3 turned(const glm::dvec3& vector, const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dvec3 axis = glm::cross(from, to);
    const double cosine = glm::dot(from, to);
    if (cosine < -0.999) return vector;
    return vector * cosine + glm::cross(axis, vector) + axis * (glm::dot(axis, vector) / (1 + cosine));
  }

  CurveMesh result_;
  double widened_ = 1.0;
  Ring last_, before_;
};

Expected<void> check_triangles(std::size_t rings, int sides) {
  if (rings <= kMostTriangles / (2 * std::size_t(sides))) return {};
  return fail(fmt::format("the curves would be {} triangles; at most {} are made",
                          rings * 2 * std::size_t(sides), kMostTriangles));
}

/// Adds a sphere as rings from pole to pole.
void add_sphere(TubeBuilder& builder, const ControlPoint& point, const glm::dvec3& axis, double v) {
  const int rings = builder.sides() / 2;
  for (int i = 0; i <= rings; ++i) {
    const double angle = kPi * i / rings, along = -std::cos(angle),
                 out = i % rings == 0 ? 0.0 : std::sin(angle);
    builder.ring(point.position + point.radius * along * axis, axis, point.radius * out, v,
                 [&](const glm::dvec3& side) { return out * side + along * axis; });
    if (i > 0) builder.join();
  }
}

}  // namespace

Expected<CurveMesh> curve_mesh(const Curves& curves) {
  return curves.form == CurveForm::kBalls ? linear_curve_mesh(curves.curves)
                                          : bspline_curve_mesh(curves.curves);
}

Expected<CurveMesh> bspline_curve_mesh(std::span<const Curve> curves) {
  std::size_t segments = 0;
  for (const Curve& curve : curves) segments += curve.size() - 3;
  const auto rings = [&](const Fineness& fineness) {
    std::size_t count = curves.size();
    for (const Curve& curve : curves)
      for (std::size_t i = 0; i + 3 < curve.size(); ++i)
        count += std::size_t(pieces_of(&curve[i], fineness.chord_error));
    return count;
  };
  const Fineness& fineness = fineness_for(rings);
  TubeBuilder builder(fineness);
  if (const auto few = check_triangles(rings(fineness), builder.sides()); !few)
    return std::unexpected(few.error());
  std::size_t before = 0;
  for (const Curve& curve : curves) {
    glm::dvec3 tangent(0, 0, 1);
    const auto add = [&](std::size_t segment, double t) {
      const CurveSample sample = bspline_at(&curve[segment], t);
      tangent = direction(sample.first, tangent);
      const double speed = glm::length(sample.first);
      // The derivative of the unit tangent.
      const glm::dvec3 bend =
          speed > 0 ? (sample.second - tangent * glm::dot(sample.second, tangent)) / speed : glm::dvec3(0);
      const double v = (double(before + segment) + t) / double(segments);
      // The normal is perpendicular to both derivatives of the surface; the one along the curve is (|C'| - r
      // d.T') T + r' d.
      builder.ring(sample.position, tangent, sample.radius, v, [&](const glm::dvec3& side) {
        const double along = std::max(speed - sample.radius * glm::dot(side, bend), 1e-6 * speed);
        const glm::dvec3 normal = along * side - sample.radius_slope * tangent;
        return glm::length(normal) > 0 ? normal : side;
      });
    };
    add(0, 0.0);
    for (std::size_t i = 0; i + 3 < curve.size(); ++i) {
      const int pieces = pieces_of(&curve[i], fineness.chord_error);
      for (int k = 1; k <= pieces; ++k) {
        add(i, double(k) / pieces);
        builder.join();
      }
    }
    before += curve.size() - 3;
  }
  return builder.take();
}

Expected<CurveMesh> linear_curve_mesh(std::span<const Curve> curves) {
  std::size_t segments = 0, points = 0;
  for (const Curve& curve : curves) {
    segments += curve.size() - 1;
    points += curve.size();
  }
  const auto rings = [&](const Fineness& fineness) {
    return segments * 2 + points * (std::size_t(fineness.sides) / 2 + 1);
  };
  const Fineness& fineness = fineness_for(rings);
  TubeBuilder builder(fineness);
  if (const auto few = check_triangles(rings(fineness), builder.sides()); !few)
    return std::unexpected(few.error());
  std::size_t before = 0;
  for (const Curve& curve : curves) {
    glm::dvec3 axis(0, 0, 1);
    for (std::size_t i = 0; i < curve.size(); ++i) {
      const double v = double(before + i) / double(segments);
      const bool last = i + 1 == curve.size();
      const glm::dvec3 step = last ? glm::dvec3(0) : curve[i + 1].position - curve[i].position;
      const glm::dvec3 along = direction(step, axis);
      // As in Embree, a sphere has the frame of the segment that ends there; the first, of that which begins.
      if (curve[i].radius > 0) add_sphere(builder, curve[i], i == 0 ? along : axis, v);
      axis = along;
      if (last) continue;
      // The cone's circles are tilted towards the smaller sphere. There is no cone if one sphere contains the
      // other.
      const double sine = (curve[i].radius - curve[i + 1].radius) / glm::length(step);
      if (!(std::abs(sine) < 1.0)) continue;
      const double cosine = std::sqrt(1 - sine * sine);
      const auto normal = [&](const glm::dvec3& side) { return cosine * side + sine * axis; };
      for (const std::size_t end : {i, i + 1}) {
        const ControlPoint& point = curve[end];
        builder.ring(point.position + axis * (point.radius * sine), axis, point.radius * cosine,
                     double(before + end) / double(segments), normal);
      }
      builder.join();
    }
    before += curve.size() - 1;
  }
  return builder.take();
}

}  // namespace penumbra
