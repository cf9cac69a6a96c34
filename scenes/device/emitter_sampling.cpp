#include "scenes/device/emitter_sampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "scenes/device/to_vec3.h"

namespace penumbra {
namespace {

// A light of more parts has small parts, which gain nothing from solid-angle sampling and take long to
// evaluate.
constexpr std::size_t kMaxParts = 64;
constexpr int kNodes = 6;  // quadrature nodes along each axis of a part
constexpr double kOtherVariance = 0.2;
constexpr double kDirectCost = 0.02, kPathCost = 0.17;

/// The k-th number of an additive recurrence in [0, 1).
double spread(int k, double step) { return std::fmod(0.5 + k * step, 1.0); }

/// Calls add(area, point) for each piece of a shape's surface. point(u, v) maps the unit square onto the
/// piece.
template <typename Add>
void each_piece(const Shape& shape, const Add& add) {
  if (const auto* mesh = std::get_if<Mesh>(&shape.geometry)) {
    for (const glm::uvec3& t : mesh->triangles) {
      const glm::dvec3 a = mesh->positions[t.x], b = mesh->positions[t.y] - a, c = mesh->positions[t.z] - a;
      const glm::dvec3 cross = glm::cross(b, c);
      const double length = glm::length(cross);
      if (!(length > 0) || !std::isfinite(length)) continue;
      add(0.5 * length, [=](double u, double v) {
        const double root = std::sqrt(u);
        return Receiver{a + root * (1 - v) * b + root * v * c, cross / length};
      });
    }
  }
  if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
    add(4 * std::numbers::pi * sphere->radius * sphere->radius, [=](double u, double v) {
      const double z = 1 - 2 * u, r = std::sqrt(std::max(0.0, 1 - z * z)), phi = 2 * std::numbers::pi * v;
      const glm::dvec3 n(r * std::cos(phi), r * std::sin(phi), z);
      return Receiver{sphere->center + sphere->radius * n, n};
    });
  }
  if (const auto* disk = std::get_if<Disk>(&shape.geometry)) {
    add(std::numbers::pi * disk->radius * disk->radius, [=](double u, double v) {
      const glm::dvec3 n = disk->normal;
      const glm::dvec3 other = std::abs(n.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
      const glm::dvec3 s = glm::normalize(glm::cross(n, other)), t = glm::cross(n, s);
      const double r = disk->radius * std::sqrt(u), phi = 2 * std::numbers::pi * v;
      return Receiver{disk->center + r * (std::cos(phi) * s + std::sin(phi) * t), n};
    });
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry)) {
    add(2 * std::numbers::pi * cylinder->radius * cylinder->length, [=](double u, double v) {
      const double phi = 2 * std::numbers::pi * v;
      const glm::dvec3 n = std::cos(phi) * cylinder->x_axis + std::sin(phi) * cylinder->y_axis;
      return Receiver{cylinder->center + u * cylinder->length * cylinder->axis + cylinder->radius * n, n};
    });
  }
}

/// A parallelogram, or half of one.
struct LightPart {
  glm::dvec3 corner, s, t, normal;
  bool whole = false;
  double area = 0;
};

std::vector<LightPart> parts_of(std::span<const LightTriangle> triangles, const Outlines& outlines) {
  std::vector<LightPart> parts;
  const auto add = [&](const vec3& p0, const vec3& p1, const vec3& p2, bool whole) {
    const glm::dvec3 corner = to_dvec3(p0), s = to_dvec3(p1) - corner, t = to_dvec3(p2) - corner;
    const glm::dvec3 cross = glm::cross(s, t);
    const double length = glm::length(cross);
    if (length > 0) parts.push_back({corner, s, t, cross / length, whole, whole ? length : 0.5 * length});
  };
  for (const Outline& outline : outlines.outlines) {
    if (outline.rectangle) {
      const auto& [corner, next, previous] = *outline.rectangle;
      add(corner, next, previous, true);
      continue;
    }
    for (const int t : outline.triangles) {
      const LightTriangle& triangle = triangles[std::size_t(t)];
      add(triangle.p0, triangle.p1, triangle.p2, false);
    }
  }
  return parts;
}

/// Integrals over a part seen from a receiver, with g = cosine at the light / distance^2 and c = the
/// receiver's cosine. They use the midpoint rule on a grid that is uniform in area.
struct Moments {
  double g = 0, gc = 0, gc2 = 0, g2c2 = 0;
};

Moments moments_of(const LightPart& part, const Receiver& receiver, bool two_sided) {
  Moments sum;
  for (int i = 0; i < kNodes; ++i)
    for (int j = 0; j < kNodes; ++j) {
      const double u = (i + 0.5) / kNodes, v = (j + 0.5) / kNodes, root = std::sqrt(u);
      const glm::dvec3 at =
          part.corner + (part.whole ? u * part.s + v * part.t : root * (1 - v) * part.s + root * v * part.t);
      const glm::dvec3 way = receiver.p - at;
      const double d2 = glm::dot(way, way);
      if (!(d2 > 0)) continue;
      const double front = glm::dot(way, part.normal) / std::sqrt(d2);
      const double g = (two_sided ? std::abs(front) : std::max(front, 0.0)) / d2;
      const double c = std::abs(glm::dot(way, receiver.n)) / std::sqrt(d2);
      const double area = part.area / (kNodes * kNodes);
      sum.g += g * area;
      sum.gc += g * c * area;
      sum.gc2 += g * c * c * area;
      sum.g2c2 += g * c * g * c * area;
    }
  return sum;
}

}  // namespace

