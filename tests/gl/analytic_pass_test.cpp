// The closed form on the screen against the kernels', pixel by pixel.
#include "gl/analytic_pass.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>

#include "kernels/host/sample_buffer.h"
#include "tests/gl/analytic_scenes.h"
#include "tests/gl/gl_test_context.h"
#include "tests/gl/pixel_primitives.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/oracles.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

using AnalyticPassTest = GlTest;

std::unique_ptr<AnalyticPass> pass_of(const DeviceScene& scene) {
  auto pass = AnalyticPass::create(scene);
  if (!pass) throw std::runtime_error(pass.error().message);
  return std::move(*pass);
}

/// The scene as polygon_analytic renders it, at another size.
SceneDescription analytic_scene(SceneDescription scene, int width, int height) {
  scene.integrator = integrator_of(IntegratorKind::kPolygonAnalytic);
  resize_film(scene, width, height);
  return scene;
}

void sample_centres(SceneDescription& scene) {
  scene.film.filter = FilterKind::kBox;
  scene.film.filter_radius = 1e-6f;
  scene.sampler.spp = 1;
}

/// What the kernels say.
struct Offline {
  statistics::Image closed_form, emission;
};
Offline offline_image(const DeviceScene& scene) {
  const FilmAccumulator film = render_or_throw(scene);
  Offline made{{film.width(), film.height(), 3}, {film.width(), film.height(), 3}};
  for (int y = 0; y < film.height(); ++y)
    for (int x = 0; x < film.width(); ++x)
      for (int c = 0; c < 3; ++c) {
        made.closed_form.at(x, y, c) = film.layer(x, y, LAYER_ANALYTIC, c);
        made.emission.at(x, y, c) = film.at(x, y).mean[c] - film.layer(x, y, LAYER_ANALYTIC, c);
      }
  return made;
}

SceneDescription project_scene(const char* file) { return read_or_throw(project_file(file)); }
SceneDescription oracle_scene(const char* file) {
  return read_or_throw(*find_oracle("tinyrender-a4") / file);
}

struct Compared {
  const char* name;
  SceneDescription (*read)();
  int width, height;
  bool is_oracle = false;
};
void PrintTo(const Compared& compared, std::ostream* out) { *out << compared.name; }

const Compared kScenes[] = {
    {"Grid", [] { return oracle_scene("grid/tinyrender/grid_analytic.toml"); }, 600, 400, true},
    {"Polygon", [] { return oracle_scene("polygon/tinyrender/polygon_analytic_realtime.toml"); }, 300, 200,
     true},
    {"StarLight", [] { return project_scene("scenes/star-light/star-light.xml"); }, 240, 160},
    {"Cornell", [] { return project_scene("scenes/cornell/cornell.xml"); }, 160, 160},
    {"GlossyCornell", glossy_box, 160, 160},
    {"Star", [] { return oracle_scene("star/tinyrender/star_analytic_realtime.toml"); }, 240, 160, true},
    {"McGill", [] { return oracle_scene("mcgill/tinyrender/mcgill_analytic_offline.toml"); }, 240, 160, true},
    {"Strips", strips, 240, 160},
    {"OnAPlain", on_a_plain, 200, 150},
    {"RoundThings", round_things, 200, 150},
    {"RoundLobes", round_lobes, 200, 150},
    {"CoarseRims", coarse_rims, 200, 150},
    {"TinyRoundThings", [] { return scaled(round_things(), 1e-5); }, 200, 150},
    {"HugeRoundThings", [] { return scaled(round_things(), 1e6); }, 200, 150},
};

class AnalyticPassScenes : public GlTest, public testing::WithParamInterface<Compared> {};

// Of what a diffuse or glossy surface may reflect at most, half the sum over the edges of an angle times a
// height: the angles of an outline that is in front add up to at most 2 pi, and each product has some eight
// roundings in single precision, a lobe's likewise.
constexpr double kRounding = 8 * 0x1p-24;
// Relative, above that: positions have roundings of the scene's size, which counts where lights are close,
// and a lobe of exponent e turns a direction's rounding into e times as much.
constexpr double kTolerance = 1e-3;
// Differences of a mean in single precision, less one in double.
constexpr double kEmissionTolerance = 1e-6;

