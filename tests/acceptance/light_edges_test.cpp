// Edges of lights that the camera sees: fractions of pixels in closed form, without bias whatever occludes
// the lights.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "kernels/host/view.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/acceptance/shadowed_polygon.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra::light_edges_test {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr double kSignificance = 0.01;
constexpr float kRadiance = 3;
constexpr int kSide = 12;  ///< of the film
/// Film positions are rounded to some 2^-20 of a pixel here, directions to 2^-24 of a film that is 12 pixels
/// wide: a share is off by less than this.
constexpr double kShareRounding = 1e-4;

/// A camera at the origin that sees from -1 to 1, either way, at distance 1.
SceneDescription seen_from_origin(std::uint32_t spp, std::uint32_t seed = 1) {
  SceneDescription scene = empty_scene(kSide, kSide, spp, seed);
  scene.camera = look_at(dvec3(0), dvec3(0, 0, 1), dvec3(0, 1, 0), 90);
  scene.integrator = direct_integrator(1, 0);
  return scene;
}

/// A light that shines at the camera, its corners in the plane at distance 1: (x, y) there times `distance`.
Shape area_light(const std::array<dvec2, 4>& corners, double distance, float radiance = kRadiance,
                 int bsdf = kBlackBsdf) {
  const auto at = [&](int k) { return distance * dvec3(corners[std::size_t(k)], 1); };
  return triangles(std::array{at(0), at(2), at(1), at(0), at(3), at(2)}, bsdf, radiance);
}
constexpr std::array<dvec2, 4> kOblique{{{-0.62, -0.41}, {0.53, -0.7}, {0.71, 0.37}, {-0.29, 0.66}}};

/// The share of a pixel that a convex polygon of the plane at distance 1 takes up; x is to the left there.
double share_of_pixel(const std::array<dvec2, 4>& corners, int x, int y) {
  constexpr double kPixel = 2.0 / kSide;
  const double high_x = 1 - x * kPixel, high_y = 1 - y * kPixel;
  PolygonPoints polygon;
  for (const dvec2& corner : corners) polygon.emplace_back(corner, 1);
  // By planes through the origin and the pixel's sides.
  for (const dvec3& side : {dvec3(-1, 0, high_x), dvec3(1, 0, kPixel - high_x), dvec3(0, -1, high_y),
                            dvec3(0, 1, kPixel - high_y)})
    polygon = clipped(polygon, side);
  double area = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const dvec3 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    area += 0.5 * (a.x * b.y - a.y * b.x);
  }
  return std::abs(area) / (kPixel * kPixel);
}

bool has_light_edges(const SceneDescription& scene) {
  return (build_or_throw(scene).header.features & FEATURE_LIGHT_EDGES) != 0u;
}

struct Integrated {
  const char* name;
  IntegratorSettings integrator;
};
std::vector<Integrated> integrators() {
  IntegratorSettings cv, analytic, whitted;
  use(cv, IntegratorKind::kPolygonCv);
  use(analytic, IntegratorKind::kPolygonAnalytic);
  use(whitted, IntegratorKind::kWhitted);
  return {{"direct", direct_integrator(1, 0)},
          {"direct with directions", direct_integrator(1, 1)},
          {"path", path_integrator(DirectSampling::kMis)},
          {"path by directions", path_integrator(DirectSampling::kBsdfOnly)},
          {"whitted", whitted},
          {"polygon_cv", cv},
          {"polygon_analytic", analytic}};
}

TEST(LightEdges, OfALightAloneAreItsSharesOfPixels) {
  for (const Integrated& one : integrators()) {
    SceneDescription scene = seen_from_origin(3);
    scene.integrator = one.integrator;
    scene.shapes.push_back(area_light(kOblique, 5));
    const FilmAccumulator film = render_or_throw(scene);
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const statistics::Sample pixel = pixel_sample(film, x, y, 1);
        ASSERT_NEAR(pixel.mean() / double(kRadiance), share_of_pixel(kOblique, x, y), kShareRounding)
            << one.name << " " << x << ", " << y;
        ASSERT_LT(pixel.variance(), 1e-9) << one.name << " " << x << ", " << y;
      }
  }
}

/// Scenes in which things hide edges, or edges lie over others.
struct Place {
  std::string name;
  SceneDescription scene;
  bool edges = true;  ///< whether there are any
};
void PrintTo(const Place& place, std::ostream* out) { *out << place.name; }

