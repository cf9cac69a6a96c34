// Ambient and reflection occlusion of surfaces whose occlusion has a closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/acceptance/scene_pieces.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra::occlusion_test {
namespace {

const double kSignificance = statistics::sidak_significance(0.01, 60);  ///< of each of some 60
constexpr double kRounding = 1e-6;
constexpr std::uint32_t kSamples = 40'000;

/// Looks at the origin of the floor y = 0 from this place, below anything that hangs above it.
SceneDescription floor_seen_from(glm::dvec3 eye) {
  SceneDescription scene = empty_scene(1, 1, kSamples, 5);
  scene.camera = look_at(eye, {0, 0, 0}, {0, 0.6, 0.8}, 1e-3);
  scene.shapes.push_back(parallelogram({-4, 0, -4}, {0, 0, 8}, {8, 0, 0}, add_diffuse(scene, 0.5f)));
  return scene;
}

void hang_disk(SceneDescription& scene, double height, double radius) {
  Shape disk;
  disk.name = "disk";
  disk.geometry = Disk{.center = {0, height, 0}, .normal = {0, -1, 0}, .radius = radius};
  scene.shapes.push_back(disk);
}

AmbientOcclusionIntegrator ambient(OcclusionSampling sampling, OcclusionWeighting weighting,
                                   float length = 0) {
  return {.sampling = sampling, .weighting = weighting, .ray_length = length};
}

void expect_openness(SceneDescription scene, const IntegratorMethod& method, double expected) {
  scene.integrator.method = method;
  TestDevice device = native_device();
  device.samples_per_pass = kMaxSamplesPerUnit;
  const statistics::Sample sample = pixel_sample(render_or_throw(scene, device), 0, 0, 1);
  EXPECT_GT(statistics::t_test(sample, expected, kRounding).p, kSignificance)
      << sample.mean() << " +- " << sample.standard_error() << ", exactly " << expected;
}

/// Every way to sample that has a finite variance.
void expect_openness(const SceneDescription& scene, float length, double cosine, double uniform) {
  for (const OcclusionSampling sampling :
       {OcclusionSampling::kCosine, OcclusionSampling::kHemisphere, OcclusionSampling::kSphere}) {
    SCOPED_TRACE(int(sampling));
    expect_openness(scene, ambient(sampling, OcclusionWeighting::kCosine, length), cosine);
    if (sampling != OcclusionSampling::kCosine)
      expect_openness(scene, ambient(sampling, OcclusionWeighting::kUniform, length), uniform);
  }
}

/// Of a floor that leans: the absolute values of its normal, and black beyond it.
TEST(Normals, AreThoseOfTheSurface) {
  SceneDescription scene = empty_scene(1, 1, 64, 5);
  scene.camera = look_at({0, 3, 0}, {0, 0, 0}, {0, 0, 1}, 1e-3);
  scene.shapes.push_back(parallelogram({-4, 3, -4}, {0, 0, 8}, {8, -6, 0}, add_diffuse(scene, 0.5f)));
  scene.integrator.method = NormalsIntegrator{};
  const FilmAccumulator film = render_or_throw(scene, native_device());
  const glm::dvec3 normal = glm::normalize(glm::dvec3(6, 8, 0));
  for (int channel = 0; channel < 3; ++channel)
    EXPECT_NEAR(pixel_sample(film, 0, 0, channel).mean(), normal[channel], 1e-6) << channel;
  scene.camera = look_at({0, 3, 0}, {0, 6, 0}, {0, 0, 1}, 1e-3);
  EXPECT_EQ(pixel_sample(render_or_throw(scene, native_device()), 0, 0, 1).mean(), 0.0);
}

TEST(AmbientOcclusion, BelowADisk) {
  struct Case {
    double height, radius, uniform;
  };
  for (const auto& [height, radius, uniform] :
       {Case{2, 1, 0.894427191}, Case{1, 1, 0.70710678118}, Case{2, 2, 0.70710678118}}) {
    SceneDescription scene = floor_seen_from({0.6, 0.3, 0.4});
    hang_disk(scene, height, radius);
    const double h2 = height * height, r2 = radius * radius;
    EXPECT_NEAR(uniform, std::sqrt(h2 / (h2 + r2)), 1e-9);
    expect_openness(scene, 0, h2 / (h2 + r2), uniform);
    // A ray of length l meets the disk within the angle whose cosine is height / l.
    const double length = 0.5 * (height + std::sqrt(h2 + r2));
    expect_openness(scene, float(length), h2 / (length * length), height / length);
    expect_openness(scene, float(0.999 * height), 1, 1);
  }
}

TEST(AmbientOcclusion, BelowADiskThatIsHalfThere) {
  SceneDescription scene = floor_seen_from({0.6, 0.3, 0.4});
  hang_disk(scene, 2, 1);
  scene.bsdfs.push_back({"mask", MaskBsdf{0.5f, kBlackBsdf}});
  Shape& disk = scene.shapes.back();
  disk.front_bsdf = disk.back_bsdf = int(scene.bsdfs.size()) - 1;
  expect_openness(scene, 0, 1 - 0.5 * 0.2, 1 - 0.5 * (1 - std::sqrt(0.8)));
  AmbientOcclusionIntegrator several = ambient(OcclusionSampling::kCosine, OcclusionWeighting::kCosine);
  several.vis_samples = 4;
  expect_openness(scene, several, 0.9);
}

// Half the directions have the same openness as the other half of a mirror image.
TEST(AmbientOcclusion, BelowAHalfPlane) {
  SceneDescription scene = floor_seen_from({0.6, 0.3, 0.4});
  scene.shapes.push_back(parallelogram({0, 1, -1e4}, {1e4, 0, 0}, {0, 0, 2e4}, kBlackBsdf));
  expect_openness(scene, 0, 0.5, 0.5);
}

// A chord at the angle t to the normal has length 2 cos t, so those longer than l are open.
TEST(AmbientOcclusion, InsideASphere) {
  SceneDescription scene = empty_scene(1, 1, kSamples, 6);
  scene.camera = look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 1e-3);
  Shape sphere;
  sphere.name = "sphere";
  sphere.geometry = Sphere{};
  sphere.back_bsdf = add_diffuse(scene, 0.5f);
  scene.shapes.push_back(sphere);
  expect_openness(scene, 0, 0, 0);
  for (const double length : {0.25, 1.0, 1.75})
    expect_openness(scene, float(length), 1 - length * length / 4, 1 - length / 2);
  // Half the radius of the sphere about the box about the sphere.
  expect_openness(scene, -1, 13.0 / 16, 1 - std::sqrt(3.0) / 4);
}