/// What a surface reflects at most: all that the brightest material can of all lights, each covering half the
/// sphere.
double most_reflected(const SceneDescription& scene) {
  double light = 0, reflectance = 0;
  for (const Shape& shape : scene.shapes)
    if (shape.radiance && std::holds_alternative<Mesh>(shape.geometry))
      light += std::max({shape.radiance->r, shape.radiance->g, shape.radiance->b});
  for (const Bsdf& bsdf : scene.bsdfs) {
    const auto* diffuse = std::get_if<DiffuseBsdf>(&bsdf.model);
    const auto* phong = std::get_if<PhongBsdf>(&bsdf.model);
    const glm::vec3 most = diffuse != nullptr ? diffuse->reflectance.value
                           : phong != nullptr ? phong->diffuse.value + phong->specular.value
                                              : glm::vec3(1);
    reflectance = std::max<double>(reflectance, std::max({most.r, most.g, most.b}));
  }
  return light * reflectance;
}

/// The largest difference of the inner pixels, relative to what the kernels say or, where that is little, to
/// `floor`.
struct Difference {
  double most = 0, brightest = 0;
  int x = 0, y = 0, pixels = 0;
};
Difference largest_difference(const statistics::Image& ours, const statistics::Image& theirs,
                              const std::vector<char>& inside, double floor) {
  Difference d;
  for (int y = 0; y < ours.height; ++y)
    for (int x = 0; x < ours.width; ++x) {
      if (!inside[std::size_t(y) * ours.width + x]) continue;
      ++d.pixels;
      for (int c = 0; c < 3; ++c) {
        const double value = theirs.at(x, y, c), off = std::abs(ours.at(x, y, c) - value) / (value + floor);
        d.brightest = std::max(d.brightest, value);
        if (!(off <= d.most)) {  // NaN counts as the worst
          d.most = off;
          d.x = x;
          d.y = y;
        }
      }
    }
  return d;
}

/// Both parts of a first frame, in the view of `scene`, against the kernels'.
void expect_as_the_kernels(AnalyticPass& pass, const SceneDescription& description,
                           const DeviceScene& scene) {
  const Offline offline = offline_image(scene);
  ASSERT_TRUE(pass.begin(scene.header, scene.header.film.width, scene.header.film.height));
  pass.add_frame();
  const std::vector<char> inside = pixels_off_silhouettes(scene);
  const Difference form = largest_difference(read_texture(pass.closed_form()), offline.closed_form, inside,
                                             kRounding / kTolerance * most_reflected(description));
  const Difference emission = largest_difference(read_texture(pass.emission()), offline.emission, inside, 1);
  EXPECT_GT(form.pixels, int(inside.size() / 3));
  EXPECT_GT(form.brightest, 0);
  EXPECT_LE(form.most, kTolerance) << "pixel " << form.x << ", " << form.y;
  EXPECT_LE(emission.most, kEmissionTolerance) << "pixel " << emission.x << ", " << emission.y;
  std::printf("largest difference of %d pixels: %.1e of the closed form, %.1e of the emission\n", form.pixels,
              form.most, emission.most);
}

