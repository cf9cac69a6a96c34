#include "scenes/device/curve_pieces.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>

#include "scenes/curve_spline.h"
#include "scenes/device/to_vec3.h"

namespace penumbra {
namespace {

/// Levels of fineness: of curves with at most so many pieces, each within so many radii of the curve.
struct Fineness {
  std::size_t most_pieces;
  double chord_error;
};
constexpr Fineness kFineness[] = {{100'000, 0.01}, {1'000'000, 0.05}, {SIZE_MAX, 0.25}};

double fineness_of(const Curves& curves) {
  for (const Fineness& each : kFineness) {
    std::size_t pieces = 0;
    for (const Curve& curve : curves.curves)
      for (std::size_t i = 0; i + 3 < curve.size(); ++i)
        pieces += std::size_t(pieces_of(&curve[i], each.chord_error));
    if (pieces <= each.most_pieces) return each.chord_error;
  }
  return std::end(kFineness)[-1].chord_error;
}

/// The end of a piece.
struct Joint {
  glm::dvec3 position, tangent;
  double radius, parameter;
};

class PieceMaker {
 public:
  PieceMaker(int kind, const std::function<vec3(const glm::dvec3&, double)>& local)
      : kind_(kind), local_(local) {}

  void add(const Joint& from, const Joint& to) {
    Quadric q{};
    q.kind = kind_;
    q.light = -1;
    q.center = local_(from.position, from.radius);
    q.x_axis = local_(to.position, to.radius);
    q.radius = float(from.radius);
    q.length = float(to.radius);
    q.orientation = float(from.parameter);
    const vec3 step = sub(q.x_axis, q.center);
    const float length = length3(step), span = float(to.parameter - from.parameter);
    if (!(length > 0.0f) || !(std::max(q.radius, q.length) > 0.0f) || !(span > 0.0f)) return;
    const glm::dvec3 along = glm::normalize(to.position - from.position);
    // A plane that leans more than this cuts the piece across its axis instead.
    constexpr double kLeastCosine = 0.8;
    const auto cut = [&](const glm::dvec3& tangent) {
      return glm::dot(tangent, along) > kLeastCosine ? tangent : along;
    };
    q.normal = to_vec3(cut(from.tangent));
    q.y_axis = to_vec3(double(span) * cut(to.tangent));
    pieces_.push_back(q);
  }
  std::vector<Quadric> take() { return std::move(pieces_); }

 private:
  const int kind_;
  const std::function<vec3(const glm::dvec3&, double)>& local_;
  std::vector<Quadric> pieces_;
};

Joint joint_at(const ControlPoint* points, double t, double parameter) {
  const CurveSample sample = bspline_at(points, t);
  // Where the speed is 0 the curve goes the way of its second derivative.
  const glm::dvec3 way =
      glm::length(sample.first) > 0 ? sample.first : (t < 0.5 ? 1.0 : -1.0) * sample.second;
  return {sample.position, direction(way, glm::dvec3(0, 0, 1)), std::max(sample.radius, 0.0), parameter};
}

void add_spline(PieceMaker& maker, const Curve& curve, glm::dvec2 range, double chord_error) {
  const std::size_t segments = curve.size() - 3;
  for (std::size_t i = 0; i < segments; ++i) {
    const auto at = [&](double t) {
      const double along = (double(i) + t) / double(segments);
      return joint_at(&curve[i], t, range.x + along * (range.y - range.x));
    };
    const int pieces = pieces_of(&curve[i], chord_error);
    Joint before = at(0);
    for (int k = 1; k <= pieces; ++k) {
      const Joint next = at(double(k) / pieces);
      maker.add(before, next);
      before = next;
    }
  }
}

void add_straight(PieceMaker& maker, const Curve& curve, glm::dvec2 range) {
  const std::size_t segments = curve.size() - 1;
  for (std::size_t i = 0; i < segments; ++i) {
    const glm::dvec3 along = direction(curve[i + 1].position - curve[i].position, glm::dvec3(0, 0, 1));
    const auto at = [&](std::size_t k) {
      return Joint{curve[k].position, along, curve[k].radius,
                   range.x + double(k) / double(segments) * (range.y - range.x)};
    };
    maker.add(at(i), at(i + 1));
  }
}

}  // namespace

std::vector<Quadric> curve_pieces(const Curves& curves,
                                  const std::function<vec3(const glm::dvec3& p, double reach)>& local) {
  constexpr int kKinds[] = {QUADRIC_ROUND, QUADRIC_ROUND_BALLS, QUADRIC_RIBBON, QUADRIC_CYLINDRICAL_RIBBON};
  const bool straight = curves.form == CurveForm::kBalls;
  const std::size_t more = straight ? 1 : 3;  // points than segments
  const double chord_error = straight ? 0.0 : fineness_of(curves);
  std::size_t segments = 0, before = 0;
  for (const Curve& curve : curves.curves) segments += curve.size() - more;
  PieceMaker maker(kKinds[int(curves.form)], local);
  for (std::size_t i = 0; i < curves.curves.size(); ++i) {
    const Curve& curve = curves.curves[i];
    const std::size_t own = curve.size() - more;
    const glm::dvec2 range = curves.ranges.empty()
                                 ? glm::dvec2(double(before), double(before + own)) / double(segments)
                                 : glm::dvec2(curves.ranges[i]);
    if (straight)
      add_straight(maker, curve, range);
    else
      add_spline(maker, curve, range, chord_error);
    before += own;
  }
  return maker.take();
}

}  // namespace penumbra
