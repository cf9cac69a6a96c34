#include "scenes/device/filter_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernels/scene_types.h"

namespace penumbra {
namespace {

/// The cumulative distribution of |x| up to position s of the table, in cells from 0 to FILTER_CELLS.
double mass_before(double s) {
  const double beyond = 1 - s / FILTER_CELLS;
  return 1 - beyond * beyond;
}

// Steps of the midpoint rule for each filter: fine enough that the error of a knot is below 100 rounding
// errors of a float.
constexpr int kSteps = 1 << 16;

/// Mitchell and Netravali 1988 with parameters B and C, at x in pixels, |x| <= 2.
double mitchell(double x, double b, double c) {
  x = std::abs(x);
  if (x >= 2) return 0;
  if (x < 1) return ((12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + (6 - 2 * b)) / 6;
  return ((-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x + (8 * b + 24 * c)) /
         6;
}

double sinc(double x) {
  x *= std::numbers::pi;
  return std::abs(x) < 1e-8 ? 1 : std::sin(x) / x;
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
      // Shifted down so that it falls continuously to 0 at the radius.
      const double falloff = -1 / (2.0 * film.filter_stddev * film.filter_stddev);
      return std::max(0.0, std::exp(falloff * x * x * r * r) - std::exp(falloff * r * r));
    }
    case FilterKind::kMitchell:
      return mitchell(2 * x, film.filter_b, film.filter_c);  // stretched to the radius
    case FilterKind::kLanczos:
      return sinc(x * r) * sinc(x);
  }
  return 0;
}

std::vector<float> filter_table(const Film& film) {
  std::vector<double> value(kSteps);
  double total_magnitude = 0, total = 0;
  for (int i = 0; i < kSteps; ++i) {
    value[std::size_t(i)] = filter_value(film, (i + 0.5) / kSteps);
    total_magnitude += std::abs(value[std::size_t(i)]);
    total += value[std::size_t(i)];
  }
  std::vector<float> knots{0.0f}, weights;
  double magnitude = 0, cell_magnitude = 0, cell_mass = 0;
  const auto finish_cell = [&](double knot) {
    knots.push_back(float(knot));
    const double mean = cell_magnitude > 0 ? cell_mass / cell_magnitude : 1;
    weights.push_back(float(mean * total_magnitude / total));
    cell_magnitude = cell_mass = 0;
  };
  for (int i = 0; i < kSteps; ++i) {
    const double whole = std::abs(value[std::size_t(i)]), sign = value[std::size_t(i)] < 0 ? -1 : 1;
    double remaining = whole;
    while (int(weights.size()) < FILTER_CELLS - 1) {
      const double above = 1 - double(weights.size() + 1) / FILTER_CELLS;
      const double cell_end = total_magnitude * (1 - above * above);
      if (magnitude + remaining < cell_end) break;
      const double part = cell_end - magnitude;
      cell_magnitude += part;
      cell_mass += sign * part;
      remaining -= part;
      magnitude = cell_end;
      finish_cell((i + 1 - remaining / whole) / kSteps);
    }
    magnitude += remaining;
    cell_magnitude += remaining;
    cell_mass += sign * remaining;
  }
  finish_cell(1);
  knots.insert(knots.end(), weights.begin(), weights.end());
  return knots;
}

FilterMass::FilterMass(int filter, const std::vector<float>& table) : filter_(filter), table_(table) {
  double sum = 0;
  for (int k = 0; k < FILTER_CELLS; ++k) {
    nearer_.push_back(sum);
    sum += weight(k) * (mass_before(k + 1) - mass_before(k));
  }
}

FilterMass::Place FilterMass::find(double distance) const {
  const auto knots = table_.begin(), end = knots + FILTER_CELLS + 1;
  const int above = int(std::upper_bound(knots, end, float(distance)) - knots);
  const int cell = std::clamp(above - 1, 0, FILTER_CELLS - 1);
  const double low = double(knots[cell]), high = double(knots[cell + 1]);
  return {cell, high > low ? std::clamp((distance - low) / (high - low), 0.0, 1.0) : 1.0};
}

double FilterMass::up_to(double x) const {
  const double distance = std::min(std::abs(x), 1.0);
  double nearer = 0;
  switch (filter_) {
    case FILTER_BOX:
      nearer = distance;
      break;
    case FILTER_TENT:
      nearer = distance * (2 - distance);
      break;
    default: {
      const Place place = find(distance);
      nearer = nearer_[std::size_t(place.cell)] +
               weight(place.cell) * (mass_before(place.cell + place.inside) - mass_before(place.cell));
    }
  }
  return 0.5 * (1 + std::copysign(nearer, x));
}

FilmParameters film_parameters(const Film& film) {
  FilmParameters made{};
  made.width = film.width;
  made.height = film.height;
  made.filter = film.filter == FilterKind::kBox    ? FILTER_BOX
                : film.filter == FilterKind::kTent ? FILTER_TENT
                                                   : FILTER_TABULATED;
  made.filter_radius = film.filter_radius;
  return made;
}

}  // namespace penumbra
