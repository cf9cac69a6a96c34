// Media on grids: transmittance against integrals over the grid, and against equivalent homogeneous media.
#include <gtest/gtest.h>

#include <cmath>

#include "kernels/host/native_kernels.h"
#include "scenes/transform.h"
#include "tests/acceptance/media_pieces.h"
#include "worker/native_device.h"

namespace penumbra::media {
namespace {

/// Layers along z of which some are empty, the rest some up to 1; more than one coarse cell of them.
float layer(int z, int channel) {
  if (z % 7 == 3 || (z > 12 && z < 17)) return 0.0f;
  return 0.5f + 0.5f * float(std::sin(1.7 * z + channel));
}
constexpr int kLayers = 21;

/// The mean of the layers over the depth, by the midpoint rule between all the centres, where it is exact.
/// `fades`: towards layers of 0 outside.
double mean_layer(bool nearest, int channel, bool fades = false) {
  double sum = 0;
  for (int z = 0; z < kLayers; ++z) {
    const auto at = [&](int k) {
      const bool outside = k < 0 || k >= kLayers;
      return fades && outside ? 0.0 : double(layer(std::clamp(k, 0, kLayers - 1), channel));
    };
    // Half a cell before the centre and half a cell behind it, each linear.
    sum +=
        nearest ? at(z) : 0.5 * (0.75 * at(z) + 0.25 * at(z - 1)) + 0.5 * (0.75 * at(z) + 0.25 * at(z + 1));
  }
  return sum / kLayers;
}

const glm::vec3 kExtinction(0.6f, 1.5f, 4.0f);

ParticipatingMedium layers(const glm::dvec3& low, const glm::dvec3& high, bool nearest, int channels,
                           float albedo) {
  ParticipatingMedium m = medium(kExtinction, glm::vec3(albedo));
  m.density = grid({2, 3, kLayers}, channels, [](int, int, int z, int c) { return layer(z, c); });
  m.density->to_world = unit_cube_to(low, high);
  m.density->nearest = nearest;
  return m;
}

TEST(GridMedia, LetThroughWhatTheIntegralOfTheirNumbersSays) {
  for (const bool nearest : {false, true})
    for (const int channels : {1, 3}) {
      SceneDescription scene = narrow_view(300'000);
      const glm::dvec3 low(-1, -1, 1), high(1, 1, 2.3);
      bound(scene, box(low, high, add_null(scene)),
            add_medium(scene, layers(low, high, nearest, channels, 0)));
      scene.emitters.emplace_back(ConstantEnvironment{});
      glm::dvec3 truth;
      for (int k = 0; k < 3; ++k)
        truth[k] = std::exp(-double(kExtinction[k]) * 1.3 * mean_layer(nearest, channels == 3 ? k : 0));
      SCOPED_TRACE(::testing::Message() << nearest << " " << channels);
      expect_colour(scene, truth, 1e-5);
    }
}

TEST(GridMedia, MayFadeTowardsTheirFaces) {
  SceneDescription scene = narrow_view(300'000);
  const glm::dvec3 low(-1, -1, 1), high(1, 1, 2.3);
  ParticipatingMedium fading = layers(low, high, false, 3, 0);
  fading.density->fades = true;
  bound(scene, box(low, high, add_null(scene)), add_medium(scene, fading));
  scene.emitters.emplace_back(ConstantEnvironment{});
  glm::dvec3 truth;
  for (int k = 0; k < 3; ++k) truth[k] = std::exp(-double(kExtinction[k]) * 1.3 * mean_layer(false, k, true));
  expect_colour(scene, truth, 1e-5);
}

// Of a grid that is smaller than its boundary there is nothing outside.
TEST(GridMedia, DimShadowRaysWithinTheirBoxWhereverItIs) {
  const glm::dvec3 light(1.5, 0, 0.5), wall(0, 0, 4);
  const auto lit = [&](bool between) {
    SceneDescription scene = narrow_view(200'000);
    const int grey = add_diffuse(scene, 0.5f);
    scene.shapes.push_back(parallelogram({2, -2, 4}, {-4, 0, 0}, {0, 4, 0}, grey));
    PointLight point;
    point.position = light;
    scene.emitters.emplace_back(point);
    ParticipatingMedium m = layers({0, 0, 0}, {1, 1, 1}, false, 1, 0.5f);
    // Turned so that its layers are across the light's way.
    const glm::dvec3 way = glm::normalize(wall - light), side = glm::normalize(glm::cross(way, {0, 1, 0}));
    const glm::dmat3 axes(side, glm::cross(way, side), way);
    glm::dmat4 place = translation(light + way) * glm::dmat4(axes);
    m.density->to_world = place * unit_cube_to({-0.5, -0.5, 0}, {0.5, 0.5, 1.5});
    bound(scene, box({0.05, -1, 0.6}, {1.45, 1, 3.9}, add_null(scene)), add_medium(scene, m));
    if (!between) scene.shapes.pop_back();
    param::max_depth(scene.integrator) = 2;
    return render_or_throw(scene, big_passes());
  };
  const FilmAccumulator film = lit(true);
  const statistics::Image plain = mean_image(lit(false));
  for (int k = 0; k < 3; ++k) {
    const double truth =
        double(plain.at(0, 0, k)) * std::exp(-double(kExtinction[k]) * 1.5 * mean_layer(false, 0));
    const statistics::Sample sample = pixel_sample(film, 0, 0, k);
    EXPECT_GT(statistics::t_test(sample, truth, truth * 1e-4).p, kSignificance / 3)
        << k << ": " << sample.mean() << ", expected " << truth;
  }
}

/// Cells of density 1 of which one, at (5, 5, 5) of 8 along each axis, is `dense`.
ParticipatingMedium with_one_dense_cell(float dense, bool nearest) {
  ParticipatingMedium m = medium(glm::vec3(0.5f, 1.0f, 2.0f), glm::vec3(0));
  m.density = grid({8, 8, 8}, 1,
                   [dense](int x, int y, int z, int) { return x == 5 && y == 5 && z == 5 ? dense : 1.0f; });
  m.density->to_world = unit_cube_to({-1, -1, 1}, {1, 1, 3});
  m.density->nearest = nearest;
  return m;
}

// A cell's majorant is that of the densest in it, and rays that pass beside that one see the rest as it is.
TEST(GridMedia, AVeryDenseCellDarkensNothingBesideIt) {
  constexpr double kCell = 0.25;
  for (const bool nearest : {false, true})
    for (const float dense : {1e3f, 1e8f, 1e20f}) {
      SCOPED_TRACE(::testing::Message() << dense << (nearest ? ", nearest" : ", interpolated"));
      const ParticipatingMedium m = with_one_dense_cell(dense, nearest);
      // Along z at x = y: by what share of its numbers the ray sees those of the dense cell, in its layer.
      const auto passes = [&](double xy, double share) {
        SceneDescription scene = narrow_view(100'000);
        scene.camera = look_at(glm::dvec3(xy, xy, 0), glm::dvec3(xy, xy, 1), glm::dvec3(0, 1, 0), 1e-3);
        bound(scene, box({-1, -1, 1}, {1, 1, 3}, add_null(scene)), add_medium(scene, m));
        scene.emitters.emplace_back(ConstantEnvironment{});
        glm::dvec3 truth;
        for (int k = 0; k < 3; ++k)
          truth[k] = std::exp(-double(m.extinction[k]) * (2 + share * kCell * (double(dense) - 1)));
        expect_colour(scene, truth, 1e-5);
      };
      // Its centre is at 0.375, and its sides from 0.25 to 0.5.
      passes(-0.6, 0);
      passes(nearest ? 0.24 : 0.12, 0);
      passes(0.375, 1);
      // Between centres, by the product of the shares along x and y, of a cell that is not too steep.
      if (!nearest && dense == 1e3f) passes(0.375 - kCell * 0.93, 0.07 * 0.07);
    }
}

TEST(GridMedia, AVeryDenseCellLeavesShadowRaysBesideItAsTheyAre) {
  SceneDescription scene = narrow_view(100'000);
  const int grey = add_diffuse(scene, 0.5f);
  scene.shapes.push_back(parallelogram({2, -2, 4}, {-4, 0, 0}, {0, 4, 0}, grey));
  PointLight point;
  point.position = glm::dvec3(0, 0, 0.5);
  scene.emitters.emplace_back(point);
  param::max_depth(scene.integrator) = 2;
  scene.camera = look_at(glm::dvec3(0.05, 0, 3.5), glm::dvec3(0, 0, 4), glm::dvec3(0, 1, 0), 1e-3);
  const statistics::Image plain = mean_image(render_or_throw(scene, big_passes()));
  const ParticipatingMedium m = with_one_dense_cell(1e8f, false);
  bound(scene, box({-1, -1, 1}, {1, 1, 3}, add_null(scene)), add_medium(scene, m));
  const FilmAccumulator film = render_or_throw(scene, big_passes());
  for (int k = 0; k < 3; ++k) {
    const double truth = double(plain.at(0, 0, k)) * std::exp(-2.0 * double(m.extinction[k]));
    const statistics::Sample sample = pixel_sample(film, 0, 0, k);
    EXPECT_GT(statistics::t_test(sample, truth, truth * 1e-4).p, kSignificance / 3)
        << k << ": " << sample.mean() << ", expected " << truth;
  }
}

TEST(GridMedia, WithoutAbsorptionChangeNoFurnace) {
  for (const DirectSampling sampling : {DirectSampling::kBsdfOnly, DirectSampling::kMis}) {
    SceneDescription scene = narrow_view(100'000, volpath(sampling));
    ParticipatingMedium m = layers({-1, -1, 2}, {1, 1, 4}, false, 3, 1);
    bound(scene, sphere({0, 0, 3}, 1, add_null(scene)), add_medium(scene, m));
    scene.emitters.emplace_back(ConstantEnvironment{});
    expect_colour(scene, glm::dvec3(1));
  }
}

/// A cloud in a room with a light; `even`: the same numbers everywhere, by a grid or not.
SceneDescription cloud(DirectSampling sampling, bool even, bool by_grid, std::uint32_t spp = 3000) {
  SceneDescription scene = empty_scene(8, 8, spp, 3);
  scene.camera = look_at(glm::dvec3(0, 0, -3), glm::dvec3(0), glm::dvec3(0, 1, 0), 40);
  scene.integrator = volpath(sampling);
  const int grey = add_diffuse(scene, 0.6f);
  scene.shapes.push_back(parallelogram({-2, -1, -2}, {0, 0, 4}, {4, 0, 0}, grey));
  scene.shapes.push_back(parallelogram({0.5, 1.5, 0.5}, {0, 0, -1}, {-1, 0, 0}, grey, 10.0f));
  scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(0.3f)});
  ParticipatingMedium m = medium({3, 2, 1}, {0.8f, 0.9f, 0.99f}, 0.4f);
  const glm::dmat4 place = unit_cube_to({-0.8, -0.9, -0.7}, {0.7, 0.6, 0.8});
  if (by_grid) {
    m.density = grid({9, 17, 12}, 1, [&](int x, int y, int z, int) {
      return even ? 1.0f : std::max(0.0f, float(std::sin(x * 0.7) * std::cos(y * 0.5) + std::sin(z * 0.9)));
    });
    m.density->to_world = place;
    if (!even) {
      m.albedo = glm::vec3(1);
      m.albedo_grid = grid({3, 2, 2}, 3, [](int x, int y, int z, int c) {
        return 0.5f + 0.1f * float(x) + 0.1f * float(y + z) + 0.02f * float(c);
      });
      m.albedo_grid->to_world = place;
    }
  }
  bound(scene, box({-0.8, -0.9, -0.7}, {0.7, 0.6, 0.8}, add_null(scene)), add_medium(scene, m));
  return scene;
}

TEST(GridMedia, OfOneNumberAreHomogeneousOnes) {
  expect_alike(cloud(DirectSampling::kMis, true, true), cloud(DirectSampling::kMis, true, false));
}

// Of one number, by a grid or not; over all of space, not only in its box.
TEST(GridMedia, OfOneAlbedoAreHomogeneousOnes) {
  SceneDescription gridded = cloud(DirectSampling::kMis, true, false);
  gridded.media[0].albedo = glm::vec3(1.6f, 1.8f, 1.98f) * 0.5f;
  SceneDescription plain = gridded;
  gridded.media[0].albedo_grid = grid({2, 1, 1}, 1, [](int, int, int, int) { return 0.5f; });
  plain.media[0].albedo *= 0.5f;
  expect_alike(gridded, plain);
}

TEST(GridMedia, AreTheSameByEveryTechnique) {
  expect_alike(cloud(DirectSampling::kMis, false, true), cloud(DirectSampling::kBsdfOnly, false, true));
}

TEST(GridMedia, GiveTheSameBitsEverywhere) {
  SceneDescription scene = cloud(DirectSampling::kMis, false, true, 32);
  // It also emits, by a grid, in a room whose air emits evenly.
  scene.media[0].emission = {3.0f, 1.0f, 0.2f};
  scene.media[0].emission_grid =
      grid({5, 9, 20}, 1, [](int x, int y, int z, int) { return x == 3 && y > 4 ? 0.3f * float(z) : 0.0f; });
  scene.media[0].emission_grid->to_world = unit_cube_to({-0.6, -0.8, -0.9}, {0.7, 0.8, 0.5});
  ParticipatingMedium air = medium(glm::vec3(0.01f, 0.02f, 0.0f), glm::vec3(0.5f));
  air.emission = {0.01f, 0.0f, 0.03f};
  scene.camera_medium = add_medium(scene, air);
  const statistics::Image widest = mean_image(render_or_throw(scene));
  for (const Isa isa : usable_isas()) {
    TestDevice device = native_device();
    device.options.isa = isa;
    EXPECT_EQ(mean_image(render_or_throw(scene, device)).values, widest.values) << int(isa);
  }
  TestDevice one_lane = native_device();
  one_lane.options.block_of_one = true;
  EXPECT_EQ(mean_image(render_or_throw(scene, one_lane)).values, widest.values);
  EXPECT_EQ(mean_image(render_or_throw(scene, opencl_device())).values, widest.values);
}

}  // namespace
}  // namespace penumbra::media
