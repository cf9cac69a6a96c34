#include "scenes/gltf/gltf_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "scenes/gltf/asset.h"
#include "scenes/gltf/extensions.h"
#include "scenes/gltf/material_builder.h"
#include "scenes/gltf/mesh_pose.h"
#include "scenes/gltf/node_transforms.h"
#include "scenes/gltf/primitive.h"
#include "scenes/gltf/tangents.h"
#include "scenes/gltf/view_reader.h"
#include "scenes/mesh_tools.h"
#include "scenes/reading.h"
#include "scenes/texture_needs.h"
#include "scenes/transform.h"

namespace penumbra::gltf {
namespace {

constexpr std::size_t kMostShapes = 1000000;

class SceneBuilder {
 public:
  SceneBuilder(const Asset& asset, const FileAccess& files, ReaderReport& report, SceneDescription& scene)
      : asset_(asset),
        report_(report),
        scene_(scene),
        textures_(asset, files, report, scene),
        materials_(asset, report, textures_, scene) {}

  void build() {
    check_extensions(asset_, report_);
    node_to_world_ = world_transforms(asset_);
    for (const int root : roots()) visit(root);
    finish_camera();
    textures_.install();
    if (asset_.has_animations)
      report_.warn(asset_.place({"animations"}), "animations are ignored: nodes are where they rest");
    if (!is_lit()) {
      report_.warn(
          {asset_.json.get(), 0},
          "the file has no light; a white sky of radiance 1 stands in for it (Blender exports lamps with "
          "'Punctual Lights', but no area lamps and no world)");
      scene_.emitters.emplace_back(ConstantEnvironment{});
    }
  }

 private:
  /// Whether there is light for the surfaces. If all materials are unlit, none is needed.
  [[nodiscard]] bool is_lit() const {
    return !scene_.emitters.empty() || has_area_light_ || (has_unlit_ && !has_lit_);
  }

  /// The root nodes of the scene to show; in a file without scenes all nodes without a parent.
  std::vector<int> roots() {
    const tinygltf::Model& model = asset_.model;
    if (!model.scenes.empty()) {
      const int index = std::max(model.defaultScene, 0);
      if (std::size_t(index) >= model.scenes.size()) {
        report_.error(asset_.place({"scene"}), fmt::format("there is no scene {}", index));
        return {};
      }
      if (model.scenes.size() > 1)
        report_.warn(asset_.place({"scenes"}),
                     fmt::format("of {} scenes number {} is shown", model.scenes.size(), index));
      return model.scenes[std::size_t(index)].nodes;
    }
    std::vector<bool> is_child(model.nodes.size(), false);
    for (const tinygltf::Node& node : model.nodes)
      for (const int child : node.children)
        if (child >= 0 && std::size_t(child) < is_child.size()) is_child[std::size_t(child)] = true;
    std::vector<int> result;
    for (std::size_t i = 0; i < is_child.size(); ++i)
      if (!is_child[i]) result.push_back(int(i));
    return result;
  }

  struct Pending {
    int node;
    glm::dmat4 parent;
    bool visible;
  };

  /// Traverses depth first without recursion, so that deep nesting cannot overflow the stack. A node that is
  /// reached twice is an error, and so are cycles.
  void visit(int root) {
    if (visited_.empty()) visited_.assign(asset_.model.nodes.size(), false);
    std::vector<Pending> stack = {{root, glm::dmat4(1.0), true}};
    while (!stack.empty() && !report_.full()) {
      const Pending next = stack.back();
      stack.pop_back();
      if (next.node < 0 || std::size_t(next.node) >= asset_.model.nodes.size()) {
        report_.error(asset_.place({"nodes"}), fmt::format("there is no node {}", next.node));
        continue;
      }
      const auto index = std::size_t(next.node);
      if (visited_[index]) {
        report_.error(asset_.place({"nodes", index}),
                      fmt::format("node {} is there twice, or below itself", index));
        continue;
      }
      visited_[index] = true;
      const tinygltf::Node& node = asset_.model.nodes[index];
      const auto local = local_transform(asset_, index, report_);
      if (!local) continue;
      const glm::dmat4 to_world = next.parent * *local;
      const bool visible = next.visible && is_visible(node);
      read_node(node, index, to_world, visible);
      for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
        stack.push_back({*child, to_world, visible});
    }
  }