TEST(AmbientOcclusion, OfNothingIsTheBackground) {
  SceneDescription scene = empty_scene(1, 1, 4, 0);
  scene.camera = look_at({0, 1, 0}, {0, 2, 0}, {0, 0, 1}, 1);
  scene.shapes = floor_seen_from({0, 1, 0}).shapes;
  add_diffuse(scene, 0.5f);
  for (const float background : {0.0f, 0.75f}) {
    scene.integrator.method = AmbientOcclusionIntegrator{.background = background};
    EXPECT_EQ(render_or_throw(scene).at(0, 0).mean[1], double(background));
  }
  EXPECT_EQ(AmbientOcclusionIntegrator{}.background, 1);
}

TEST(AmbientOcclusion, SeveralRaysAreTheirMean) {
  SceneDescription scene = floor_seen_from({0.6, 0.3, 0.4});
  hang_disk(scene, 2, 1);
  scene.sampler.spp = kSamples / 8;
  AmbientOcclusionIntegrator method = ambient(OcclusionSampling::kHemisphere, OcclusionWeighting::kCosine);
  method.vis_samples = 8;
  expect_openness(scene, method, 0.8);
}

/// (n + 2) / (2 pi) cos^n alpha cos theta over the hemisphere, alpha about a direction at the angle `tilt` to
/// its axis.
double lobe_integral(double n, double tilt) {
  constexpr int kCells = 2000;
  double sum = 0;
  for (int i = 0; i < kCells; ++i) {
    const double theta = (i + 0.5) / kCells * std::numbers::pi / 2;
    for (int j = 0; j < kCells; ++j) {
      const double phi = (j + 0.5) / kCells * 2 * std::numbers::pi;
      const double alpha =
          std::sin(theta) * std::cos(phi) * std::sin(tilt) + std::cos(theta) * std::cos(tilt);
      if (alpha > 0) sum += std::pow(alpha, n) * std::cos(theta) * std::sin(theta);
    }
  }
  return (n + 2) / (2 * std::numbers::pi) * sum * (std::numbers::pi / 2 / kCells) *
         (2 * std::numbers::pi / kCells);
}

TEST(ReflectionOcclusion, OfAnOpenFloorIsTheIntegralOfTheLobe) {
  EXPECT_NEAR(lobe_integral(5, 0), 1, 1e-5);
  for (const double n : {0.0, 5.0, 30.0})
    for (const double tilt : {0.0, 0.9, 1.4}) {
      SCOPED_TRACE(std::to_string(n) + " at " + std::to_string(tilt));
      expect_openness(floor_seen_from({std::sin(tilt), std::cos(tilt), 0}),
                      ReflectionOcclusionIntegrator{.exponent = float(n)}, lobe_integral(n, tilt));
    }
}

// Seen along the normal the lobe is cos^n about it: of it c^(n + 2) is beyond the angle whose cosine is c.
TEST(ReflectionOcclusion, BelowADisk) {
  SceneDescription scene = floor_seen_from({0, 1, 0});
  hang_disk(scene, 2, 1);
  const double cosine = 2 / std::sqrt(5.0);
  for (const double n : {1.0, 30.0}) {
    expect_openness(scene, ReflectionOcclusionIntegrator{.exponent = float(n)}, std::pow(cosine, n + 2));
    expect_openness(scene, ReflectionOcclusionIntegrator{.exponent = float(n), .ray_length = 1.99f}, 1);
    expect_openness(scene, ReflectionOcclusionIntegrator{.exponent = float(n), .ray_length = 2.1f},
                    std::pow(2 / 2.1, n + 2));
  }
}

}  // namespace
}  // namespace penumbra::occlusion_test
