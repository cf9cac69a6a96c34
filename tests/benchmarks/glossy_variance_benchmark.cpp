// Variance of direct light on glossy BSDFs under polygon lights, per sample with independent random numbers,
// relative to the mean squared radiance, for sampling strategies that trace two rays; and the seconds of
// each, so that the product is the time to equal error. Prints one line per roughness.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/acceptance/glossy_room.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

struct Way {
  const char* name;
  IntegratorSettings integrator;
};

std::vector<Way> ways() {
  const auto lights = [](EmitterSampling sampling) {
    IntegratorSettings integrator = direct_integrator(2, 0);
    param::emitter_sampling(integrator) = sampling;
    param::light_choice(integrator) = LightChoice::kAnalytic;
    return integrator;
  };
  const auto both = [](EmitterSampling sampling) {
    IntegratorSettings integrator = direct_integrator(1, 1);
    param::emitter_sampling(integrator) = sampling;
    return integrator;
  };
  const auto control = [](EmitterSampling sampling, std::optional<float> alpha) {
    IntegratorSettings integrator;
    use(integrator, IntegratorKind::kPolygonCv);
    param::vis_samples(integrator) = 2;
    param::alpha(integrator) = alpha;
    param::emitter_sampling(integrator) = sampling;
    return integrator;
  };
  using enum EmitterSampling;
  return {{"light", lights(kSolidAngle)},
          {"BSDF", direct_integrator(0, 2)},
          {"MIS", both(kSolidAngle)},
          {"LTC light", lights(kProjected)},
          {"LTC MIS", both(kProjected)},
          {"cv 1", control(kSolidAngle, 1.0f)},
          {"cv auto", control(kSolidAngle, std::nullopt)},
          {"LTC cv 1", control(kProjected, 1.0f)},
          {"LTC cv auto", control(kProjected, std::nullopt)}};
}

void measure(const char* name, const std::function<BsdfModel(float alpha)>& bsdf, int spp) {
  const std::vector<Way> all = ways();
  fmt::print("{}\n| alpha |", name);
  for (const Way& way : all) fmt::print(" {} |", way.name);
  fmt::print("\n");
  for (const float alpha : {0.02f, 0.05f, 0.1f, 0.2f, 0.4f, 0.7f, 1.0f}) {
    fmt::print("| {} |", alpha);
    for (const Way& way : all) {
      SceneDescription scene = glossy_room(bsdf(alpha), 96, 64);
      scene.sampler.spp = std::uint32_t(spp);
      scene.integrator = way.integrator;
      scene.integrator.hide_emitters = true;
      const DeviceScene built = build_or_throw(scene);
      const auto start = std::chrono::steady_clock::now();
      const FilmAccumulator film = render_or_throw(built);
      const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
      const statistics::Image mean = mean_image(film);
      double squares = 0;
      for (const double v : mean.values) squares += v * v;
      fmt::print(" {:.3g} ({:.2f} s) |", mean_variance(film) / (squares / double(mean.values.size())),
                 seconds.count());
      std::fflush(stdout);
    }
    fmt::print("\n");
  }
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) {
  using namespace penumbra;
  const int spp = argc > 1 ? std::max(std::atoi(argv[1]), 2) : 256;
  const auto conductor = [](int distribution) {
    return [distribution](float alpha) { return rough_conductor(alpha, distribution); };
  };
  measure("rough conductor, GGX", conductor(DISTRIBUTION_GGX), spp);
  measure("rough conductor, Beckmann", conductor(DISTRIBUTION_BECKMANN), spp);
  const auto plastic = [](float alpha) {
    RoughPlasticBsdf bsdf;
    bsdf.distribution = DISTRIBUTION_GGX;
    bsdf.alpha = alpha;
    return BsdfModel(bsdf);
  };
  measure("rough plastic, GGX", plastic, spp);
  const auto principled = [](float alpha) {
    PrincipledBsdf bsdf;
    bsdf.metallic = 0.5f;
    bsdf.roughness = std::sqrt(alpha);
    return BsdfModel(bsdf);
  };
  measure("principled, metallic 0.5", principled, spp);
}
