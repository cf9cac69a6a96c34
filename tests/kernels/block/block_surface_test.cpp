// Surfaces of LANES paths at a time equal those of single rays.
#include <gtest/gtest.h>

#include <bit>
#include <string>

#include "tests/kernels/block/path_values.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra {
namespace {

/// Of a point inside the unit ball about the centre, for each of the primitives.
SceneTables random_scene(RandomNumbers& random, bool with_normals, bool with_quadrics, bool with_uv) {
  SceneTables tables;
  for (int k = 0; k < 12; ++k) {
    tables.add_triangle(rounded(random.point(1)), rounded(random.point(1)), rounded(random.point(1)));
    Triangle& t = tables.triangles.back();
    t.front = 1 + k;
    t.back = 100 + k;
    t.light = k % 3 - 1;
    const auto number = [&] { return float(random.between(-1, 2)); };
    if (with_uv) tables.vertex_uvs.push_back({number(), number(), number(), number(), number(), number()});
    if (!with_normals || k % 2 == 0) continue;
    t.normals = int(tables.normals.size());
    tables.normals.push_back(
        {rounded(random.direction()), rounded(random.direction()), rounded(random.direction())});
  }
  for (int k = 0; with_quadrics && k < 12; ++k) {
    const vec3 center = rounded(random.point(1));
    const auto radius = float(random.between(0.1, 0.5));
    if (k % 2 == 0)
      tables.add_sphere(center, radius, k % 4 == 0 ? 1.0f : -1.0f);
    else
      tables.add_disk(center, rounded(random.direction()), radius);
    Quadric& q = tables.quadrics.back();
    q.front = 200 + k;
    q.back = 300 + k;
    q.light = k % 3 - 1;
  }
  return tables;
}

vec3 middle_of(const SceneTables& tables, int primitive) {
  const int triangles = int(tables.triangles.size());
  if (primitive < 0) return make_vec3(0, 0, 0);
  if (primitive >= triangles) return tables.quadrics[std::size_t(primitive - triangles)].center;
  const Triangle& t = tables.triangles[std::size_t(primitive)];
  return scale(add(t.p0, add(t.p1, t.p2)), 1.0f / 3);
}

void expect_bits(int a, int b, const std::string& what) { EXPECT_EQ(a, b) << what; }
void expect_bits(bool a, bool b, const std::string& what) { EXPECT_EQ(a, b) << what; }
void expect_bits(float a, float b, const std::string& what) {
  EXPECT_EQ(std::bit_cast<std::uint32_t>(a), std::bit_cast<std::uint32_t>(b)) << what;
}
void expect_bits(const vec3& a, const vec3& b, const std::string& what) {
  expect_bits(a.x, b.x, what);
  expect_bits(a.y, b.y, what);
  expect_bits(a.z, b.z, what);
}

void expect_same_surfaces(SceneTables& tables, RandomNumbers& random) {
  const int primitives = int(tables.triangles.size() + tables.quadrics.size());
  const Scene scene = tables.scene();
  constexpr int kFirst = LANES;  // not the first lanes of the block
  BlockMemory memory(FEATURE_ALL, 3 * LANES, 0);
  const PathState paths = memory.block().paths;
  for (int i = kFirst; i < kFirst + LANES; ++i) {
    const int hit = int(random.below(std::uint64_t(primitives + 1))) - 1;
    const vec3 origin = rounded(random.point(3));
    const Exact3 target = exact(middle_of(tables, hit)) + random.point(0.05);
    set_hit(&paths, i, hit);
    set_ray_origin(&paths, i, origin);
    set_ray_direction(&paths, i, rounded(normalize(target - exact(origin))));
  }
  Surfaces surfaces;
  find_surfaces(&scene, &paths, kFirst, &surfaces);
  for (int j = 0; j < LANES; ++j) {
    const int hit = get_hit(&paths, kFirst + j);
    const Surface s = load_surface(&surfaces, j);
    const Surface alone =
        surface_at(&scene, hit, get_ray_origin(&paths, kFirst + j), get_ray_direction(&paths, kFirst + j));
    ASSERT_EQ(is_hit(s), hit >= 0);
    ASSERT_EQ(s.material, alone.material);
    ASSERT_EQ(s.light, alone.light);
    if (hit < 0) {
      ASSERT_EQ(s.light, -1);
      continue;  // the rest means nothing
    }
#define CHECK_FIELD(_, type, name) \
  expect_bits(s.name, alone.name, #name " on primitive " + std::to_string(hit));
    SURFACE_HIT_FIELDS(CHECK_FIELD, _)
    if ((scene.header.features & FEATURE_UV) != 0) {
      SURFACE_UV_FIELDS(CHECK_FIELD, _)
    }
#undef CHECK_FIELD
  }
}

TEST(SurfaceLanes, AreThoseOfEachRayByItself) {
  RandomNumbers random(1);
  for (const bool with_normals : {false, true})
    for (const bool with_quadrics : {false, true})
      for (const bool with_uv : {false, true})
        for (int k = 0; k < 300 && !testing::Test::HasFailure(); ++k) {
          SceneTables tables = random_scene(random, with_normals, with_quadrics, with_uv);
          expect_same_surfaces(tables, random);
        }
}

TEST(SurfaceLanes, OfASceneWithoutTrianglesAreThoseOfItsQuadrics) {
  RandomNumbers random(2);
  for (int k = 0; k < 300 && !testing::Test::HasFailure(); ++k) {
    SceneTables tables = random_scene(random, false, true, false);
    tables.triangles.clear();
    if (k % 2 == 0) tables.header.features |= FEATURE_UV;
    expect_same_surfaces(tables, random);
  }
}

TEST(LaneRecord, StoresLoadsAndSelectsEveryField) {
  Surfaces lanes;
  Surface each[LANES];
  for (int j = 0; j < LANES; ++j) {
    int field = 0;
#define SET_FIELD(_, type, name) each[j].name = value_of<type>(field++, j);
    SURFACE_FIELDS(SET_FIELD, _)
#undef SET_FIELD
    store_surface(&lanes, j, each[j]);
  }
  for (int j = 0; j < LANES; ++j) {
    const Surface other = each[(j + 1) % LANES], loaded = load_surface(&lanes, j);
    const Surface yes = select_surface(true, each[j], other), no = select_surface(false, other, each[j]);
#define CHECK_FIELD(_, type, name)               \
  expect_bits(loaded.name, each[j].name, #name); \
  expect_bits(yes.name, each[j].name, #name);    \
  expect_bits(no.name, each[j].name, #name);
    SURFACE_FIELDS(CHECK_FIELD, _)
#undef CHECK_FIELD
  }
}

TEST(LaneRecord, StoresAPartAndLeavesTheRest) {
  Surfaces lanes;
  for (int j = 0; j < LANES; ++j) {
    Surface old, hit, uv;
    int field = 0;
#define SET_FIELD(_, type, name)                  \
  old.name = value_of<type>(field, j);            \
  hit.name = value_of<type>(field, j + LANES);    \
  uv.name = value_of<type>(field, j + 2 * LANES); \
  ++field;
    SURFACE_FIELDS(SET_FIELD, _)
#undef SET_FIELD
    store_surface(&lanes, j, old);
    store_surface_hit(&lanes, j, hit);
    const Surface first = load_surface(&lanes, j);
    store_surface_uv(&lanes, j, uv);
    const Surface both = load_surface(&lanes, j);
#define CHECK_FIELD(expected, type, name) expect_bits(first.name, (expected).name, #name);
    SURFACE_HIT_FIELDS(CHECK_FIELD, hit)
    SURFACE_UV_FIELDS(CHECK_FIELD, old)
#undef CHECK_FIELD
#define CHECK_FIELD(expected, type, name) expect_bits(both.name, (expected).name, #name);
    SURFACE_HIT_FIELDS(CHECK_FIELD, hit)
    SURFACE_UV_FIELDS(CHECK_FIELD, uv)
#undef CHECK_FIELD
  }
}

}  // namespace
}  // namespace penumbra
