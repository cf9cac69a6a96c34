#include "scenes/bsdfs/measured_table.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>

#include "kernels/bsdf/families.h"
#include "scenes/angles.h"

namespace penumbra {
namespace {

using Grids = MeasuredBrdf::Grids;

/// A density over the unit square, bilinear between knots, and its sums, in cells of area 1.
struct Warp {
  int columns, rows;
  std::vector<double> density;  ///< that integrates to 1
  std::vector<double> along;    ///< for each knot, the integral along its row from the left
  std::vector<double> down;     ///< for each row, the integral over the rows before it

  Warp(const Grids& grids, std::size_t slice) : columns(grids.columns), rows(grids.rows) {
    const auto from = grids.values.begin() + std::ptrdiff_t(slice * grids.knots());
    density.assign(from, from + std::ptrdiff_t(grids.knots()));
    integrate();
    if (!(down.back() > 0)) {
      std::ranges::fill(density, 1.0);
      integrate();
    }
    const double whole = down.back();
    for (auto* numbers : {&density, &along, &down})
      for (double& each : *numbers) each /= whole;
  }
  [[nodiscard]] std::size_t at(int column, int row) const {
    return std::size_t(row) * std::size_t(columns) + std::size_t(column);
  }
  [[nodiscard]] double whole(int row) const { return along[at(columns - 1, row)]; }
  /// The point that goes to (u, v) of the unit square.
  [[nodiscard]] glm::dvec2 unwarp(double u, double v) const {
    const double x = u * (columns - 1), y = v * (rows - 1);
    const int column = std::min(int(x), columns - 2), row = std::min(int(y), rows - 2);
    const double s = x - column, t = y - row, above = whole(row), below = whole(row + 1);
    const auto between = [&](const std::vector<double>& numbers, int i) {
      return std::lerp(numbers[at(i, row)], numbers[at(i, row + 1)], t);
    };
    const double left = between(density, column), right = between(density, column + 1);
    const double before = between(along, column) + s * (left + 0.5 * s * (right - left));
    const double all = std::lerp(above, below, t);
    return {all > 0 ? before / all : 0, down[std::size_t(row)] + t * (above + 0.5 * t * (below - above))};
  }

 private:
  void integrate() {
    along.assign(density.size(), 0);
    down.assign(std::size_t(rows), 0);
    for (int row = 0; row < rows; ++row) {
      for (int column = 1; column < columns; ++column)
        along[at(column, row)] =
            along[at(column - 1, row)] + 0.5 * (density[at(column - 1, row)] + density[at(column, row)]);
      if (row > 0) down[std::size_t(row)] = down[std::size_t(row) - 1] + 0.5 * (whole(row - 1) + whole(row));
    }
  }
};

/// Of `size` numbers per knot, the one of `channel`, at a point of the unit square.
double bilinear(std::span<const float> values, int columns, int rows, double u, double v, int size = 1,
                int channel = 0) {
  const double x = std::clamp(u, 0.0, 1.0) * (columns - 1), y = std::clamp(v, 0.0, 1.0) * (rows - 1);
  const int column = std::min(int(x), columns - 2), row = std::min(int(y), rows - 2);
  const auto at = [&](int i, int j) {
    return double(values[std::size_t(((row + j) * columns + column + i) * size + channel)]);
  };
  return std::lerp(std::lerp(at(0, 0), at(1, 0), x - column), std::lerp(at(0, 1), at(1, 1), x - column),
                   y - row);
}

double square_of_angle(double theta) { return std::sqrt(std::max(theta, 0.0) * 2 / kPi); }

}  // namespace

glm::vec3 measured_albedo(const MeasuredBrdf& brdf) {
  const auto nearest =
      std::ranges::min_element(brdf.theta, {}, [](float theta) { return std::abs(double(theta) - kPi / 4); });
  const auto slice = std::size_t(nearest - brdf.theta.begin());
  const double theta = double(*nearest), azimuth = brdf.is_isotropic() ? 0.0 : double(brdf.phi.front());
  const glm::dvec3 wo(std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth),
                      std::cos(theta));
  const double projected = bilinear(brdf.sigma.values, brdf.sigma.columns, brdf.sigma.rows,
                                    square_of_angle(theta), 0.5 + azimuth / (2 * kPi));
  const Grids& grid = brdf.luminance;
  const auto colours = std::span(brdf.colours).subspan(3 * slice * grid.knots(), 3 * grid.knots());
  const Warp warp(brdf.vndf, slice);
  constexpr int kParts = 256;
  glm::dvec3 sum(0.0);
  for (int i = 0; i < kParts * kParts; ++i) {
    const double u = (i % kParts + 0.5) / kParts, v = (i / kParts + 0.5) / kParts;
    const double theta_m = u * u * kPi / 2, phi_m = (2 * v - 1) * kPi, sine = std::sin(theta_m);
    const glm::dvec3 h(sine * std::cos(phi_m), sine * std::sin(phi_m), std::cos(theta_m));
    const double cosine = glm::dot(wo, h);
    if (cosine <= 0 || (2 * cosine * h - wo).z <= 0) continue;
    double factor = 2 * kPi * kPi * u * sine * 4 * cosine / (kParts * kParts);
    if (brdf.by_facets)
      factor *= projected > 0
                    ? bilinear(brdf.ndf.values, brdf.ndf.columns, brdf.ndf.rows, u, v) / (4 * projected)
                    : 0.0;
    const glm::dvec2 from = warp.unwarp(u, v);
    for (int c = 0; c < 3; ++c)
      sum[c] += factor * bilinear(colours, grid.columns, grid.rows, from.x, from.y, 3, c);
  }
  return glm::clamp(glm::vec3(sum), 1e-4f, 1.0f);
}

std::vector<float> measured_table(const MeasuredBrdf& brdf) {
  float symmetry = MEASURED_ISOTROPIC;
  if (!brdf.is_isotropic()) {
    const double parts = std::round(2 * kPi / (double(brdf.phi.back()) - double(brdf.phi.front())));
    symmetry = parts == 4 ? MEASURED_QUARTER : parts >= 2 ? MEASURED_HALF : MEASURED_WHOLE;
  }
  std::vector<float> table{float(brdf.phi.size()), float(brdf.theta.size())};
  for (const Grids* grid : {&brdf.ndf, &brdf.sigma, &brdf.vndf, &brdf.luminance})
    table.insert(table.end(), {float(grid->columns), float(grid->rows)});
  table.insert(table.end(), {brdf.by_facets ? 1.0f : 0.0f, symmetry});
  for (const auto* numbers : {&brdf.phi, &brdf.theta, &brdf.ndf.values, &brdf.sigma.values})
    table.insert(table.end(), numbers->begin(), numbers->end());
  for (const Grids* grid : {&brdf.vndf, &brdf.luminance})
    for (std::size_t slice = 0; slice < brdf.phi.size() * brdf.theta.size(); ++slice) {
      const Warp warp(*grid, slice);
      for (const auto* numbers : {&warp.density, &warp.along, &warp.down})
        std::ranges::transform(*numbers, std::back_inserter(table), [](double each) { return float(each); });
    }
  const glm::vec3 albedo = measured_albedo(brdf);
  for (std::size_t i = 0; i < brdf.colours.size(); ++i) table.push_back(brdf.colours[i] / albedo[int(i % 3)]);
  if (table.size() < CURVE_STRIDE) table.resize(CURVE_STRIDE);
  return table;
}

}  // namespace penumbra
