// Instances of groups against the transformed geometry in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scenes/device/hierarchy/bvh_builder.h"
#include "scenes/transform.h"
#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra::instance_test {
namespace {

using glm::dmat4;
using glm::dvec3;

dvec3 wide(const vec3& v) { return {v.x, v.y, v.z}; }
vec3 narrow(const dvec3& v) { return make_vec3(float(v.x), float(v.y), float(v.z)); }

Instance instance_of(const dmat4& to_world, int group) {
  const glm::dmat3 rows = glm::transpose(glm::inverse(glm::dmat3(to_world)));
  Instance i{};
  i.x = narrow(dvec3(to_world[0]));
  i.y = narrow(dvec3(to_world[1]));
  i.z = narrow(dvec3(to_world[2]));
  i.at = narrow(dvec3(to_world[3]));
  i.row_x = narrow(rows[0]);
  i.row_y = narrow(rows[1]);
  i.row_z = narrow(rows[2]);
  i.group = group;
  return i;
}

/// What the kernels see of it: numbers of single precision.
dmat4 rounded_transform(const Instance& i) {
  dmat4 m(1.0);
  m[0] = {wide(i.x), 0};
  m[1] = {wide(i.y), 0};
  m[2] = {wide(i.z), 0};
  m[3] = {wide(i.at), 1};
  return m;
}

enum class Places { kRigid, kStretched, kMirrored };

dmat4 random_transform(RandomNumbers& random, Places places) {
  const auto number = [&] { return random.between(-1, 1); };
  dmat4 m = translation({4 * number(), 4 * number(), 4 * number()}) *
            rotation(dvec3(number(), number(), number() + 2), 360 * random.uniform());
  if (places != Places::kRigid) {
    dvec3 factors(std::exp2(2 * number()), std::exp2(2 * number()), std::exp2(2 * number()));
    if (places == Places::kMirrored) factors.y = -factors.y;
    m = m * scaling(factors) * rotation(dvec3(1, number(), 0), 360 * random.uniform());
  }
  return m;
}

struct Room {
  SceneTables tables;
  std::vector<dmat4> transforms;  ///< of the instances
  int own_triangles = 0;