std::vector<Receiver> light_receivers(const SceneDescription& scene, const glm::dvec3& origin) {
  double total = 0;
  for (const Shape& shape : scene.shapes) each_piece(shape, [&](double area, const auto&) { total += area; });
  std::vector<Receiver> receivers;
  if (!(total > 0) || !std::isfinite(total)) return receivers;
  double passed = 0;
  for (const Shape& shape : scene.shapes) {
    each_piece(shape, [&](double area, const auto& point) {
      passed += area;
      // An additive recurrence with steps of the plastic number (Roberts 2018).
      for (int k = int(receivers.size()); k < kReceivers && (k + 0.5) / kReceivers * total < passed; ++k) {
        receivers.push_back(point(spread(k, 0.7548776662466927), spread(k, 0.5698402909980532)));
        receivers.back().p -= origin;
      }
    });
  }
  return receivers;
}

SamplingVariance sampling_variance(std::span<const LightTriangle> triangles, const Outlines& outlines,
                                   bool two_sided, std::span<const Receiver> receivers) {
  const std::vector<LightPart> parts = parts_of(triangles, outlines);
  SamplingVariance mean;
  if (parts.size() > kMaxParts) return mean;
  double area = 0, weights = 0;
  for (const LightPart& part : parts) area += part.area;
  for (const Receiver& receiver : receivers) {
    double irradiance = 0, by_area = 0, by_angle = 0;
    for (const LightPart& part : parts) {
      const Moments m = moments_of(part, receiver, two_sided);
      irradiance += m.gc;
      by_area += area * m.g2c2;
      by_angle += area / part.area * m.g * m.gc2;
    }
    if (!(irradiance > 0)) continue;
    const auto relative = [&](double second) {
      return std::clamp(second / (irradiance * irradiance) - 1, 0.0, kMostVariance);
    };
    mean.area += irradiance * relative(by_area);
    mean.solid_angle += irradiance * relative(by_angle);
    weights += irradiance;
  }
  if (!(weights > 0)) return {};
  return {mean.area / weights, mean.solid_angle / weights};
}

bool solid_angle_pays(const SamplingVariance& variance, const IntegratorSettings& integrator) {
  const auto path = direct_sampling(integrator);
  const auto* direct = integrator.get<DirectIntegrator>();
  const bool recursive = integrator.is<WhittedIntegrator>();
  const bool samples = path ? *path != DirectSampling::kBsdfOnly
                            : recursive || (direct != nullptr && direct->emitter_samples > 0);
  if (!samples) return false;
  const double cost = path || recursive ? kPathCost : kDirectCost;
  return (kOtherVariance + variance.solid_angle) * (1 + cost) < kOtherVariance + variance.area;
}

}  // namespace penumbra
