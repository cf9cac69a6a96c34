#include "scenes/device/filter_table.h"

#include <cmath>

#include "kernels/scene_types.h"

namespace penumbra {
namespace {

// Steps of the midpoint rule for each filter: fine enough that a knot is off by less than a float's rounding times 100.
constexpr int kSteps = 1 << 16;

/// Mitchell and Netravali 1988 with parameters B and C, at x in pixels, |x| <= 2.
double mitchell(double x, double b, double c) {
  x = std::abs(x);
  if (x >= 2) return 0;
  if (x < 1) return ((12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + (6 - 2 * b)) / 6;
  return ((-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x + (8 * b + 24 * c)) / 6;
}

}  // namespace

double filter_value(const Film& film, double x) {
  const double r = film.filter_radius;
  switch (film.filter) {
    case FilterKind::kBox:
      return 1;
    case FilterKind::kTent:
      return 1 - std::abs(x);
    case FilterKind::kGaussian: {
      // Lowered so that it ends at 0 without a step.
      const double falloff = -1 / (2.0 * film.filter_stddev * film.filter_stddev);
      return std::max(0.0, std::exp(falloff * x * x * r * r) - std::exp(falloff * r * r));
    }
    case FilterKind::kMitchell:
      return mitchell(2 * x, film.filter_b, film.filter_c);  // stretched to the radius
  }
  return 0;
}

std::vector<float> filter_table(const Film& film) {
  std::vector<double> value(kSteps);
  double total_magnitude = 0, total = 0;
  for (int i = 0; i < kSteps; ++i) {
    value[std::size_t(i)] = filter_value(film, -1 + (i + 0.5) * 2 / kSteps);
    total_magnitude += std::abs(value[std::size_t(i)]);
    total += value[std::size_t(i)];
  }
  std::vector<float> knots{-1.0f}, weights;
  double magnitude = 0, mass = 0;
  for (int i = 0; i < kSteps; ++i) {
    double remaining = std::abs(value[std::size_t(i)]);
    const double sign = value[std::size_t(i)] < 0 ? -1 : 1;
    while (int(weights.size()) < FILTER_CELLS - 1) {
      const double cell_end = total_magnitude * double(weights.size() + 1) / FILTER_CELLS;
      if (magnitude + remaining < cell_end) break;
      const double part = cell_end - magnitude;
      const double into = 1 - (remaining - part) / std::abs(value[std::size_t(i)]);
      knots.push_back(float(-1 + (i + into) * 2 / kSteps));
      weights.push_back(float((mass + sign * part) / total * FILTER_CELLS));
      mass = 0;
      magnitude = cell_end;
      remaining -= part;
    }
    magnitude += remaining;
    mass += sign * remaining;
  }
  knots.push_back(1.0f);
  weights.push_back(float(mass / total * FILTER_CELLS));
  knots.insert(knots.end(), weights.begin(), weights.end());
  return knots;
}

}  // namespace penumbra
