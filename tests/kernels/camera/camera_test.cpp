// Camera rays against the pinhole's closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"

namespace penumbra {
namespace {

/// A camera at `origin` with random axes, half extents tan_x and tan_x height / width.
SceneHeader random_camera(RandomNumbers& random, int width, int height, double tan_x) {
  SceneHeader h{};
  h.film.width = width;
  h.film.height = height;
  const Exact3 z = random.direction(), x = normalize(cross(z, random.direction())), y = cross(z, x);
  h.camera.origin = rounded(random.point(10));
  h.camera.x = rounded((long double)tan_x * x);
  h.camera.y = rounded((long double)(tan_x * height / width) * y);
  h.camera.z = rounded(z);
  h.camera.near_clip = 0.25f;
  h.camera.far_clip = 100;
  return h;
}

TEST(CameraRay, GoesThroughItsPointOfTheFilm) {
  RandomNumbers random(1);
  for (auto [width, height] : {std::pair{1, 1}, {640, 480}, {480, 640}, {32768, 3}})
    for (int k = 0; k < 5000; ++k) {
      const SceneHeader h = random_camera(random, width, height, random.between(1e-3, 3));
      const int x = int(random.below(std::uint64_t(width))), y = int(random.below(std::uint64_t(height)));
      const float dx = float(random.between(-0.5, 0.5)), dy = float(random.between(-0.5, 0.5));
      const Ray ray = camera_ray(h.camera, h.film, x, y, dx, dy);
      // From the film's left and top edges: +x of the camera is left, +y is up.
      const long double sx = 1 - 2 * (x + 0.5L + dx) / width, sy = 1 - 2 * (y + 0.5L + dy) / height;
      const Exact3 through = exact(h.camera.z) + sx * exact(h.camera.x) + sy * exact(h.camera.y);
      // A few roundings of a vector of this length.
      ASSERT_LE(double(length(exact(ray.direction) - normalize(through))), 8 * 0x1p-24);
      ASSERT_NEAR(double(length(exact(ray.direction))), 1, 4 * 0x1p-24);
    }
}

TEST(CameraRay, RunsFromTheNearToTheFarPlane) {
  RandomNumbers random(2);
  for (int k = 0; k < 5000; ++k) {
    const SceneHeader h = random_camera(random, 64, 48, 1);
    const Ray ray = camera_ray(h.camera, h.film, int(random.below(64)), int(random.below(48)), 0, 0);
    const Exact3 start = exact(ray.origin) - exact(h.camera.origin);
    const Exact3 end = start + (long double)ray.tmax * exact(ray.direction);
    // Positions about the camera are rounded to 2^-24 of its coordinates, up to 10 in each, and of the
    // distance.
    ASSERT_NEAR(double(dot(start, exact(h.camera.z))), 0.25, 40 * 0x1p-24);
    ASSERT_NEAR(double(dot(end, exact(h.camera.z))), 100, 100 * 8 * 0x1p-24);
  }
}

TEST(CameraRay, WithoutAFarPlaneEndsAtTheLimit) {
  RandomNumbers random(3);
  SceneHeader h = random_camera(random, 64, 48, 1);
  h.camera.far_clip = 3e38f;
  EXPECT_EQ(camera_ray(h.camera, h.film, 0, 0, 0, 0).tmax, NO_LIMIT);
}

TEST(CameraRay, NeighboursOnAWideFilmAreApart) {
  // At the edge of 32k pixels a step of a hundredth of a pixel still turns the ray.
  RandomNumbers random(4);
  SceneHeader h = random_camera(random, 32768, 1024, 0.5);
  h.camera.origin = make_vec3(0, 0, 0);
  h.camera.x = make_vec3(0.5f, 0, 0);
  h.camera.y = make_vec3(0, 0.5f / 32, 0);
  h.camera.z = make_vec3(0, 0, 1);
  for (int x : {0, 1, 16384, 32766, 32767})
    for (float dx = -0.5f; dx < 0.4f; dx += 0.1f)
      EXPECT_LT(camera_ray(h.camera, h.film, x, 512, dx + 0.1f, 0).direction.x,
                camera_ray(h.camera, h.film, x, 512, dx, 0).direction.x)
          << x;
}

}  // namespace
}  // namespace penumbra
