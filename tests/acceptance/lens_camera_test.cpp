// Images of cameras beyond the pinhole against closed forms: defocused edges, chromatic aberration, parallel
// projection, mirrored cameras, layers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/acceptance/scene_pieces.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

constexpr int kWidth = 32;

/// A camera at the origin that looks along z, x to the left, over a black world whose half x > edge shines
/// with radiance 1 at depth z. One row of pixels; independent samples.
SceneDescription half_plane(double z, double edge, std::uint32_t spp) {
  SceneDescription scene = empty_scene(kWidth, 1, spp, 5);
  scene.integrator = direct_integrator(1, 0);
  scene.shapes.push_back(parallelogram({edge, -1e3, z}, {0, 2e3, 0}, {1e3, 0, 0}, kBlackBsdf, 1));
  scene.camera = {};
  scene.camera.fov = 60;
  return scene;
}

/// Of the film at distance 1.
double half_width(const SceneDescription& scene) {
  return std::tan(scene.camera.fov * std::numbers::pi / 360);
}

/// Share of the unit disk on the side x < s of a line.
double disk_share(double s) {
  s = std::clamp(s, -1.0, 1.0);
  return 1 - (std::acos(s) - s * std::sqrt(1 - s * s)) / std::numbers::pi;
}

/// Two-sided t-tests of the means of all pixels of a row, together at significance .01.
template <typename Expected>
void expect_row(const FilmAccumulator& film, int channel, const Expected& expected) {
  const double alpha = statistics::sidak_significance(0.01, std::size_t(kWidth));
  for (int x = 0; x < kWidth; ++x) {
    const statistics::Sample sample = pixel_sample(film, x, 0, channel);
    // Rounding of a ray: its place within a pixel.
    EXPECT_GT(statistics::t_test(sample, expected(x), 1e-4).p, alpha)
        << "pixel " << x << ": " << sample.mean() << ", expected " << expected(x);
  }
}

TEST(ThinLens, AnEdgeIsBlurredByTheDiskOfTheLens) {
  constexpr double kDepth = 6, kFocus = 2.5, kRadius = 0.3, kEdge = 0.37;
  SceneDescription scene = half_plane(kDepth, kEdge, 4096);
  scene.camera.aperture_radius = kRadius;
  scene.camera.focus_distance = kFocus;
  const double half = half_width(scene);
  // From the point a of the lens the film's p sees x = p z + a (1 - z / F); over the pixel, by the midpoint
  // rule.
  const auto expected = [&](int x) {
    constexpr int kSteps = 1000;
    double sum = 0;
    for (int k = 0; k < kSteps; ++k) {
      const double p = half * (1 - 2 * (x + (k + 0.5) / kSteps) / kWidth);
      sum += disk_share((p * kDepth - kEdge) / (kRadius * std::abs(1 - kDepth / kFocus)));
    }
    return sum / kSteps;
  };
  expect_row(render_or_throw(scene), 0, expected);
}

TEST(ThinLens, TheFocalPlaneIsSharp) {
  SceneDescription scene = half_plane(6, 0.37, 256);
  scene.camera.aperture_radius = 0.3;
  scene.camera.focus_distance = 6;
  const double edge = 0.5 * kWidth * (1 - 0.37 / 6 / half_width(scene));
  const FilmAccumulator film = render_or_throw(scene);
  for (int x = 0; x < kWidth; ++x) {
    if (x == int(edge)) continue;
    EXPECT_EQ(pixel_sample(film, x, 0, 1).mean(), x < edge ? 1 : 0) << x;
  }
}

TEST(ThinLens, ASquareLensBlursAnEdgeByItsWidths) {
  // With its corners on the axes, a square has widths that fall linearly to both sides: the share on one side
  // is 1 - (1 - s)^2 / 2 beyond the middle.
  constexpr double kDepth = 1.5, kFocus = 4, kRadius = 0.3;
  SceneDescription scene = half_plane(kDepth, 0, 4096);
  scene.camera.aperture_radius = kRadius;
  scene.camera.focus_distance = kFocus;
  scene.camera.blades = 4;
  const double half = half_width(scene);
  const auto share = [](double s) {
    const double t = std::max(0.0, 1 - std::abs(s));
    return s > 0 ? 1 - 0.5 * t * t : 0.5 * t * t;
  };
  expect_row(render_or_throw(scene), 2, [&](int x) {
    constexpr int kSteps = 1000;
    double sum = 0;
    for (int k = 0; k < kSteps; ++k) {
      const double p = half * (1 - 2 * (x + (k + 0.5) / kSteps) / kWidth);
      sum += share(p * kDepth / (kRadius * (1 - kDepth / kFocus)));
    }
    return sum / kSteps;
  });
}

