// The two portable intersectors against a test of every primitive, and with rays that probe for leaks.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <utility>

#include "scenes/device/hierarchy/bvh_builder.h"
#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra {
namespace {

/// A closed mesh: an icosahedron with every triangle split into four `levels` times, its vertices pushed to
/// random distances in [0.7, 1.3] radii, so that it is star-shaped about `center`.
class ClosedMesh {
 public:
  ClosedMesh(int levels, double radius, const Exact3& center, std::uint64_t seed) {
    const double g = (1 + std::sqrt(5.0)) / 2;
    for (double s : {-1.0, 1.0})
      for (double t : {-g, g}) {
        directions_.push_back(normalize({0, s, t}));
        directions_.push_back(normalize({s, t, 0}));
        directions_.push_back(normalize({t, 0, s}));
      }
    // The faces are the triples of vertices that are nearest neighbours of each other.
    const auto near = [&](std::size_t a, std::size_t b) {
      return dot(directions_[a], directions_[b]) > 0.4L;
    };
    for (std::size_t a = 0; a < 12; ++a)
      for (std::size_t b = a + 1; b < 12; ++b)
        for (std::size_t c = b + 1; c < 12; ++c)
          if (near(a, b) && near(b, c) && near(a, c)) faces_.push_back({a, b, c});
    for (int i = 0; i < levels; ++i) subdivide();
    RandomNumbers random(seed);
    for (const Exact3& d : directions_)
      points_.push_back(rounded(center + (radius * random.between(0.7, 1.3)) * d));
  }

  [[nodiscard]] SceneTables tables() const {
    SceneTables tables;
    for (const auto& [a, b, c] : faces_) tables.add_triangle(points_[a], points_[b], points_[c]);
    return tables;
  }
  /// A random vertex, or a random point of a random edge.
  [[nodiscard]] Exact3 rim_point(RandomNumbers& random) const {
    const auto& face = faces_[random.below(faces_.size())];
    const Exact3 a = exact(points_[face[0]]), b = exact(points_[face[1]]);
    if (random.below(4) == 0) return a;
    return a + (long double)random.uniform() * (b - a);
  }