TEST_P(AnalyticPassScenes, FirstFrameIsWhatTheKernelsSay) {
  if (GetParam().is_oracle) PENUMBRA_NEED_ORACLE("tinyrender-a4");
  SceneDescription description = analytic_scene(GetParam().read(), GetParam().width, GetParam().height);
  sample_centres(description);
  const DeviceScene scene = build_or_throw(description);
  expect_as_the_kernels(*pass_of(scene), description, scene);
}
INSTANTIATE_TEST_SUITE_P(Scenes, AnalyticPassScenes, testing::ValuesIn(kScenes),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_F(AnalyticPassTest, ShowsANewViewOfTheSameScene) {
  SceneDescription description = analytic_scene(round_things(), 60, 80);
  sample_centres(description);
  const auto pass = pass_of(build_or_throw(description));
  for (const glm::dvec3 eye : {glm::dvec3(3, 1.2, -4), glm::dvec3(-0.2, 0.3, 1.1), glm::dvec3(0, 20, 0.1)}) {
    description.camera.to_world = look_at(eye, {0, 0.9, 0}, {0.1, 1, 0});
    description.camera.fov *= 0.9;
    resize_film(description, description.film.width + 31, description.film.height - 7);
    expect_as_the_kernels(*pass, description, build_or_throw(description));
  }
}

TEST_F(AnalyticPassTest, ClipsAtTheCamerasPlanes) {
  SceneDescription description = analytic_scene(round_things(), 120, 90);
  sample_centres(description);
  description.camera.near_clip = 5.5;  // through a sphere
  description.camera.far_clip = 7.2;   // before the disk
  const DeviceScene scene = build_or_throw(description);
  const std::vector<int> seen = pixel_primitives(scene);
  ASSERT_GT(std::ranges::count(seen, -1), 0);
  expect_as_the_kernels(*pass_of(scene), description, scene);
}

TEST_F(AnalyticPassTest, HidesEmitters) {
  SceneDescription description = analytic_scene(round_things(), 60, 40);
  sample_centres(description);
  description.integrator.hide_emitters = true;
  const DeviceScene scene = build_or_throw(description);
  const auto pass = pass_of(scene);
  expect_as_the_kernels(*pass, description, scene);
  for (const double value : read_texture(pass->emission()).values) ASSERT_EQ(value, 0);
}

TEST_F(AnalyticPassTest, LooksThroughHiddenEmitters) {
  SceneDescription description = analytic_scene(round_things(), 60, 40);
  sample_centres(description);
  description.integrator.hide_emitters = true;
  const DeviceScene unlit = build_or_throw(description);
  description.integrator.hidden_emitters = HiddenEmitters::kLookedThrough;
  const DeviceScene scene = build_or_throw(description);
  const auto pass = pass_of(scene), unlit_pass = pass_of(unlit);
  expect_as_the_kernels(*pass, description, scene);
  expect_as_the_kernels(*unlit_pass, description, unlit);
  EXPECT_NE(read_texture(pass->closed_form()).values, read_texture(unlit_pass->closed_form()).values);
  for (const double value : read_texture(pass->emission()).values) ASSERT_EQ(value, 0);
}

TEST_F(AnalyticPassTest, LightsDoNotShineOnThemselves) {
  SceneDescription description = analytic_scene(round_things(), 120, 90);
  sample_centres(description);
  description.camera.to_world = look_at({1, 6, 2}, {0, 2.7, 0}, {0, 1, 0});
  const DeviceScene scene = build_or_throw(description);
  const auto pass = pass_of(scene);
  ASSERT_TRUE(pass->begin(scene.header, 120, 90));
  pass->add_frame();
  const statistics::Image form = read_texture(pass->closed_form()), emission = read_texture(pass->emission());
  const std::vector<char> on_light = pixels_on_polygon_lights(scene), inside = pixels_off_silhouettes(scene);
  int pixels = 0;
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (!inside[i] || !on_light[i]) continue;
    ++pixels;
    ASSERT_EQ(form.values[3 * i], 0);
    ASSERT_EQ(emission.values[3 * i], 5);
  }
  EXPECT_GT(pixels, 100);
}

struct Filter {
  const char* name;
  FilterKind kind;
  float radius;
};
void PrintTo(const Filter& filter, std::ostream* out) { *out << filter.name; }
class AnalyticPassFilters : public GlTest, public testing::WithParamInterface<Filter> {};

