// Media that emit: closed forms, furnaces, quadrature along rays, and photon mapping against path tracing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/acceptance/media_pieces.h"

namespace penumbra::media {
namespace {

// Lengths within boxes of coordinates up to 4, whose boundaries are off by up to 7 * 2^-24 of them.
constexpr double kLengths = 1e-5;

ParticipatingMedium shining(ParticipatingMedium m, const glm::vec3& emission) {
  m.emission = emission;
  return m;
}

/// What is seen of a slab of depth d.
double of_slab(double extinction, double emission, double d) {
  return extinction > 0 ? emission / extinction * -std::expm1(-extinction * d) : emission * d;
}

// --- The same everywhere.

TEST(EmittingMedia, ASlabShinesAsItsClosedFormSays) {
  const glm::vec3 emission(0.5f, 2.0f, 7.0f);
  for (const glm::vec3 extinction : {glm::vec3(0), glm::vec3(1e-6f, 0.3f, 2), glm::vec3(50, 1e-3f, 1e6f)}) {
    SceneDescription scene = narrow_view(4);
    bound(scene, box({-1, -1, 1}, {1, 1, 2.5}, add_null(scene)),
          add_medium(scene, shining(medium(extinction, glm::vec3(0)), emission)));
    glm::dvec3 truth;
    for (int k = 0; k < 3; ++k) truth[k] = of_slab(double(extinction[k]), double(emission[k]), 1.5);
    SCOPED_TRACE(extinction.z);
    expect_colour(scene, truth, kLengths);
  }
}

TEST(EmittingMedia, AClearSphereShinesByItsChords) {
  for (const double off : {0.0, 0.6, 0.8}) {
    SceneDescription scene = narrow_view(4);
    bound(scene, sphere({off, 0, 3}, 1, add_null(scene)),
          add_medium(scene, shining(medium(0, 0), {1, 2, 3})));
    SCOPED_TRACE(off);
    expect_colour(scene, 2 * std::sqrt(1 - off * off) * glm::dvec3(1, 2, 3), 1e-4);
  }
}

TEST(EmittingMedia, TheCameraMayBeWithin) {
  SceneDescription scene = narrow_view(4);
  scene.camera_medium = add_medium(scene, shining(medium(2, 0), {1, 2, 3}));
  expect_colour(scene, glm::dvec3(1, 2, 3) / 2.0, kLengths);
}

// In radiance that is the same everywhere, absorption is made up for by emission.
TEST(EmittingMedia, InBalanceChangeNoFurnace) {
  const glm::vec3 extinction(0.5f, 2, 6), albedo(0.9f, 0.5f, 0.2f);
  for (const DirectSampling sampling : {DirectSampling::kBsdfOnly, DirectSampling::kMis})
    for (const bool by_grid : {false, true}) {
      SceneDescription scene = narrow_view(30'000, volpath(sampling));
      ParticipatingMedium m = shining(medium(extinction, albedo, 0.4f), extinction * (1.0f - albedo));
      if (by_grid) {
        m.density = grid({3, 2, 19}, 1, [](int x, int, int z, int) { return float((x + z) % 5) * 0.4f; });
        m.density->to_world = unit_cube_to({-1, -1, 2}, {1, 1, 4});
        m.density->fades = true;
        m.emission_by_density = true;
      }
      bound(scene, sphere({0, 0, 3}, 1, add_null(scene)), add_medium(scene, m));
      scene.emitters.emplace_back(ConstantEnvironment{});
      SCOPED_TRACE(::testing::Message() << int(sampling) << by_grid);
      expect_colour(scene, glm::dvec3(1));
    }
}

/// Of a wide slab of depth d, what is seen straight from its front: emitted, and scattered once.
double scattered_in_slab(double extinction, double albedo, double emission, double d) {
  constexpr int kSteps = 2000, kAngles = 400;
  const double h = d / kSteps;
  double sum = of_slab(extinction, emission, d);
  for (int i = 0; i < kSteps; ++i) {
    const double z = (i + 0.5) * h;
    double around = 0;  // the mean over directions
    for (int k = 0; k < kAngles; ++k) {
      const double mu = (k + 0.5) / kAngles;
      around += 0.5 / kAngles *
                (of_slab(extinction, emission, z / mu) + of_slab(extinction, emission, (d - z) / mu));
    }
    sum += h * std::exp(-extinction * z) * extinction * albedo * around;
  }
  return sum;
}

TEST(EmittingMedia, ScatterTheirOwnLightAsQuadratureSays) {
  const glm::vec3 extinction(0.3f, 1, 4), albedo(0.5f, 0.9f, 0.7f), emission(1, 2, 0.5f);
  SceneDescription scene = narrow_view(50'000, volpath(DirectSampling::kMis, 2));
  bound(scene, box({-1e4, -1e4, 1}, {1e4, 1e4, 2.5}, add_null(scene)),
        add_medium(scene, shining(medium(extinction, albedo), emission)));
  glm::dvec3 truth;
  for (int k = 0; k < 3; ++k)
    truth[k] = scattered_in_slab(double(extinction[k]), double(albedo[k]), double(emission[k]), 1.5);
  expect_colour(scene, truth, 1e-4);
}

// --- Grids.

TEST(EmittingMedia, EvenGridsAreTheMediumWithoutOne) {
  const glm::vec3 extinction(0, 0.8f, 3), emission(0.5f, 2, 7);
  glm::dvec3 truth;
  for (int k = 0; k < 3; ++k) truth[k] = of_slab(double(extinction[k]), double(emission[k]), 1.5);
  const glm::dmat4 place = unit_cube_to({-1, -1, 1}, {1, 1, 2.5});
  const auto one = [&](glm::ivec3 size) {
    GridVolume volume = grid(size, 1, [](int, int, int, int) { return 0.5f; });
    volume.to_world = place;
    return volume;
  };
  for (const int kind : {0, 1, 2, 3}) {
    SceneDescription scene = narrow_view(20'000);
    ParticipatingMedium m = shining(medium(extinction, glm::vec3(0)), emission);
    const bool gridded = kind != 1;  // else only its emission
    if (gridded) m.density = one({9, 17, 30});
    if (gridded) m.extinction *= 2.0f;
    if (kind == 1 || kind == 2) m.emission_grid = one({20, 2, 11});
    if (kind == 1 || kind == 2) m.emission *= 2.0f;
    m.emission_by_density = kind >= 2;
    if (kind >= 2) m.emission *= 2.0f;
    bound(scene, box({-1, -1, 1}, {1, 1, 2.5}, add_null(scene)), add_medium(scene, m));
    SCOPED_TRACE(kind);
    expect_colour(scene, truth, 1e-4);
  }
}

/// The value of a grid in the unit cube at a place, interpolated in double.
double value_of(const VolumeGrid& g, glm::dvec3 place) {
  const glm::ivec3 size(g.nx, g.ny, g.nz);
  place = glm::clamp(place * glm::dvec3(size) - 0.5, glm::dvec3(0), glm::dvec3(size - 1));
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2);
    const glm::ivec3 cell = glm::min(glm::ivec3(place) + step, size - 1);
    const glm::dvec3 share = glm::mix(1.0 - glm::fract(place), glm::fract(place), glm::dvec3(step));
    sum +=
        share.x * share.y * share.z * double(g.values[std::size_t((cell.z * g.ny + cell.y) * g.nx + cell.x)]);
  }
  return sum;
}

/// A small flame in a large grid of smoke, both within [-2, 2] x [-2, 2] x [1, 5].
struct Flame {
  ParticipatingMedium medium;
  glm::dmat4 place = unit_cube_to({-2, -2, 1}, {2, 2, 5});

  Flame(const glm::vec3& extinction, const glm::vec3& emission) {
    medium = shining(media::medium(extinction, glm::vec3(0)), emission);
    medium.density =
        grid({40, 40, 40}, 1, [](int x, int y, int z, int) { return 0.2f + 0.1f * float((x * y + z) % 7); });
    medium.emission_grid = grid({64, 64, 64}, 1, [](int x, int y, int z, int) {
      const glm::dvec3 from = (glm::dvec3(x, y, z) + 0.5) / 64.0 - glm::dvec3(0.52, 0.5, 0.6);
      return float(std::exp(-dot(from, from) / (2 * 0.03 * 0.03)));
    });
    medium.density->to_world = medium.emission_grid->to_world = place;
  }
  /// The radiance seen along z from (x, y, 0).
  [[nodiscard]] glm::dvec3 seen(double x, double y) const {
    constexpr int kSteps = 64 * 40 * 4;  // of the same length in all cells
    const double h = 4.0 / kSteps;
    double depth = 0;
    glm::dvec3 sum(0);
    for (int i = 0; i < kSteps; ++i) {
      const glm::dvec3 at((x + 2) / 4, (y + 2) / 4, (i + 0.5) / kSteps);
      const double density = value_of(*medium.density->grid, at);
      const double emission = value_of(*medium.emission_grid->grid, at);
      depth += density * h / 2;
      for (int k = 0; k < 3; ++k)
        sum[k] += h * emission * double(medium.emission[k]) * std::exp(-depth * double(medium.extinction[k]));
      depth += density * h / 2;
    }
    return sum;
  }
  [[nodiscard]] SceneDescription scene(double x, double y, std::uint32_t spp) const {
    SceneDescription scene = narrow_view(spp);
    scene.camera = look_at(glm::dvec3(x, y, 0), glm::dvec3(x, y, 1), glm::dvec3(0, 1, 0), 1e-3);
    bound(scene, box({-2, -2, 1}, {2, 2, 5}, add_null(scene)), add_medium(scene, medium));
    return scene;
  }
};

TEST(EmittingMedia, ASmallFlameInALargeGridIsAsQuadratureSaysAndHasLittleNoise) {
  for (const float extinction : {0.0f, 0.5f, 8.0f}) {
    const Flame flame(glm::vec3(0.5f, 1, 2) * extinction, {5, 2, 1});
    for (const double off : {0.0, 0.3}) {
      SCOPED_TRACE(::testing::Message() << extinction << " " << off);
      const SceneDescription scene = flame.scene(0.08 + off, 0.0, 20'000);
      const glm::dvec3 truth = flame.seen(0.08 + off, 0.0);
      expect_colour(scene, truth, 1e-4);
      if (extinction > 1) continue;
      // Points where the emission's majorant is have less than a third of its mean as standard deviation.
      const statistics::Sample sample = pixel_sample(render_or_throw(scene, big_passes()), 0, 0, 0);
      EXPECT_LT(sample.standard_error() * std::sqrt(20'000.0) / truth.x, off > 0 ? 0.7 : 0.35);
    }
  }
}

// --- Other integrators, layers.

/// A room with a lamp, a ball of glass, and a flame.
SceneDescription lit_room(const IntegratorSettings& integrator, std::uint32_t spp) {
  SceneDescription scene = empty_scene(8, 8, spp, 3);
  scene.camera = look_at(glm::dvec3(0, 0, -2.9), glm::dvec3(0), glm::dvec3(0, 1, 0), 60);
  scene.integrator = integrator;
  const int grey = add_diffuse(scene, 0.6f), nothing = add_null(scene);
  Shape walls = box({-2, -1, -3}, {2, 1.5, 2}, grey);
  walls.flip_normals = true;
  scene.shapes.push_back(walls);
  scene.shapes.push_back(parallelogram({0.5, 1.45, 0.5}, {0, 0, -1}, {-1, 0, 0}, grey, 1.0f));
  ParticipatingMedium m = shining(medium({0.6f, 0.4f, 0.2f}, {0.5f, 0.8f, 0.9f}), {2, 1, 0.3f});
  bound(scene, box({-1.2, -0.9, -0.7}, {-0.1, 0.4, 0.8}, nothing), add_medium(scene, m));
  m.emission_grid =
      grid({3, 8, 3}, 1, [](int x, int y, int z, int) { return x == 1 && z == 1 ? float(y) : 0.1f; });
  m.emission_grid->to_world = unit_cube_to({0.3, -0.9, -0.5}, {1, 0.4, 0.5});
  bound(scene, box({0.3, -0.9, -0.5}, {1, 0.4, 0.5}, nothing), add_medium(scene, m));
  return scene;
}

void expect_same_image(const SceneDescription& one, const SceneDescription& other, const TestDevice& device) {
  const statistics::Estimate a = block_estimate(one, 8, 10, 4, device),
                             b = block_estimate(other, 8, 100, 4, big_passes());
  const statistics::ImageTestResult test = statistics::z_test(a, b, {.significance = kSignificance});
  EXPECT_LE(std::abs(test.worst), test.limit) << test.summary();
}

TEST(EmittingMedia, EveryTechniqueFindsTheSame) {
  expect_alike(lit_room(volpath(DirectSampling::kMis), 400),
               lit_room(volpath(DirectSampling::kBsdfOnly), 400));
}

TEST(EmittingMedia, PhotonMapsLeaveTheirLightToPaths) {
  // Without light that photons bring, which is biased: photons of the lamp alone are black here.
  const auto with = [](IntegratorSettings integrator, std::uint32_t spp) {
    SceneDescription scene = lit_room(integrator, spp);
    scene.shapes[1].radiance = glm::vec3(1e-6f);
    return scene;
  };
  ProgressivePhotonIntegrator ppm;
  ppm.photon_count = 64;
  ppm.initial_radius = 0.1f;
  PhotonMapIntegrator fixed;
  fixed.global_photons = fixed.caustic_photons = fixed.volume_photons = 64;
  fixed.photon_radius = 0.1f;
  fixed.final_gather = true;
  TestDevice device = native_device();
  device.samples_per_pass = 64;
  for (const IntegratorSettings& by_photons :
       {IntegratorSettings{.method = ppm}, IntegratorSettings{.method = fixed}})
    expect_same_image(with(by_photons, 256), with(volpath(), 256), device);
}

}  // namespace
}  // namespace penumbra::media