TEST(Channels, EdgesAreWhereTheSizesOfTheirImagesPutThem) {
  SceneDescription scene = half_plane(3, -1.1, 4096);
  scene.camera.magnify_red = 0.05;
  scene.camera.magnify_blue = -0.08;
  const FilmAccumulator film = render_or_throw(scene);
  for (int channel = 0; channel < 3; ++channel) {
    const double p = -1.1 / 3 * (1 + scene.camera.magnify()[channel]);
    const double edge = 0.5 * kWidth * (1 - p / half_width(scene));
    expect_row(film, channel, [&](int x) { return std::clamp(edge - x, 0.0, 1.0); });
  }
}

TEST(Channels, EdgesAreBlurredByTheirOwnFocus) {
  constexpr double kDepth = 6, kRadius = 0.3;
  SceneDescription scene = half_plane(kDepth, 0, 4096);
  scene.camera.aperture_radius = kRadius;
  scene.camera.focus_distance = 5;
  scene.camera.refocus_red = 0.2;  // sharp at the edge
  scene.camera.refocus_green = -0.3;
  scene.camera.refocus_blue = 0.5;
  const double half = half_width(scene);
  const FilmAccumulator film = render_or_throw(scene);
  for (int channel = 0; channel < 3; ++channel) {
    const double focus = 5 * (1 + scene.camera.refocus()[channel]);
    expect_row(film, channel, [&](int x) {
      constexpr int kSteps = 1000;
      double sum = 0;
      for (int k = 0; k < kSteps; ++k) {
        const double p = half * (1 - 2 * (x + (k + 0.5) / kSteps) / kWidth) * kDepth;
        const double blur = kRadius * std::abs(1 - kDepth / focus);
        sum += blur < 1e-9 ? (p > 0 ? 1 : 0) : disk_share(p / blur);
      }
      return sum / kSteps;
    });
  }
}

/// Three rays a sample, from the same numbers: where they are the same rays, so is the image, to the bit.
TEST(Channels, WithoutAberrationAreThoseOfTheCameraWithout) {
  for (const char* file : {"scenes/cornell-small/cornell-small.xml", "scenes/star-light/star-light.xml"}) {
    SceneDescription scene = read_or_throw(project_file(file));
    resize_film(scene, 24, 18);
    scene.sampler.spp = 8;
    scene.film.closed_light_edges = false;  // lenses have none
    const FilmAccumulator plain = render_or_throw(scene);
    // Too small for single precision.
    scene.camera.magnify_green = 1e-12;
    const FilmAccumulator split = render_or_throw(scene);
    EXPECT_EQ(plain.hash(), split.hash()) << file;
    scene.camera.magnify_green = 0.3;
    const FilmAccumulator apart = render_or_throw(scene);
    EXPECT_NE(plain.hash(), apart.hash()) << file;
    // The other channels do not change.
    for (int x = 0; x < 24; ++x) {
      EXPECT_EQ(plain.at(x, 9).mean[0], apart.at(x, 9).mean[0]);
      EXPECT_EQ(plain.at(x, 9).mean[2], apart.at(x, 9).mean[2]);
    }
  }
}

/// A parallelogram that shines, seen along z by a film from x = scale_x on its left to -scale_x.
TEST(Orthographic, EdgesAreWhereTheScalePutsThemAtEveryDepth) {
  for (const double depth : {0.5, 3.0, 70.0}) {
    SceneDescription scene = half_plane(depth, 0.83, 4096);
    scene.camera.projection = Projection::kOrthographic;
    scene.camera.scale_x = 2.2;
    const double edge = 0.5 * kWidth * (1 - 0.83 / 2.2);
    expect_row(render_or_throw(scene), 0, [&](int x) { return std::clamp(edge - x, 0.0, 1.0); });
  }
}

