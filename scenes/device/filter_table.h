// Tables of the inverse distribution functions of reconstruction filters (kernels/sampler/filter.h), and the
// filters' integrals.
#pragma once

#include <cstddef>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// The unnormalised filter value at `x` filter radii from the centre, |x| <= 1.
double filter_value(const Film& film, double x);

/// The table that sample_filter reads: FILTER_CELLS + 1 knots from the centre, 0, to the radius, 1, then the
/// weights of the cells between them. The weights average to 1 over all samples.
std::vector<float> filter_table(const Film& film);

/// The integral of the pixel filter along one axis, for the density with which film positions are sampled.
class FilterMass {
 public:
  /// `table` is the result of filter_table(). It must outlive this object.
  FilterMass(int filter, const std::vector<float>& table);

  /// The filter's cumulative distribution from -1 to x, in filter radii, for x in [-1, 1]. At 1 it is 1 up to
  /// the rounding of a table's weights.
  [[nodiscard]] double up_to(double x) const;

 private:
  /// The position of a distance from the centre in the table.
  struct Place {
    int cell;
    double inside;  ///< position within the cell, from 0 to 1
  };
  [[nodiscard]] Place find(double distance) const;
  [[nodiscard]] double weight(int cell) const { return double(table_[std::size_t(FILTER_CELLS + 1 + cell)]); }

  int filter_;
  const std::vector<float>& table_;
  std::vector<double> nearer_;  ///< cumulative distribution of |x| at each knot
};

/// The film as kernels know it, except for `sky_coverage`.
FilmParameters film_parameters(const Film& film);

}  // namespace penumbra
