// The pixel filter along one axis as film positions are sampled from it (sampler/filter.h), integrated.
#pragma once

#include <cstddef>
#include <vector>

#include "kernels/scene_types.h"

namespace penumbra {

class FilterMass {
 public:
  /// `table`: of filter_table.h; it is there as long as this.
  FilterMass(int filter, const std::vector<float>& table);

  /// The filter's integral from -1 to x, in filter radii, of [-1, 1]; that to 1 is 1, but for the rounding of
  /// a table's weights.
  [[nodiscard]] double up_to(double x) const;

 private:
  /// Where a distance from the centre is in the table.
  struct Place {
    int cell;
    double inside;  ///< from 0 to 1 within the cell
  };
  [[nodiscard]] Place find(double distance) const;
  [[nodiscard]] double weight(int cell) const { return double(table_[std::size_t(FILTER_CELLS + 1 + cell)]); }

  int filter_;
  const std::vector<float>& table_;
  std::vector<double> nearer_;  ///< of |x|, the filter's integral over what is nearer than each knot
};

}  // namespace penumbra
