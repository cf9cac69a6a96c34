#include "tests/kernels/scene_tables.h"

#include <array>
#include <map>
#include <stdexcept>

#include "scenes/device/bvh_builder.h"
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
  s.header.triangle_count = int(triangles.size());
  s.header.normals_count = int(normals.size());
  s.header.quadric_count = int(quadrics.size());
  s.header.material_count = int(materials.size());
  s.header.light_count = int(lights.size());
  for (const Light& light : lights) s.header.light_kinds |= 1u << light.kind;
  s.header.vertex_count = int(vertices.size());
  s.header.corner_count = int(corners.size());
  s.header.node_count = int(nodes.size());
  s.header.triangle_leaf_count = int(triangle_leaves.size());
  s.header.quadric_leaf_count = int(quadric_leaves.size());
  // Kernels read record 0 of these whatever they hit.
  static const Triangle no_triangle{};
  static const VertexNormals no_normals{};
  static const Quadric no_quadric{};
  static const Material no_material{};
  static const Light no_light{};
  s.triangles = triangles.empty() ? &no_triangle : triangles.data();
  s.normals = normals.empty() ? &no_normals : normals.data();
  s.quadrics = quadrics.empty() ? &no_quadric : quadrics.data();
  s.materials = materials.empty() ? &no_material : materials.data();
  s.lights = lights.empty() ? &no_light : lights.data();
  s.vertices = vertices.data();
  s.corners = corners.data();
  s.nodes = nodes.data();
  s.triangle_leaves = triangle_leaves.data();
  s.quadric_leaves = quadric_leaves.data();
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
