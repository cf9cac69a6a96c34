// Media that emit as lights: quadrature, the estimator without light samples, and noise.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "tests/acceptance/media_pieces.h"

namespace penumbra::media {
namespace {

constexpr double kReflectance = 0.5;

/// A grid of 16^3 cells in [1, 3] x [-1, 1] x [3, 5], of which one shines.
struct SmallFlame {
  static constexpr int kSide = 16, kCell = 9;
  ParticipatingMedium medium;
  glm::dvec3 low{1, -1, 3}, high{3, 1, 5};

  SmallFlame(float extinction, bool nearest) {
    medium = media::medium(extinction, 0);
    medium.emission = glm::vec3(100, 40, 10);
    medium.emission_grid = grid({kSide, kSide, kSide}, 1, [](int x, int y, int z, int) {
      return x == kCell && y == kCell && z == kCell ? 1.0f : 0.0f;
    });
    medium.emission_grid->to_world = unit_cube_to(low, high);
    medium.emission_grid->nearest = nearest;
  }
  /// What the grid has at a place in cells: that of the cell, or interpolated between the centres.
  [[nodiscard]] double value(const glm::dvec3& place) const {
    if (medium.emission_grid->nearest) return glm::ivec3(place) == glm::ivec3(kCell) ? 1 : 0;
    const glm::dvec3 off = glm::abs(place - (kCell + 0.5));
    return std::max(0.0, 1 - off.x) * std::max(0.0, 1 - off.y) * std::max(0.0, 1 - off.z);
  }
  /// The irradiance of a wall at (0, 0, 6) that faces -z, by midpoints in double. `extinction` dims from the
  /// grid's side on.
  [[nodiscard]] double irradiance(double extinction) const {
    constexpr int kPoints = 60;  // along the three cells about that one
    const double cell = (high.x - low.x) / kSide, step = 3.0 / kPoints;
    const glm::dvec3 wall(0, 0, 6);
    double sum = 0;
    for (int i = 0; i < kPoints; ++i)
      for (int j = 0; j < kPoints; ++j)
        for (int k = 0; k < kPoints; ++k) {
          const glm::dvec3 place = double(kCell - 1) + step * (glm::dvec3(i, j, k) + 0.5);
          const glm::dvec3 from = low + cell * place - wall;
          const double r = glm::length(from);
          // The way through the box: the ray from the wall enters it at z = 5 or x = 1.
          const double enters = std::max((high.z - wall.z) / from.z, low.x / from.x) * r;
          sum += value(place) * (-from.z / r) / (r * r) * std::exp(-extinction * (r - enters));
        }
    return sum * std::pow(cell * step, 3);
  }
  [[nodiscard]] SceneDescription scene(const IntegratorSettings& integrator, std::uint32_t spp) const {
    SceneDescription scene = narrow_view(spp, integrator);
    scene.shapes.push_back(
        parallelogram({-4, -4, 6}, {0, 8, 0}, {8, 0, 0}, add_diffuse(scene, float(kReflectance))));
    bound(scene, box(low, high, add_null(scene)), add_medium(scene, medium));
    return scene;
  }
};

TEST(MediumLights, LightAWallAsQuadratureSays) {
  for (const bool nearest : {true, false})
    for (const float extinction : {0.0f, 2.0f}) {
      const SmallFlame flame(extinction, nearest);
      const double radiance = flame.irradiance(double(extinction)) * kReflectance / std::numbers::pi;
      for (const MisHeuristic heuristic : {MisHeuristic::kBalance, MisHeuristic::kPower}) {
        SCOPED_TRACE(::testing::Message() << nearest << extinction << int(heuristic));
        VolpathIntegrator integrator{.max_depth = 2, .heuristic = heuristic};
        // The midpoint rule is off by less than 1e-3 of the cell's integral.
        expect_colour(flame.scene({.method = integrator}, 20'000), radiance * glm::dvec3(100, 40, 10), 1e-3);
      }
    }
}

TEST(MediumLights, CauseMuchLessNoiseThanDirectionsAlone) {
  const SmallFlame flame(0.5f, true);
  const auto variance = [&](DirectSampling sampling) {
    const FilmAccumulator film = render_or_throw(flame.scene(volpath(sampling, 2), 20'000), big_passes());
    return std::pow(pixel_sample(film, 0, 0, 0).standard_error(), 2);
  };
  EXPECT_LT(10 * variance(DirectSampling::kMis), variance(DirectSampling::kBsdfOnly));
}

/// A box that shines evenly, in the way that its light goes to a wall.
struct EvenFlame {
  ParticipatingMedium medium;
  glm::dvec3 low{1.9, -0.1, 3.9}, high{2.1, 0.1, 4.1};

  explicit EvenFlame(float extinction) {
    medium = media::medium(glm::vec3(extinction, 0.5f * extinction, 0), glm::vec3(0));
    medium.emission = glm::vec3(100, 40, 10);
  }
  /// The irradiance of a wall at (0, 0, 6) that faces -z, by midpoints in double, over the emission.
  [[nodiscard]] double irradiance(double extinction) const {
    constexpr int kPoints = 80;
    const double step = (high.x - low.x) / kPoints;
    const glm::dvec3 wall(0, 0, 6);
    double sum = 0;
    for (int i = 0; i < kPoints; ++i)
      for (int j = 0; j < kPoints; ++j)
        for (int k = 0; k < kPoints; ++k) {
          const glm::dvec3 at = low + step * (glm::dvec3(i, j, k) + 0.5), to = wall - at;
          const double r = glm::length(to);
          double within = r;
          for (int axis = 0; axis < 3; ++axis)
            within =
                std::min(within, std::abs(((to[axis] > 0 ? high : low)[axis] - at[axis]) / to[axis]) * r);
          sum += to.z / (r * r * r) * std::exp(-extinction * within);
        }
    return sum * std::pow(step, 3);
  }
  [[nodiscard]] SceneDescription scene(const IntegratorSettings& integrator, std::uint32_t spp) const {
    SceneDescription scene = narrow_view(spp, integrator);
    scene.shapes.push_back(
        parallelogram({-4, -4, 6}, {0, 8, 0}, {8, 0, 0}, add_diffuse(scene, float(kReflectance))));
    bound(scene, box(low, high, add_null(scene)), add_medium(scene, medium));
    return scene;
  }
};

TEST(MediumLights, OfEvenEmissionLightAWallAsQuadratureSays) {
  for (const float extinction : {0.0f, 2.0f, 50.0f})
    for (const MisHeuristic heuristic : {MisHeuristic::kBalance, MisHeuristic::kPower}) {
      SCOPED_TRACE(::testing::Message() << extinction << " " << int(heuristic));
      const EvenFlame flame(extinction);
      glm::dvec3 radiance;
      for (int k = 0; k < 3; ++k)
        radiance[k] = flame.irradiance(double(flame.medium.extinction[k])) * kReflectance / std::numbers::pi *
                      double(flame.medium.emission[k]);
      const VolpathIntegrator integrator{.max_depth = 2, .heuristic = heuristic};
      // Midpoints are off by less than 1e-3 where the box is 10 free paths deep.
      expect_colour(flame.scene({.method = integrator}, 20'000), radiance, 1e-3);
    }
}

TEST(MediumLights, OfEvenEmissionCauseMuchLessNoiseThanDirectionsAlone) {
  const EvenFlame flame(2);
  const auto variance = [&](DirectSampling sampling) {
    const FilmAccumulator film = render_or_throw(flame.scene(volpath(sampling, 2), 20'000), big_passes());
    return std::pow(pixel_sample(film, 0, 0, 0).standard_error(), 2);
  };
  EXPECT_LT(10 * variance(DirectSampling::kMis), variance(DirectSampling::kBsdfOnly));
}

/// A room with a flame. `change` may add to it.
SceneDescription room(const IntegratorSettings& integrator,
                      const std::function<void(SceneDescription&, ParticipatingMedium&)>& change) {
  SceneDescription scene = empty_scene(8, 8, 400, 3);
  scene.camera = look_at(glm::dvec3(0, 0, -2.9), glm::dvec3(0), glm::dvec3(0, 1, 0), 60);
  scene.integrator = integrator;
  Shape walls = box({-2, -1, -3}, {2, 1.5, 2}, add_diffuse(scene, 0.6f));
  walls.flip_normals = true;
  scene.shapes.push_back(walls);
  ParticipatingMedium flame = medium({0.6f, 0.4f, 0.2f}, {0.5f, 0.8f, 0.9f});
  flame.emission = glm::vec3(20, 10, 3);
  flame.emission_grid = grid({6, 8, 6}, 1, [](int x, int y, int z, int) {
    return x == 2 && y == 3 && z == 3 ? 5.0f : x == 4 && z == 1 ? 0.2f * float(y) : 0.0f;
  });
  flame.emission_grid->to_world = unit_cube_to({-0.7, -0.9, -0.5}, {0.9, 0.6, 1});
  change(scene, flame);
  return scene;
}

/// Both estimators have the same mean.
void expect_same_light(const std::function<void(SceneDescription&, ParticipatingMedium&)>& change) {
  expect_alike(room(volpath(DirectSampling::kMis), change), room(volpath(DirectSampling::kBsdfOnly), change));
}

void add_flame(SceneDescription& scene, const ParticipatingMedium& flame) {
  bound(scene, box({-0.7, -0.9, -0.5}, {0.9, 0.6, 1}, add_null(scene)), add_medium(scene, flame));
}

TEST(MediumLights, HaveTheirLightInFog) {
  expect_same_light([](SceneDescription& scene, ParticipatingMedium& flame) {
    flame.density =
        grid({5, 5, 5}, 1, [](int x, int y, int z, int) { return 0.5f * float((x + y + z) % 4); });
    flame.density->to_world = flame.emission_grid->to_world;
    flame.emission_by_density = true;
    const int fog = add_medium(scene, medium({0.1f, 0.2f, 0.3f}, glm::vec3(0.8f)));
    bound(scene, box({-1.5, -0.95, -1.5}, {1.5, 1.2, 1.5}, add_null(scene)), fog);
    Shape around = box({-0.7, -0.9, -0.5}, {0.9, 0.6, 1}, add_null(scene));
    around.exterior = fog;
    bound(scene, around, add_medium(scene, flame));
  });
}

TEST(MediumLights, HaveTheirLightBehindGlass) {
  expect_same_light([](SceneDescription& scene, ParticipatingMedium& flame) {
    add_flame(scene, flame);
    scene.bsdfs.push_back({"glass", DielectricBsdf{}});
    const int glass = int(scene.bsdfs.size()) - 1;
    scene.shapes.push_back(sphere({0.3, 0.2, -1.2}, 0.4, glass));
    scene.shapes.push_back(box({-1.6, -0.9, -0.8}, {-1.2, 0.6, 1.2}, glass));
  });
}

TEST(MediumLights, HaveTheirLightAroundTheCamera) {
  expect_same_light([](SceneDescription& scene, ParticipatingMedium& flame) {
    scene.camera = look_at(glm::dvec3(0.05, -0.2, 0.3), glm::dvec3(1, 0, -1), glm::dvec3(0, 1, 0), 70);
    add_flame(scene, flame);
    scene.camera_medium = int(scene.media.size()) - 1;
    scene.shapes.push_back(sphere({0.5, -0.6, 0.2}, 0.15, 0));  // within the grid
  });
}

TEST(MediumLights, EndWhereTheirMediumDoes) {
  expect_same_light([](SceneDescription& scene, ParticipatingMedium& flame) {
    // The shape cuts the grid, and a ball of another medium a part of what is left.
    const int own = add_medium(scene, flame);
    bound(scene, box({-0.7, -0.9, -0.5}, {0.5, 0.2, 1}, add_null(scene)), own);
    Shape ball = sphere({-0.1, -0.2, 0.35}, 0.12, add_null(scene));
    ball.exterior = own;
    bound(scene, ball, add_medium(scene, medium(1, 0.5f)));
  });
}

TEST(MediumLights, OfEvenEmissionMayHaveSeveralShapes) {
  expect_same_light([](SceneDescription& scene, ParticipatingMedium& flame) {
    flame.emission_grid.reset();
    flame.emission = glm::vec3(2, 1, 0.3f);
    const int own = add_medium(scene, flame), nothing = add_null(scene);
    bound(scene, box({-0.7, -0.9, -0.5}, {0.1, -0.5, 0}, nothing), own);
    bound(scene, sphere({0.9, 0.5, 0.5}, 0.3, nothing), own);
    Shape ball = sphere({-0.3, -0.7, -0.2}, 0.15, nothing);
    ball.exterior = own;
    bound(scene, ball, add_medium(scene, medium(1, 0.5f)));
    ShapeGroup group;
    group.name = "group";
    group.shapes.push_back(sphere({0, 0, 0}, 0.5, nothing));
    group.shapes.back().interior = own;
    scene.groups.push_back(group);
    scene.instances.push_back({.name = "placed",
                               .group = 0,
                               .to_world = translation(glm::dvec3(-1.2, 0.6, 1)) * scaling(glm::dvec3(0.5))});
  });
}

TEST(MediumLights, AreChosenAmongOthersByAnyMethod) {
  const auto with_lamps = [](SceneDescription& scene, ParticipatingMedium& flame) {
    add_flame(scene, flame);
    const int grey = add_diffuse(scene, 0.6f);
    scene.shapes.push_back(parallelogram({0.5, 1.45, 0.5}, {0, 0, -1}, {-1, 0, 0}, grey, 1.0f));
    scene.shapes.push_back(sphere({1.5, -0.7, -1}, 0.2, grey));
    scene.shapes.back().radiance = glm::vec3(2);
    flame.emission_grid->to_world = unit_cube_to({-1.9, -0.9, 0.5}, {-1.1, 0, 1.5});
    bound(scene, box({-1.9, -0.9, 0.5}, {-1.1, 0, 1.5}, add_null(scene)), add_medium(scene, flame));
  };
  for (const LightChoice choice : {LightChoice::kPower, LightChoice::kTree}) {
    SCOPED_TRACE(int(choice));
    IntegratorSettings sampled{.method = VolpathIntegrator{.light_choice = choice}};
    expect_alike(room(sampled, with_lamps), room(volpath(DirectSampling::kBsdfOnly), with_lamps));
  }
}

}  // namespace
}  // namespace penumbra::media