  /// KHR_node_visibility also hides all descendants.
  static bool is_visible(const tinygltf::Node& node) {
    const auto found = node.extensions.find("KHR_node_visibility");
    if (found == node.extensions.end() || !found->second.Has("visible")) return true;
    const tinygltf::Value& visible = found->second.Get("visible");
    return !visible.IsBool() || visible.Get<bool>();
  }

  void read_node(const tinygltf::Node& node, std::size_t index, const glm::dmat4& to_world, bool visible) {
    const auto there = [&](int wanted, std::size_t count, const char* what) {
      if (wanted < 0) return false;
      if (std::size_t(wanted) < count) return true;
      report_.error(asset_.place({"nodes", index}),
                    fmt::format("node {}: there is no {} {}", index, what, wanted));
      return false;
    };
    const bool has_camera = there(node.camera, asset_.model.cameras.size(), "camera");
    const auto punctual = node.extensions.find("KHR_lights_punctual");
    const int light = punctual != node.extensions.end() && punctual->second.Has("light")
                          ? punctual->second.Get("light").GetNumberAsInt()
                          : -1;
    const bool has_light = there(light, asset_.model.lights.size(), "light") && visible;
    const bool has_mesh = there(node.mesh, asset_.model.meshes.size(), "mesh") && visible;
    // The joints of a skin place its mesh, not the node.
    const bool is_flat = is_singular(to_world) && (has_camera || has_light || (has_mesh && node.skin < 0));
    if (is_flat && (has_camera || has_light || !keeps_areas(to_world)))
      return report_.warn(
          asset_.place({"nodes", index}),
          fmt::format("node {} is flattened by its transform, and what it holds is left out", index));
    if (has_camera && cameras_++ == 0) read_camera(asset_, node.camera, to_world, report_, scene_);
    if (has_light) read_light(asset_, light, to_world, report_, scene_);
    if (has_mesh) place_mesh_of(node, index, to_world);
  }

  /// Whether any triangle keeps an area, that is, at most one axis is flattened.
  static bool keeps_areas(const glm::dmat4& to_world) {
    const glm::dmat3 m(to_world);
    const auto area = [&](int i, int j) {
      const double sides = glm::length(m[i]) * glm::length(m[j]);
      return sides > 0.0 && glm::length(glm::cross(m[i], m[j])) > 1e-6 * sides;
    };
    return area(0, 1) || area(1, 2) || area(2, 0);
  }

  void place_mesh_of(const tinygltf::Node& node, std::size_t index, const glm::dmat4& to_world) {
    const auto instances = node_instances(asset_, node);
    if (!instances)
      return report_.error(asset_.place({"nodes", index}),
                           fmt::format("node {}: {}", index, instances.error().message));
    if (!*instances) return read_mesh(node, index, to_world, false, scene_.shapes);
    std::string name = node.name.empty() ? fmt::format("node {}", index) : node.name;
    // Mirrored instances have other normal maps.
    std::optional<int> groups[2];
    const auto group_of = [&](bool mirrored) {
      if (groups[mirrored]) return *groups[mirrored];
      ShapeGroup shapes{mirrored ? name + " (mirrored)" : name, {}, {}};
      read_mesh(node, index, glm::dmat4(1.0), mirrored, shapes.shapes);
      groups[mirrored] = shapes.shapes.empty() ? -1 : int(scene_.groups.size());
      if (!shapes.shapes.empty()) scene_.groups.push_back(std::move(shapes));
      return *groups[mirrored];
    };
    const bool has_maps = has_normal_maps(asset_.model.meshes[std::size_t(node.mesh)]);
    std::size_t flat = 0;
    for (const glm::dmat4& instance : **instances) {
      const glm::dmat4 placed = to_world * instance;
      if (is_singular(placed)) {
        ++flat;
        continue;
      }
      const int group = group_of(has_maps && is_mirror(placed));
      if (group >= 0) scene_.instances.push_back({name, group, placed});
    }
    if (flat > 0)
      report_.warn(asset_.place({"nodes", index}),
                   fmt::format("node {}: {} of {} instances are flattened by their transforms, and left out",
                               index, flat, (*instances)->size()));
  }

  [[nodiscard]] bool has_normal_maps(const tinygltf::Mesh& mesh) const {
    const auto& materials = asset_.model.materials;
    return std::ranges::any_of(mesh.primitives, [&](const tinygltf::Primitive& primitive) {
      return primitive.material >= 0 && std::size_t(primitive.material) < materials.size() &&
             materials[std::size_t(primitive.material)].normalTexture.index >= 0;
    });
  }

