// Cameras with lenses, parallel projection and distortion against their closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "scenes/device/camera_builder.h"
#include "scenes/device/to_vec3.h"
#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/statistics.h"

namespace penumbra {
namespace {

struct Filmed {
  CameraSettings camera;
  Film film;
};

Filmed random_camera(RandomNumbers& random, Projection projection) {
  Filmed f;
  f.film.width = f.film.crop_width = int(16 + random.below(400));
  f.film.height = f.film.crop_height = int(16 + random.below(400));
  f.camera.projection = projection;
  f.camera.fov = random.between(5, 120);
  f.camera.fov_axis = FovAxis(random.below(5));
  f.camera.scale_x = random.between(0.2, 5);
  f.camera.scale_y = random.between(0.2, 5);
  f.camera.near_clip = random.between(0.01, 0.3);
  f.camera.principal_point_offset_x = random.between(-0.4, 0.4);
  f.camera.principal_point_offset_y = random.between(-0.4, 0.4);
  const Exact3 z = random.direction(), x = normalize(cross(z, random.direction())), y = cross(z, x);
  const auto axis = [](const Exact3& v, double sign) {
    return glm::dvec4(sign * double(v.x), sign * double(v.y), sign * double(v.z), 0);
  };
  const double mirrored = random.below(2) == 0 ? 1 : -1;
  const Exact3 at = random.point(3);
  f.camera.to_world = glm::dmat4(axis(x, mirrored), axis(y, 1), axis(z, 1), glm::dvec4(at.x, at.y, at.z, 1));
  return f;
}

Camera kernel_camera(const Filmed& f) {
  return build_camera(f.camera, f.film, to_vec3(glm::dvec3(f.camera.to_world[3])));
}

/// Where the film shows a point of camera space (x to the left, y up), in pixels from its upper left corner:
/// pinhole or parallel projection, then distortion, size of the channel's image, and the axis' place.
glm::dvec2 project(const Filmed& f, glm::dvec3 p, int channel) {
  const CameraSettings& c = f.camera;
  const double w = f.film.width, h = f.film.height;
  glm::dvec2 at(p.x / p.z, p.y / p.z);
  glm::dvec2 pixels_per_unit;
  if (c.projection == Projection::kOrthographic) {
    at = glm::dvec2(p.x, p.y);
    pixels_per_unit = {w / (2 * c.scale_x), w / (2 * c.scale_y)};
  } else {
    const double sizes[] = {w, h, std::hypot(w, h), std::min(w, h), std::max(w, h)};
    pixels_per_unit = glm::dvec2(sizes[int(c.fov_axis)] / 2 / std::tan(c.fov * std::numbers::pi / 360));
  }
  const double r2 = glm::dot(at, at);
  at *= (1 + c.distortion_k1 * r2 + c.distortion_k2 * r2 * r2) * (1 + c.magnify()[channel]);
  return {w / 2 - at.x * pixels_per_unit.x - c.principal_point_offset_x * w,
          h / 2 - at.y * pixels_per_unit.y - c.principal_point_offset_y * h};
}

FilmParameters film_of(const Filmed& f) {
  FilmParameters film{};
  film.width = f.film.width;
  film.height = f.film.height;
  return film;
}

/// The ray from a point of the lens through a film position in pixels.
Ray ray_through(const Filmed& f, glm::dvec2 position, int channel, float u, float v) {
  const Camera camera = kernel_camera(f);
  const int x = int(std::floor(position.x)), y = int(std::floor(position.y));
  const FilmPoint p = film_point(camera, film_of(f), channel_of(camera.image_scale, channel), x, y,
                                 float(position.x - x - 0.5), float(position.y - y - 0.5));
  std::array<float, LANES> d{}, px{}, py{};
  d.fill(film_radius(camera, p.x, p.y));
  px.fill(p.x);
  py.fill(p.y);
  if (camera.reach > 0) undistort(camera, d.data(), px.data(), py.data());
  const LensPoint lens = lens_point(camera, u, v);
  return lens_ray(camera, channel_of(camera.focus, channel), px[0], py[0], lens.x, lens.y);
}

glm::dvec3 wide(const vec3& v) { return {v.x, v.y, v.z}; }

/// Distance of a point of camera space from the ray.
double miss(const Filmed& f, const Ray& ray, glm::dvec3 p) {
  const glm::dvec3 world(f.camera.to_world * glm::dvec4(p, 1));
  return glm::length(glm::cross(world - wide(ray.origin), wide(ray.direction)));
}

/// A point of camera space that the film sees, from 0.5 to 10 away, a little beyond its borders.
glm::dvec3 random_seen_point(const Filmed& f, RandomNumbers& random) {
  const Camera camera = kernel_camera(f);
  const double x = random.between(-0.9, 0.9) + camera.offset_x,
               y = random.between(-0.9, 0.9) + camera.offset_y, z = random.between(0.5, 10);
  const double reach = f.camera.projection == Projection::kOrthographic ? 1 : z;
  return {x * length3(camera.x) * reach, y * length3(camera.y) * reach, z};
}

/// Some 20 roundings of numbers of this size.
double rounding(const Filmed& f, const glm::dvec3& p) {
  const double film = glm::length(glm::dvec2(p)) + std::hypot(f.camera.scale_x, f.camera.scale_y) + p.z;
  return 20 * 0x1p-24 * (glm::length(glm::dvec3(f.camera.to_world[3])) + film);
}

class Cameras : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(Projections, Cameras,
                         testing::Values(Projection::kPerspective, Projection::kOrthographic),
                         [](const auto& tested) {
                           return tested.param == Projection::kPerspective ? "Perspective" : "Orthographic";
                         });

TEST_P(Cameras, RaysGoThroughWhatTheirPointOfTheFilmShows) {
  RandomNumbers random(1);
  for (int k = 0; k < 20000; ++k) {
    const Filmed f = random_camera(random, GetParam());
    const glm::dvec3 p = random_seen_point(f, random);
    const Ray ray = ray_through(f, project(f, p, 0), 0, 0.5f, 0.5f);
    ASSERT_LE(miss(f, ray, p), rounding(f, p)) << k;
    ASSERT_NEAR(glm::length(wide(ray.direction)), 1, 4 * 0x1p-24);
  }
}

TEST_P(Cameras, RaysRunFromTheNearToTheFarPlane) {
  RandomNumbers random(2);
  for (int k = 0; k < 5000; ++k) {
    Filmed f = random_camera(random, GetParam());
    f.camera.far_clip = random.between(1, 20);
    f.camera.aperture_radius = random.between(0, 0.2);
    f.camera.focus_distance = random.between(1, 20);
    const Ray ray = ray_through(f, project(f, random_seen_point(f, random), 0), 0, random.unit_float(),
                                random.unit_float());
    const glm::dvec3 z(f.camera.to_world[2]), from(f.camera.to_world[3]);
    const double tolerance = 60 * 0x1p-24 * (10 + f.camera.far_clip);
    ASSERT_NEAR(glm::dot(wide(ray.origin) - from, z), f.camera.near_clip, tolerance);
    ASSERT_NEAR(glm::dot(wide(ray.origin) + double(ray.tmax) * wide(ray.direction) - from, z),
                f.camera.far_clip, tolerance);
  }
}

TEST_P(Cameras, EveryPointOfTheLensSeesTheFocalPlaneSharp) {
  RandomNumbers random(3);
  for (int k = 0; k < 20000; ++k) {
    Filmed f = random_camera(random, GetParam());
    glm::dvec3 p = random_seen_point(f, random);
    f.camera.aperture_radius = random.between(0.01, 0.4);
    f.camera.blades = random.below(2) == 0 ? 0 : int(3 + random.below(7));
    f.camera.focus_distance = p.z;
    const glm::dvec2 position = project(f, p, 0);
    const Ray ray = ray_through(f, position, 0, random.unit_float(), random.unit_float());
    ASSERT_LE(miss(f, ray, p), 2 * rounding(f, p)) << k;
  }
}

TEST_P(Cameras, OtherPointsAreSpreadByTheCircleOfConfusion) {
  // Through a point of the lens a, what is at depth z appears where the centre of the lens would show
  // something beside it by a (1 - z / F): similar triangles.
  RandomNumbers random(4);
  for (int k = 0; k < 20000; ++k) {
    Filmed f = random_camera(random, GetParam());
    const glm::dvec3 p = random_seen_point(f, random);
    f.camera.aperture_radius = random.between(0.01, 0.2);
    f.camera.focus_distance = random.between(0.5, 20);
    const float u = random.unit_float(), v = random.unit_float();
    const LensPoint lens = lens_point(kernel_camera(f), u, v);
    const glm::dvec3 on_lens = f.camera.aperture_radius * glm::dvec3(lens.x, lens.y, 0);
    const glm::dvec3 shown = p - on_lens * (1 - p.z / f.camera.focus_distance);
    const Ray ray = ray_through(f, project(f, shown, 0), 0, u, v);
    ASSERT_LE(miss(f, ray, p), 4 * rounding(f, p) * (1 + p.z / f.camera.focus_distance)) << k;
  }
}

TEST_P(Cameras, ChannelsHaveImagesOfTheirOwnSizeAndFocus) {
  RandomNumbers random(5);
  for (int k = 0; k < 20000; ++k) {
    Filmed f = random_camera(random, GetParam());
    const glm::dvec3 p = random_seen_point(f, random);
    f.camera.magnify_red = random.between(-0.1, 0.1);
    f.camera.magnify_green = random.between(-0.1, 0.1);
    f.camera.magnify_blue = random.between(-0.1, 0.1);
    f.camera.refocus_red = random.between(-0.1, 0.1);
    f.camera.refocus_green = random.between(-0.1, 0.1);
    f.camera.refocus_blue = random.between(-0.1, 0.1);
    f.camera.aperture_radius = random.between(0.01, 0.2);
    const int channel = int(random.below(3));
    f.camera.focus_distance = p.z / (1 + f.camera.refocus()[channel]);
    const Ray ray = ray_through(f, project(f, p, channel), channel, random.unit_float(), random.unit_float());
    ASSERT_LE(miss(f, ray, p), 3 * rounding(f, p)) << k;
  }
}

TEST(LensCamera, ThePinholesRaysAreTheSame) {
  RandomNumbers random(6);
  for (int k = 0; k < 5000; ++k) {
    Filmed f = random_camera(random, Projection::kPerspective);
    f.camera.principal_point_offset_x = f.camera.principal_point_offset_y = 0;
    const Camera camera = kernel_camera(f);
    const int x = int(random.below(std::uint64_t(f.film.width)));
    const int y = int(random.below(std::uint64_t(f.film.height)));
    const Ray plain = camera_ray(camera, film_of(f), x, y, 0.25f, -0.125f);
    const Ray ray = ray_through(f, {x + 0.75, y + 0.375}, 0, 0.5f, 0.5f);
    ASSERT_EQ(wide(plain.origin), wide(ray.origin));
    ASSERT_EQ(wide(plain.direction), wide(ray.direction));
    ASSERT_EQ(plain.tmax, ray.tmax);
  }
}

// --- distortion

/// d(r) in extended precision, with the coefficients that kernels have.
long double exact_distorted(const Camera& c, long double r) {
  return r * (1 + r * r * ((long double)c.k1 + r * r * (long double)c.k2));
}

/// |d(r) - d| in roundings of what d(r) is the sum of, which do not cancel as its terms do.
double roundings(const Camera& c, long double r, long double d) {
  const long double terms =
      r * (1 + r * r * (std::abs((long double)c.k1) + r * r * std::abs((long double)c.k2)));
  return double(std::abs(exact_distorted(c, r) - d) / (terms * 0x1p-24L));
}

TEST(Distortion, IsInvertedToSinglePrecision) {
  // Up to the fold, where d' is 0: then no float r is better. d(r) itself is evaluated with 5 roundings, and
  // that of r is up to 5 of d(r), as r^5 grows: half of one for the r that is found, and 3 for the point that
  // is moved there (a quotient, a product, a length).
  RandomNumbers random(7);
  double worst_search = 0, worst_point = 0;
  int tested = 0;
  while (tested < 20000) {
    Filmed f = random_camera(random, Projection::kPerspective);
    f.camera.principal_point_offset_x = f.camera.principal_point_offset_y = 0;
    const double size = std::pow(10.0, random.between(-4, 1));
    f.camera.distortion_k1 = random.between(-size, size);
    f.camera.distortion_k2 = random.below(3) == 0 ? 0 : random.between(-size, size);
    if (!check_camera(f.camera, f.film)) continue;
    ++tested;
    const Camera camera = kernel_camera(f);
    std::array<float, LANES> x{}, y{}, d{};
    for (std::size_t j = 0; j < LANES; ++j) {
      x[j] = float(random.between(-1, 1));
      y[j] = float(random.between(-1, 1));
      d[j] = film_radius(camera, x[j], y[j]);
      DistortionSearch search = start_distortion_search(camera, d[j]);
      for (int step = 0; step < DISTORTION_STEPS; ++step) search = narrowed(camera, d[j], search);
      worst_search = std::max(worst_search, roundings(camera, search.r, d[j]));
    }
    undistort(camera, d.data(), x.data(), y.data());
    for (std::size_t j = 0; j < LANES; ++j)
      worst_point = std::max(worst_point, roundings(camera, film_radius(camera, x[j], y[j]), d[j]));
  }
  EXPECT_LE(worst_search, 7.5);
  EXPECT_LE(worst_point, 7.5 + 5 * 3);
  RecordProperty("worst", std::to_string(worst_search) + ", " + std::to_string(worst_point));
}

TEST(Distortion, TheCentreStaysWhereItIs) {
  Filmed f;
  f.camera.distortion_k1 = -0.1;
  std::array<float, LANES> d{}, x{}, y{};
  undistort(kernel_camera(f), d.data(), x.data(), y.data());
  EXPECT_EQ(x[0], 0);
  EXPECT_EQ(y[0], 0);
}

TEST(Distortion, FilmShowsWhatTheFormulaSays) {
  RandomNumbers random(8);
  int tested = 0;
  while (tested < 20000) {
    Filmed f = random_camera(random, Projection::kPerspective);
    f.camera.fov = random.between(5, 80);
    f.camera.distortion_k1 = random.between(-0.2, 0.5);
    f.camera.distortion_k2 = random.between(-0.1, 0.5);
    f.camera.magnify_green = random.between(-0.1, 0.1);
    if (!check_camera(f.camera, f.film)) continue;
    const glm::dvec3 p = random_seen_point(f, random);
    const glm::dvec2 position = project(f, p, 1);
    if (!(position.x >= 0 && position.y >= 0 && position.x < f.film.width && position.y < f.film.height))
      continue;
    // Where the image is squeezed a rounding on the film is more in the scene.
    const double r2 = (p.x * p.x + p.y * p.y) / (p.z * p.z);
    const double slope = 1 + r2 * (3 * f.camera.distortion_k1 + r2 * 5 * f.camera.distortion_k2);
    if (slope < 0.1) continue;
    ++tested;
    const Ray ray = ray_through(f, position, 1, 0.5f, 0.5f);
    ASSERT_LE(miss(f, ray, p), rounding(f, p) * (2 + 2 * r2) / slope) << tested;
  }
}

TEST(Distortion, FoldsAreFoundAtTheirRadius) {
  // r (1 - r^2 / 3) grows up to 1, where it is 2/3; a film of 90 degrees reaches to 1.
  Filmed f;
  f.film.width = f.film.height = f.film.crop_width = f.film.crop_height = 100;
  f.film.filter = FilterKind::kBox;
  f.film.filter_radius = 0.5f;
  f.camera.distortion_k1 = -1 / 3.0;
  const auto with_corner_at = [&](double radius) {
    f.camera.fov = 2 * std::atan(radius / std::numbers::sqrt2) * 180 / std::numbers::pi;
    return check_camera(f.camera, f.film);
  };
  EXPECT_TRUE(with_corner_at(0.6666));
  const auto folded = with_corner_at(0.6667);
  ASSERT_FALSE(folded);
  EXPECT_NE(folded.error().message.find("grows up to r = 1, where it is 0.666667"), std::string::npos)
      << folded.error().message;
  EXPECT_NE(folded.error().message.find("reaches to 0.6667"), std::string::npos) << folded.error().message;
  // A crop that the fold does not reach; a wide filter; an image that is smaller than the film.
  f.film.crop_x = f.film.crop_y = 10;
  f.film.crop_width = f.film.crop_height = 80;
  EXPECT_TRUE(with_corner_at(0.6667));
  f.film.filter_radius = 12.0f;
  EXPECT_FALSE(with_corner_at(0.6667));
  f.film.filter_radius = 0.5f;
  f.camera.magnify_blue = -0.25;
  EXPECT_FALSE(with_corner_at(0.6667));
  // Both coefficients: 1 + 3 k1 r^2 + 5 k2 r^4 = (1 - r^2)(1 - 2 r^2).
  f.camera.magnify_blue = 0;
  f.camera.distortion_k1 = -1;
  f.camera.distortion_k2 = 0.4;
  const double fold = 1 / std::numbers::sqrt2, most = fold * (1 - 0.5 + 0.1);
  f.film.crop_x = f.film.crop_y = 0;
  f.film.crop_width = f.film.crop_height = 100;
  EXPECT_TRUE(with_corner_at(most * 0.9999));
  EXPECT_FALSE(with_corner_at(most * 1.0001));
  // One that never folds, however far the film reaches.
  f.camera.distortion_k1 = -0.1;
  f.camera.distortion_k2 = 0.01;
  EXPECT_TRUE(with_corner_at(1e3));
}

// --- the lens

struct LensCase {
  std::string name;
  int blades;
  double rotation;
};
class Lens : public testing::TestWithParam<LensCase> {};
INSTANTIATE_TEST_SUITE_P(Shapes, Lens,
                         testing::Values(LensCase{"Disk", 0, 0}, LensCase{"Triangle", 3, 20},
                                         LensCase{"Pentagon", 5, -77}, LensCase{"Hexagon", 6, 0},
                                         LensCase{"Nonagon", 9, 361}),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(Lens, IsSampledUniformly) {
  // Cells by angle and by the share of the lens' area within: uniform over a disk or polygon is uniform over
  // (angle's share of the area, (r / rim)^2), both in closed form.
  const auto& [name, blades, rotation] = GetParam();
  Filmed f;
  f.camera.aperture_radius = 1;
  f.camera.blades = blades;
  f.camera.blade_rotation = rotation;
  const Camera camera = kernel_camera(f);
  constexpr int kSectors = 12, kRings = 6, kSamples = 200000;
  // Sectors of equal area: of a polygon, of its triangles, by where they cut the edge.
  std::vector<double> observed(kSectors * kRings),
      expected(kSectors * kRings, double(kSamples) / (kSectors * kRings));
  RandomNumbers random(9);
  for (int k = 0; k < kSamples; ++k) {
    const LensPoint p = lens_point(camera, random.unit_float(), random.unit_float());
    double turn = std::atan2(double(p.y), double(p.x)) / (2 * std::numbers::pi) - rotation / 360;
    turn -= std::floor(turn);
    double around = turn, within = double(p.x) * p.x + double(p.y) * p.y;
    if (blades > 0) {
      const double half = std::numbers::pi / blades;
      const int blade = std::min(int(turn * blades), blades - 1);
      const double angle = (turn * blades - blade) * 2 * half - half;  // from the edge's middle
      const double distance = std::sqrt(within) * std::cos(angle) / std::cos(half);
      around = (blade + 0.5 + 0.5 * std::tan(angle) / std::tan(half)) / blades;
      within = distance * distance;
    }
    ASSERT_LE(within, 1 + 1e-6);
    const int sector = std::clamp(int(around * kSectors), 0, kSectors - 1);
    const int ring = std::min(int(within * kRings), kRings - 1);
    observed[std::size_t(sector * kRings + ring)] += 1;
  }
  EXPECT_GT(statistics::chi_square_test(observed, expected).p, 0.001);
}

}  // namespace
}  // namespace penumbra