  [[nodiscard]] bool is_triangle(int primitive) const { return primitive < int(tables.triangles.size()); }
};

/// Triangles of the scene's own, and two groups, of triangles alone and with spheres and disks.
Room make_room(std::uint64_t seed, Places places, int instances, int own = 30) {
  Room room;
  RandomNumbers random(seed);
  const auto corner = [&](double reach) {
    return make_vec3(float(reach * random.between(-1, 1)), float(reach * random.between(-1, 1)),
                     float(reach * random.between(-1, 1)));
  };
  SceneTables& t = room.tables;
  const auto add_triangles = [&](int count, double reach, double size) {
    for (int i = 0; i < count; ++i) {
      const vec3 a = corner(reach);
      t.add_triangle(a, add(a, corner(size)), add(a, corner(size)));
      const Triangle& last = t.triangles.back();
      const vec3 n = normalize3(cross3(sub(last.p1, last.p0), sub(last.p2, last.p0)));
      t.triangles.back().normals = int(t.normals.size());
      const auto bent = [&] { return normalize3(add(n, scale(corner(1), 0.1f))); };
      t.normals.push_back({bent(), bent(), bent()});
      t.vertex_uvs.push_back({0, 0, 1, float(random.uniform()), 0.2f, 1});
    }
  };
  add_triangles(own, 4, 1);
  room.own_triangles = own;
  t.groups.push_back({0, 0, own, 0, 0});
  for (int g = 0; g < 2; ++g) {
    const int triangle = int(t.triangles.size()), quadric = int(t.quadrics.size());
    add_triangles(60, 1, 0.6);
    for (int i = 0; i < 4 * g; ++i) {
      t.add_sphere(corner(1), float(random.between(0.05, 0.3)));
      t.add_disk(corner(1), normalize3(corner(1)), float(random.between(0.05, 0.4)));
    }
    t.groups.push_back(
        {0, triangle, int(t.triangles.size()) - triangle, quadric, int(t.quadrics.size()) - quadric});
  }
  for (int i = 0; i < instances; ++i) {
    t.instances.push_back(instance_of(random_transform(random, places), 1 + i % 2));
    room.transforms.push_back(rounded_transform(t.instances.back()));
  }
  t.header.features |= FEATURE_INSTANCES;
  t.materials.resize(1);
  const auto hierarchy = build_hierarchy(t.triangles, t.quadrics, t.groups, t.instances);
  if (!hierarchy) throw std::runtime_error(hierarchy.error().message);
  t.nodes = hierarchy->nodes;
  t.triangle_leaves = hierarchy->triangle_leaves;
  t.quadric_leaves = hierarchy->quadric_leaves;
  for (std::size_t g = 0; g < t.groups.size(); ++g) t.groups[g].root = hierarchy->roots[g];
  return room;
}

struct Found {
  int primitive = -1, instance = -1;
  double t = 1e30;
  double margin = 1;  ///< of its barycentric coordinates, or of what stands for them, to the rim
};

void meet(const Room& room, int primitive, int instance, const dvec3& o, const dvec3& d, Found& best,
          double& second) {
  const dmat4 m = instance < 0 ? dmat4(1.0) : room.transforms[std::size_t(instance)];
  double t = -1, margin = -1;
  if (room.is_triangle(primitive)) {
    const Triangle& at = room.tables.triangles[std::size_t(primitive)];
    const dvec3 a = transform_point(m, wide(at.p0)), e = transform_point(m, wide(at.p1)) - a,
                f = transform_point(m, wide(at.p2)) - a, n = glm::cross(e, f);
    t = glm::dot(a - o, n) / glm::dot(d, n);
    const dvec3 p = o + t * d - a;
    const double v = glm::dot(glm::cross(p, f), n) / glm::dot(n, n),
                 w = glm::dot(glm::cross(e, p), n) / glm::dot(n, n);
    margin = std::min({v, w, 1 - v - w});
  } else {
    const Quadric& q = room.tables.quadrics[std::size_t(primitive) - room.tables.triangles.size()];
    const dmat4 back = glm::inverse(m);
    const dvec3 from = transform_point(back, o) - wide(q.center), along = transform_vector(back, d);
    if (q.kind == QUADRIC_SPHERE) {
      const double a = glm::dot(along, along), b = glm::dot(along, from),
                   c = glm::dot(from, from) - double(q.radius) * q.radius, disc = b * b - a * c;
      margin = disc / (a * q.radius * q.radius);
      if (disc > 0)
        t = (-b - std::sqrt(disc)) / a > 0 ? (-b - std::sqrt(disc)) / a : (-b + std::sqrt(disc)) / a;
    } else {
      t = -glm::dot(from, wide(q.normal)) / glm::dot(along, wide(q.normal));
      margin = 1 - glm::length(from + t * along) / q.radius;
    }
  }
  if (!(margin > -1e-4) || !(t > 0)) return;
  if (std::abs(margin) < 1e-4) second = std::min(second, t);  // in doubt: it may be hit or not
  if (margin <= 0) return;
  if (t < best.t) {
    second = std::min(second, best.t);
    best = {primitive, instance, t, margin};
  } else {
    second = std::min(second, t);
  }
}

/// The nearest of all in double precision; nothing where single precision may find another.
std::optional<Found> nearest(const Room& room, const vec3& origin, const vec3& direction) {
  Found best;
  double second = 1e30;
  const dvec3 o = wide(origin), d = wide(direction);
  for (int k = 0; k < room.own_triangles; ++k) meet(room, k, -1, o, d, best, second);
  for (int i = 0; i < int(room.transforms.size()); ++i) {
    const PrimitiveGroup& g = room.tables.groups[std::size_t(room.tables.instances[std::size_t(i)].group)];
    for (int k = 0; k < g.triangle_count; ++k) meet(room, g.first_triangle + k, i, o, d, best, second);
    for (int k = 0; k < g.quadric_count; ++k)
      meet(room, int(room.tables.triangles.size()) + g.first_quadric + k, i, o, d, best, second);
  }
  if (second < (best.primitive < 0 ? 1e30 : best.t * (1 + 1e-4))) return std::nullopt;
  return best;
}

vec3 random_direction(RandomNumbers& random) {
  return sample_uniform_sphere(random.unit_float(), random.unit_float());
}

/// A ray from somewhere in the room, and what it hits.
struct Shot {
  vec3 o, d;
  Hit hit;
};
Shot shot(const Scene& scene, RandomNumbers& random) {
  const vec3 o = scale(random_direction(random), float(10 * random.uniform()));
  const vec3 d = random_direction(random);
  return {o, d, intersect_levels(&scene, o, d, 1e30f, -1, -1, true)};
}

class Instances : public testing::TestWithParam<Places> {};

TEST_P(Instances, AreHitWhereTheirGeometryIs) {
  int hits = 0, misses = 0, in_doubt = 0, mixed = 0;
  for (const int own : {30, 0}) {
    Room room = make_room(11, GetParam(), 40, own);
    const Scene scene = room.tables.scene();
    RandomNumbers random(12);
    for (int i = 0; i < 4000; ++i) {
      const auto [o, d, hit] = shot(scene, random);
      const auto truth = nearest(room, o, d);
      const Hit any = occlude_levels(&scene, o, d, 1e30f, -1, -1, true);
      if (!truth) {
        ++in_doubt;
        continue;
      }
      ASSERT_EQ(hit.primitive, truth->primitive) << "ray " << i;
      ASSERT_EQ(any.primitive >= 0, truth->primitive >= 0);
      if (truth->primitive < 0) {
        ++misses;
        continue;
      }
      ++hits;
      mixed += truth->instance >= 0 ? 1 : 0;
      ASSERT_EQ(hit.instance, truth->instance) << "ray " << i;
      ASSERT_NEAR(hit.t, truth->t, 1e-4 * (1 + truth->t));
    }
  }
  EXPECT_GT(hits, 2000);
  EXPECT_GT(mixed, 1000);
  EXPECT_GT(misses, 100);
  EXPECT_LT(in_doubt, 400);
}

TEST_P(Instances, SurfacesAreThoseOfTheirGeometryInTheScene) {
  Room room = make_room(21, GetParam(), 40);
  const Scene scene = room.tables.scene();
  RandomNumbers random(22);
  int triangles = 0, quadrics = 0;
  for (int i = 0; i < 6000; ++i) {
    const auto [o, d, hit] = shot(scene, random);
    if (hit.primitive < 0 || hit.instance < 0) continue;
    const Surface s = surface_at_instance(&scene, hit.primitive, hit.instance, o, d);
    const dmat4& m = room.transforms[std::size_t(hit.instance)];
    const dvec3 p = wide(s.p), n = wide(s.geometric);
    EXPECT_EQ(s.instance, hit.instance);
    ASSERT_NEAR(glm::length(n), 1, 1e-5);
    ASSERT_LT(glm::dot(n, wide(d)), 0);
    ASSERT_NEAR(glm::dot(wide(s.tangent), wide(s.shading)), 0, 0.6) << "about the same normal";
    ASSERT_LT(s.error, 1e-3f);
    if (room.is_triangle(hit.primitive)) {
      ++triangles;
      const Triangle& t = room.tables.triangles[std::size_t(hit.primitive)];
      const dvec3 a = transform_point(m, wide(t.p0)), e = transform_point(m, wide(t.p1)) - a,
                  f = transform_point(m, wide(t.p2)) - a;
      dvec3 normal = glm::normalize(glm::cross(e, f));
      if (is_mirror(m)) normal = -normal;  // the front follows the transformed normal
      ASSERT_LE(std::abs(glm::dot(p - a, normal)), s.error) << "off its plane";
      ASSERT_EQ(s.front, glm::dot(normal, wide(d)) < 0);
      ASSERT_LT(glm::length(n - (s.front ? normal : -normal)), 1e-4);
      // Barycentric coordinates, and from them normals and texture coordinates, are those of the group.
      const dvec3 cross = glm::cross(e, f), q = p - a;
      const double v = glm::dot(glm::cross(q, f), cross) / glm::dot(cross, cross),
                   w = glm::dot(glm::cross(e, q), cross) / glm::dot(cross, cross);
      const VertexNormals& at = room.tables.normals[std::size_t(t.normals)];
      const dvec3 blend = (1 - v - w) * wide(at.n0) + v * wide(at.n1) + w * wide(at.n2);
      const dvec3 shading = glm::normalize(normal_matrix(m) * blend) * (s.front ? 1.0 : -1.0);
      if (glm::dot(shading, wide(d)) < -1e-3 && glm::dot(shading, n) > 1e-3)
        ASSERT_LT(glm::length(wide(s.shading) - shading), 2e-3);
      const VertexUvs& uv = room.tables.vertex_uvs[std::size_t(hit.primitive)];
      ASSERT_NEAR(s.u, (1 - v - w) * uv.u0 + v * uv.u1 + w * uv.u2, 1e-3);
      ASSERT_NEAR(s.v, (1 - v - w) * uv.v0 + v * uv.v1 + w * uv.v2, 1e-3);
      const double det = double(uv.u1 - uv.u0) * (uv.v2 - uv.v0) - double(uv.v1 - uv.v0) * (uv.u2 - uv.u0);
      const dvec3 du = (double(uv.v2 - uv.v0) * e - double(uv.v1 - uv.v0) * f) / det;
      ASSERT_GT(glm::dot(glm::normalize(du), wide(s.tangent)), 1 - 1e-4);
    } else {
      ++quadrics;
      const Quadric& q = room.tables.quadrics[std::size_t(hit.primitive) - room.tables.triangles.size()];
      const dvec3 from = transform_point(glm::inverse(m), p) - wide(q.center);
      const bool sphere = q.kind == QUADRIC_SPHERE;
      const double off = sphere ? glm::length(from) - q.radius : glm::dot(from, wide(q.normal));
      const dvec3 outward = sphere ? glm::normalize(from) : wide(q.normal);
      const dvec3 normal = normal_matrix(m) * outward;
      // The distance along the scene's normal: by how much the group's function grows along it.
      const double slope = glm::length(glm::transpose(glm::inverse(glm::dmat3(m))) * outward);
      ASSERT_LE(std::abs(off) / slope, s.error);
      ASSERT_GT(std::abs(glm::dot(glm::normalize(normal), n)), 1 - 1e-5);
    }
  }
  EXPECT_GT(triangles, 1000);
  EXPECT_GT(quadrics, 100);
}

/// A ray skips the triangle that it starts on in its own instance, and meets it in others.
TEST_P(Instances, RaysSkipOnlyWhereTheyStart) {
  Room room = make_room(31, GetParam(), 40);
  const Scene scene = room.tables.scene();
  RandomNumbers random(32);
  int started = 0, others = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto [o, d, hit] = shot(scene, random);
    if (hit.primitive < 0 || !room.is_triangle(hit.primitive)) continue;
    ++started;
    const Hit next = intersect_levels(&scene, o, d, 1e30f, hit.primitive, hit.instance, true);
    ASSERT_TRUE(next.primitive != hit.primitive || next.instance != hit.instance);
    ASSERT_GE(next.t, hit.t);
    const Hit elsewhere = intersect_levels(&scene, o, d, 1e30f, hit.primitive, hit.instance + 2, true);
    ASSERT_EQ(elsewhere.primitive, hit.primitive);
    ASSERT_EQ(elsewhere.instance, hit.instance);
    others += next.primitive == hit.primitive ? 1 : 0;
    const Hit blocked = occlude_levels(&scene, o, d, hit.t * 1.0001f, hit.primitive, hit.instance, true);
    if (next.t > hit.t * 1.001f) {
      ASSERT_LT(blocked.primitive, 0);
    }
  }
  EXPECT_GT(started, 5000);
  EXPECT_GT(others, 0) << "the same triangle of another instance";
}

