// The integral of the pixel filter along one axis, for the density with which film positions are sampled
// (sampler/filter.h).
#pragma once

#include <cstddef>
#include <vector>

#include "kernels/scene_types.h"

namespace penumbra {

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

}  // namespace penumbra
