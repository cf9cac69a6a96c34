#include "tests/kernels/scene_tables.h"

#include <array>
#include <map>
#include <stdexcept>

#include "scenes/device/hierarchy/bvh_builder.h"
#include "tests/kernels/kernels_under_test.h"

namespace penumbra {

void SceneTables::add_triangle(const vec3& a, const vec3& b, const vec3& c) {
  Triangle t{};
  t.p0 = a;
  t.p1 = b;
  t.p2 = c;
  t.light = t.normals = -1;
  triangles.push_back(t);
}

void SceneTables::add_sphere(const vec3& center, float radius, float orientation) {
  Quadric q{};
  q.kind = QUADRIC_SPHERE;
  q.center = center;
  q.radius = radius;
  q.orientation = orientation;
  q.normal = make_vec3(0, 0, 1);
  q.x_axis = make_vec3(1, 0, 0);
  q.y_axis = make_vec3(0, 1, 0);
  q.light = -1;
  quadrics.push_back(q);
}

void SceneTables::add_disk(const vec3& center, const vec3& normal, float radius) {
  Quadric q{};
  q.kind = QUADRIC_DISK;
  q.center = center;
  q.normal = normal;
  q.radius = radius;
  q.orientation = 1;
  q.x_axis = from_frame(normal, 1, 0, 0);
  q.y_axis = from_frame(normal, 0, 1, 0);
  q.light = -1;
  quadrics.push_back(q);
}

void SceneTables::index_corners() {
  std::map<std::array<float, 3>, int> index;
  const auto find = [&](const vec3& p) {
    const auto [at, added] = index.try_emplace({p.x, p.y, p.z}, int(vertices.size()));
    if (added) vertices.push_back(p);
    return at->second;
  };
  for (const Triangle& t : triangles) corners.push_back({find(t.p0), find(t.p1), find(t.p2)});
}

void SceneTables::build_hierarchy() {
  Expected<Hierarchy> hierarchy = penumbra::build_hierarchy(triangles, quadrics);
  if (!hierarchy) throw std::runtime_error(hierarchy.error().message);
  nodes = std::move(hierarchy->nodes);
  triangle_leaves = std::move(hierarchy->triangle_leaves);
  quadric_leaves = std::move(hierarchy->quadric_leaves);
}

Scene SceneTables::scene() {
  Scene s{};
  s.header = header;
#define POINT_TO_TABLE(_, name, record, least, what)  \
  static const std::array<record, least> no_##name{}; \
  s.header.tables.name.count = int(name.size());      \
  s.name = name.empty() ? no_##name.data() : name.data();
  SCENE_TABLES(POINT_TO_TABLE, _)
#undef POINT_TO_TABLE
  if (!normals.empty()) s.header.features |= FEATURE_SHADING_NORMALS;
  if (!quadrics.empty()) s.header.features |= FEATURE_QUADRICS;
  for (const Quadric& q : quadrics)
    if (q.kind == QUADRIC_CYLINDER) s.header.features |= FEATURE_CYLINDERS;
  if (!vertex_uvs.empty()) s.header.features |= FEATURE_UV;
  for (const Light& light : lights) s.header.light_kinds |= 1u << light.kind;
  for (const Material& material : materials)
    s.header.families |= (ulong{1} << material.family) & EVERY_FAMILY;
  return s;
}

std::vector<TestHit> trace_hierarchy(SceneTables& tables, std::span<const TestRay> rays, bool any) {
  const Scene scene = tables.scene();
  std::vector<TestHit> hits;
  hits.reserve(rays.size());
  for (const TestRay& ray : rays) {
    const Hit hit =
        (any ? occlude_bvh : intersect_bvh)(&scene, ray.origin, ray.direction, ray.tmax, ray.skip);
    hits.push_back({hit.primitive, hit.t});
  }
  return hits;
}

std::vector<TestHit> trace_one_by_one(SceneTables& tables, std::span<const TestRay> rays) {
  std::vector<TestHit> hits;
  hits.reserve(rays.size());
  for (const TestRay& ray : rays) {
    TestHit best{-1, ray.tmax};
    const Shear shear = make_shear(ray.direction);
    for (std::size_t k = 0; k < tables.triangles.size(); ++k) {
      const Triangle& t = tables.triangles[k];
      const TriangleHit h = intersect_sheared(shear_point(shear, sub(t.p0, ray.origin)),
                                              shear_point(shear, sub(t.p1, ray.origin)),
                                              shear_point(shear, sub(t.p2, ray.origin)));
      if (h.inside && h.t > 0 && h.t < best.t && int(k) != ray.skip) best = {int(k), h.t};
    }
    for (std::size_t k = 0; k < tables.quadrics.size(); ++k) {
      const float t = intersect_quadric(tables.quadrics[k], ray.origin, ray.direction);
      if (t > 0 && t < best.t) best = {int(tables.triangles.size() + k), t};
    }
    hits.push_back(best);
  }
  return hits;
}

}  // namespace penumbra
