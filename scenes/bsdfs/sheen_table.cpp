#include "scenes/bsdfs/sheen_table.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

namespace penumbra {
namespace {

constexpr int kSide = 32;
constexpr SheenCell kSheenCells[] = {
#include "scenes/bsdfs/sheen_table.inc"
};
static_assert(std::size(kSheenCells) == kSide * kSide);

SheenCell between(const SheenCell& a, const SheenCell& b, double w) {
  const float t = float(w);
  return {std::lerp(a.reflectance, b.reflectance, t), std::lerp(a.narrow, b.narrow, t),
          std::lerp(a.lean, b.lean, t)};
}

}  // namespace

SheenCell sheen_cell(double roughness, double cosine) {
  const double y = std::clamp(roughness, 0.0, 1.0) * (kSide - 1),
               x = std::clamp(cosine, 0.0, 1.0) * (kSide - 1);
  const int row = std::min(int(y), kSide - 2), column = std::min(int(x), kSide - 2);
  const auto in_row = [&](int r) {
    const SheenCell* const cell = kSheenCells + std::size_t(r * kSide + column);
    return between(cell[0], cell[1], x - column);
  };
  return between(in_row(row), in_row(row + 1), y - row);
}

}  // namespace penumbra
