#include "scenes/bsdfs/rough_boundary.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <vector>

#include "scenes/angles.h"

namespace penumbra {
namespace {

/// A Gauss-Legendre quadrature rule on [0, 1].
struct Rule {
  std::vector<double> nodes, weights;
  explicit Rule(int n) {
    for (int i = 0; i < n; ++i) {
      double x = std::cos(kPi * (i + 0.75) / (n + 0.5)), slope = 1;
      for (int turn = 0; turn < 10; ++turn) {  // Newton's method for the Legendre polynomial's zero
        double before = 1, value = x;
        for (int k = 2; k <= n; ++k) {
          const double next = ((2 * k - 1) * x * value - (k - 1) * before) / k;
          before = value;
          value = next;
        }
        slope = n * (x * value - before) / (x * x - 1);
        x -= value / slope;
      }
      nodes.push_back(0.5 * (1 + x));
      weights.push_back(1 / ((1 - x * x) * slope * slope));
    }
  }
};

/// As many nodes in each dimension as in Mitsuba 3; more if there is total internal reflection.
const Rule& rule_for(double ior) {
  static const Rule few(32), many(128);
  return ior > 1 ? few : many;
}

/// Finds where an increasing function has a given value, between low and high.
template <typename Function>
double solve(const Function& function, double value, double low, double high) {
  for (int turn = 0; turn < 60; ++turn) {
    const double middle = 0.5 * (low + high);
    (function(middle) > value ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

/// The inverse distribution function of slopes perpendicular to the view plane, for a Gaussian surface of
/// roughness 1.
double gaussian_slope(double u) {
  return solve([](double s) { return std::erf(s); }, 2 * u - 1, -6, 6);
}

/// The same for slopes in the view plane, among those visible from a direction whose tangent is `tangent`
/// (Heitz and d'Eon 2014).
double visible_gaussian_slope(double tangent, double u) {
  const auto below = [&](double s) { return 1 + std::erf(s) + tangent * std::exp(-s * s) / std::sqrt(kPi); };
  const double last = tangent > 1.0 / 6 ? 1 / tangent : 6;
  return solve(below, u * below(last), -6, last);
}

/// The distribution of visible microfacet normals for a viewer at this cosine in the xz plane, represented by
/// the nodes of a quadrature rule.
class VisibleNormals {
 public:
  VisibleNormals(const RoughBoundary& boundary, double cosine, const Rule& rule)
      : ggx_(boundary.distribution == DISTRIBUTION_GGX), alpha_(boundary.alpha) {
    const double sine = std::sqrt(1 - cosine * cosine), length = std::hypot(alpha_ * sine, cosine);
    cosine_ = cosine / length;
    sine_ = alpha_ * sine / length;
    if (ggx_) return;
    for (const double node : rule.nodes) {
      along_.push_back(visible_gaussian_slope(sine_ / cosine_, node));
      across_.push_back(gaussian_slope(node));
    }
  }

  /// The normal for nodes i and j of the rule.
  [[nodiscard]] glm::dvec3 at(const Rule& rule, std::size_t i, std::size_t j) const {
    const glm::dvec2 slope =
        ggx_ ? ggx_slope(rule.nodes[i], rule.nodes[j]) : glm::dvec2(along_[i], across_[j]);
    return glm::normalize(glm::dvec3(-alpha_ * slope.x, -alpha_ * slope.y, 1));
  }

 private:
  /// GGX of roughness 1, whose visible normals are a projected hemisphere (Heitz 2018), with the concentric
  /// disk map of Shirley and Chiu 1997.
  [[nodiscard]] glm::dvec2 ggx_slope(double u, double v) const {
    const double x = 2 * u - 1, y = 2 * v - 1;
    const bool steep = std::abs(x) < std::abs(y);
    const double r = steep ? y : x;
    const double angle = r == 0 ? 0 : steep ? kPi / 2 - kPi / 4 * x / y : kPi / 4 * y / x;
    const double p = r * std::cos(angle), share = 0.5 * (1 + cosine_);
    const double q = (1 - share) * std::sqrt(std::max(0.0, 1 - p * p)) + share * r * std::sin(angle);
    const double z = std::sqrt(std::max(0.0, 1 - p * p - q * q));
    return glm::dvec2(cosine_ * q - sine_ * z, p) / (sine_ * q + cosine_ * z);
  }

  bool ggx_;
  double alpha_, cosine_, sine_;
  std::vector<double> along_, across_;
};

/// Smith's masking for direction v on its side of the microfacet. For Gaussian surfaces it is the rational
/// fit of Walter et al. 2007, which is part of the model.
double masking(const RoughBoundary& boundary, const glm::dvec3& v, const glm::dvec3& m) {
  if (glm::dot(v, m) * v.z <= 0) return 0;
  const double tangent = boundary.alpha * std::hypot(v.x, v.y) / std::abs(v.z);
  if (boundary.distribution == DISTRIBUTION_GGX) return 2 / (1 + std::sqrt(1 + tangent * tangent));
  if (tangent * 1.6 <= 1) return 1;
  const double a = 1 / tangent;
  return (3.535 * a + 2.181 * a * a) / (1 + 2.276 * a + 2.577 * a * a);
}

struct Refraction {
  /// Fresnel reflectance; cosine of the transmitted direction, 0 for total reflection.
  double reflected = 1, cosine = 0;
};
Refraction refract(double cosine, double ior) {
  const double beyond = 1 - (1 - cosine * cosine) / (ior * ior);
  if (beyond <= 0) return {};
  const double t = std::sqrt(beyond);
  const double s = (cosine - ior * t) / (cosine + ior * t), p = (ior * cosine - t) / (ior * cosine + t);
  return {0.5 * (s * s + p * p), t};
}

double knot_cosine(int i) { return std::max(1e-6, double(i) / (CURVE_KNOTS - 1)); }

/// The mean of part(wo, m) over the normals m visible from a viewer wo at this cosine.
template <typename Part>
double mean_over_normals(const RoughBoundary& boundary, double cosine, const Part& part) {
  const Rule& rule = rule_for(boundary.ior);
  const VisibleNormals normals(boundary, cosine, rule);
  const glm::dvec3 wo(std::sqrt(1 - cosine * cosine), 0, cosine);
  double mean = 0;
  for (std::size_t i = 0; i < rule.nodes.size(); ++i)
    for (std::size_t j = 0; j < rule.nodes.size(); ++j)
      mean += rule.weights[i] * rule.weights[j] * part(wo, normals.at(rule, i, j));
  return mean;
}

}  // namespace

std::array<double, CURVE_KNOTS> RoughBoundary::transmittance() const {
  const auto through = [&](const glm::dvec3& wo, const glm::dvec3& m) {
    const double cosine = glm::dot(wo, m);
    const Refraction r = refract(cosine, ior);
    const glm::dvec3 wi = (cosine / ior - r.cosine) * m - wo / ior;
    return wi.z < 0 ? (1 - r.reflected) * masking(*this, wi, m) : 0;
  };
  std::array<double, CURVE_KNOTS> curve{};
  if (smooth_base) {
    for (int i = 0; i < CURVE_KNOTS; ++i) curve[std::size_t(i)] = 1 - refract(knot_cosine(i), ior).reflected;
    return curve;
  }
  for (int i = 0; i < CURVE_KNOTS; ++i)
    curve[std::size_t(i)] = mean_over_normals(*this, knot_cosine(i), through);
  return curve;
}

double RoughBoundary::internal_reflectance() const {
  if (smooth_base) return 1 - 1 / (ior * ior);
  const RoughBoundary beneath{distribution, alpha, 1 / ior};
  const auto back = [&](const glm::dvec3& wo, const glm::dvec3& m) {
    const double cosine = glm::dot(wo, m);
    const glm::dvec3 wi = 2 * cosine * m - wo;
    return wi.z > 0 ? refract(cosine, beneath.ior).reflected * masking(beneath, wi, m) : 0;
  };
  // 2 int R(mu) mu dmu as the mean over all knots including both ends, as in Mitsuba 3.
  double sum = 0;
  for (int i = 0; i < CURVE_KNOTS; ++i)
    sum += 2 * knot_cosine(i) * mean_over_normals(beneath, knot_cosine(i), back);
  return sum / CURVE_KNOTS;
}

}  // namespace penumbra
