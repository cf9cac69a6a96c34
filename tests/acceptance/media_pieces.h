// Parts of media tests: boundaries without a surface, a view along z, and a t-test for colours.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "scenes/transform.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra::media {

inline constexpr double kSignificance = 0.01;
inline constexpr double kRounding =
    64.0 / (1 << 24);  // of a product of some factors, exponentials among them

inline ParticipatingMedium medium(const glm::vec3& extinction, const glm::vec3& albedo, float g = 0) {
  return {.name = "medium", .extinction = extinction, .albedo = albedo, .phase = {{PHASE_HG, g, 1}}};
}
inline ParticipatingMedium medium(float extinction, float albedo, float g = 0) {
  return medium(glm::vec3(extinction), glm::vec3(albedo), g);
}

inline IntegratorSettings volpath(DirectSampling sampling = DirectSampling::kMis, int max_depth = -1) {
  return {.method = VolpathIntegrator{.max_depth = max_depth, .direct_sampling = sampling}};
}

/// A pixel that looks along z from the origin through almost no angle, and what `volpath` makes of it.
inline SceneDescription narrow_view(std::uint32_t spp, const IntegratorSettings& integrator = volpath()) {
  SceneDescription scene = empty_scene(1, 1, spp, 1);
  scene.camera = look_at(glm::dvec3(0), glm::dvec3(0, 0, 1), glm::dvec3(0, 1, 0), 1e-3);
  scene.integrator = integrator;
  return scene;
}

/// Reflectance of a smooth boundary, by Fresnel's equations.
inline double reflectance(double cosine, double index) {
  const double inside = std::sqrt(1 - (1 - cosine * cosine) / (index * index));
  const double s = (cosine - index * inside) / (cosine + index * inside),
               p = (index * cosine - inside) / (index * cosine + inside);
  return (s * s + p * p) / 2;
}

/// A grid of one channel, or three, whose numbers are f(x, y, z, channel) of the cells' indices.
inline GridVolume grid(glm::ivec3 size, int channels, const std::function<float(int, int, int, int)>& f) {
  auto numbers = std::make_shared<VolumeGrid>();
  numbers->nx = size.x;
  numbers->ny = size.y;
  numbers->nz = size.z;
  numbers->channels = channels;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x)
        for (int c = 0; c < channels; ++c) numbers->values.push_back(f(x, y, z, c));
  return {.grid = numbers};
}

inline glm::dmat4 unit_cube_to(glm::dvec3 low, glm::dvec3 high) {
  return translation(low) * scaling(high - low);
}

inline int add_null(SceneDescription& scene) {
  scene.bsdfs.push_back({"nothing", NullBsdf{}});
  return int(scene.bsdfs.size()) - 1;
}

inline int add_medium(SceneDescription& scene, const ParticipatingMedium& one) {
  scene.media.push_back(one);
  return int(scene.media.size()) - 1;
}

/// A box whose sides face outwards.
inline Shape box(const glm::dvec3& low, const glm::dvec3& high, int bsdf) {
  const auto corner = [&](int i) {
    return glm::dvec3((i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                      (i & 4) != 0 ? high.z : low.z);
  };
  std::vector<glm::dvec3> positions;
  for (const std::array<int, 4>& side :
       {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4}, std::array{2, 6, 7, 3},
        std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}})
    for (const int k : {0, 1, 2, 0, 2, 3}) positions.push_back(corner(side[std::size_t(k)]));
  Shape shape = triangles(positions, bsdf);
  shape.back_bsdf = bsdf;
  return shape;
}

inline void bound(SceneDescription& scene, Shape shape, int interior) {
  shape.interior = interior;
  scene.shapes.push_back(std::move(shape));
}

inline Shape sphere(const glm::dvec3& center, double radius, int bsdf) {
  Shape shape;
  shape.name = "sphere";
  shape.geometry = Sphere{.center = center, .radius = radius};
  shape.front_bsdf = shape.back_bsdf = bsdf;
  return shape;
}

inline TestDevice big_passes() {
  TestDevice device = native_device();
  device.samples_per_pass = kMaxSamplesPerUnit;
  return device;
}

inline void expect_colour(const SceneDescription& scene, const glm::dvec3& expected,
                          double tolerance = kRounding) {
  const FilmAccumulator film = render_or_throw(scene, big_passes());
  EXPECT_EQ(non_finite_count(film.flagged()), 0u);
  for (int channel = 0; channel < 3; ++channel) {
    const statistics::Sample sample = pixel_sample(film, 0, 0, channel);
    const double truth = expected[channel];
    EXPECT_GT(statistics::t_test(sample, truth, truth * tolerance + 1e-30).p, kSignificance / 3)
        << "channel " << channel << ": " << sample.mean() << " +- " << sample.standard_error()
        << ", expected " << truth;
  }
}

/// The same image, by the means of blocks of pixels, none of which is black.
inline void expect_alike(const SceneDescription& one, const SceneDescription& other) {
  const statistics::Estimate a = block_estimate(one, 8, 10, 4, big_passes()),
                             b = block_estimate(other, 8, 100, 4, big_passes());
  const statistics::ImageTestResult test = statistics::z_test(a, b, {.significance = kSignificance});
  EXPECT_LE(std::abs(test.worst), test.limit) << test.summary();
  for (const double value : a.mean.values) EXPECT_GT(value, 0);
}

}  // namespace penumbra::media
