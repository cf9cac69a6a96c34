// penumbra_load: measures a real scheduler with simulated workers, which render nothing.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <new>
#include <vector>

#include "kernels/film_layers.h"
#include "scheduler/farm/acceptor.h"
#include "tests/load/load_farm.h"
#include "tests/load/simulated_crew.h"
#include "worker/cli/command_line.h"
#include "worker/protocol/token.h"

namespace penumbra {
namespace {

/// As for `--denoise` and `--layers` with everything.
constexpr std::uint64_t kAllLayers =
    FEATURE_LAYERS | FEATURE_DENOISING | FEATURE_POLYGONS | FEATURE_COVERAGE | LAYERS_ON_DEMAND;

/// As a scheduler starts it: the workers.
int run_workers(const std::string& address) {
  const char* path = std::getenv(kBoardVariable);
  const char* key = std::getenv(kWorkerKeyVariable);
  if (path == nullptr || key == nullptr) return 2;
  const int file = open(path, O_RDWR | O_CLOEXEC);
  void* memory = mmap(nullptr, sizeof(LoadBoard), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (file < 0 || memory == MAP_FAILED) return 2;
  raise_descriptor_limit();
  run_simulated_crew(*std::launder(static_cast<LoadBoard*>(memory)), address, key);
  std::_Exit(0);
}

void print(const LoadSettings& settings, const LoadFigures& figures) {
  const auto milliseconds = [](double seconds) { return fmt::format("{:.3g} ms", 1e3 * seconds); };
  fmt::print("| {} | {:.0f} KB | {} | {:.0f} | {:.0f} | {} | {} | {:.0f} us | {:.0f} KiB | {:.0f} MB |",
             settings.workers, double(figures.bytes_per_result) * 1e-3, figures.units,
             figures.units_per_second, figures.units_per_second * double(figures.bytes_per_result) * 1e-6,
             milliseconds(figures.order_p50), milliseconds(figures.order_p99),
             1e6 * figures.cpu_seconds_per_unit, figures.bytes_per_idle_worker / 1024,
             double(figures.peak_bytes) * 1e-6);
  fmt::print(" {} |", settings.unit_seconds > 0 ? fmt::format("{:.2f}%", 100 * figures.overhead) : "");
  if (settings.deaths > 0)
    fmt::print(" lost units are with others after {} (half of them), {} (all) |",
               milliseconds(figures.redispatch_p50), milliseconds(figures.redispatch_most));
  fmt::print("\n");
  std::fflush(stdout);
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) {
  using namespace penumbra;
  if (argc == 3 && std::string(argv[1]) == "--connect") return run_workers(argv[2]);
  CommandLine app("A scheduler under the load of simulated workers");
  LoadSettings settings;
  std::vector<int> workers{10, 100, 1000, 5000};
  double unit_milliseconds = 0;
  std::string layers = "none";
  app.add_option("--workers", workers, "One run for each number")->delimiter(',')->capture_default_str();
  app.add_option("--units", settings.units, "Work units, at least")->capture_default_str();
  app.add_option("--unit-ms", unit_milliseconds, "What a unit takes a worker")->capture_default_str();
  app.add_option("--tile", settings.tile, "Pixels along a side of a unit")->capture_default_str();
  app.add_option("--side", settings.side, "Tiles along a side of the film")->capture_default_str();
  app.add_option("--layers", layers, "Layers of results")
      ->check(one_of({"none", "default", "all"}))
      ->capture_default_str();
  app.add_option("--deaths", settings.deaths, "Workers that leave with units in hand")->capture_default_str();
  if (const auto ended = app.parse(argc, argv)) return *ended;
  settings.unit_seconds = 1e-3 * unit_milliseconds;
  settings.features = layers == "all" ? kAllLayers : layers == "default" ? std::uint64_t(FEATURE_LAYERS) : 0;
  const std::string program = std::filesystem::canonical("/proc/self/exe");
  fmt::print(
      "| workers | a result | units | units/s | MB/s | order p50 | p99 | CPU a unit | an idle worker | peak "
      "| overhead "
      "|\n");
  for (const int count : workers) {
    settings.workers = count;
    const Expected<LoadFigures> figures = run_load(settings, program);
    if (!figures) {
      fmt::print(stderr, "{} workers: {}\n", count, figures.error().message);
      return 1;
    }
    print(settings, *figures);
  }
  return 0;
}
