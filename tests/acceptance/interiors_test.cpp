// Interiors of materials: subsurface scattering and coloured glass against closed forms, quadrature and
// furnaces, and against the same media as scenes declare them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "kernels/features.h"
#include "scenes/bsdfs/half_space.h"
#include "scenes/interiors.h"
#include "tests/acceptance/media_pieces.h"

namespace penumbra::interiors_test {
namespace {

using namespace media;

/// The albedo of a half-space that scatters evenly and is lit evenly, by Chandrasekhar's H function:
/// 1 - 2 sqrt(1 - single) times the integral of H(mu) mu, from his nonlinear equation at midpoints.
double albedo_by_h_function(double single) {
  constexpr int kPoints = 200;
  std::vector<double> cosine(kPoints), weight(kPoints), h(kPoints, 1.0), next(kPoints);
  for (int i = 0; i < kPoints; ++i) {
    const double u = (i + 0.5) / kPoints;
    cosine[std::size_t(i)] = u * u;
    weight[std::size_t(i)] = 2 * u / kPoints;
  }
  for (double change = 1; change > 1e-10; h.swap(next)) {
    change = 0;
    for (std::size_t i = 0; i < kPoints; ++i) {
      double sum = 0;
      for (std::size_t j = 0; j < kPoints; ++j) sum += weight[j] * cosine[j] * h[j] / (cosine[i] + cosine[j]);
      next[i] = 1 / (std::sqrt(1 - single) + single / 2 * sum);
      change = std::max(change, std::abs(next[i] - h[i]));
    }
  }
  double mean = 0;
  for (std::size_t i = 0; i < kPoints; ++i) mean += weight[i] * cosine[i] * h[i];
  return 1 - 2 * std::sqrt(1 - single) * mean;
}

TEST(Interiors, AlbedoOfAHalfSpaceIsThatOfTheHFunction) {
  const HalfSpace even(0);
  // The midpoint rule of 200 points is off by up to 1.3e-5.
  for (const double single : {0.1, 0.3, 0.5, 0.8, 0.9, 0.97, 0.99, 0.999})
    EXPECT_NEAR(even.albedo(single), albedo_by_h_function(single), 2e-5) << single;
  EXPECT_EQ(even.albedo(0), 0);
  EXPECT_EQ(even.albedo(1), 1);
}

TEST(Interiors, SingleAlbedoIsTheInverse) {
  for (const double g : {-0.7, 0.0, 0.5, 0.9}) {
    const HalfSpace medium(g);
    EXPECT_EQ(medium.single_albedo(0), 0);
    EXPECT_EQ(medium.single_albedo(1), 1);
    double before = 0;
    for (const double albedo : {0.01, 0.05, 0.2, 0.5, 0.8, 0.95, 0.999}) {
      const double single = medium.single_albedo(albedo);
      EXPECT_NEAR(medium.albedo(single), albedo, 1e-9) << g << " " << albedo;
      EXPECT_GT(single, before);
      before = single;
    }
  }
}

/// Light scatters below the whole surface, which reflects nothing by itself.
OpenPbrBsdf wax(const glm::vec3& colour, float radius, float g = 0) {
  OpenPbrBsdf surface;
  surface.specular_weight = TexturedNumber(0.0f);
  surface.subsurface_weight = TexturedNumber(1.0f);
  surface.subsurface_color = TexturedColour(colour);
  surface.subsurface_radius = radius;
  surface.subsurface_radius_scale = glm::vec3(1.0f);
  surface.subsurface_anisotropy = g;
  return surface;
}

int add(SceneDescription& scene, const BsdfModel& model) {
  scene.bsdfs.push_back({"surface", model});
  return int(scene.bsdfs.size()) - 1;
}

/// Of a material that does not transmit the back is black.
Shape one_sided(Shape shape, int bsdf) {
  shape.front_bsdf = bsdf;
  shape.back_bsdf = kBlackBsdf;
  return shape;
}

IntegratorSettings path(int max_depth = -1) { return {.method = PathIntegrator{.max_depth = max_depth}}; }

/// A wall of that material under an even sky, thick enough for a half-space.
SceneDescription wall(const OpenPbrBsdf& surface, const IntegratorSettings& integrator = path(),
                      std::uint32_t spp = 40'000) {
  SceneDescription scene = narrow_view(spp, integrator);
  scene.shapes.push_back(one_sided(box({-1, -1, 1}, {1, 1, 2}, 0), add(scene, surface)));
  scene.emitters.emplace_back(ConstantEnvironment{});
  return scene;
}

TEST(Interiors, HalfSpaceHasTheColourAsAlbedo) {
  // The albedos of HalfSpace have this error, relative to the smallest colour.
  constexpr double kTolerance = 1e-4 / 0.05;
  for (const glm::vec3& colour : {glm::vec3(0.05f, 0.5f, 0.9f), glm::vec3(0.99f, 0.8f, 0.2f)})
    for (const float g : {0.0f, 0.6f, -0.4f}) {
      SCOPED_TRACE(g);
      expect_colour(wall(wax(colour, 1e-5f, g)), glm::dvec3(colour), kTolerance);
      OpenPbrBsdf skin = wax(colour, 1e-5f, g);
      skin.subsurface_radius_scale = glm::vec3(1.0f, 0.4f, 0.1f);
      expect_colour(wall(skin), glm::dvec3(colour), kTolerance);
    }
}

TEST(Interiors, WayInAndOutCountAsOneScattering) {
  const glm::vec3 colour(0.3f, 0.6f, 0.9f);
  expect_colour(wall(wax(colour, 1e-5f), path(2)), glm::dvec3(colour), 1e-3);
  expect_colour(wall(wax(colour, 1e-5f), path(1), 100), glm::dvec3(0), 1e-3);
}

TEST(Interiors, WhiteFurnaceStaysWhite) {
  for (const float radius : {0.02f, 0.3f, 5.0f})
    for (const bool round : {false, true})
      for (const IntegratorSettings& integrator : {path(), volpath()}) {
        SCOPED_TRACE(radius);
        SceneDescription scene = narrow_view(20'000, integrator);
        const Shape shape = round ? sphere({0, 0, 2}, 1, 0) : box({-1, -1, 1}, {1, 1, 2}, 0);
        scene.shapes.push_back(one_sided(shape, add(scene, wax(glm::vec3(1), radius))));
        scene.emitters.emplace_back(ConstantEnvironment{});
        // At most some hundred vertices, whose weights round.
        expect_colour(scene, glm::dvec3(1), 100 * kRounding);
      }
}

/// A ball, lit from one side and by the sky.
SceneDescription lit_ball(const IntegratorSettings& integrator) {
  SceneDescription scene = empty_scene(16, 16, 200, 3);
  scene.camera = look_at({0.2, 1, -3}, {0, 0, 0}, {0, 1, 0}, 26);
  scene.integrator = integrator;
  scene.shapes.push_back(parallelogram({0.7, 2, 0.7}, {-1.4, 0, 0}, {0, 0, -1.4}, 0, 3.0f));
  scene.shapes.back().front_bsdf = scene.shapes.back().back_bsdf = add_diffuse(scene, 0.5f);
  scene.emitters.emplace_back(ConstantEnvironment{.radiance = glm::vec3(0.2f)});
  return scene;
}

TEST(Interiors, WalksAreThoseThroughADeclaredMedium) {
  const glm::vec3 colour(0.4f, 0.7f, 0.9f), scale(1.0f, 0.5f, 0.2f);
  constexpr float kRadius = 0.2f, kCosine = 0.4f;
  SceneDescription declared = lit_ball(volpath());
  glm::vec3 single;
  for (int c = 0; c < 3; ++c) single[c] = float(HalfSpace(double(kCosine)).single_albedo(double(colour[c])));
  const int sheet = add(declared, DiffuseTransmitterBsdf{.transmittance = TexturedColour(glm::vec3(1))});
  bound(declared, sphere({0, 0, 0}, 0.7, sheet),
        add_medium(declared, medium(1.0f / (kRadius * scale), single, kCosine)));

  OpenPbrBsdf surface = wax(colour, kRadius, kCosine);
  surface.subsurface_radius_scale = scale;
  for (const IntegratorSettings& integrator : {path(), volpath()}) {
    SceneDescription scene = lit_ball(integrator);
    scene.shapes.push_back(one_sided(sphere({0, 0, 0}, 0.7, 0), add(scene, surface)));
    expect_alike(scene, declared);
  }
}

TEST(Interiors, PathSeesNoDeclaredMedium) {
  SceneDescription scene = narrow_view(100, path());
  bound(scene, box({-1, -1, 1}, {1, 1, 2}, add_null(scene)), add_medium(scene, medium(5.0f, 0.0f)));
  scene.camera_medium = 0;
  scene.shapes.push_back(one_sided(box({-1, -1, 3}, {1, 1, 4}, 0), add(scene, wax(glm::vec3(1), 1e-3f))));
  scene.emitters.emplace_back(ConstantEnvironment{});
  expect_colour(scene, glm::dvec3(1), 100 * kRounding);
}

TEST(Interiors, GlassAbsorbsAsBeerSays) {
  const glm::vec3 colour(0.9f, 0.5f, 0.1f);
  constexpr double kThickness = 1.25, kDepth = 0.5, kIndex = 1.5;
  const double r = reflectance(1, kIndex);
  glm::dvec3 expected;
  for (int c = 0; c < 3; ++c) {
    const double passes = std::pow(double(colour[c]), kThickness / kDepth);
    expected[c] = r + (1 - r) * (1 - r) * passes / (1 - r * passes);  // light goes to and fro
  }
  OpenPbrBsdf glass;
  glass.transmission_weight = TexturedNumber(1.0f);
  glass.transmission_color = TexturedColour(colour);
  glass.transmission_depth = float(kDepth);
  glass.specular_roughness = TexturedNumber(0.0f);
  glass.specular_ior = float(kIndex);
  for (const IntegratorSettings& integrator : {path(), volpath()}) {
    SceneDescription scene = narrow_view(200'000, integrator);
    Shape plate = box({-9, -9, 1}, {9, 9, 1 + kThickness}, 0);
    plate.front_bsdf = add(scene, glass);
    plate.back_bsdf = add(scene, *glass.other_side());
    scene.shapes.push_back(plate);
    scene.emitters.emplace_back(ConstantEnvironment{});
    // The reflected share is a number of 15 bits of a curve; facets of the least roughness lean by 1e-3.
    expect_colour(scene, expected, 1e-3);
  }
}

TEST(Interiors, ScatteringInGlassIsThatOfOpenPbr) {
  OpenPbrBsdf glass;
  glass.transmission_weight = TexturedNumber(1.0f);
  glass.transmission_color = TexturedColour(glm::vec3(1.0f, 0.5f, 0.25f));
  glass.transmission_depth = 2;
  glass.transmission_scatter = glm::vec3(0.1f, 0.2f, 0.3f);
  SceneDescription scene = empty_scene(1, 1, 1, 1);
  const auto inside = interior_of(scene, add(scene, glass));
  ASSERT_TRUE(inside.has_value());
  // More is scattered in red than is taken, so that all channels absorb more.
  for (int c = 0; c < 3; ++c) {
    const double taken = -std::log(double(glass.transmission_color.value[c])) / 2,
                 scattered = double(glass.transmission_scatter[c]) / 2;
    const double extinction = taken + 0.05;
    EXPECT_NEAR(double(inside->medium.extinction[c]), extinction, 1e-6) << c;
    EXPECT_NEAR(double(inside->medium.albedo[c]), scattered / extinction, 1e-6) << c;
  }
}

TEST(Interiors, WhiteGlassThatScattersStaysWhite) {
  OpenPbrBsdf glass;
  glass.transmission_weight = TexturedNumber(1.0f);
  glass.transmission_depth = 0.5f;
  glass.transmission_scatter = glm::vec3(0.5f);
  glass.specular_roughness = TexturedNumber(0.0f);
  SceneDescription scene = narrow_view(20'000, path());
  Shape ball = sphere({0, 0, 2}, 1, 0);
  ball.front_bsdf = add(scene, glass);
  ball.back_bsdf = add(scene, *glass.other_side());
  scene.shapes.push_back(ball);
  scene.emitters.emplace_back(ConstantEnvironment{});
  expect_colour(scene, glm::dvec3(1), 3e-3);  // of the curves' 15 bits, at each of some reflections
}

TEST(Interiors, DielectricsMayHaveAMediumInside) {
  const glm::vec3 extinction(2.0f, 4.0f, 8.0f), single(0.99f, 0.9f, 0.5f);
  DielectricBsdf glass;
  glass.int_ior = 1.33f;
  glass.ext_ior = 1.0f;
  const auto ball_of = [&](SceneDescription& scene) {
    Shape ball = sphere({0, 0, 0}, 0.7, 0);
    ball.front_bsdf = add(scene, glass);
    ball.back_bsdf = add(scene, glass.other_side());
    return ball;
  };
  SceneDescription declared = lit_ball(volpath());
  bound(declared, ball_of(declared), add_medium(declared, medium(extinction, single, 0.5f)));
  for (const IntegratorSettings& integrator : {path(), volpath()}) {
    SceneDescription scene = lit_ball(integrator);
    const Shape ball = ball_of(scene);
    scene.bsdfs[std::size_t(ball.front_bsdf)].inside = InnerMedium{extinction, single, 0.5f};
    scene.shapes.push_back(ball);
    expect_alike(scene, declared);
  }
}

/// A board of these colours, which alternate at every unit of the texture coordinates.
int add_board(SceneDescription& scene, const glm::vec3& one, const glm::vec3& other) {
  CheckerboardTexture board;
  board.color0 = TexturedColour(one);
  board.color1 = TexturedColour(other);
  scene.textures.push_back({"board", board});
  return int(scene.textures.size()) - 1;
}

TEST(Interiors, ColourMayBeATexture) {
  for (const float g : {0.0f, 0.5f}) {
    const glm::vec3 colour(0.1f, 0.55f, 0.93f);
    OpenPbrBsdf surface = wax(glm::vec3(1), 1e-5f, g);
    surface.subsurface_radius_scale = glm::vec3(1.0f, 0.4f, 0.1f);
    surface.subsurface_color.texture = 0;
    SceneDescription scene = wall(surface);
    add_board(scene, colour, colour);
    // Between the knots of the curve the root of the complement is off by up to 3e-5 of 0.1.
    expect_colour(scene, glm::dvec3(colour), 2e-3);
  }
}

TEST(Interiors, EveryBackendGivesTheSameBits) {
  SceneDescription described = lit_ball(path());
  described.sampler.spp = 4;
  OpenPbrBsdf surface = wax(glm::vec3(1), 0.1f, 0.3f);
  surface.specular_weight = TexturedNumber(1.0f);
  surface.coat_weight = TexturedNumber(0.5f);
  surface.subsurface_weight = TexturedNumber(0.7f);
  surface.subsurface_color.texture =
      add_board(described, glm::vec3(0.9f, 0.5f, 0.2f), glm::vec3(0.2f, 0.5f, 0.9f));
  described.shapes.push_back(one_sided(sphere({0.4, 0, 0}, 0.4, 0), add(described, surface)));
  OpenPbrBsdf glass;
  glass.transmission_weight = TexturedNumber(1.0f);
  glass.transmission_color = TexturedColour(glm::vec3(0.2f, 0.9f, 0.4f));
  glass.transmission_depth = 0.3f;
  Shape ball = sphere({-0.4, 0, 0}, 0.4, 0);
  ball.front_bsdf = add(described, glass);
  ball.back_bsdf = add(described, *glass.other_side());
  described.shapes.push_back(ball);
  const DeviceScene scene = build_or_throw(described);
  EXPECT_NE(scene.header.features & FEATURE_INTERIORS, 0u);
  TestDevice device = native_device();
  device.options.threads = 1;
  device.options.block_of_one = true;
  const auto hash = [&](const TestDevice& on) { return render_or_throw(scene, on).hash(); };
  const auto reference = hash(device);
  device.options.block_of_one = false;
  for (const Isa isa : usable_isas())
    for (const int threads : {1, 2}) {
      device.options.isa = isa;
      device.options.threads = threads;
      EXPECT_EQ(hash(device), reference) << isa_name(isa) << " " << threads;
    }
  EXPECT_EQ(hash(opencl_device()), reference);
}

TEST(Interiors, CameraInsideSeesTheWalls) {
  // Rays that start inside are outside for all they know: the back of the surface is black.
  SceneDescription scene = narrow_view(100, path());
  scene.shapes.push_back(one_sided(sphere({0, 0, 0}, 2, 0), add(scene, wax(glm::vec3(0.9f), 0.1f))));
  scene.emitters.emplace_back(ConstantEnvironment{});
  const FilmAccumulator film = render_or_throw(scene);
  EXPECT_EQ(film.flagged()[BAD_BOUNDARY].count, 0u);
  EXPECT_EQ(mean_image(film).at(0, 0, 0), 0);
}

TEST(Interiors, OpenSurfacesEndWalks) {
  SceneDescription scene = narrow_view(2'000, path());
  scene.shapes.push_back(
      one_sided(parallelogram({1, -1, 1}, {-2, 0, 0}, {0, 2, 0}, 0), add(scene, wax(glm::vec3(0.9f), 0.1f))));
  scene.emitters.emplace_back(ConstantEnvironment{});
  const FilmAccumulator film = render_or_throw(scene);
  EXPECT_EQ(non_finite_count(film.flagged()), 0u);
  const double value = mean_image(film).at(0, 0, 0);
  EXPECT_LT(value, 0.9);
}

TEST(Interiors, InstancesAreLikeCopies) {
  const OpenPbrBsdf surface = wax(glm::vec3(0.4f, 0.7f, 0.9f), 0.2f);
  SceneDescription copies = lit_ball(path()), instances = lit_ball(path());
  const int of_copies = add(copies, surface), of_instances = add(instances, surface);
  ShapeGroup group;
  group.name = "group";
  group.shapes.push_back(one_sided(sphere({0, 0, 0}, 0.5, 0), of_instances));
  instances.groups.push_back(group);
  for (const double x : {-0.45, 0.45}) {
    copies.shapes.push_back(one_sided(sphere({x, 0, 0}, 0.4, 0), of_copies));
    instances.instances.push_back({.name = "instance",
                                   .group = 0,
                                   .to_world = translation(glm::dvec3(x, 0, 0)) * scaling(glm::dvec3(0.8))});
  }
  // Lengths are those of the world, whatever the instance's scale.
  expect_alike(instances, copies);
}

TEST(Interiors, OthersReflectDiffuselyAndSaySo) {
  const glm::vec3 colour(0.3f, 0.6f, 0.9f);
  const SceneDescription scene = wall(wax(colour, 1e-3f), {.method = WhittedIntegrator{}}, 2'000);
  expect_colour(scene, glm::dvec3(colour), 1e-3);
  EXPECT_EQ(interior_warnings(scene).size(), 1u);
  EXPECT_EQ(interior_warnings(wall(wax(colour, 1e-3f))).size(), 0u);
}

TEST(Interiors, ThinWallsScatterToBothSides) {
  const glm::vec3 colour(0.3f, 0.6f, 0.9f);
  for (const float g : {-1.0f, 0.0f, 0.5f})
    for (const bool behind : {false, true}) {
      SceneDescription scene = narrow_view(20'000, path());
      OpenPbrBsdf sheet = wax(colour, 1, std::clamp(g, -0.99f, 0.99f));
      sheet.thin_walled = true;
      Shape wall = parallelogram({1, -1, 1}, {-2, 0, 0}, {0, 2, 0}, 0);
      wall.front_bsdf = wall.back_bsdf = add(scene, sheet);
      scene.shapes.push_back(wall);
      // A large light before the wall or behind it.
      const double z = behind ? 2 : -1e-3, side = behind ? -1 : 1;
      scene.shapes.push_back(parallelogram({-1e3 * side, -1e3, z}, {2e3 * side, 0, 0}, {0, 2e3, 0},
                                           add_diffuse(scene, 0), 1.0f));
      const double share = (1 + double(sheet.subsurface_anisotropy)) / 2;
      // The light covers all but 2e-3 of the cosines.
      expect_colour(scene, (behind ? share : 1 - share) * glm::dvec3(colour), 5e-3);
    }
}

}  // namespace
}  // namespace penumbra::interiors_test