TEST(Orthographic, HeightFollowsTheAspectOfTheFilm) {
  // Mitsuba's film is 2 wide and 2 / aspect high before its scale.
  SceneDescription scene = empty_scene(4, 20, 1024, 3);
  scene.integrator = direct_integrator(1, 0);
  scene.camera = {};
  scene.camera.projection = Projection::kOrthographic;
  scene.camera.scale_x = 0.5;
  scene.camera.scale_y = 0.7;
  scene.shapes.push_back(parallelogram({-9, 1.3, 2}, {0, 90, 0}, {90, 0, 0}, kBlackBsdf, 1));
  const FilmAccumulator film = render_or_throw(scene);
  const double edge = 10 * (1 - 1.3 / (0.7 * 20 / 4));
  const double alpha = statistics::sidak_significance(0.01, 20);
  for (int y = 0; y < 20; ++y) {
    const statistics::Sample sample = pixel_sample(film, 1, y, 0);
    EXPECT_GT(statistics::t_test(sample, std::clamp(edge - y, 0.0, 1.0), 1e-4).p, alpha) << y;
  }
}

TEST(Orthographic, DepthIsTheDistanceAlongTheView) {
  SceneDescription scene = empty_scene(8, 8, 16, 1);
  scene.integrator = direct_integrator(0, 1);
  scene.camera = {};
  scene.camera.projection = Projection::kOrthographic;
  scene.camera.near_clip = 0.25;
  scene.shapes.push_back(parallelogram({-9, -9, 4}, {0, 90, 0}, {90, 0, 0}, add_diffuse(scene, 0.4f)));
  scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(1)});
  for (const double aperture : {0.0, 0.5}) {
    scene.camera.aperture_radius = aperture;
    scene.camera.focus_distance = 4;
    const FilmAccumulator film = render_or_throw(scene);
    for (const int x : {0, 4, 7}) {
      // Slanted rays through a lens of radius R are longer by at most sqrt(1 + (R / F)^2).
      const double depth = film.layer(x, 7 - x, LAYER_DEPTH);
      EXPECT_GE(depth, 3.75 * (1 - 1e-6));
      EXPECT_LE(depth, 3.75 * std::hypot(1, aperture / 4) * (1 + 1e-6));
      EXPECT_NEAR(film.layer(x, x, LAYER_ALBEDO, 1), 0.4, 1e-6);
    }
  }
}

TEST(Cameras, AMirroredOneMirrorsTheImage) {
  for (const Projection projection : {Projection::kPerspective, Projection::kOrthographic}) {
    SceneDescription scene = half_plane(3, -0.4, 64);
    scene.camera.projection = projection;
    scene.camera.scale_x = 1.5;
    const FilmAccumulator image = render_or_throw(scene);
    scene.camera.to_world[0] = -scene.camera.to_world[0];
    const FilmAccumulator mirrored = render_or_throw(scene);
    int compared = 0;
    for (int x = 0; x < kWidth; ++x) {
      const double value = image.at(x, 0).mean[0];
      if (value != 0 && value != 1) continue;  // but for the edge, which other samples see
      ++compared;
      EXPECT_EQ(value, mirrored.at(kWidth - 1 - x, 0).mean[0]) << x;
    }
    EXPECT_GE(compared, kWidth - 1);
    EXPECT_NE(image.at(0, 0).mean[0], mirrored.at(0, 0).mean[0]);
  }
}

TEST(Cameras, ThePrincipalPointMovesThePicture) {
  SceneDescription scene = half_plane(3, 0, 4096);
  scene.camera.principal_point_offset_x = 0.21;
  const double edge = kWidth * (0.5 - 0.21);
  expect_row(render_or_throw(scene), 0, [&](int x) { return std::clamp(edge - x, 0.0, 1.0); });
}

TEST(Cameras, DistortionMovesEdgesAlongTheirRadius) {
  // One row through the axis: r is |x|.
  SceneDescription scene = half_plane(3, -0.9, 4096);
  scene.camera.distortion_k1 = 0.6;
  scene.camera.distortion_k2 = -0.2;
  const double r = 0.3, d = r * (1 + r * r * (0.6 - 0.2 * r * r));
  const double edge = 0.5 * kWidth * (1 + d / half_width(scene));
  // Within the row, half a pixel high, edges bend by less than 1e-3 of a pixel.
  expect_row(render_or_throw(scene), 0, [&](int x) { return std::clamp(edge - x, 0.0, 1.0); });
}

}  // namespace
}  // namespace penumbra
