// A kernel scene built table by table, in unchanged coordinates: like the scene builder's, without its
// recentring and its choices.
#pragma once

#include <span>
#include <vector>

#include "kernels/scene.h"
#include "scenes/device/scene_records.h"
#include "tests/kernels/exact_vector.h"

namespace penumbra {

struct SceneTables : SceneRecords {
  SceneHeader header{};

  /// A triangle of material 0 on both sides that emits nothing.
  void add_triangle(const vec3& a, const vec3& b, const vec3& c);
  void add_sphere(const vec3& center, float radius, float orientation = 1);
  void add_disk(const vec3& center, const vec3& normal, float radius);

  /// The distinct vertices, for tests of every triangle.
  void index_corners();
  /// The hierarchy over everything so far. Throws std::runtime_error.
  void build_hierarchy();

  /// Pointers into the tables; counts as the tables' sizes; the header names what is in them besides what it
  /// names already. Valid until a table changes.
  Scene scene();
};

struct TestRay {
  vec3 origin, direction;
  float tmax = 1e30f;
  int skip = -1;
};

struct TestHit {
  int primitive = -1;
  float t = 0;
};

/// Every ray against every primitive, by the lanes of intersect_brute_force.
std::vector<TestHit> trace_whole(SceneTables& tables, std::span<const TestRay> rays);
/// How many triangles LANES rays are tested against; negative: all.
int count_listed(SceneTables& tables, std::span<const TestRay> rays);

/// Through the hierarchy; with `any` some hit.
std::vector<TestHit> trace_hierarchy(SceneTables& tables, std::span<const TestRay> rays, bool any = false);

/// The same of many interleaved rays: the primitives alone, or -1; with `any` 0 for some.
std::vector<int> trace_in_flight(SceneTables& tables, std::span<const TestRay> rays, bool any = false);

/// Every ray against every primitive one by one; of equal distances the smallest primitive.
std::vector<TestHit> trace_one_by_one(SceneTables& tables, std::span<const TestRay> rays);

}  // namespace penumbra
