// How the cost of a render grows with pixels, samples and triangles: seconds on one thread, from the device
// scene to the last sample, and the exponent of each. `scaling_benchmark [MOST_TRIANGLES]`.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "scenes/device/device_scene_builder.h"
#include "scheduler/report/slope_fit.h"
#include "tests/benchmarks/bumpy_room.h"
#include "tests/benchmarks/load_stages.h"
#include "tests/support/integrator_parameters.h"
#include "worker/device.h"

namespace penumbra {
namespace {

constexpr int kTile = 64, kRepetitions = 5;
constexpr int kTriangles = 10'000;  // while pixels or samples grow

struct Cell {
  double x = 0;        // pixels, samples or triangles
  double seconds = 0;  // of one thread
  double samples = 0;
};

DeviceScene room(int triangles, int size) {
  SceneDescription description = bumpy_room(triangles);
  use(description.integrator, IntegratorKind::kPath);
  description.film.width = description.film.crop_width = size;
  description.film.height = description.film.crop_height = size;
  return value_or_exit(build_device_scene(
      description, {.intersector = IntersectorChoice::kPortable, .feature_layers = false}));
}

/// The least of a few, by the processor's clock: others on the machine only add to it.
double seconds_of(const DeviceScene& scene, int size, std::uint32_t spp) {
  DeviceOptions options;
  options.isa = best_isa();
  options.threads = 1;
  const auto device = value_or_exit(make_device(scene, options));
  double least = INFINITY;
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    const std::clock_t begin = std::clock();
    for (int y = 0; y < size; y += kTile)
      for (int x = 0; x < size; x += kTile)
        value_or_exit(device->render({x, y, std::min(kTile, size - x), std::min(kTile, size - y), 0, spp}));
    least = std::min(least, double(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  return least;
}

/// Of seconds over x.
SlopeFit power_of(const std::vector<Cell>& cells) {
  std::vector<CostError> points;
  for (const Cell& cell : cells) points.push_back({cell.x, cell.seconds});
  return fit_slope(points).value_or(SlopeFit{});
}

double log_x(const Cell& cell) { return std::log2(cell.x); }
double log_seconds(const Cell& cell) { return std::log2(cell.seconds); }
double nanoseconds(const Cell& cell) { return 1e9 * cell.seconds / cell.samples; }

void print_cells(const char* what, const std::vector<Cell>& cells) {
  fmt::print("\n| {} | s | ns a sample | s ~ {}^ |\n|---|---|---|---|\n", what, what);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Cell& cell = cells[i];
    const double power =
        i == 0 ? NAN : (log_seconds(cell) - log_seconds(cells[i - 1])) / (log_x(cell) - log_x(cells[i - 1]));
    fmt::print("| {:.0f} | {:.4f} | {:.1f} | {} |\n", cell.x, cell.seconds, nanoseconds(cell),
               i == 0 ? "" : fmt::format("{:.3f}", power));
    std::fflush(stdout);
  }
}

void show_power(const char* what, const std::vector<Cell>& cells) {
  print_cells(what, cells);
  const SlopeFit power = power_of(cells);
  fmt::print("all of them: s ~ {}^{:.3f} ({:.3f} to {:.3f})\n", what, power.slope, power.low, power.high);
}

/// Also constant + slope log2(triangles), by least squares, of those in a hierarchy.
void show_logarithm(std::vector<Cell> cells) {
  constexpr double kFewest = 1000;
  show_power("triangles", cells);
  std::erase_if(cells, [](const Cell& cell) { return cell.x < kFewest; });
  if (cells.size() < 2) return;
  double x = 0, y = 0, xx = 0, xy = 0;
  for (const Cell& cell : cells) {
    x += log_x(cell) / double(cells.size());
    y += nanoseconds(cell) / double(cells.size());
  }
  for (const Cell& cell : cells) {
    xx += (log_x(cell) - x) * (log_x(cell) - x);
    xy += (log_x(cell) - x) * (nanoseconds(cell) - y);
  }
  const double slope = xy / xx, constant = y - slope * x;
  double worst = 0;
  for (const Cell& cell : cells)
    worst = std::max(worst, std::abs(nanoseconds(cell) / (constant + slope * log_x(cell)) - 1));
  fmt::print("{:.1f} + {:.1f} log2(triangles) ns a sample from {} triangles on, within {:.0f} %\n", constant,
             slope, kFewest, 100 * worst);
}

int run(int argc, char** argv) {
  const int most_triangles = argc > 1 ? std::atoi(argv[1]) : 1'000'000;
  if (most_triangles < 100) return fmt::print(stderr, "scaling_benchmark [MOST_TRIANGLES]\n"), 2;
  fmt::print("a room with a ball, path traced, {}, one thread\n", isa_name(best_isa()));
  std::vector<Cell> pixels, samples, triangles;
  for (const int size : {64, 128, 256, 512, 1024}) {
    constexpr std::uint32_t kSpp = 4;
    const double count = double(size) * size;
    pixels.push_back({count, seconds_of(room(kTriangles, size), size, kSpp), count * kSpp});
  }
  show_power("pixels", pixels);
  for (const std::uint32_t spp : {1u, 4u, 16u, 64u, 256u}) {
    constexpr int kSize = 128;
    samples.push_back(
        {double(spp), seconds_of(room(kTriangles, kSize), kSize, spp), double(kSize) * kSize * spp});
  }
  show_power("spp", samples);
  for (double count = 100; count <= most_triangles; count *= std::sqrt(10.0)) {
    constexpr int kSize = 256;
    constexpr std::uint32_t kSpp = 4;
    const DeviceScene scene = room(int(count), kSize);
    triangles.push_back({double(scene.header.tables.triangles.count), seconds_of(scene, kSize, kSpp),
                         double(kSize) * kSize * kSpp});
  }
  show_logarithm(triangles);
  return 0;
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) { return penumbra::run(argc, argv); }