std::vector<Place> places() {
  std::vector<Place> all;
  const auto add = [&](const char* name, auto... shapes) -> SceneDescription& {
    SceneDescription scene = seen_from_origin(1 << 15);
    (scene.shapes.push_back(shapes), ...);
    all.push_back({name, scene});
    return all.back().scene;
  };
  const Shape whole = area_light(kOblique, 5);
  // Black, across the light's middle, so that its edges end in pixels.
  const Shape bar = parallelogram({-3, -0.31, 3}, {0, 0.5, 0}, {6, 0.4, 0}, kBlackBsdf);
  add("Bare", whole);
  add("BehindABar", whole, bar);
  add("BehindItsLike", whole, area_light({{{-0.9, -0.13}, {0.17, -0.3}, {0.2, 0.3}, {-0.8, 0.21}}}, 3));
  add("BehindADimmerOne", whole, area_light({{{-0.9, -0.13}, {0.17, -0.3}, {0.2, 0.3}, {-0.8, 0.21}}}, 3, 1));
  add("BeforeASky", whole).emitters.emplace_back(ConstantEnvironment{glm::vec3(1)});
  // Beyond the far plane on one side, and nearer than the near one on the other.
  SceneDescription& clipped =
      add("Clipped", parallelogram({-4, -2.3, 9}, {0, 4.1, 0}, {8, 0.7, -12}, kBlackBsdf, kRadiance));
  clipped.camera.near_clip = 2;
  clipped.camera.far_clip = 6;
  SceneDescription& mirrored = add("InAMirroredCamera", whole, bar);
  mirrored.camera.to_world[0] *= -1.0;
  SceneDescription& path = add("OverAFloor", whole);
  path.shapes.push_back(parallelogram({-20, -1.5, -20}, {0, 0, 60}, {60, 0, 0}, add_diffuse(path, 0.7f)));
  path.integrator = path_integrator(DirectSampling::kMis);
  // All sides of a box, of which three are seen: inner edges are none.
  SceneDescription& box = add("OfABox");
  const dvec3 low(0.3, 0.4, 3), u(1.1, 0.2, 0.3), v(-0.3, 0.9, 0.2), w(-0.2, 0.1, 1);
  for (const auto& [corner, a, b] :
       {std::tuple(low, v, u), std::tuple(low, u, w), std::tuple(low, w, v), std::tuple(low + w, u, v),
        std::tuple(low + v, w, u), std::tuple(low + u, v, w)})
    box.shapes.push_back(parallelogram(corner, a, b, kBlackBsdf, kRadiance));
  SceneDescription& two_sided =
      add("OfBothSides", area_light({{kOblique[3], kOblique[2], kOblique[1], kOblique[0]}}, 5));
  two_sided.shapes[0].two_sided_emission = true;
  const auto round = [](const auto& geometry) {
    Shape shape;
    shape.name = "round";
    shape.geometry = geometry;
    shape.radiance = glm::vec3(kRadiance);
    return shape;
  };
  add("OfASphere", round(Sphere{{0.5, 0.2, 4}, 1.3}));
  add("OfADisk", round(Disk{{-0.5, 0.4, 3}, glm::normalize(dvec3(0.3, -0.2, -1)), 1.1}));
  add("OfASphereBehindABar", round(Sphere{{0.5, 0.2, 7}, 3}), bar);
  add("OfASphereBeforeADisk", round(Disk{{-0.5, 0.4, 6}, {0, 0, -1}, 3.1}),
      round(Sphere{{1.5, 0.2, 4}, 1.3}));
  SceneDescription& cut = add("OfACutSphere", round(Sphere{{0.5, 0.2, 4}, 1.3}));
  cut.camera.near_clip = 3.5;
  all.back().edges = false;
  add("OfASphereAboutTheCamera", round(Sphere{{0.5, 0.2, 1}, 4}));
  all.back().edges = false;
  const auto filtered = [&](const char* name, FilterKind kind, float radius) {
    SceneDescription& scene = add(name, whole, bar);
    scene.film.filter = kind;
    scene.film.filter_radius = radius;
  };
  filtered("ByATent", FilterKind::kTent, 1);
  filtered("ByAGaussian", FilterKind::kGaussian, 2);
  filtered("ByLobesBelowZero", FilterKind::kMitchell, 2);
  add("FromBehind", area_light({{kOblique[3], kOblique[2], kOblique[1], kOblique[0]}}, 5));
  all.back().edges = false;
  add("BehindAWall", whole, parallelogram({-9, -9, 2}, {0, 18, 0}, {18, 0, 0}, kBlackBsdf));
  all.back().edges = false;
  return all;
}

