#include "scenes/device/scene_inventory.h"

#include <xxhash.h>

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "kernels/block/path_state.h"
#include "kernels/features.h"
#include "kernels/host/device_scene.h"
#include "kernels/host/sample_buffer.h"
#include "scenes/device/device_scene_builder.h"
#include "scenes/device/hierarchy/bvh_builder.h"

namespace penumbra {
namespace {

constexpr int kQuicklyBuilt = 1 << 16;

#define LIST_LIGHT_KIND(name, NAME, number, ways, description) {1u << (number), "LIGHT_" #NAME, description},
constexpr NamedBit kLightKinds[] = {LIGHT_KINDS(LIST_LIGHT_KIND)};

constexpr int kUnknown = -1;

/// The number of distinct vertices, counted with an open-addressing hash table of triangle corners.
std::size_t distinct_vertices(std::span<const Triangle> triangles) {
  const std::size_t corners = triangles.size() * 3;
  const auto vertex = [&](std::size_t corner) {
    const Triangle& t = triangles[corner / 3];
    const vec3& p = corner % 3 == 0 ? t.p0 : corner % 3 == 1 ? t.p1 : t.p2;
    return std::array<float, 3>{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};  // both zeros become equal
  };
  constexpr std::uint32_t kFree = ~std::uint32_t{0};
  std::size_t count = 0;
  std::vector<std::uint32_t> slots(64, kFree);
  // The slot of that corner, or the empty one for it.
  const auto slot_of = [&](const std::array<float, 3>& p) -> std::uint32_t& {
    std::size_t at = XXH3_64bits(p.data(), sizeof p) & (slots.size() - 1);
    while (slots[at] != kFree && vertex(slots[at]) != p) at = (at + 1) & (slots.size() - 1);
    return slots[at];
  };
  for (std::size_t corner = 0; corner < corners; ++corner) {
    std::uint32_t& slot = slot_of(vertex(corner));
    if (slot != kFree) continue;
    slot = std::uint32_t(corner);
    if (++count * 2 <= slots.size()) continue;
    const std::vector<std::uint32_t> full = std::exchange(slots, std::vector(slots.size() * 2, kFree));
    for (const std::uint32_t each : full)
      if (each != kFree) slot_of(vertex(each)) = each;
  }
  return count;
}

/// The sizes of both acceleration structures over the scene's primitives. Unknown if one cannot be built.
void count_search(const DeviceScene& scene, TableSpans& all) {
  const auto triangles = table<Triangle>(scene, scene.header.tables.triangles);
  const auto quadrics = table<Quadric>(scene, scene.header.tables.quadrics);
  if (triangles.empty() && quadrics.empty()) return;
  all.vertices.count = int(distinct_vertices(triangles));
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

/// The sizes of the outlines of all mesh lights.
void count_polygons(const SceneDescription& description, TableSpans& all) {
  SceneDescription lights = polygon_lights_of(description);
  lights.integrator = {.method = PolygonAnalyticIntegrator{}};
  const auto built = build_device_scene(lights, {.intersector = IntersectorChoice::kEmbree});
  all.polygons.count = built ? built->header.tables.polygons.count : kUnknown;
  all.polygon_corners.count = built ? built->header.tables.polygon_corners.count : kUnknown;
}

/// The sizes of all tables with every feature.
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

std::uint64_t path_bytes(std::uint64_t features) {
  return 4 * std::uint64_t(path_words(features) + slot_words(features));
}

}  // namespace

SceneDescription polygon_lights_of(const SceneDescription& description) {
  SceneDescription lights;
  static_cast<RenderSettings&>(lights) = description;
  lights.source = description.source;
  lights.files = description.files;
  lights.contents_hash = description.contents_hash;
  lights.warnings = description.warnings;
  lights.instances = description.instances;
  const auto copy = [](const std::vector<Shape>& from, std::vector<Shape>& to) {
    for (const Shape& shape : from) {
      if (!shape.radiance || shape.radiance_texture != kNoTexture) continue;
      if (!std::holds_alternative<Mesh>(shape.geometry)) continue;
      to.push_back(shape);
      to.back().front_bsdf = to.back().back_bsdf = kBlackBsdf;
      to.back().interior = to.back().exterior = kNoMedium;
    }
  };
  copy(description.shapes, lights.shapes);
  for (const ShapeGroup& group : description.groups) {
    lights.groups.push_back({group.name, {}, group.instances});
    copy(group.shapes, lights.groups.back().shapes);
  }
  return lights;
}

SceneInventory take_inventory(const SceneDescription& description, const DeviceScene& scene, bool thorough) {
  const SceneHeader& h = scene.header;
  SceneInventory inventory;
  inventory.features = h.features;
  for (const NamedBit& feature : kFeatures)
    inventory.feature_uses.push_back({feature.name, feature.description, (h.features & feature.bit) != 0u});
  for (const NamedBit& family : kFamilies)
    inventory.feature_uses.push_back({family.name, family.description, (h.families & family.bit) != 0u});
  for (const NamedBit& kind : kLightKinds)
    inventory.feature_uses.push_back({kind.name, kind.description, (h.light_kinds & kind.bit) != 0u});

  const TableSpans all = count_everything(description, scene, thorough);
  for (const SceneTable& each : kSceneTables) {
    const bool known = (all.*each.span).count != kUnknown;
    inventory.tables.push_back(
        {each.what, {each.bytes(h.tables), known ? std::optional(each.bytes(all)) : std::nullopt}});
  }

  // Header and alignment are the same with every feature.
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