  /// `mirrored`: further transforms mirror the shapes.
  void read_mesh(const tinygltf::Node& node, std::size_t index, const glm::dmat4& to_world, bool mirrored,
                 std::vector<Shape>& shapes) {
    const auto mesh_index = std::size_t(node.mesh);
    const tinygltf::Mesh& mesh = asset_.model.meshes[mesh_index];
    for (std::size_t i = 0; i < mesh.primitives.size() && !report_.full(); ++i) {
      const tinygltf::Primitive& primitive = mesh.primitives[i];
      const SourceLocation location = asset_.place({"meshes", mesh_index, "primitives", i});
      std::string name = !node.name.empty()   ? node.name
                         : !mesh.name.empty() ? mesh.name
                                              : fmt::format("node {}", index);
      if (mesh.primitives.size() > 1) name += fmt::format(" ({})", i + 1);
      if (!is_surface(primitive)) {
        report_.warn(location,
                     fmt::format("'{}': points and lines have no surface; they are left out", name));
        continue;
      }
      if (!primitive.attributes.contains("POSITION")) {
        report_.warn(location,
                     fmt::format("'{}': a primitive without POSITION has no place; it is left out", name));
        continue;
      }
      if (primitive.material >= 0 && std::size_t(primitive.material) >= asset_.model.materials.size()) {
        report_.error(location, fmt::format("there is no material {}", primitive.material));
        continue;
      }
      if (shapes.size() >= kMostShapes) return report_.error(location, "more than a million shapes");
      MaterialUse where{.coloured = primitive.attributes.contains("COLOR_0")};
      const SurfaceOfMaterial& surface = materials_.surface(primitive.material, where);
      auto posed = read_posed(node, mesh, primitive, surface.texcoord);
      if (!posed) {
        report_.error(location, fmt::format("'{}': {}", name, posed.error().message));
        continue;
      }
      check_opacity(primitive, location);
      const glm::dmat4 placed = node.skin >= 0 ? glm::dmat4(1.0) : to_world;
      if (!surface.has_normal_map) {
        add_mesh(std::move(*posed), surface, placed, location, name, shapes);
        continue;
      }
      auto reversed =
          reversed_triangles(primitive, *posed, mirrored != is_mirror(placed), node.skin >= 0, location);
      if (!reversed) {
        report_.error(location, fmt::format("'{}': {}", name, reversed.error().message));
        continue;
      }
      const auto count = std::size_t(std::ranges::count(*reversed, true));
      if (count == 0) {
        add_mesh(std::move(*posed), surface, placed, location, name, shapes);
        continue;
      }
      where.mirrored = true;
      const SurfaceOfMaterial& other = materials_.surface(primitive.material, where);
      if (count == reversed->size()) {
        add_mesh(std::move(*posed), other, placed, location, name, shapes);
        continue;
      }
      std::array<std::vector<std::size_t>, 2> parts;
      for (std::size_t t = 0; t < reversed->size(); ++t) parts[(*reversed)[t] ? 1 : 0].push_back(t);
      add_mesh(part_of(*posed, parts[1]), other, placed, location, name, shapes);
      add_mesh(part_of(*posed, parts[0]), surface, placed, location, name, shapes);
    }
  }

  /// The triangles on which green counts the other way: those with mirrored coordinates, or with others in a
  /// mirrored place.
  Expected<std::vector<bool>> reversed_triangles(const tinygltf::Primitive& primitive, const Mesh& mesh,
                                                 bool mirror, bool is_skinned, SourceLocation location) {
    const auto attributes = PrimitiveAttributes::open(asset_, primitive);
    if (!attributes) return std::unexpected(attributes.error());
    const auto tangents = attributes->read("TANGENT", 4, 4);
    if (!tangents) return std::unexpected(tangents.error());
    if (*tangents && !is_skinned && has_other_tangents(mesh, **tangents))
      report_.warn_counted(location,
                           "TANGENT leans by more than 45 degrees from the direction of the texture "
                           "coordinates, which is used");
    auto reversed = mirrored_triangles(mesh, *tangents);
    if (mirror) reversed.flip();
    return reversed;
  }

