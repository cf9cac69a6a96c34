// Fits the table of linearly transformed cosines and writes it as C++:
//   fit_ltc > scenes/device/ltc/ltc_table.inc
// Residuals go to standard error: per distribution, mean and worst, at the knots and between them, and with
// --cells those of every cell. Four minutes on one core.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/device/ltc/ltc_fit.h"

namespace penumbra::ltc {
namespace {

constexpr int kSize = LTC_SIZE;
constexpr int kResidualSide = 60;

using Table = std::vector<Cell>;  // rows of kSize cells

Table fitted(Distribution distribution) {
  Table table(kSize * kSize);
  for (int column = kSize - 1; column >= 0; --column) {
    Cell cell{.lean = 0, .width_x = 1, .width_y = 1};
    for (int row = 0; row < kSize; ++row) {
      // Starts from the previous cell of smaller roughness and from that of the steeper view, and keeps the
      // better fit.
      const Lobe lobe(distribution, knot_alpha(row, kSize), knot_cosine(column, kSize));
      cell = fit(lobe, cell);
      if (column + 1 < kSize) {
        const Cell other = fit(lobe, table[std::size_t(row * kSize + column + 1)]);
        if (residual(lobe, other, kResidualSide).discrimination <
            residual(lobe, cell, kResidualSide).discrimination)
          cell = other;
      }
      // At normal incidence the lobe does not lean and is isotropic.
      if (column == kSize - 1) {
        cell.lean = 0;
        cell.width_x = cell.width_y;
      }
      table[std::size_t(row * kSize + column)] = cell;
    }
    // The quotient of two sines that both vanish is replaced by its limit.
    if (column == kSize - 2)
      for (int row = 0; row < kSize; ++row)
        table[std::size_t(row * kSize + kSize - 1)].lean = table[std::size_t(row * kSize + kSize - 2)].lean;
  }
  return table;
}

Cell mean(const Cell& a, const Cell& b) {
  return {0.5 * (a.lean + b.lean), 0.5 * (a.width_x + b.width_x), 0.5 * (a.width_y + b.width_y),
          0.5 * (a.albedo + b.albedo), 0.5 * (a.schlick + b.schlick)};
}

void report(const char* name, Distribution distribution, const Table& table, bool cells) {
  for (const double offset : {0.0, 0.5}) {
    const int count = offset > 0 ? kSize - 1 : kSize;
    Residual sum, worst;
    for (int row = 0; row < count; ++row)
      for (int column = 0; column < count; ++column) {
        const auto at = [&](int i, int j) { return table[std::size_t((row + i) * kSize + column + j)]; };
        const Cell cell = offset > 0 ? mean(mean(at(0, 0), at(0, 1)), mean(at(1, 0), at(1, 1))) : at(0, 0);
        const Lobe lobe(distribution, knot_alpha(row + offset, kSize), knot_cosine(column + offset, kSize));
        const Residual r = residual(lobe, cell, kResidualSide);
        sum.discrimination += r.discrimination;
        sum.square += r.square;
        worst = {std::max(worst.discrimination, r.discrimination), std::max(worst.square, r.square)};
        if (cells)
          std::fprintf(stderr, "%s alpha %.5f cosine %.5f discrimination %.5f square %.5f\n", name,
                       lobe.alpha(), lobe.wo().z, r.discrimination, r.square);
      }
    std::fprintf(stderr, "%s %s: discrimination %.4f, at most %.4f; relative square %.4f, at most %.4f\n",
                 name, offset > 0 ? "between knots" : "at knots", sum.discrimination / (count * count),
                 worst.discrimination, sum.square / (count * count), worst.square);
  }
}

void write(const char* name, const Table& table) {
  std::printf("// %s: lean, width_x, width_y, albedo, schlick.\n", name);
  for (const Cell& c : table)
    std::printf("{%#.7gf, %#.6gf, %#.6gf, %#.6gf, %#.5gf},\n", c.lean, c.width_x, c.width_y, c.albedo,
                c.schlick);
}

}  // namespace
}  // namespace penumbra::ltc

int main(int argc, char** argv) {
  using namespace penumbra::ltc;
  const bool cells = argc > 1 && std::strcmp(argv[1], "--cells") == 0;
  std::printf("// Written by fit_ltc: %d rows of roughness by %d columns of the viewer's cosine.\n", kSize,
              kSize);
  const Table ggx = fitted(Distribution::kGgx), beckmann = fitted(Distribution::kBeckmann);
  write("GGX", ggx);
  write("Beckmann", beckmann);
  report("GGX", Distribution::kGgx, ggx, cells);
  report("Beckmann", Distribution::kBeckmann, beckmann, cells);
}
