#include "scenes/device/filter_mass.h"

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

/// The cumulative distribution of |x| up to position s of the table, in cells from 0 to FILTER_CELLS.
double mass_before(double s) {
  const double beyond = 1 - s / FILTER_CELLS;
  return 1 - beyond * beyond;
}

}  // namespace

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

}  // namespace penumbra