std::string places_name(const testing::TestParamInfo<Places>& tested) {
  constexpr const char* kNames[] = {"Rigid", "Stretched", "Mirrored"};
  return kNames[int(tested.param)];
}
INSTANTIATE_TEST_SUITE_P(All, Instances,
                         testing::Values(Places::kRigid, Places::kStretched, Places::kMirrored), places_name);

/// Closed meshes stay closed, whatever the transform: rays from inside an instance to its edges and vertices.
TEST(InstanceLeaks, NoneThroughSharedEdges) {
  SceneTables t;
  const auto corner = [](int k) {
    return make_vec3((k & 1) != 0 ? 1.0f : -1.0f, (k & 2) != 0 ? 1.0f : -1.0f, (k & 4) != 0 ? 1.0f : -1.0f);
  };
  constexpr int kFaces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  for (const auto& f : kFaces) {
    t.add_triangle(corner(f[0]), corner(f[1]), corner(f[2]));
    t.add_triangle(corner(f[0]), corner(f[2]), corner(f[3]));
  }
  t.groups = {{0, 0, 0, 0, 0}, {0, 0, 12, 0, 0}};
  t.materials.resize(1);
  RandomNumbers random(41);
  for (int i = 0; i < 200; ++i) {
    const dmat4 m = random_transform(random, Places(i % 3));
    t.instances = {instance_of(m, 1)};
    const auto hierarchy = build_hierarchy(t.triangles, t.quadrics, t.groups, t.instances);
    ASSERT_TRUE(hierarchy);
    t.nodes = hierarchy->nodes;
    t.triangle_leaves = hierarchy->triangle_leaves;
    for (std::size_t g = 0; g < 2; ++g) t.groups[g].root = hierarchy->roots[g];
    const Scene scene = t.scene();
    for (int k = 0; k < 500; ++k) {
      const dvec3 inside = transform_point(
          m, {random.between(-0.9, 0.9), random.between(-0.9, 0.9), random.between(-0.9, 0.9)});
      const double s = random.uniform();
      const auto& f = kFaces[k % 6];
      const dvec3 a = wide(corner(f[k % 3])), b = wide(corner(f[k % 3 + 1]));
      const dvec3 rim = transform_point(m, k % 7 == 0 ? a : a + s * (b - a));
      const vec3 o = narrow(inside), d = normalize3(narrow(rim - inside));
      ASSERT_GE(intersect_levels(&scene, o, d, 1e30f, -1, -1, true).primitive, 0) << i << " " << k;
      ASSERT_GE(occlude_levels(&scene, o, d, 1e30f, -1, -1, true).primitive, 0) << i << " " << k;
    }
  }
}

}  // namespace
}  // namespace penumbra::instance_test