class LightEdgePlace : public testing::TestWithParam<Place> {};
INSTANTIATE_TEST_SUITE_P(Places, LightEdgePlace, testing::ValuesIn(places()),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(LightEdgePlace, HasTheMeanOfSamples) {
  SceneDescription scene = GetParam().scene;
  EXPECT_EQ(has_light_edges(scene), GetParam().edges);
  const FilmAccumulator closed = render_or_throw(scene);
  scene.film.closed_light_edges = false;
  EXPECT_FALSE(has_light_edges(scene));
  scene.sampler.seed = 2;
  const FilmAccumulator sampled = render_or_throw(scene);
  const double limit = statistics::sidak_significance(kSignificance, std::size_t{kSide} * kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const statistics::Sample a = pixel_sample(closed, x, y, 1), b = pixel_sample(sampled, x, y, 1);
      // A corner of a light that fewer than 20 samples met has no normal mean: it is one that 40 would meet
      // at most (chance 2e-4).
      const double one = kRadiance / double(b.count());
      if (b.variance() < 20 * one * kRadiance) {
        EXPECT_LT(std::abs(a.mean() - b.mean()), 40 * one) << x << ", " << y;
        continue;
      }
      EXPECT_GT(statistics::welch_t_test(a, b, kRadiance * kShareRounding).p, limit)
          << x << ", " << y << ": " << a.mean() << " +- " << a.standard_error() << ", samples " << b.mean()
          << " +- " << b.standard_error();
    }
  // Next to nothing of the noise is left where all edges are seen, and nowhere is it more.
  const double noise = mean_variance(closed), of_samples = mean_variance(sampled);
  EXPECT_LE(noise, of_samples * 1.02);
  const std::string& name = GetParam().name;
  if (name == "Bare" || name == "OfABox" || name == "Clipped") EXPECT_LT(noise, 1e-6 * of_samples);
  // Where samples fall between a circle and its polygon there is some.
  if (name == "OfASphere" || name == "OfADisk") EXPECT_LT(noise, 0.01 * of_samples);
}

TEST(LightEdges, AreLeftToSamplesWhereOtherThingsCount) {
  SceneDescription scene = seen_from_origin(1);
  scene.shapes.push_back(area_light(kOblique, 5));
  ASSERT_TRUE(has_light_edges(scene));
  const auto without = [&](auto change) {
    SceneDescription changed = scene;
    change(changed);
    return !has_light_edges(changed);
  };
  EXPECT_TRUE(without([](SceneDescription& s) { s.film.closed_light_edges = false; }));
  EXPECT_TRUE(without([](SceneDescription& s) { s.film.alpha = true; }));
  EXPECT_TRUE(without([](SceneDescription& s) { s.integrator.hide_emitters = true; }));
  EXPECT_TRUE(without([](SceneDescription& s) { s.camera.aperture_radius = 0.1; }));
  EXPECT_TRUE(without([](SceneDescription& s) { s.camera.projection = Projection::kOrthographic; }));
  EXPECT_TRUE(without([](SceneDescription& s) { use(s.integrator, IntegratorKind::kAmbientOcclusion); }));
  EXPECT_TRUE(without([](SceneDescription& s) {
    s.integrator = path_integrator(DirectSampling::kMis);
    std::get<PathIntegrator>(s.integrator.method).only_bounces = 1;
  }));
}

TEST(LightEdges, AreNotThoseOfAnotherCamera) {
  SceneDescription scene = seen_from_origin(64);
  scene.shapes.push_back(area_light(kOblique, 5));
  DeviceScene seen = build_or_throw(scene);
  const View at_first = view_of(seen.header);
  View moved = at_first;
  moved.camera.origin.x += 0.5f;
  apply_view(moved, seen.header);
  EXPECT_EQ(seen.header.sees_edges, 0);
  const FilmAccumulator film = render_or_throw(seen);
  scene.camera.to_world[3].x += 0.5;
  scene.film.closed_light_edges = false;
  const FilmAccumulator there = render_or_throw(scene);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      EXPECT_EQ(pixel_sample(film, x, y, 1).mean(), pixel_sample(there, x, y, 1).mean()) << x << ", " << y;
  apply_view(at_first, seen.header);
  EXPECT_EQ(seen.header.sees_edges, 1);
}

TEST(LightEdges, AreTheSameWithEitherIntersector) {
  SceneDescription scene = seen_from_origin(2);
  scene.shapes.push_back(area_light(kOblique, 5));
  const DeviceScene portable = build_or_throw(scene), embree = build_or_throw(scene, true);
  EXPECT_EQ(embree.header.tables.light_edges.count, portable.header.tables.light_edges.count);
  EXPECT_GT(embree.header.tables.light_edges.count, 0);
  EXPECT_EQ(embree.header.tables.nodes.count, 0);
}

}  // namespace
}  // namespace penumbra::light_edges_test