  /// The mesh of a primitive in its rest pose: in its own space, or with a skin in world space.
  Expected<Mesh> read_posed(const tinygltf::Node& node, const tinygltf::Mesh& mesh,
                            const tinygltf::Primitive& primitive, int texcoord) {
    const auto attributes = PrimitiveAttributes::open(asset_, primitive);
    if (!attributes) return std::unexpected(attributes.error());
    auto posed = read_primitive(*attributes, primitive.mode, texcoord);
    if (!posed) return posed;
    const auto& weights = node.weights.empty() ? mesh.weights : node.weights;
    if (const auto done = morph(asset_, primitive, weights, *posed); !done)
      return std::unexpected(done.error());
    if (node.skin < 0) return posed;
    if (const auto done = apply_skin(asset_, *attributes, node.skin, node_to_world_, *posed); !done)
      return std::unexpected(done.error());
    return posed;
  }

  void add_mesh(Mesh mesh, const SurfaceOfMaterial& surface, glm::dmat4 to_world, SourceLocation location,
                const std::string& name, std::vector<Shape>& shapes) {
    if (is_singular(to_world)) {
      // The normals of a flattened mesh are those of its plane.
      for (glm::dvec3& position : mesh.positions) position = transform_point(to_world, position);
      mesh.normals.clear();
      to_world = glm::dmat4(1.0);
    }
    // A mirroring transform reverses glTF's winding. If there are normals, they determine it here.
    const bool faceted = mesh.normals.empty();
    if (faceted && is_mirror(to_world))
      for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
    if (!report_.place(mesh, to_world, faceted, name, location)) return;
    Shape shape;
    shape.name = shape.id = name;
    shape.geometry = std::move(mesh);
    shape.front_bsdf = surface.front;
    shape.back_bsdf = surface.back;
    shape.radiance = surface.radiance;
    shape.radiance_texture = surface.radiance_texture;
    shape.two_sided_emission = surface.two_sided_emission;
    has_unlit_ = has_unlit_ || surface.unlit;
    has_lit_ = has_lit_ || !surface.unlit;
    has_area_light_ = has_area_light_ || (surface.radiance && !surface.unlit);
    if (missing_for_textures(scene_, shape).coordinates)
      report_.warn(location,
                   fmt::format("'{}' has textures, but no texture coordinates {}; those of each triangle "
                               "are its barycentric ones",
                               name, surface.texcoord));
    shapes.push_back(std::move(shape));
  }

  /// The alpha of vertex colours is not supported.
  void check_opacity(const tinygltf::Primitive& primitive, SourceLocation location) {
    const auto colours = primitive.attributes.find("COLOR_0");
    if (colours == primitive.attributes.end() || primitive.material < 0 ||
        asset_.model.materials[std::size_t(primitive.material)].alphaMode == "OPAQUE")
      return;
    const auto attributes = PrimitiveAttributes::open(asset_, primitive);
    const auto values = attributes ? attributes->read("COLOR_0", 4, 4) : std::unexpected(attributes.error());
    if (!values || !*values) return;
    for (std::size_t i = 0; i < (*values)->count; ++i)
      if ((*values)->at(i, 3) < 1.0)
        return report_.warn_counted(location, "the opacity of vertices (the alpha of COLOR_0) is ignored");
  }

  void finish_camera() {
    if (cameras_ > 1)
      report_.warn(asset_.place({"cameras"}), fmt::format("of {} cameras the first is used", cameras_));
    if (cameras_ > 0) return;
    report_.warn(
        {asset_.json.get(), 0},
        "the file has no camera; the whole scene is seen from in front (Blender exports cameras with "
        "'Cameras')");
    look_at_everything(scene_);
  }

  const Asset& asset_;
  ReaderReport& report_;
  SceneDescription& scene_;
  TextureBuilder textures_;
  MaterialBuilder materials_;
  std::vector<glm::dmat4> node_to_world_;
  std::vector<bool> visited_;
  int cameras_ = 0;
  bool has_area_light_ = false, has_unlit_ = false, has_lit_ = false;
};

}  // namespace

Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options) {
  Reading reading(options);
  const auto asset = read_asset(file, reading.files);
  if (!asset) return std::unexpected(asset.error());
  reading.refuse_variables("glTF");
  SceneDescription scene;
  scene.source = file.string();
  SceneBuilder(**asset, reading.files, reading.report, scene).build();
  return reading.finish(std::move(scene));
}

}  // namespace penumbra::gltf
