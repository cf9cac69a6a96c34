#include "scenes/pbrt/grid_refinement.h"

#include <cmath>

namespace penumbra::pbrt {

int refinement_of(const VolumeGrid& size) {
  constexpr std::size_t kFewCells = std::size_t{1} << 21;
  const std::size_t cells = std::size_t(size.nx) * std::size_t(size.ny) * std::size_t(size.nz);
  int finer = 4;
  while (finer > 1 && cells * std::size_t(finer * finer * finer) > kFewCells) finer /= 2;
  return finer;
}

std::vector<float> refined(const std::vector<float>& values, const VolumeGrid& size, int channels,
                           int finer) {
  /// The cell below a fine cell's centre, and the share of the one above.
  struct Between {
    int low;
    double share;
  };
  const auto between = [&](int fine) {
    const double at = (fine + 0.5) / finer - 0.5;
    return Between{int(std::floor(at)), at - std::floor(at)};
  };
  const auto cell = [&](int x, int y, int z, int c) {
    const bool inside = x >= 0 && x < size.nx && y >= 0 && y < size.ny && z >= 0 && z < size.nz;
    if (!inside) return 0.0;
    const std::size_t index =
        (std::size_t(z) * std::size_t(size.ny) + std::size_t(y)) * std::size_t(size.nx) + std::size_t(x);
    return double(values[index * std::size_t(channels) + std::size_t(c)]);
  };
  std::vector<float> result;
  for (int z = 0; z < finer * size.nz; ++z)
    for (int y = 0; y < finer * size.ny; ++y)
      for (int x = 0; x < finer * size.nx; ++x) {
        const Between bx = between(x), by = between(y), bz = between(z);
        for (int c = 0; c < channels; ++c) {
          double sum = 0;
          for (int corner = 0; corner < 8; ++corner) {
            const int i = corner & 1, j = corner >> 1 & 1, k = corner >> 2;
            const double weight = (i != 0 ? bx.share : 1 - bx.share) * (j != 0 ? by.share : 1 - by.share) *
                                  (k != 0 ? bz.share : 1 - bz.share);
            if (weight > 0.0) sum += weight * cell(bx.low + i, by.low + j, bz.low + k, c);
          }
          result.push_back(float(sum));
        }
      }
  return result;
}

}  // namespace penumbra::pbrt
