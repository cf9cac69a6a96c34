// TinyRender's scenes, unedited, against its own reference images. Each reference is one realisation of a
// known estimator with a known encoding. Penumbra uses the same estimator and the same encoding, so that
// noise, clamping and rounding are the same, too.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/acceptance/tinyrender_reference.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/oracles.h"
#include "tests/support/render_scene.h"

namespace penumbra::tinyrender_reference_test {
namespace {

constexpr double kSignificance = 1e-4;
constexpr double kFloorAlbedo = 0.5;
constexpr double kGridAlbedo[3] = {0.1, 0.2, 1};
constexpr int kBlock = 8;

struct Tested {
  SceneDescription scene;
  statistics::Image reference;
};

/// A scene of a folder of the oracle and a reference beside it; pixels at their centres, independent samples.
Tested tested(const std::string& folder, const std::string& scene, const std::string& reference) {
  const auto path = *find_oracle("tinyrender-a4/" + folder + "/tinyrender");
  Tested result{read_or_throw(path / (scene + ".toml")), read_reference(path / (reference + "_REF.exr"))};
  sample_pixel_centres(result.scene);
  result.scene.sampler.kind = SamplerKind::kIndependent;
  result.scene.sampler.seed = 1;
  return result;
}

Shape light_of(const SceneDescription& scene) {
  return *std::ranges::find_if(scene.shapes, [](const Shape& shape) { return shape.radiance.has_value(); });
}

template <typename Function>
statistics::Image transformed(statistics::Image image, const Function& function) {
  for (double& value : image.values) value = function(value);
  return image;
}

/// What pixels see at their centres; the scene's integrator does not matter.
struct Seen {
  Mask emitters, smooth, lit, floor;

