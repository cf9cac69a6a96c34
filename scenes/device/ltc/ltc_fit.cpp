#include "scenes/device/ltc/ltc_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "scenes/angles.h"

namespace penumbra::ltc {
namespace {

// The roughness of the first row. Below it, shapes are assumed to scale with alpha.
constexpr double kLeastAlpha = 1e-3;
constexpr double kLeastCosine = 1e-3;
constexpr int kFitSide = 40, kMeanSide = 300;

double sqr(double x) { return x * x; }

double ggx_lambda(const glm::dvec3& w, double alpha) {
  const double slope2 = sqr(alpha) * (sqr(w.x) + sqr(w.y)) / sqr(w.z);
  return 0.5 * (std::sqrt(1 + slope2) - 1);
}

double beckmann_lambda(const glm::dvec3& w, double alpha) {
  const double sine = std::sqrt(sqr(w.x) + sqr(w.y));
  if (sine == 0) return 0;
  const double a = std::abs(w.z) / (alpha * sine);
  return 0.5 * (std::exp(-a * a) / (a * std::sqrt(kPi)) - std::erfc(a));
}

/// Smith's G1.
double masking(Distribution distribution, const glm::dvec3& w, double alpha) {
  return 1 / (1 + (distribution == Distribution::kGgx ? ggx_lambda(w, alpha) : beckmann_lambda(w, alpha)));
}

double density(Distribution distribution, const glm::dvec3& h, double alpha) {
  const double z2 = sqr(h.z), a2 = sqr(alpha), tangent2 = (sqr(h.x) + sqr(h.y)) / z2;
  if (distribution == Distribution::kGgx) return 1 / (kPi * a2 * sqr(z2) * sqr(1 + tangent2 / a2));
  return std::exp(-tangent2 / a2) / (kPi * a2 * sqr(z2));
}

/// Minimisation by the simplex method of Nelder and Mead 1965.
using Point = std::array<double, 3>;
template <typename Function>
Point minimum(const Function& f, const Point& start, double step) {
  struct Vertex {
    Point x;
    double f;
  };
  std::array<Vertex, 4> s;
  s[0] = {start, f(start)};
  for (std::size_t i = 0; i < 3; ++i) {
    Point x = start;
    x[i] += step;
    s[i + 1] = {x, f(x)};
  }
  const auto order = [&] { std::sort(s.begin(), s.end(), [](auto& a, auto& b) { return a.f < b.f; }); };
  order();
  for (int k = 0; k < 200 && s[3].f - s[0].f > 1e-9 * s[0].f; ++k) {
    const auto at = [&](double t) {
      Point x;
      for (std::size_t i = 0; i < 3; ++i) {
        const double center = (s[0].x[i] + s[1].x[i] + s[2].x[i]) / 3;
        x[i] = center + t * (s[3].x[i] - center);
      }
      return Vertex{x, f(x)};
    };
    const Vertex mirrored = at(-1);
    if (mirrored.f < s[0].f) {
      const Vertex farther = at(-2);
      s[3] = farther.f < mirrored.f ? farther : mirrored;
    } else if (mirrored.f < s[2].f) {
      s[3] = mirrored;
    } else {
      const Vertex nearer = mirrored.f < s[3].f ? at(-0.5) : at(0.5);
      if (nearer.f < std::min(mirrored.f, s[3].f)) {
        s[3] = nearer;
      } else {
        for (std::size_t v = 1; v < 4; ++v) {
          for (std::size_t i = 0; i < 3; ++i) s[v].x[i] = 0.5 * (s[0].x[i] + s[v].x[i]);
          s[v].f = f(s[v].x);
        }
      }
    }
    order();
  }
  return s[0].x;
}

}  // namespace

Lobe::Lobe(Distribution distribution, double alpha, double cosine)
    : distribution_(distribution), alpha_(alpha), wo_(-std::sqrt(1 - sqr(cosine)), 0, cosine) {
  masking_ = masking(distribution, wo_, alpha);
  ggx_masking_ = masking(Distribution::kGgx, wo_, alpha);
}

double Lobe::operator()(const glm::dvec3& wi) const {
  if (wi.z <= 0) return 0;
  const glm::dvec3 h = glm::normalize(wi + wo_);
  return density(distribution_, h, alpha_) * masking_ * masking(distribution_, wi, alpha_) / (4 * wo_.z);
}

glm::dvec3 Lobe::sample(double u, double v) const {
  const glm::dvec3 stretched = glm::normalize(glm::dvec3(alpha_ * wo_.x, 0, wo_.z));
  const glm::dvec3 t(0, 1, 0), b(stretched.z, 0, -stretched.x);
  const double r = std::sqrt(u), phi = 2 * kPi * v, p1 = r * std::cos(phi);
  const double s = 0.5 * (1 + stretched.z);
  const double p2 = (1 - s) * std::sqrt(1 - p1 * p1) + s * r * std::sin(phi);
  const glm::dvec3 n = p1 * t + p2 * b + std::sqrt(std::max(0.0, 1 - p1 * p1 - p2 * p2)) * stretched;
  const glm::dvec3 h = glm::normalize(glm::dvec3(alpha_ * n.x, alpha_ * n.y, std::max(1e-300, n.z)));
  return 2 * glm::dot(wo_, h) * h - wo_;
}

double Lobe::pdf(const glm::dvec3& wi) const {
  const glm::dvec3 h = glm::normalize(wi + wo_);
  return h.z <= 0 ? 0 : density(Distribution::kGgx, h, alpha_) * ggx_masking_ / (4 * wo_.z);
}

double Transform::operator()(const glm::dvec3& wi) const {
  if (wi.z <= 0) return 0;
  const double x = (wi.x - shift * wi.z) / width_x, y = wi.y / width_y;
  return wi.z / (kPi * width_x * width_y * sqr(x * x + y * y + wi.z * wi.z));
}

glm::dvec3 Transform::sample(double u, double v) const {
  const double r = std::sqrt(u), phi = 2 * kPi * v, z = std::sqrt(1 - u);
  return glm::normalize(glm::dvec3(width_x * r * std::cos(phi) + shift * z, width_y * r * std::sin(phi), z));
}

Transform transform_of(const Cell& cell, double alpha, double cosine) {
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const double lean = sine * cell.lean, upright = std::sqrt(std::max(0.0, 1 - lean * lean));
  const double shift = (sine * upright - cosine * lean) / (cosine * upright + sine * lean);
  return {2 * alpha * cell.width_x * (1 + shift * shift), 2 * alpha * cell.width_y, shift};
}

Residual residual(const Lobe& lobe, const Cell& cell, int side) {
  const Transform transform = transform_of(cell, lobe.alpha(), lobe.wo().z);
  double discrimination = 0, squares = 0, all = 0;
  const auto add = [&](const glm::dvec3& wi) {
    const double f = lobe(wi), g = cell.albedo * transform(wi);
    const double weight = 1 / (lobe.pdf(wi) + transform(wi));
    if (f + g > 0) discrimination += sqr(f - g) / (f + g) * weight;
    squares += sqr(f - g) * weight;
    all += f * f * weight;
  };
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const double u = (i + 0.5) / side, v = (j + 0.5) / side;
      add(lobe.sample(u, v));
      add(transform.sample(u, v));
    }
  return {0.5 * discrimination / (side * side) / cell.albedo, std::sqrt(squares / all)};
}

