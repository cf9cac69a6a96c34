// The default choice of lights against that by power: relative mean squared error for equal sample counts
// (the median over the pixels, which a few bright paths do not change), CPU time (the minimum over batches),
// and the quotients of their products: 2 means half the time to equal error. If both give the same image,
// times differ by chance only. Prints one line per scene.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "tests/acceptance/many_lights.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

struct RelativeError {
  double mean = 0, median = 0;  ///< over the pixels
};
struct Measured {
  double seconds = 0;
  RelativeError error;
};

struct Options {
  int spp = 16, batches = 8, reference_spp = 2048;
};

SceneDescription with_choice(SceneDescription scene, LightChoice choice, int spp, std::uint32_t seed) {
  param::light_choice(scene.integrator) = choice;
  scene.sampler.spp = std::uint32_t(spp);
  scene.sampler.seed = seed;
  return scene;
}

/// Of (image - reference)^2 / (reference^2 + 1 % of the mean squared), means over the channels.
RelativeError relative_error(const statistics::Image& image, const statistics::Image& reference) {
  double squares = 0, sum = 0;
  for (const double v : reference.values) squares += v * v;
  const double floor = 0.01 * squares / double(reference.values.size());
  std::vector<double> pixels(image.values.size() / 3);
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    const double d = image.values[i] - reference.values[i];
    const double error = d * d / (reference.values[i] * reference.values[i] + floor);
    sum += error;
    pixels[i / 3] += error / 3;
  }
  std::ranges::nth_element(pixels, pixels.begin() + std::ptrdiff_t(pixels.size() / 2));
  return {sum / double(image.values.size()), pixels[pixels.size() / 2]};
}

void compare(const std::string& name, const SceneDescription& scene, const Options& options) {
  constexpr LightChoice kChoices[] = {LightChoice::kPower, LightChoice::kAuto};
  const statistics::Image reference =
      mean_image(render_or_throw(with_choice(scene, LightChoice::kTree, options.reference_spp, 999)));
  Measured measured[2];
  std::uint64_t hashes[2];
  for (int k = 0; k < options.batches; ++k)
    for (int way = 0; way < 2; ++way) {
      const DeviceScene built =
          build_or_throw(with_choice(scene, kChoices[way], options.spp, std::uint32_t(k + 1)));
      const std::clock_t start = std::clock();
      const FilmAccumulator film = render_or_throw(built);
      const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
      measured[way].seconds = k == 0 ? seconds : std::min(measured[way].seconds, seconds);
      const RelativeError error = relative_error(mean_image(film), reference);
      measured[way].error.mean += error.mean / options.batches;
      measured[way].error.median += error.median / options.batches;
      hashes[way] = film.hash();
    }
  const auto [power, own] = measured;
  fmt::print("| {} | {:.4g} | {:.4g} | {:.4g} | {:.4g} | {:.3f} | {:.3f} | ", name, power.error.mean,
             own.error.mean, power.error.median, own.error.median, power.seconds, own.seconds);
  if (hashes[0] == hashes[1])
    fmt::print("same image | |\n");
  else
    fmt::print("{:.2f} | {:.2f} |\n", power.error.mean * power.seconds / (own.error.mean * own.seconds),
               power.error.median * power.seconds / (own.error.median * own.seconds));
  std::fflush(stdout);
}

}  // namespace
}  // namespace penumbra

// light_choice_benchmark [SPP [REFERENCE_SPP [WIDTH FILE]...]]
int main(int argc, char** argv) {
  using namespace penumbra;
  Options options;
  if (argc > 1) options.spp = std::max(std::atoi(argv[1]), 1);
  if (argc > 2) options.reference_spp = std::max(std::atoi(argv[2]), 1);
  fmt::print(
      "| scene | relMSE by power | auto | median by power | auto | s by power | auto | efficiency | by "
      "medians "
      "|\n|---|---|---|---|---|---|---|---|---|\n");
  for (int i = 3; i + 1 < argc; i += 2) {
    SceneDescription scene = read_or_throw(argv[i + 1]);
    const int width = std::max(std::atoi(argv[i]), 1);
    resize_film(scene, width, std::max(1, width * scene.film.height / scene.film.width));
    compare(std::filesystem::path(argv[i + 1]).parent_path().filename().string(), scene, options);
  }
  if (argc <= 3)
    for (const ManyLights& each : many_lights()) compare(each.name, each.scene, options);
}