  explicit Seen(SceneDescription scene) {
    sample_pixel_centres(scene);
    scene.sampler.spp = 1;
    scene.integrator = {.method = DirectIntegrator{.trace_shadows = false}};
    const FilmAccumulator film = render_or_throw(scene);
    emitters = emitter_pixels(film);
    smooth = smooth_pixels(film, emitters);
    for (int y = 0; y < film.height(); ++y)
      for (int x = 0; x < film.width(); ++x) {
        const bool reflects = film.layer(x, y, LAYER_DEPTH) > 0 && !emitters[lit.size()];
        const bool inside = smooth[lit.size()] != 0 && reflects;
        lit.push_back(inside);
        floor.push_back(inside && film.layer(x, y, LAYER_NORMAL, 1) > 0.999);
      }
  }
};

class TinyRender : public testing::Test {
 protected:
  void SetUp() override { PENUMBRA_NEED_ORACLE("tinyrender-a4"); }
};

using TinyRenderGrid = TinyRender;
using TinyRenderPolygon = TinyRender;

const PinholeCamera kGridCamera{{5, 3, -2}, {-2, 0.4, 1}, 35, 600, 400};
const PinholeCamera kPolygonCamera{{5, 1, 0}, {-2, 0.5, 0}, 35, 600, 400};

// --- closed forms

/// A float ray meets the floor to within 1e-6 of a distance of up to 14; the radiance has a gradient below
/// 1/2.
constexpr double kPosition = 7e-6;

/// Of an angle that is the acos of a dot product of unit vectors in float, after three roundings.
double float_acos_error(double angle) { return 3 * std::ldexp(1, -24) / std::sin(angle); }
/// ... and as a shader's is: a square root times a quadratic is commonly taken for acos, to within so much
/// (Lagarde 2014, "Inverse trigonometric functions GPU optimization for AMD GCN architecture"). What the
/// references of windows are off by is a function of the edges' angles alone, of about this size.
double shader_acos_error(double) { return 6.1e-4; }

TEST_F(TinyRenderGrid, AnalyticIsTheClosedForm) {
  const auto [scene, reference] = tested("grid", "grid_analytic", "grid_analytic");
  ASSERT_EQ(scene.sampler.spp, 1u);
  const statistics::Image ours = mean_image(render_or_throw(scene));
  const Seen seen(scene);
  const Shape light = light_of(scene);
  std::vector<double> ratios;
  int behind = 0;
  for (int y = 0; y < ours.height; ++y)
    for (int x = 0; x < ours.width; ++x) {
      const std::size_t pixel = std::size_t(y) * std::size_t(ours.width) + std::size_t(x);
      const double stored = reference.at(x, y, 2), value = ours.at(x, y, 2);
      if (seen.emitters[pixel] != 0 && seen.smooth[pixel] != 0) {
        EXPECT_EQ(stored, 12);
        EXPECT_EQ(value, 12);
      }
      if (!seen.floor[pixel]) continue;
      const double exact = unshadowed_radiance(light, kFloorAlbedo, kGridCamera.floor_point(x, y), 2);
      ASSERT_NEAR(value, std::max(exact, 0.0), kPosition) << x << ", " << y;
      // The reference does not clamp: behind the light it is as dark as the front would be bright.
      const double off = 12 * kFloorAlbedo / (2 * std::numbers::pi) *
                         edge_error(light, kGridCamera.floor_point(x, y), float_acos_error);
      ASSERT_NEAR(stored, exact, half_spacing(stored) / 2 + off + kPosition) << x << ", " << y;
      behind += stored < 0 ? 1 : 0;
      if (stored > 0) ratios.push_back(value / stored);
    }
  EXPECT_GT(behind, 2000);
  ASSERT_GT(ratios.size(), 100000u);
  std::ranges::sort(ratios);
  const auto quantile = [&](double share) { return ratios[std::size_t(share * double(ratios.size() - 1))]; };
  EXPECT_NEAR(quantile(0.5), 1, 1e-5);
  EXPECT_NEAR(quantile(0.05), 1, 5e-4);
  EXPECT_NEAR(quantile(0.95), 1, 5e-4);
  RecordProperty("median", std::to_string(quantile(0.5)));
}

TEST_F(TinyRenderGrid, AnalyticOnTheGridItself) {
  // Tilted facets: ours are the reference's half floats but for ties.
  const auto [scene, reference] = tested("grid", "grid_analytic", "grid_analytic");
  const statistics::Image ours = mean_image(render_or_throw(scene));
  const Seen seen(scene);
  int facets = 0;
  for (int y = 0; y < ours.height; ++y)
    for (int x = 0; x < ours.width; ++x) {
      const std::size_t pixel = std::size_t(y) * std::size_t(ours.width) + std::size_t(x);
      if (!seen.lit[pixel] || seen.floor[pixel]) continue;
      ++facets;
      for (int c = 0; c < 3; ++c) {
        const double stored = reference.at(x, y, c);
        // Four edges, none of which is seen under less than 0.2.
        const double off = 12 * kGridAlbedo[c] / (2 * std::numbers::pi) * 4 * float_acos_error(0.2);
        ASSERT_NEAR(ours.at(x, y, c), stored, half_spacing(stored) / 2 + off + kPosition) << x << ", " << y;
      }
    }
  EXPECT_GT(facets, 3000);
}

/// A window's image of 8 bits in sRGB, whose decoded values are stored. Graphics hardware may round by 0.6 in
/// that conversion (Direct3D 11.3 functional specification, float to sRGB).
TEST_F(TinyRenderPolygon, RealtimeIsTheClosedFormInEightBits) {
  const auto [scene, reference] = tested("polygon", "polygon_analytic_realtime", "polygon_analytic_realtime");
  const statistics::Image ours = mean_image(render_or_throw(scene));
  const Seen seen(scene);
  const Shape light = light_of(scene);
  constexpr double kConversion = 0.6;
  int compared = 0;
  double squares = 0, widest = 0;
  for (int y = 0; y < ours.height; ++y)
    for (int x = 0; x < ours.width; ++x) {
      const std::size_t pixel = std::size_t(y) * std::size_t(ours.width) + std::size_t(x);
      if (!seen.smooth[pixel]) continue;
      const double stored = reference.at(x, y, 1), value = ours.at(x, y, 1);
      if (!seen.floor[pixel]) {
        ASSERT_EQ(stored, seen.emitters[pixel] ? 1 : 0) << "a window clamps; " << x << ", " << y;
        ASSERT_EQ(value, seen.emitters[pixel] ? 10 : 0);
        continue;
      }
      const glm::dvec3 point = kPolygonCamera.floor_point(x, y);
      const double exact = std::max(unshadowed_radiance(light, kFloorAlbedo, point, 1), 0.0);
      ASSERT_NEAR(value, exact, kPosition) << x << ", " << y;
      const double off =
          10 * kFloorAlbedo / (2 * std::numbers::pi) * edge_error(light, point, shader_acos_error);
      const double above = srgb_code(value + off) - srgb_code(value);
      const double below = srgb_code(value) - srgb_code(value - off);
      const double code = std::round(srgb_code(stored)), tolerance = kConversion + std::max(above, below);
      ASSERT_NEAR(srgb_code(stored), code, 0.05) << "not a decoded code";  // half floats
      ASSERT_NEAR(srgb_code(value), code, tolerance) << x << ", " << y << ": " << value << ", " << stored;
      if (exact == 0) continue;
      ++compared;
      squares += (srgb_code(value) - code) * (srgb_code(value) - code);
      widest = std::max(widest, tolerance);
    }
  EXPECT_GT(compared, 90000);
  EXPECT_LT(widest, 2);
  // Rounding to whole codes alone has a mean square of 1/12.
  EXPECT_NEAR(std::sqrt(12 * squares / compared), 1, 0.02);
  RecordProperty("widest", std::to_string(widest));
  RecordProperty("rms", std::to_string(std::sqrt(12 * squares / compared)));
}

// --- draws of estimators

void expect_same_estimator(const SymmetryTest& test, bool with_signs = true) {
  EXPECT_EQ(test.failure(kSignificance, with_signs), "") << test.summary();
  testing::Test::RecordProperty("symmetry", test.summary());
}

TEST_F(TinyRenderGrid, Area) {
  auto [scene, reference] = tested("grid", "grid_area", "grid_area");
  ASSERT_EQ(scene.sampler.spp, 4u);
  scene.film.filter_radius = 0.5f;  // of several samples each has its place in the pixel
  const statistics::Image ours = transformed(mean_image(render_or_throw(scene)), to_half);
  expect_same_estimator(symmetry_test(reference, ours, 2, Seen(scene).lit, kBlock));
}

TEST_F(TinyRenderGrid, ControlVariates) {
  // What lies below 0, in noise or behind the light, is stored as 0.
  auto tested_scene = tested("grid", "grid_cv", "grid_cv");
  SceneDescription& scene = tested_scene.scene;
  const statistics::Image& reference = tested_scene.reference;
  ASSERT_EQ(param::vis_samples(scene.integrator), 4);
  ASSERT_EQ(scene.sampler.spp, 1u);
  const statistics::Image ours = transformed(mean_image(render_or_throw(scene)),
                                             [](double value) { return to_half(std::max(value, 0.0)); });
  // Where all is visible there is no noise, and what the closed forms differ by has no fair sign.
  const auto rounding = [&](int x, int y) {
    return 1.01 * half_spacing(reference.at(x, y, 2)) +
           12 / (2 * std::numbers::pi) * 4 * float_acos_error(0.2);
  };
  expect_same_estimator(symmetry_test(reference, ours, 2, Seen(scene).lit, kBlock, rounding));
}

TEST_F(TinyRenderGrid, RealtimeControlVariates) {
  // A window after one step of one shadow ray: clamped, 8 bits in sRGB.
  auto tested_scene = tested("grid", "grid_cv_realtime", "grid_cv_realtime");
  SceneDescription& scene = tested_scene.scene;
  const statistics::Image& reference = tested_scene.reference;
  param::vis_samples(scene.integrator) = 1;
  scene.sampler.spp = 1;
  const auto code = [](double value) { return std::round(srgb_code(value)); };
  const statistics::Image ours = transformed(mean_image(render_or_throw(scene)), code);
  // Where all is visible there is no noise, and what the closed forms differ by has no fair sign.
  const Shape light = light_of(scene);
  const auto rounding = [&](int x, int y) {
    const double off = 12 * kFloorAlbedo / (2 * std::numbers::pi) *
                       edge_error(light, kGridCamera.floor_point(x, y), shader_acos_error);
    const double value = reference.at(x, y, 0);
    return 1 + std::max(srgb_code(value + off) - srgb_code(value), srgb_code(value) - srgb_code(value - off));
  };
  expect_same_estimator(
      symmetry_test(transformed(reference, code), ours, 0, Seen(scene).floor, kBlock, rounding));
}

class TinyRenderVeach : public testing::TestWithParam<const char*> {};

TEST_P(TinyRenderVeach, IsTheSameEstimator) {
  PENUMBRA_NEED_ORACLE("tinyrender-a4");
  const std::string name = GetParam();
  auto [scene, reference] =
      tested("veach_test", name == "emitter" ? "veach_area" : "veach_" + name, "veach_" + name);
  ASSERT_EQ(scene.sampler.spp, 1u);
  const Mask mask = Seen(scene).lit;
  const bool samples_emitters = param::emitter_samples(scene.integrator) > 0;
  if (samples_emitters) make_emitters_spheres_chosen_alike(scene);
  const statistics::Image ours = transformed(mean_image(render_or_throw(scene)), to_half);
  // A direction within the cone of a sphere misses the mesh inside it at times, about 0.8 % as often as it
  // hits: mean and variance are then ours to that order, but of pixels with equally many samples of a light
  // the reference's are mostly a little brighter. So the signs do not count here.
  expect_same_estimator(symmetry_test(reference, ours, 0, mask, kBlock), !samples_emitters);
}

INSTANTIATE_TEST_SUITE_P(Strategies, TinyRenderVeach, testing::Values("emitter", "bsdf", "mis"),
                         [](const auto& instance) { return std::string(instance.param); });

}  // namespace
}  // namespace penumbra::tinyrender_reference_test
