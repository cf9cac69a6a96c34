#include "scenes/device/scene_inventory.h"

#include <array>
#include <set>

#include "kernels/block/path_state.h"
#include "kernels/features.h"
#include "kernels/host/device_scene_check.h"
#include "kernels/host/sample_buffer.h"
#include "scenes/device/bvh_builder.h"
#include "scenes/device/device_scene_builder.h"

namespace penumbra {
namespace {

constexpr int kQuicklyBuilt = 1 << 16;

struct Named {
  std::uint32_t bit;
  const char *name, *description;
};
#define LIST_FEATURE(name, bit, description) {bit, #name, description},
constexpr Named kFeatures[] = {PENUMBRA_FEATURES(LIST_FEATURE)};

template <typename T>
std::uint64_t bytes_of(int records) {
  return std::uint64_t(records) * sizeof(T);
}

/// What both search structures over the scene's primitives take.
struct SearchBytes {
  std::uint64_t vertices = 0, corners = 0, nodes = 0, triangle_leaves = 0, quadric_leaves = 0;
};

std::optional<SearchBytes> search_bytes(const DeviceScene& scene) {
  const SceneHeader& h = scene.header;
  const auto triangles = table<Triangle>(scene, h.triangles, h.triangle_count);
  const auto quadrics = table<Quadric>(scene, h.quadrics, h.quadric_count);
  SearchBytes bytes;
  if (triangles.empty() && quadrics.empty()) return bytes;
  std::set<std::array<float, 3>> vertices;
  for (const Triangle& t : triangles)
    for (const vec3& p : {t.p0, t.p1, t.p2}) vertices.insert({p.x, p.y, p.z});
  bytes.vertices = vertices.size() * sizeof(vec3);
  bytes.corners = triangles.size() * sizeof(Corner);
  const Expected<Hierarchy> hierarchy = build_hierarchy(triangles, quadrics);
  if (!hierarchy) return std::nullopt;
  bytes.nodes = hierarchy->nodes.size() * sizeof(BvhNode);
  bytes.triangle_leaves = hierarchy->triangle_leaves.size() * sizeof(TriangleLeaf);
  bytes.quadric_leaves = hierarchy->quadric_leaves.size() * sizeof(QuadricLeaf);
  return bytes;
}

/// The scene with the closed forms of its polygon lights.
std::optional<SceneHeader> with_polygons(SceneDescription description) {
  description.integrator = {.method = PolygonAnalyticIntegrator{}};
  const auto built = build_device_scene(description, {.intersector = IntersectorChoice::kEmbree});
  return built ? std::optional(built->header) : std::nullopt;
}

std::uint64_t path_bytes(std::uint32_t features) {
  return sizeof(float) * std::uint64_t(state_floats(features) + slot_floats(features)) +
         sizeof(int) * STATE_INTS;
}

}  // namespace

std::uint32_t every_feature(const SceneHeader& header) {
  return header.intersector == INTERSECTOR_EMBREE
             ? FEATURE_ALL
             : (FEATURE_ALL & ~FEATURE_BVH) | (header.features & FEATURE_BVH);
}

SceneInventory take_inventory(const SceneDescription& description, const DeviceScene& scene, bool thorough) {
  const SceneHeader& h = scene.header;
  SceneInventory inventory;
  inventory.features = h.features;
  for (const Named& feature : kFeatures)
    inventory.feature_uses.push_back({feature.name, feature.description, (h.features & feature.bit) != 0u});

  const bool build = thorough || std::int64_t(h.triangle_count) + h.quadric_count <= kQuicklyBuilt;
  const std::optional<SearchBytes> search = build ? search_bytes(scene) : std::nullopt;
  const std::optional<SceneHeader> polygons = build ? with_polygons(description) : std::nullopt;
  const auto of_search = [&](std::uint64_t SearchBytes::*member) {
    return search ? std::optional((*search).*member) : std::nullopt;
  };
  const auto add = [&](const char* name, std::uint64_t own, std::optional<std::uint64_t> everything) {
    inventory.tables.push_back({name, {own, everything}});
  };
  const auto same = [&](const char* name, std::uint64_t own) { add(name, own, own); };
  same("triangles", bytes_of<Triangle>(h.triangle_count));
  add("vertex normals", bytes_of<VertexNormals>(h.normals_count), bytes_of<VertexNormals>(h.triangle_count));
  same("spheres and disks", bytes_of<Quadric>(h.quadric_count));
  same("materials", bytes_of<Material>(h.material_count));
  same("lights", bytes_of<Light>(h.light_count));
  const auto of_polygons = [&](auto bytes) {
    return polygons ? std::optional<std::uint64_t>(bytes(*polygons)) : std::nullopt;
  };
  add("polygon lights", bytes_of<Polygon>(h.polygon_count),
      of_polygons([](const SceneHeader& p) { return bytes_of<Polygon>(p.polygon_count); }));
  add("their corners", bytes_of<PolygonCorner>(h.polygon_corner_count),
      of_polygons([](const SceneHeader& p) { return bytes_of<PolygonCorner>(p.polygon_corner_count); }));
  add("vertices, to test every primitive", bytes_of<vec3>(h.vertex_count), of_search(&SearchBytes::vertices));
  add("corners, to test every primitive", bytes_of<Corner>(h.corner_count), of_search(&SearchBytes::corners));
  add("nodes of the hierarchy", bytes_of<BvhNode>(h.node_count), of_search(&SearchBytes::nodes));
  add("leaves of triangles", bytes_of<TriangleLeaf>(h.triangle_leaf_count),
      of_search(&SearchBytes::triangle_leaves));
  add("leaves of spheres and disks", bytes_of<QuadricLeaf>(h.quadric_leaf_count),
      of_search(&SearchBytes::quadric_leaves));

  // Header, filter table and alignment are the same with everything.
  inventory.device_scene.own = sizeof h + scene.words.size() * sizeof(std::uint32_t);
  inventory.device_scene.everything = inventory.device_scene.own;
  for (const TableCost& t : inventory.tables) {
    std::optional<std::uint64_t>& sum = inventory.device_scene.everything;
    sum = sum && t.bytes.everything ? std::optional(*sum - t.bytes.own + *t.bytes.everything) : std::nullopt;
  }
  inventory.path_state = {path_bytes(h.features), path_bytes(FEATURE_ALL)};
  inventory.result = {sizeof(float) * std::uint64_t(plane_count(h.features)),
                      sizeof(float) * std::uint64_t(plane_count(FEATURE_ALL))};
  return inventory;
}

}  // namespace penumbra
