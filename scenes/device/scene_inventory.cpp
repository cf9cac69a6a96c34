#include "scenes/device/scene_inventory.h"

#include <array>
#include <set>

#include "kernels/block/path_state.h"
#include "kernels/features.h"
#include "kernels/host/device_scene_tables.h"
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
#define LIST_FAMILY(name, NAME, number, properties, description) {1u << (number), "BSDF_" #NAME, description},
constexpr Named kFamilies[] = {BSDF_FAMILIES(LIST_FAMILY)};
#define LIST_LIGHT_KIND(name, NAME, number, ways, description) {1u << (number), "LIGHT_" #NAME, description},
constexpr Named kLightKinds[] = {LIGHT_KINDS(LIST_LIGHT_KIND)};

constexpr int kUnknown = -1;

/// Counts of both search structures over the scene's primitives; what cannot be built is unknown.
void count_search(const DeviceScene& scene, TableSpans& all) {
  const auto triangles = table<Triangle>(scene, scene.header.tables.triangles);
  const auto quadrics = table<Quadric>(scene, scene.header.tables.quadrics);
  if (triangles.empty() && quadrics.empty()) return;
  std::set<std::array<float, 3>> vertices;
  for (const Triangle& t : triangles)
    for (const vec3& p : {t.p0, t.p1, t.p2}) vertices.insert({p.x, p.y, p.z});
  all.vertices.count = int(vertices.size());
  all.corners.count = int(triangles.size());
  const auto groups = table<PrimitiveGroup>(scene, scene.header.tables.groups);
  const PrimitiveGroup whole{0, 0, int(triangles.size()), 0, int(quadrics.size())};
  const Expected<Hierarchy> hierarchy =
      build_hierarchy(triangles, quadrics, groups.empty() ? std::span(&whole, 1) : groups,
                      table<Instance>(scene, scene.header.tables.instances));
  all.nodes.count = hierarchy ? int(hierarchy->nodes.size()) : kUnknown;
  all.triangle_leaves.count = hierarchy ? int(hierarchy->triangle_leaves.size()) : kUnknown;
  all.quadric_leaves.count = hierarchy ? int(hierarchy->quadric_leaves.size()) : kUnknown;
}

/// Counts of the outlines of all mesh lights.
void count_polygons(SceneDescription description, TableSpans& all) {
  description.integrator = {.method = PolygonAnalyticIntegrator{}};
  const auto built = build_device_scene(description, {.intersector = IntersectorChoice::kEmbree});
  all.polygons.count = built ? built->header.tables.polygons.count : kUnknown;
  all.polygon_corners.count = built ? built->header.tables.polygon_corners.count : kUnknown;
}

/// The tables' counts with everything.
TableSpans count_everything(const SceneDescription& description, const DeviceScene& scene, bool thorough) {
  TableSpans all = scene.header.tables;
  all.normals.count = all.vertex_uvs.count = all.triangles.count;
  all.light_triangles.count = all.lights.count;
  if (thorough || std::int64_t(all.triangles.count) + all.quadrics.count <= kQuicklyBuilt) {
    count_search(scene, all);
    count_polygons(description, all);
  } else {
    for (TableSpan TableSpans::*built :
         {&TableSpans::vertices, &TableSpans::corners, &TableSpans::nodes, &TableSpans::triangle_leaves,
          &TableSpans::quadric_leaves, &TableSpans::polygons, &TableSpans::polygon_corners})
      (all.*built).count = kUnknown;
  }
  return all;
}

std::uint64_t path_bytes(std::uint32_t features) {
  return 4 * std::uint64_t(path_words(features) + slot_words(features));
}

}  // namespace

SceneInventory take_inventory(const SceneDescription& description, const DeviceScene& scene, bool thorough) {
  const SceneHeader& h = scene.header;
  SceneInventory inventory;
  inventory.features = h.features;
  for (const Named& feature : kFeatures)
    inventory.feature_uses.push_back({feature.name, feature.description, (h.features & feature.bit) != 0u});
  for (const Named& family : kFamilies)
    inventory.feature_uses.push_back({family.name, family.description, (h.families & family.bit) != 0u});
  for (const Named& kind : kLightKinds)
    inventory.feature_uses.push_back({kind.name, kind.description, (h.light_kinds & kind.bit) != 0u});

  const TableSpans all = count_everything(description, scene, thorough);
  for (const SceneTable& each : kSceneTables) {
    const bool known = (all.*each.span).count != kUnknown;
    inventory.tables.push_back(
        {each.what, {each.bytes(h.tables), known ? std::optional(each.bytes(all)) : std::nullopt}});
  }

  // Header and alignment are the same with everything.
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
