// TinyRender's scenes, most of which have no reference: all methods that estimate the same light must agree,
// block by block.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include "tests/acceptance/scene_pieces.h"
#include "tests/acceptance/shadowed_polygon.h"
#include "tests/acceptance/strategies.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/oracles.h"
#include "tests/support/render_scene.h"

namespace penumbra::tinyrender_methods_test {
namespace {

constexpr int kWidth = 30, kHeight = 20, kBlock = 2, kBatches = 8;
constexpr double kBlocks = double(kWidth / kBlock) * (kHeight / kBlock);
constexpr double kSignificance = 1e-4;
/// Below this, relative to the brightest light, the closed forms in double are nothing but rounding.
constexpr double kRounding = 1e-12;

constexpr std::uint32_t kSpp = 64;

struct SceneCase {
  std::string name, file;
};

void PrintTo(const SceneCase& tested, std::ostream* out) { *out << tested.name; }

class TinyRenderMethods : public testing::TestWithParam<SceneCase> {
 protected:
  void SetUp() override { PENUMBRA_NEED_ORACLE("tinyrender-a4"); }
};

IntegratorSettings without_shadows(IntegratorSettings settings) {
  param::trace_shadows(settings) = false;
  return settings;
}

IntegratorSettings polygonal(IntegratorKind kind) {
  IntegratorSettings settings;
  use(settings, kind);
  return settings;
}

/// With shadows.
std::vector<Strategy> shadowed_methods() {
  using enum EmitterSampling;
  IntegratorSettings both = direct_integrator(1, 1);
  param::emitter_sampling(both) = kArea;
  return {{"polygon_area", polygonal(IntegratorKind::kPolygonArea)},
          {"alpha_1", polygon_cv(1.0f, kArea, 1)},
          {"alpha_auto", polygon_cv(std::nullopt, kArea, 2)},
          {"alpha_auto_projected", polygon_cv(std::nullopt, kProjected, 1)},
          {"direct_area", emitter_only(kArea, 1)},
          {"direct_solid_angle", emitter_only(kSolidAngle, 1)},
          {"direct_projected", emitter_only(kProjected, 1)},
          {"direct_mis", both}};
}

std::vector<Strategy> unshadowed_methods() {
  using enum EmitterSampling;
  return {{"polygon_analytic", polygonal(IntegratorKind::kPolygonAnalytic)},
          {"polygon_area", without_shadows(polygonal(IntegratorKind::kPolygonArea))},
          {"direct_solid_angle", without_shadows(emitter_only(kSolidAngle, 1))},
          {"direct_projected", without_shadows(emitter_only(kProjected, 1))}};
}

/// The mean of all but one of the estimates.
statistics::Estimate mean_of_others(std::span<const statistics::Estimate> estimates, std::size_t one) {
  statistics::Estimate result{.mean = estimates[0].mean, .standard_error = estimates[0].mean};
  const double others = double(estimates.size() - 1);
  result.dof = others * (kBatches - 1);
  for (std::size_t i = 0; i < result.mean.values.size(); ++i) {
    double sum = 0, squares = 0;
    for (std::size_t k = 0; k < estimates.size(); ++k) {
      if (k == one) continue;
      sum += estimates[k].mean.values[i];
      squares += estimates[k].standard_error.values[i] * estimates[k].standard_error.values[i];
    }
    result.mean.values[i] = sum / others;
    result.standard_error.values[i] = std::sqrt(squares) / others;
  }
  return result;
}

void expect_agreement(SceneDescription scene, const std::vector<Strategy>& methods) {
  resize_film(scene, kWidth, kHeight);
  scene.sampler.kind = SamplerKind::kIndependent;
  scene.sampler.spp = kSpp;
  TestDevice device = native_device();
  device.samples_per_pass = kSpp;
  double brightest = 0;
  for (const Shape& shape : scene.shapes)
    if (shape.radiance) brightest = std::max(brightest, double(shape.radiance->b));
  std::vector<statistics::Estimate> estimates;
  std::uint32_t seed = 1000;
  for (const Strategy& method : methods) {
    scene.integrator = method.integrator;
    estimates.push_back(block_estimate(scene, kBatches, seed, kBlock, device));
    for (std::size_t i = 0; i < estimates.back().mean.values.size(); ++i) {
      double &mean = estimates.back().mean.values[i], &error = estimates.back().standard_error.values[i];
      if (std::abs(mean) < kRounding * brightest) mean = error = 0;
      // Samples are floats: what has no noise, as edges of lights, is known to their rounding alone.
      error = std::hypot(error, 0x1p-24 * mean);
    }
    seed += 100;
  }
  // No value may be outside; the channels of a block go together, so that the mean of z^2 has the deviation
  // of as many independent values as there are blocks.
  const statistics::ImageTestLimits limits{
      .significance = kSignificance, .accepted_fraction = 1, .mean_square = 1 + 4 * std::sqrt(2 / kBlocks)};
  for (std::size_t k = 0; k < methods.size(); ++k) {
    const auto result = statistics::z_test(estimates[k], mean_of_others(estimates, k), limits);
    EXPECT_TRUE(result.passed) << methods[k].name << " and the others: " << result.summary();
    testing::Test::RecordProperty(methods[k].name, result.summary());
  }
}

SceneDescription oracle_scene(const std::string& file) {
  return read_or_throw(*find_oracle("tinyrender-a4") / (file + ".toml"));
}

TEST_P(TinyRenderMethods, AgreeWithShadows) {
  expect_agreement(oracle_scene(GetParam().file), shadowed_methods());
}

TEST_P(TinyRenderMethods, AgreeWithoutShadows) {
  expect_agreement(oracle_scene(GetParam().file), unshadowed_methods());
}

INSTANTIATE_TEST_SUITE_P(Scenes, TinyRenderMethods,
                         testing::Values(SceneCase{"Grid", "grid/tinyrender/grid_analytic"},
                                         SceneCase{"Polygon", "polygon/tinyrender/polygon_analytic_realtime"},
                                         SceneCase{"Star", "star/tinyrender/star_analytic_realtime"},
                                         SceneCase{"StarGlossy",
                                                   "star/tinyrender/star_analytic_realtime_bonus"},
                                         SceneCase{"McGill", "mcgill/tinyrender/mcgill_cv_offline"},
                                         SceneCase{"McGillGlossy", "mcgill/tinyrender/mcgill_cv_bonus"}),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace penumbra::tinyrender_methods_test