 private:
  void subdivide() {
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> middles;
    const auto middle = [&](std::size_t a, std::size_t b) {
      const auto [at, added] = middles.try_emplace(std::minmax(a, b), directions_.size());
      if (added) directions_.push_back(normalize(directions_[a] + directions_[b]));
      return at->second;
    };
    std::vector<std::array<std::size_t, 3>> finer;
    for (const auto& [a, b, c] : faces_) {
      const std::size_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    faces_ = std::move(finer);
  }

  std::vector<Exact3> directions_;
  std::vector<std::array<std::size_t, 3>> faces_;
  std::vector<vec3> points_;
};

std::size_t count_misses(const std::vector<TestHit>& hits) {
  return std::size_t(std::ranges::count(hits, -1, &TestHit::primitive));
}

struct Place {
  double offset, radius;
};
// Far from the origin the vertices snap to a coarse grid; the mesh stays closed and star-shaped about its
// middle.
constexpr Place kPlaces[] = {{0, 1}, {1e3, 1}, {1e6, 50}, {0, 1e-4}, {0, 1e5}};

/// Rays from inside at edges and vertices, where two or more triangles meet.
std::vector<TestRay> rays_at_rims(const ClosedMesh& mesh, const Exact3& center, double radius, int count,
                                  std::uint64_t seed) {
  RandomNumbers random(seed);
  std::vector<TestRay> rays;
  for (int i = 0; i < count; ++i) {
    const vec3 origin = rounded(center + random.point(0.2 * radius));
    rays.push_back({origin, rounded(normalize(mesh.rim_point(random) - exact(origin)))});
  }
  return rays;
}

constexpr int kRaysAPlace = 250'000;  // more than a million over the places

TEST(Watertightness, WholeScenesDoNotLeak) {
  for (const Place& place : kPlaces) {
    const Exact3 center = place.offset * Exact3{0.6L, -0.64L, 0.48L};
    const ClosedMesh mesh(1, place.radius, center, 3);
    SceneTables tables = mesh.tables();
    tables.index_corners();
    ASSERT_LE(tables.vertices.size(), std::size_t(MAX_WHOLE_VERTICES));
    const auto rays = rays_at_rims(mesh, center, place.radius, kRaysAPlace, 4);
    EXPECT_EQ(count_misses(trace_whole(tables, rays)), 0u)
        << "at " << place.offset << ", radius " << place.radius;
  }
}

TEST(Watertightness, HierarchiesDoNotLeak) {
  for (const Place& place : kPlaces) {
    const Exact3 center = place.offset * Exact3{0.6L, -0.64L, 0.48L};
    const ClosedMesh mesh(4, place.radius, center, 5);
    SceneTables tables = mesh.tables();
    tables.build_hierarchy();
    const auto rays = rays_at_rims(mesh, center, place.radius, kRaysAPlace, 6);
    EXPECT_EQ(count_misses(trace_hierarchy(tables, rays)), 0u)
        << "at " << place.offset << ", radius " << place.radius;
  }
}

/// A cube of 2 x `cells` unit squares a side, each of two triangles, about the origin.
SceneTables grid_cube(int cells) {
  SceneTables tables;
  const float end = float(cells);
  for (int axis = 0; axis < 3; ++axis)
    for (float side : {-end, end})
      for (int i = -cells; i < cells; ++i)
        for (int j = -cells; j < cells; ++j) {
          const auto at = [&](int u, int v) {
            const float c[3] = {side, float(u), float(v)};
            return make_vec3(c[(3 - axis) % 3], c[(4 - axis) % 3], c[(5 - axis) % 3]);
          };
          tables.add_triangle(at(i, j), at(i + 1, j), at(i + 1, j + 1));
          tables.add_triangle(at(i, j), at(i + 1, j + 1), at(i, j + 1));
        }
  return tables;
}

/// From lattice points, along axes, face diagonals and space diagonals: through edges and vertices exactly,
/// with zero components of both signs, in the planes of many boxes' faces.
std::vector<TestRay> lattice_rays(int cells) {
  std::vector<TestRay> rays;
  for (int x = 1 - cells; x < cells; ++x)
    for (int y = 1 - cells; y < cells; ++y)
      for (int z = 1 - cells; z < cells; ++z)
        for (int k = 0; k < 27; ++k) {
          const float c[3] = {float(k % 3 - 1), float(k / 3 % 3 - 1), float(k / 9 - 1)};
          if (c[0] == 0 && c[1] == 0 && c[2] == 0) continue;
          const vec3 o = make_vec3(float(x), float(y), float(z)), d = normalize3(make_vec3(c[0], c[1], c[2]));
          rays.push_back({o, d});
          rays.push_back(
              {o, make_vec3(d.x == 0 ? -0.0f : d.x, d.y == 0 ? -0.0f : d.y, d.z == 0 ? -0.0f : d.z)});
        }
  return rays;
}

TEST(Watertightness, LatticeRaysInAGridDoNotLeak) {
  const auto rays = lattice_rays(4);
  SceneTables tables = grid_cube(4);
  tables.build_hierarchy();
  EXPECT_EQ(count_misses(trace_hierarchy(tables, rays)), 0u);
  SceneTables small = grid_cube(1);
  small.index_corners();
  ASSERT_LE(small.vertices.size(), std::size_t(MAX_WHOLE_VERTICES));
  EXPECT_EQ(count_misses(trace_whole(small, lattice_rays(1))), 0u);
}

/// Rays from random points at lattice points of the cube's surface and at points of lattice lines: there the
/// boxes of the hierarchy end exactly where the triangles do. From inside, and from as far outside as
/// `distance`.
std::vector<TestRay> rays_at_lattice(int cells, double distance, int count, std::uint64_t seed) {
  RandomNumbers random(seed);
  std::vector<TestRay> rays;
  while (int(rays.size()) < count) {
    const bool outside = distance > 0;
    const Exact3 from = outside ? distance * random.direction() : random.point(0.9 * cells);
    // The nearest side of the cube in the direction of `from`, or any when inside; not its outermost lines,
    // which a ray from outside may miss rightly.
    int axis = int(random.below(3));
    double side = random.below(2) != 0 ? cells : -cells;
    if (outside) {
      const long double c[3] = {std::abs(from.x), std::abs(from.y), std::abs(from.z)};
      axis = int(std::max_element(c, c + 3) - c);
      side = (axis == 0 ? from.x : axis == 1 ? from.y : from.z) > 0 ? cells : -cells;
    }
    const double u = double(random.below(std::uint64_t(2 * cells - 1))) + 1 - cells;
    const double v = random.below(2) != 0 ? random.between(1 - cells, cells - 1)
                                          : std::round(random.between(1 - cells, cells - 1));
    const Exact3 target = axis == 0   ? Exact3{side, u, v}
                          : axis == 1 ? Exact3{v, side, u}
                                      : Exact3{u, v, side};
    const vec3 origin = rounded(from);
    rays.push_back({origin, rounded(normalize(target - exact(origin)))});
  }
  return rays;
}

TEST(Watertightness, BoxesThatEndWithTheirTrianglesDoNotLeak) {
  SceneTables tables = grid_cube(16);
  tables.build_hierarchy();
  for (double distance : {0.0, 100.0, 1e4, 1e6})
    EXPECT_EQ(count_misses(trace_hierarchy(tables, rays_at_lattice(16, distance, 300'000, 20))), 0u)
        << distance;
}

void expect_same_hits(const std::vector<TestHit>& hits, const std::vector<TestHit>& truth) {
  ASSERT_EQ(hits.size(), truth.size());
  for (std::size_t i = 0; i < hits.size(); ++i) {
    ASSERT_EQ(hits[i].primitive, truth[i].primitive)
        << "ray " << i << ": " << hits[i].t << " and " << truth[i].t;
    ASSERT_EQ(hits[i].t, truth[i].t) << "ray " << i;
  }
}

/// Rays whose traversals are interleaved find the same.
void expect_same_in_flight(SceneTables& tables, const std::vector<TestRay>& rays,
                           const std::vector<TestHit>& truth) {
  const auto closest = trace_in_flight(tables, rays), some = trace_in_flight(tables, rays, true);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(closest[i], truth[i].primitive) << "ray " << i;
    ASSERT_EQ(some[i] >= 0, truth[i].primitive >= 0) << "ray " << i;
  }
}

/// Rays of every kind through the ball of radius 1.5: random, axis-parallel, short, with a primitive to skip.
std::vector<TestRay> assorted_rays(std::size_t count, std::size_t primitives, std::uint64_t seed) {
  RandomNumbers random(seed);
  std::vector<TestRay> rays;
  for (std::size_t i = 0; i < count; ++i) {
    TestRay ray{rounded(random.point(1.5)), rounded(random.direction())};
    if (i % 8 == 0) {
      const float sign = random.below(2) != 0 ? 1.0f : -1.0f;
      const std::uint64_t axis = random.below(3);
      ray.direction = make_vec3(axis == 0 ? sign : 0.0f, axis == 1 ? sign : -0.0f, axis == 2 ? sign : 0.0f);
    }
    if (i % 4 == 1) ray.tmax = float(random.between(0, 2));
    if (i % 4 == 2) ray.skip = int(random.below(primitives));
    if (i % 64 == 3) ray.tmax = -1;
    rays.push_back(ray);
  }
  return rays;
}

SceneTables random_scene(int triangles, int spheres, int disks, double size, std::uint64_t seed) {
  RandomNumbers random(seed);
  SceneTables tables;
  for (int i = 0; i < triangles; ++i) {
    const Exact3 at = random.point(1);
    tables.add_triangle(rounded(at + random.point(size)), rounded(at + random.point(size)),
                        rounded(at + random.point(size)));
  }
  for (int i = 0; i < spheres; ++i)
    tables.add_sphere(rounded(random.point(1)), float(random.between(0.01, size)));
  for (int i = 0; i < disks; ++i)
    tables.add_disk(rounded(random.point(1)), rounded(random.direction()), float(random.between(0.01, size)));
  return tables;
}

class Intersectors : public testing::TestWithParam<std::array<int, 3>> {};
INSTANTIATE_TEST_SUITE_P(Scenes, Intersectors,
                         testing::Values(std::array{1, 0, 0}, std::array{0, 1, 0}, std::array{0, 0, 1},
                                         std::array{9, 0, 0}, std::array{40, 3, 2}, std::array{300, 40, 20},
                                         std::array{2000, 0, 0}, std::array{0, 200, 100}),
                         [](const auto& tested) {
                           return std::to_string(tested.param[0]) + "Triangles" +
                                  std::to_string(tested.param[1]) + "Spheres" +
                                  std::to_string(tested.param[2]) + "Disks";
                         });

TEST_P(Intersectors, FindWhatATestOfEveryPrimitiveFinds) {
  const auto [triangles, spheres, disks] = GetParam();
  SceneTables tables = random_scene(triangles, spheres, disks, 0.3, 7);
  tables.build_hierarchy();
  const std::size_t primitives = std::size_t(triangles + spheres + disks);
  const auto rays = assorted_rays(std::min<std::size_t>(40'000, 20'000'000 / primitives), primitives, 8);
  const auto truth = trace_one_by_one(tables, rays);
  EXPECT_LT(count_misses(truth), rays.size());
  const auto closest = trace_hierarchy(tables, rays);
  expect_same_hits(closest, truth);
  expect_same_in_flight(tables, rays, truth);
  const auto any = trace_hierarchy(tables, rays, true);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(any[i].primitive >= 0, truth[i].primitive >= 0) << "ray " << i;
    ASSERT_TRUE(any[i].primitive < 0 || (any[i].t > 0 && any[i].t < rays[i].tmax)) << "ray " << i;
  }
  if (3 * triangles <= MAX_WHOLE_VERTICES) {
    tables.index_corners();
    expect_same_hits(trace_whole(tables, rays), truth);
  }
}

TEST(IntersectorCases, AgreeOnSliversAndDegenerateTriangles) {
  RandomNumbers random(9);
  SceneTables tables;
  for (int i = 0; i < 42; ++i) {
    const Exact3 a = random.point(1), d = random.direction(), e = random.direction();
    const long double thickness = i % 3 == 0 ? 0 : i % 3 == 1 ? 1e-7L : 1e-3L;  // collinear, aspect 1e7, thin
    tables.add_triangle(rounded(a), rounded(a + d), rounded(a + 0.4L * d + thickness * e));
  }
  tables.build_hierarchy();
  tables.index_corners();
  std::vector<TestRay> rays = assorted_rays(20'000, 42, 10);
  for (std::size_t i = 0; i < rays.size(); i += 2) {  // half of them at the triangles
    const Triangle& t = tables.triangles[random.below(42)];
    const Exact3 target = exact(t.p0) + (long double)random.uniform() * (exact(t.p1) - exact(t.p0));
    rays[i].direction = rounded(normalize(target - exact(rays[i].origin)));
  }
  const auto truth = trace_one_by_one(tables, rays);
  expect_same_hits(trace_hierarchy(tables, rays), truth);
  expect_same_in_flight(tables, rays, truth);
  expect_same_hits(trace_whole(tables, rays), truth);
}

/// LANES rays from about one point to about another, `wide` apart at both ends; some are none, some skip a
/// triangle, some end where they are going.
void add_bundle(std::vector<TestRay>& rays, const Exact3& from, const Exact3& to, double wide_from,
                double wide_to, int triangles, RandomNumbers& random) {
  const int kind = int(random.below(3));
  for (int j = 0; j < LANES; ++j) {
    const vec3 origin = rounded(from + random.point(wide_from));
    const Exact3 way = to + random.point(wide_to) - exact(origin);
    TestRay ray{origin, rounded(normalize(way))};
    if (kind == 1) ray.tmax = float(length(way));
    if (random.below(16) == 0) ray.tmax = -1;
    if (random.below(4) == 0) ray.skip = int(random.below(std::uint64_t(triangles)));
    rays.push_back(ray);
  }
}

TEST(Bundles, MeetWhatATestOfEveryTriangleMeets) {
  std::size_t bundles = 0, listed = 0, all = 0;
  for (const Place& place : kPlaces) {
    const Exact3 center = place.offset * Exact3{0.6L, -0.64L, 0.48L};
    const ClosedMesh mesh(1, place.radius, center, 21);
    SceneTables tables = mesh.tables();
    tables.index_corners();
    const int triangles = int(tables.triangles.size());
    RandomNumbers random(22);
    std::vector<TestRay> rays;
    for (int i = 0; i < 8000; ++i) {
      const double wide = place.radius * std::pow(10, random.between(-7, 0));
      const bool converge = random.below(2) != 0, at_rim = random.below(2) != 0;
      const Exact3 from = center + random.point(random.below(2) != 0 ? 0.3 * place.radius : 4 * place.radius);
      const Exact3 to = at_rim ? mesh.rim_point(random) : center + random.point(place.radius);
      add_bundle(rays, from, to, converge ? wide : 0, wide, triangles, random);
    }
    expect_same_hits(trace_whole(tables, rays), trace_one_by_one(tables, rays));
    for (std::size_t i = 0; place.offset == 0 && i < rays.size(); i += LANES) {
      const int count = count_listed(tables, std::span(rays).subspan(i, LANES));
      bundles += count >= 0 ? 1 : 0;
      listed += count >= 0 ? std::size_t(count) : 0;
      all += count >= 0 ? std::size_t(triangles) : 0;
    }
  }
  EXPECT_GT(bundles, 10'000u) << "of 24 000";
  EXPECT_LT(10 * listed, 3 * all);
}

TEST(IntersectorCases, DisksThatLeanALittleFillTheirBoxes) {
  RandomNumbers random(15);
  SceneTables tables;
  std::vector<TestRay> rays;
  for (int i = 0; i < 40; ++i) {
    // So far from an axis that single precision holds the axis's own component as 1.
    const Exact3 normal = normalize(Exact3{1, 0, 0} + 2e-4L * random.direction());
    const vec3 rolled = i % 3 == 0   ? rounded(normal)
                        : i % 3 == 1 ? rounded({normal.y, normal.x, normal.z})
                                     : rounded({normal.z, normal.y, normal.x});
    const vec3 center = rounded(random.point(1));
    tables.add_disk(center, rolled, 1.0f);
    for (int k = 0; k < 500; ++k) {
      const Exact3 on_rim = exact(center) + 0.99L * normalize(cross(exact(rolled), random.direction()));
      const vec3 origin = rounded(random.point(2));
      rays.push_back({origin, rounded(normalize(on_rim - exact(origin)))});
    }
  }
  tables.build_hierarchy();
  const auto truth = trace_one_by_one(tables, rays);
  expect_same_hits(trace_hierarchy(tables, rays), truth);
  expect_same_in_flight(tables, rays, truth);
}

/// A flat floor of squares in place of one another's boxes: where a ray ends on the edge of two, which of
/// them is nearer is a matter of roundings, which are not those of the boxes' sides.
TEST(IntersectorCases, EdgesInFlatBoxesGiveTheNearest) {
  RandomNumbers random(16);
  SceneTables tables;
  const int side = 24;
  const auto at = [](int u, int v) { return make_vec3(0.37f * float(u), 0.1f, 0.37f * float(v)); };
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      tables.add_triangle(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      tables.add_triangle(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  tables.build_hierarchy();
  std::vector<TestRay> rays;
  for (int i = 0; i < 20'000; ++i) {
    const int u = 1 + int(random.below(side - 1)), v = 1 + int(random.below(side - 1));
    const Exact3 from = exact(at(u, v)), to = exact(at(u + int(random.below(2)), v + int(random.below(2))));
    const vec3 origin = rounded(
        Exact3{random.between(0, 8), random.between(0.11, i % 2 == 0 ? 0.2 : 4), random.between(0, 8)});
    const Exact3 target = from + (long double)random.uniform() * (to - from);
    rays.push_back({origin, rounded(normalize(target - exact(origin)))});
  }
  const auto truth = trace_one_by_one(tables, rays);
  expect_same_hits(trace_hierarchy(tables, rays), truth);
  expect_same_in_flight(tables, rays, truth);
}

/// A flat floor of tiles that are much longer than rays are, so that vertices are rounded by more than a box
/// that ends with them is away from where rays end. Along axes, and leaning a little and much.
TEST(IntersectorCases, EdgesOfLongTilesAreMet) {
  RandomNumbers random(17);
  constexpr int kTiles = 48;
  for (const float length : {2.0f, 20.0f, 200.0f})
    for (const double lean : {0.0, 1e-6, 1e-3, 0.5}) {
      const Exact3 across = normalize(Exact3{1, lean, 0.3L * lean}),
                   along = normalize(Exact3{-lean, 0.6L * lean, 1}), up = normalize(cross(along, across));
      const auto at = [&](long double u, long double z) { return 0.37L * u * across + z * along; };
      SceneTables tables;
      for (int i = 0; i < kTiles; ++i) {
        const vec3 a = rounded(at(i, -length)), b = rounded(at(i + 1, -length)),
                   c = rounded(at(i + 1, length)), d = rounded(at(i, length));
        tables.add_triangle(a, b, c);
        tables.add_triangle(a, c, d);
      }
      tables.build_hierarchy();
      std::vector<TestRay> rays;
      for (int k = 0; k < 10'000; ++k) {
        const Exact3 target = at(1 + int(random.below(kTiles - 1)), random.between(-1, 1)) +
                              (long double)(random.between(-1e-7, 1e-7) * length) * across;
        const Exact3 way = (long double)random.between(-1, 1) * across +
                           (long double)random.between(-1, 1) * along +
                           (long double)random.between(0.01, 1) * up;
        const vec3 origin = rounded(target + (long double)random.between(0.1, 1) * way);
        rays.push_back({origin, rounded(normalize(target - exact(origin)))});
      }
      // Which of two tiles is nearer is a matter of roundings, but one there is.
      EXPECT_EQ(count_misses(trace_one_by_one(tables, rays)), 0u) << length << ", " << lean;
      for (const bool any : {false, true}) {
        EXPECT_EQ(count_misses(trace_hierarchy(tables, rays, any)), 0u) << length << ", " << lean;
        EXPECT_EQ(std::ranges::count(trace_in_flight(tables, rays, any), -1), 0) << length << ", " << lean;
      }
    }
}

TEST(IntersectorCases, CoincidentTrianglesGiveTheFirst) {
  SceneTables tables;
  for (int i = 0; i < 20; ++i)
    tables.add_triangle(make_vec3(-1, -1, 0), make_vec3(2, -1, 0), make_vec3(-1, 2, 0));
  tables.build_hierarchy();
  tables.index_corners();
  std::vector<TestRay> rays;
  RandomNumbers random(11);
  for (int i = 0; i < 1000; ++i)
    rays.push_back(
        {rounded(Exact3{random.between(-0.5, 0.5), random.between(-0.5, 0.5), 1}), make_vec3(0, 0, -1)});
  for (const TestHit& hit : trace_hierarchy(tables, rays)) ASSERT_EQ(hit.primitive, 0);
  for (const int hit : trace_in_flight(tables, rays)) ASSERT_EQ(hit, 0);
  for (const TestHit& hit : trace_whole(tables, rays)) ASSERT_EQ(hit.primitive, 0);
}

TEST(IntersectorCases, RaysThatAreNotNumbersEnd) {
  // Nothing promises them a hit; they have to come back.
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  SceneTables tables = random_scene(500, 20, 20, 0.2, 12);
  tables.build_hierarchy();
  std::vector<TestRay> rays;
  for (float bad : {nan, infinity, -infinity, 0.0f, 1e38f, 1e-45f})
    for (int k = 0; k < 6; ++k) {
      TestRay ray{make_vec3(0.1f, 0.2f, 0.3f), make_vec3(0.6f, 0, 0.8f)};
      float* fields[] = {&ray.origin.x,    &ray.origin.y,    &ray.origin.z,
                         &ray.direction.x, &ray.direction.y, &ray.direction.z};
      *fields[k] = bad;
      rays.push_back(ray);
    }
  rays.push_back({make_vec3(nan, nan, nan), make_vec3(nan, nan, nan)});
  rays.push_back({make_vec3(0, 0, 0), make_vec3(0, 0, 0)});
  rays.push_back({make_vec3(0, 0, 0), make_vec3(1, 0, 0), nan});
  EXPECT_EQ(trace_hierarchy(tables, rays).size(), rays.size());
  for (const bool any : {false, true}) EXPECT_EQ(trace_in_flight(tables, rays, any).size(), rays.size());
  // Sixteen alike are a bundle, if anything is.
  SceneTables small = random_scene(40, 0, 0, 0.2, 13);
  small.index_corners();
  std::vector<TestRay> bundles;
  for (const TestRay& ray : rays) bundles.insert(bundles.end(), LANES, ray);
  EXPECT_EQ(trace_whole(small, bundles).size(), bundles.size());
}

TEST(Hierarchy, HoldsEveryPrimitive) {
  SceneTables tables = random_scene(3000, 100, 50, 0.05, 13);
  tables.build_hierarchy();
  std::vector<int> seen(tables.triangles.size() + tables.quadrics.size());
  for (const TriangleLeaf& leaf : tables.triangle_leaves)
    for (int j = 0; j < BVH_WIDTH; ++j) {
      if (leaf.primitive[j] < 0) continue;
      ++seen[std::size_t(leaf.primitive[j])];
      const Triangle& t = tables.triangles[std::size_t(leaf.primitive[j])];
      EXPECT_EQ(leaf.p[0][0][j], t.p0.x);
      EXPECT_EQ(leaf.p[1][1][j], t.p1.y);
      EXPECT_EQ(leaf.p[2][2][j], t.p2.z);
    }
  for (const QuadricLeaf& leaf : tables.quadric_leaves)
    for (int primitive : leaf.primitive)
      if (primitive >= 0) ++seen[std::size_t(primitive)];
  EXPECT_EQ(std::ranges::count(seen, 0), 0);  // parts of a triangle are in several leaves
}

/// Each eight triangles half as large as those before and next to them, so that a binary tree is a chain, and
/// what comes of it too deep for the stacks of rays.
TEST(Hierarchy, IsNotDeeperThanStacksAre) {
  SceneTables tables;
  for (int k = -60; k < 60; ++k)
    for (int i = 0; i < 8; ++i) {
      const float size = std::ldexp(1.0f, k), turn = float(i) / 8;
      tables.add_triangle(make_vec3(size, size * turn, 0), make_vec3(1.5f * size, 0, size * turn),
                          make_vec3(size, size, size * (1 - turn)));
    }
  tables.build_hierarchy();
  std::vector<int> depth(tables.nodes.size(), 1);
  for (std::size_t i = 0; i < tables.nodes.size(); ++i)
    for (const int child : tables.nodes[i].child)
      if (child >= 0) depth[std::size_t(child)] = depth[i] + 1;
  EXPECT_LE(*std::ranges::max_element(depth), BVH_MAX_DEPTH);
}

TEST(Hierarchy, IsTheSameEveryTime) {
  const SceneTables tables = random_scene(1000, 20, 20, 0.1, 14);
  SceneTables a = tables, b = tables;
  a.build_hierarchy();
  b.build_hierarchy();
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  EXPECT_EQ(std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(BvhNode)), 0);
  ASSERT_EQ(a.triangle_leaves.size(), b.triangle_leaves.size());
  EXPECT_EQ(std::memcmp(a.triangle_leaves.data(), b.triangle_leaves.data(),
                        a.triangle_leaves.size() * sizeof(TriangleLeaf)),
            0);
}

/// Long triangles, which are split, and short ones; enough for all threads.
TEST(Hierarchies, AreTheSameWhateverTheNumberOfThreads) {
  RandomNumbers random(77);
  SceneTables tables;
  for (int i = 0; i < 60000; ++i) {
    const Exact3 a = random.point(1);
    const double size = i % 50 == 0 ? 1 : 0.02;
    tables.add_triangle(rounded(a), rounded(a + random.point(size)), rounded(a + random.point(0.1 * size)));
  }
  const PrimitiveGroup all{0, 0, int(tables.triangles.size()), 0, 0};
  const auto one = build_hierarchy(tables.triangles, {}, std::span(&all, 1), {}, 1);
  ASSERT_TRUE(one);
  EXPECT_GT(one->triangle_leaves.size(), tables.triangles.size() / 8);
  for (const int threads : {2, 3, 4, 8}) {
    const auto many = build_hierarchy(tables.triangles, {}, std::span(&all, 1), {}, threads);
    ASSERT_TRUE(many);
    ASSERT_EQ(many->nodes.size(), one->nodes.size()) << threads;
    ASSERT_EQ(many->triangle_leaves.size(), one->triangle_leaves.size()) << threads;
    EXPECT_EQ(std::memcmp(many->nodes.data(), one->nodes.data(), one->nodes.size() * sizeof(BvhNode)), 0);
    EXPECT_EQ(std::memcmp(many->triangle_leaves.data(), one->triangle_leaves.data(),
                          one->triangle_leaves.size() * sizeof(TriangleLeaf)),
              0);
  }
}

}  // namespace
}  // namespace penumbra
