// Spheres and disks against extended precision.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"

namespace penumbra {
namespace {

/// Both distances to the sphere, or none.
struct ExactRoots {
  bool real = false;
  long double near = 0, far = 0;
  long double discriminant = 0;  ///< r^2 - (distance of the line from the centre)^2
};

ExactRoots exact_sphere(const Exact3& o, const Exact3& d, const Exact3& center, long double radius) {
  const Exact3 f = o - center, unit = normalize(d);
  const long double b = -dot(f, unit);
  const Exact3 closest = f + b * unit;
  ExactRoots roots;
  roots.discriminant = radius * radius - dot(closest, closest);
  roots.real = roots.discriminant >= 0;
  const long double root = std::sqrt(std::max(0.0L, roots.discriminant));
  roots.near = (b - root) / length(d);
  roots.far = (b + root) / length(d);
  return roots;
}

TEST(Sphere, DistanceFromOutsideAndInside) {
  RandomNumbers random(1);
  int decided = 0;
  for (int i = 0; i < 300'000 && !testing::Test::HasFailure(); ++i) {
    const double scale = std::pow(10.0, random.between(-3, 4));
    const vec3 center = rounded(random.point(scale));
    const float radius = float(scale * random.between(0.1, 1));
    const Exact3 toward = exact(center) + (long double)(1.2 * radius) * random.direction();
    const double reach = radius * std::pow(10.0, random.between(-1, 3));
    const vec3 o = rounded(exact(center) + reach * random.direction());
    const vec3 d = rounded(normalize(toward - exact(o)));
    const ExactRoots truth = exact_sphere(exact(o), exact(d), exact(center), radius);
    const float t = intersect_sphere(o, d, center, radius);
    // The closest point to the centre is off by a few roundings of the distance to the centre and of the
    // coordinates.
    const long double error = 8 * 0x1p-24L * (length(exact(o) - exact(center)) + length(exact(center)));
    const long double grazing = 4 * error * radius;
    if (std::abs(truth.discriminant) < grazing) continue;  // either answer is right
    ++decided;
    if (!truth.real || truth.far < -error) {
      ASSERT_LE(t, 0) << "a miss";
      continue;
    }
    // The root's derivative by the distance of the line from the centre grows towards grazing.
    const long double margin = error * (1 + radius / std::sqrt(truth.discriminant));
    if (std::abs(truth.near) < margin || std::abs(truth.far) < margin) continue;  // starts on the sphere
    const long double expected = truth.near > 0 ? truth.near : truth.far;
    if (expected < 0) {
      ASSERT_LE(t, 0);
    } else {
      ASSERT_NEAR(double(t), double(expected), double(margin));
    }
  }
  EXPECT_GT(decided, 250'000);
}

TEST(Sphere, StaysRoundFromFarAway) {
  // A unit sphere from 1e5 away, where b^2 - c of the textbook loses all digits.
  RandomNumbers random(2);
  int hits = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Exact3 from = 1e5L * random.direction();
    const vec3 o = rounded(from);
    const Exact3 target = random.uniform() * random.direction();
    const vec3 d = rounded(normalize(target - exact(o)));
    const ExactRoots truth = exact_sphere(exact(o), exact(d), {}, 1);
    const float t = intersect_sphere(o, d, make_vec3(0, 0, 0), 1);
    if (truth.discriminant < 0.1L) continue;
    ++hits;
    ASSERT_NEAR(double(t), double(truth.near), 0.1);  // a few roundings of 1e5 each 2^-7
  }
  EXPECT_GT(hits, 5'000);
}

TEST(Sphere, SpecialRays) {
  const vec3 center = make_vec3(0, 0, 0), x = make_vec3(1, 0, 0);
  EXPECT_EQ(intersect_sphere(make_vec3(-3, 0, 0), x, center, 1), 2);
  EXPECT_EQ(intersect_sphere(make_vec3(0, 0, 0), x, center, 1), 1);  // from the centre
  EXPECT_EQ(intersect_sphere(make_vec3(0.5f, 0, 0), x, center, 1), 0.5f);
  EXPECT_LT(intersect_sphere(make_vec3(3, 0, 0), x, center, 1), 0);   // behind
  EXPECT_LT(intersect_sphere(make_vec3(-3, 2, 0), x, center, 1), 0);  // beside
  EXPECT_EQ(intersect_sphere(make_vec3(-3, 1, 0), x, center, 1), 3);  // tangent
}

TEST(Disk, DistanceAndRim) {
  RandomNumbers random(3);
  int hits = 0, misses = 0;
  for (int i = 0; i < 300'000 && !testing::Test::HasFailure(); ++i) {
    const double scale = std::pow(10.0, random.between(-3, 4));
    const vec3 center = rounded(random.point(scale)), normal = rounded(random.direction());
    const float radius = float(scale * random.between(0.1, 1));
    const vec3 o = rounded(random.point(5 * scale));
    const Exact3 in_plane = normalize(cross(exact(normal), random.direction()));
    const Exact3 toward =
        exact(center) + (long double)(1.5 * radius * std::sqrt(random.uniform())) * in_plane;
    const vec3 d = rounded(normalize(toward - exact(o)));
    const long double cosine = dot(exact(normal), exact(d));
    if (std::abs(cosine) < 1e-3L) continue;
    const Exact3 way = exact(center) - exact(o);
    const long double truth = dot(exact(normal), way) / cosine;
    const long double from_center = length(truth * exact(d) - way);
    const float t = intersect_disk(o, d, center, normal, radius);
    const long double error = 8 * 0x1p-24L * (length(way) + length(exact(center))) / std::abs(cosine);
    if (std::abs(from_center - radius) < 2 * error) continue;
    if (from_center > radius) {
      ++misses;
      ASSERT_LE(t, 0);
    } else {
      ++hits;
      ASSERT_NEAR(double(t), double(truth), double(error));
    }
  }
  EXPECT_GT(hits, 50'000);
  EXPECT_GT(misses, 50'000);
}

TEST(Disk, SpecialRays) {
  const vec3 center = make_vec3(0, 0, 2), up = make_vec3(0, 0, 1);
  EXPECT_EQ(intersect_disk(make_vec3(0, 0, 0), up, center, up, 1), 2);
  EXPECT_EQ(intersect_disk(make_vec3(1, 0, 0), up, center, up, 1), 2);  // on the rim
  EXPECT_LT(intersect_disk(make_vec3(1.001f, 0, 0), up, center, up, 1), 0);
  EXPECT_LT(intersect_disk(make_vec3(0, 0, 3), up, center, up, 1), 0);                   // behind
  EXPECT_LE(intersect_disk(make_vec3(-3, 0, 2), make_vec3(1, 0, 0), center, up, 1), 0);  // in its plane
  EXPECT_LE(intersect_disk(make_vec3(-3, 0, 1), make_vec3(1, 0, 0), center, up, 1), 0);
}

}  // namespace
}  // namespace penumbra
