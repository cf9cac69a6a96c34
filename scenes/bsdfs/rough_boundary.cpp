#include "scenes/bsdfs/rough_boundary.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <map>
#include <mutex>
#include <utility>
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

/// Finds where an increasing function has a given value, between low and high: by Newton's method, or by
/// halving where that leaves the interval.
template <typename Function, typename Slope>
double solve(const Function& function, const Slope& slope, double value, double low, double high) {
  double x = 0.5 * (low + high);
  for (int turn = 0; turn < 60; ++turn) {
    const double beyond = function(x) - value;
    (beyond > 0 ? high : low) = x;
    const double next = x - beyond / slope(x);
    const bool inside = next > low && next < high;
    const double before = std::exchange(x, inside ? next : 0.5 * (low + high));
    if (std::abs(x - before) <= 1e-16 * std::max(1.0, std::abs(x))) break;
  }
  return x;
}

/// The inverse distribution function of slopes perpendicular to the view plane, for a Gaussian surface of
/// roughness 1.
double gaussian_slope(double u) {
  return solve([](double s) { return std::erf(s); },
               [](double s) { return 2 / std::sqrt(kPi) * std::exp(-s * s); }, 2 * u - 1, -6, 6);
}

/// The same for slopes in the view plane, among those visible from a direction whose tangent is `tangent`
/// (Heitz and d'Eon 2014).
double visible_gaussian_slope(double tangent, double u) {
  const auto below = [&](double s) { return 1 + std::erf(s) + tangent * std::exp(-s * s) / std::sqrt(kPi); };
  const auto density = [&](double s) { return 2 / std::sqrt(kPi) * std::exp(-s * s) * (1 - s * tangent); };
  const double last = tangent > 1.0 / 6 ? 1 / tangent : 6;
  return solve(below, density, u * below(last), -6, last);
}

/// A rule for the normals of microfacets of roughness 1 that a viewer in the xz plane sees. They are mirrored
/// by that plane, so one half has all the weight. What does not depend on the viewer is computed once.
class NormalRule {
 public:
  /// For a rule of an even number of nodes.
  NormalRule(bool ggx, const Rule& rule) : ggx_(ggx), rule_(rule) {
    const std::size_t n = rule.nodes.size();
    for (std::size_t i = 0; i < n / 2; ++i) {
      if (!ggx) across_.push_back(gaussian_slope(rule.nodes[i]));
      for (std::size_t j = 0; ggx && j < n; ++j) discs_.push_back(disc_point(rule.nodes[i], rule.nodes[j]));
    }
  }

  /// The mean of part(slope) over the slopes that are visible at an angle with this cosine and sine.
  template <typename Part>
  double mean(double cosine, double sine, const Part& part) const {
    const std::size_t n = rule_.nodes.size();
    double mean = 0;
    for (std::size_t i = 0; ggx_ && i < n / 2; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        const DiscPoint& at = discs_[i * n + j];
        const double share = 0.5 * (1 + cosine), q = (1 - share) * at.reach + share * at.along;
        const double z = std::sqrt(std::max(0.0, at.reach * at.reach - q * q));
        const double scale = 1 / (sine * q + cosine * z);
        const glm::dvec2 slope((cosine * q - sine * z) * scale, at.across * scale);
        mean += 2 * rule_.weights[i] * rule_.weights[j] * part(slope);
      }
    for (std::size_t j = 0; !ggx_ && j < n; ++j) {
      const double along = visible_gaussian_slope(sine / cosine, rule_.nodes[j]);
      for (std::size_t i = 0; i < n / 2; ++i)
        mean += 2 * rule_.weights[i] * rule_.weights[j] * part(glm::dvec2(along, across_[i]));
    }
    return mean;
  }

 private:
  /// A point of the unit disc, perpendicular to the view plane and along it, and the extent of the disc along
  /// the plane there.
  struct DiscPoint {
    double across, along, reach;
  };

  /// Visible normals of GGX are those of a projected hemisphere (Heitz 2018), with the concentric disk map of
  /// Shirley and Chiu 1997.
  static DiscPoint disc_point(double u, double v) {
    const double x = 2 * u - 1, y = 2 * v - 1;
    const bool steep = std::abs(x) < std::abs(y);
    const double r = steep ? y : x;
    const double angle = r == 0 ? 0 : steep ? kPi / 2 - kPi / 4 * x / y : kPi / 4 * y / x;
    const double across = r * std::cos(angle);
    return {across, r * std::sin(angle), std::sqrt(std::max(0.0, 1 - across * across))};
  }

  const bool ggx_;
  const Rule& rule_;
  std::vector<DiscPoint> discs_;  ///< GGX: of each pair of nodes
  std::vector<double> across_;    ///< Beckmann: the slopes perpendicular to the view plane
};

/// As many nodes in each dimension as in Mitsuba 3; more if there is total internal reflection.
const NormalRule& rule_for(const RoughBoundary& boundary) {
  static const Rule few(32), many(128);
  static const NormalRule beckmann[] = {{false, few}, {false, many}}, ggx[] = {{true, few}, {true, many}};
  return (boundary.distribution == DISTRIBUTION_GGX ? ggx : beckmann)[boundary.ior > 1 ? 0 : 1];
}