Cell fit(const Lobe& lobe, const Cell& start) {
  Cell cell = start;
  double albedo = 0, schlick = 0;
  for (int i = 0; i < kMeanSide; ++i)
    for (int j = 0; j < kMeanSide; ++j) {
      const glm::dvec3 wi = lobe.sample((i + 0.5) / kMeanSide, (j + 0.5) / kMeanSide);
      const double f = lobe(wi);
      if (!(f > 0)) continue;
      const double c = 1 - glm::dot(wi, glm::normalize(wi + lobe.wo()));
      albedo += f / lobe.pdf(wi);
      schlick += f / lobe.pdf(wi) * (c * c) * (c * c) * c;
    }
  cell.albedo = albedo / (kMeanSide * kMeanSide);
  cell.schlick = schlick / albedo;
  const auto with = [&](const Point& x) {
    Cell changed = cell;
    changed.lean = x[0];
    changed.width_x = std::exp(x[1]);
    changed.width_y = std::exp(x[2]);
    return changed;
  };
  const auto cost = [&](const Point& x) {
    if (std::abs(x[0]) > 1) return 10 + std::abs(x[0]);
    return residual(lobe, with(x), kFitSide).discrimination;
  };
  Point best = minimum(cost, {cell.lean, std::log(cell.width_x), std::log(cell.width_y)}, 0.1);
  best = minimum(cost, best, 0.03);
  return with(best);
}

double knot_alpha(double row, int size) { return std::max(sqr(row / (size - 1)), kLeastAlpha); }
double knot_cosine(double column, int size) { return std::max(sqr(column / (size - 1)), kLeastCosine); }

}  // namespace penumbra::ltc