/// Silhouettes too: the mean of `kFrames` frames against many samples of the kernels, in standard errors as
/// if the frames were independent draws. They are not, but better spread, which makes the mean square less
/// than 1.
TEST_P(AnalyticPassFilters, ConvergeToTheFilterOfTheFilm) {
  constexpr int kFrames = 256, kSamples = 1024, kWidth = 48, kHeight = 32;
  constexpr double kMost = 6;
  constexpr double kBrightest = 9;  // of the scene: one frame more or less that sees it
  SceneDescription description =
      analytic_scene(project_scene("scenes/star-light/star-light.xml"), kWidth, kHeight);
  description.film.filter = GetParam().kind;
  description.film.filter_radius = GetParam().radius;
  description.sampler.kind = SamplerKind::kIndependent;
  description.sampler.spp = kSamples;
  const DeviceScene scene = build_or_throw(description);
  const FilmAccumulator film = render_or_throw(scene);
  const auto pass = pass_of(scene);
  ASSERT_TRUE(pass->begin(scene.header, kWidth, kHeight));
  const auto mean_square = [&](double frames, double& worst) {
    const statistics::Image form = read_texture(pass->closed_form()),
                            emission = read_texture(pass->emission());
    double sum = 0;
    int count = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        for (int k = 0; k < 3; ++k) {
          const PixelStatistics& pixel = film.at(x, y);
          const double variance = pixel.m2[k] / double(pixel.count - 1);
          const double one_frame = kBrightest / frames;
          const double rounding = kTolerance * (std::abs(pixel.mean[k]) + kRounding / kTolerance * 10);
          const double z2 =
              std::pow(form.at(x, y, k) + emission.at(x, y, k) - pixel.mean[k], 2) /
              (variance * (1 / frames + 1.0 / kSamples) + one_frame * one_frame + rounding * rounding);
          sum += z2;
          worst = std::max(worst, std::sqrt(z2));
          ++count;
        }
    return sum / count;
  };
  pass->add_frame();
  double worst = 0;
  const double after_one = mean_square(kFrames, worst);
  EXPECT_GT(worst, kMost) << "one frame would do";
  while (pass->frames() < kFrames) pass->add_frame();
  worst = 0;
  const double after_all = mean_square(kFrames, worst);
  EXPECT_LT(after_all, 1);
  EXPECT_LT(worst, kMost);
  std::printf("mean square of the standardised difference: %.2f after a frame, %.2f after %d; most %.1f\n",
              after_one, after_all, kFrames, worst);
}
INSTANTIATE_TEST_SUITE_P(Filters, AnalyticPassFilters,
                         testing::Values(Filter{"Box", FilterKind::kBox, 0.5f},
                                         Filter{"Gaussian", FilterKind::kGaussian, 2.0f},
                                         Filter{"Mitchell", FilterKind::kMitchell, 2.0f}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_F(AnalyticPassTest, ForgetsEarlierFramesWhenItBegins) {
  const DeviceScene scene = build_or_throw(analytic_scene(round_things(), 40, 30));
  const auto pass = pass_of(scene);
  pass->add_frame();  // does nothing yet
  EXPECT_EQ(pass->frames(), 0);
  EXPECT_EQ(pass->closed_form(), 0u);
  ASSERT_TRUE(pass->begin(scene.header, 40, 30));
  pass->add_frame();
  const statistics::Image first = read_texture(pass->closed_form());
  for (int k = 0; k < 5; ++k) pass->add_frame();
  EXPECT_EQ(pass->frames(), 6);
  EXPECT_NE(read_texture(pass->closed_form()).values, first.values);
  ASSERT_TRUE(pass->begin(scene.header, 40, 30));
  EXPECT_EQ(pass->frames(), 0);
  pass->add_frame();
  EXPECT_EQ(read_texture(pass->closed_form()).values, first.values);
}

TEST_F(AnalyticPassTest, KeepsWhatIsBound) {
  const DeviceScene scene = build_or_throw(analytic_scene(round_things(), 40, 30));
  const Texture texture = make_texture(GL_RGBA8, 16, 16, GL_RGBA, GL_UNSIGNED_BYTE);
  const GLuint names[] = {texture.name()};
  const auto framebuffer = make_framebuffer(names);
  ASSERT_TRUE(framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer->name());
  glViewport(1, 2, 13, 11);
  const auto pass = pass_of(scene);
  ASSERT_TRUE(pass->begin(scene.header, 40, 30));
  pass->add_frame();
  GLint draws = 0, reads = 0, viewport[4];
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &draws);
  glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &reads);
  glGetIntegerv(GL_VIEWPORT, viewport);
  EXPECT_EQ(GLuint(draws), framebuffer->name());
  EXPECT_EQ(GLuint(reads), framebuffer->name());
  EXPECT_THAT(viewport, testing::ElementsAre(1, 2, 13, 11));
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

TEST_F(AnalyticPassTest, RefusesPicturesThatAreTooLarge) {
  const DeviceScene scene = build_or_throw(analytic_scene(round_things(), 40, 30));
  const auto pass = pass_of(scene);
  for (const int width : {0, 1 << 20}) {
    const auto begun = pass->begin(scene.header, width, 30);
    ASSERT_FALSE(begun);
    EXPECT_THAT(begun.error().message, testing::HasSubstr(std::to_string(width) + " x 30"));
  }
}

}  // namespace
}  // namespace penumbra