/// Smith's masking for direction v on its side of the microfacet. For Gaussian surfaces it is the rational
/// fit of Walter et al. 2007, which is part of the model.
double masking(const RoughBoundary& boundary, const glm::dvec3& v, const glm::dvec3& m) {
  if (glm::dot(v, m) * v.z <= 0) return 0;
  const double tangent = boundary.alpha * std::sqrt(v.x * v.x + v.y * v.y) / std::abs(v.z);
  if (boundary.distribution == DISTRIBUTION_GGX) return 2 / (1 + std::sqrt(1 + tangent * tangent));
  if (tangent * 1.6 <= 1) return 1;
  const double a = 1 / tangent;
  return (3.535 * a + 2.181 * a * a) / (1 + 2.276 * a + 2.577 * a * a);
}

double knot_cosine(int i) { return std::max(1e-6, double(i) / (CURVE_KNOTS - 1)); }

/// The mean of part(wo, m) over the normals m visible from a viewer wo at this cosine.
template <typename Part>
double mean_over_normals(const RoughBoundary& boundary, double cosine, const Part& part) {
  const glm::dvec3 wo(std::sqrt(1 - cosine * cosine), 0, cosine);
  // The surface of roughness 1 that is stretched to this one, and the viewer stretched with it.
  const double length = std::hypot(boundary.alpha * wo.x, cosine);
  return rule_for(boundary).mean(
      cosine / length, boundary.alpha * wo.x / length, [&](const glm::dvec2& slope) {
        return part(wo, glm::normalize(glm::dvec3(-boundary.alpha * slope.x, -boundary.alpha * slope.y, 1)));
      });
}

}  // namespace

std::array<double, CURVE_KNOTS> RoughBoundary::transmittance() const {
  const auto through = [&](const glm::dvec3& wo, const glm::dvec3& m) {
    const double cosine = glm::dot(wo, m);
    const SmoothRefraction r = smooth_refraction(cosine, ior);
    const glm::dvec3 wi = (cosine / ior - r.cosine) * m - wo / ior;
    return wi.z < 0 ? (1 - r.reflected) * masking(*this, wi, m) * std::exp(optical_depth / wi.z) : 0;
  };
  std::array<double, CURVE_KNOTS> curve{};
  if (smooth_base) {
    for (int i = 0; i < CURVE_KNOTS; ++i)
      curve[std::size_t(i)] = 1 - smooth_refraction(knot_cosine(i), ior).reflected;
    return curve;
  }
  for (int i = 0; i < CURVE_KNOTS; ++i)
    curve[std::size_t(i)] = mean_over_normals(*this, knot_cosine(i), through);
  return curve;
}

namespace {

double computed_internal_reflectance(const RoughBoundary& boundary) {
  const RoughBoundary beneath{boundary.distribution, boundary.alpha, 1 / boundary.ior};
  const auto back = [&](const glm::dvec3& wo, const glm::dvec3& m) {
    const double cosine = glm::dot(wo, m);
    const glm::dvec3 wi = 2 * cosine * m - wo;
    if (!(wi.z > 0)) return 0.0;
    return smooth_refraction(cosine, beneath.ior).reflected * masking(beneath, wi, m) *
           std::exp(-boundary.optical_depth * (1 / wo.z + 1 / wi.z));
  };
  // 2 int R(mu) mu dmu as the mean over all knots including both ends, as in Mitsuba 3.
  double sum = 0;
  for (int i = 0; i < CURVE_KNOTS; ++i)
    sum += 2 * knot_cosine(i) * mean_over_normals(beneath, knot_cosine(i), back);
  return sum / CURVE_KNOTS;
}

}  // namespace

double RoughBoundary::internal_reflectance() const {
  if (smooth_base) return 1 - 1 / (ior * ior);
  // A quarter of the time in which a scene of many coats that has been read is built again.
  static std::mutex mutex;
  static std::map<RoughBoundary, double> known;
  const std::lock_guard lock(mutex);
  const auto [found, is_new] = known.try_emplace(*this);
  if (is_new) found->second = computed_internal_reflectance(*this);
  return found->second;
}

double smooth_internal_reflectance(double ior, double optical_depth) {
  if (!(optical_depth > 0)) return smooth_internal_reflectance(ior);
  // Beyond the critical angle all is reflected.
  static const Rule rule(64);
  const double critical = ior > 1 ? std::sqrt(1 - 1 / (ior * ior)) : 0;
  double sum = 0;
  for (const auto [low, high] : {std::pair(0.0, critical), std::pair(critical, 1.0)})
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      // Squared, so that the square root at the critical angle is smooth.
      const double cosine = low + (high - low) * rule.nodes[i] * rule.nodes[i];
      const double reflected = smooth_refraction(cosine, 1 / ior).reflected;
      sum += (high - low) * 2 * rule.nodes[i] * rule.weights[i] * 2 * cosine * reflected *
             std::exp(-2 * optical_depth / cosine);
    }
  return sum;
}

}  // namespace penumbra
