#include "scenes/gltf/gltf_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/gltf/asset.h"
#include "scenes/gltf/material_builder.h"
#include "scenes/gltf/primitive.h"
#include "scenes/gltf/view_reader.h"
#include "scenes/reading.h"
#include "scenes/texture_needs.h"
#include "scenes/transform.h"

namespace penumbra::gltf {
namespace {

constexpr std::size_t kMostShapes = 1000000;

glm::dquat no_turn() { return {1.0, 0.0, 0.0, 0.0}; }

class SceneBuilder {
 public:
  SceneBuilder(const Asset& asset, const FileAccess& files, ReaderReport& report, SceneDescription& scene)
      : asset_(asset),
        report_(report),
        scene_(scene),
        textures_(asset, files, report, scene),
        materials_(asset, report, textures_, scene) {}

  void build() {
    check_extensions();
    for (const int root : roots()) visit(root);
    finish_camera();
    textures_.install();
    if (!asset_.model.animations.empty())
      report_.warn(asset_.place({"animations"}), "animations are ignored: nodes are where they rest");
    if (scene_.emitters.empty() &&
        std::ranges::none_of(scene_.shapes, [](const Shape& shape) { return shape.radiance.has_value(); })) {
      report_.warn({asset_.json.get(), 0},
                   "the file has no light; a white sky of radiance 1 stands in for it");
      scene_.emitters.emplace_back(ConstantEnvironment{});
    }
  }

 private:
  void check_extensions() {
    std::vector<std::string> known = {"KHR_lights_punctual", "KHR_mesh_quantization"};
    known.insert(known.end(), kMaterialExtensions, kMaterialExtensions + kMaterialExtensionCount);
    const auto is_known = [&](const std::string& name) {
      return std::ranges::find(known, name) != known.end();
    };
    const auto& required = asset_.model.extensionsRequired;
    for (std::size_t i = 0; i < required.size(); ++i)
      if (!is_known(required[i]))
        report_.unsupported(
            asset_.place({"extensionsRequired", i}),
            fmt::format("the file requires the extension '{}', which is not read; those that are: {}",
                        required[i], list_names(known)),
            "what it does is left out");
    const auto& used = asset_.model.extensionsUsed;
    for (std::size_t i = 0; i < used.size(); ++i)
      if (!is_known(used[i]) && std::ranges::find(required, used[i]) == required.end())
        report_.warn(asset_.place({"extensionsUsed", i}),
                     fmt::format("the extension '{}' is ignored", used[i]));
  }

  /// Of the scene that is to be shown; of a file without scenes all nodes that are nobody's children.
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
  };

  /// Depth first, without recursion: no nesting can exhaust the stack. Nodes have one parent at most; one
  /// that is met twice is an error, and so are cycles.
  void visit(int root) {
    if (visited_.empty()) visited_.assign(asset_.model.nodes.size(), false);
    std::vector<Pending> stack = {{root, glm::dmat4(1.0)}};
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
      const auto local = transform_of(node, index);
      if (!local) continue;
      const glm::dmat4 to_world = next.parent * *local;
      if (is_singular(to_world)) {
        report_.warn(
            asset_.place({"nodes", index}),
            fmt::format("node {} is flattened by its transform, and left out with all below it", index));
        continue;
      }
      read_node(node, index, to_world);
      for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
        stack.push_back({*child, to_world});
    }
  }

  std::optional<glm::dmat4> transform_of(const tinygltf::Node& node, std::size_t index) {
    const auto wrong = [&](std::string_view message) {
      report_.error(asset_.place({"nodes", index}), fmt::format("node {}: {}", index, message));
      return std::nullopt;
    };
    const auto sized = [](const std::vector<double>& numbers, std::size_t size) {
      return numbers.empty() || numbers.size() == size;
    };
    if (!sized(node.matrix, 16) || !sized(node.translation, 3) || !sized(node.scale, 3) ||
        !sized(node.rotation, 4))
      return wrong("a matrix has 16 numbers, a translation and a scale 3, a rotation 4");
    if (!node.matrix.empty()) {
      glm::dmat4 result;
      for (int i = 0; i < 16; ++i) result[i / 4][i % 4] = node.matrix[std::size_t(i)];
      if (result[0].w != 0 || result[1].w != 0 || result[2].w != 0 || result[3].w != 1)
        return wrong("the last row of its matrix must be 0 0 0 1");
      return result;
    }
    glm::dmat4 result(1.0);
    if (!node.translation.empty())
      result = translation({node.translation[0], node.translation[1], node.translation[2]});
    if (!node.rotation.empty()) {
      glm::dquat q(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
      const double length = glm::length(q);
      q = length > 0.0 && std::isfinite(length) ? q / length : no_turn();
      result = result * glm::mat4_cast(q);
    }
    if (!node.scale.empty()) result = result * scaling({node.scale[0], node.scale[1], node.scale[2]});
    return result;
  }

  void read_node(const tinygltf::Node& node, std::size_t index, const glm::dmat4& to_world) {
    const SourceLocation location = asset_.place({"nodes", index});
    const auto there = [&](int wanted, std::size_t count, const char* what) {
      if (wanted < 0) return false;
      if (std::size_t(wanted) < count) return true;
      report_.error(location, fmt::format("node {}: there is no {} {}", index, what, wanted));
      return false;
    };
    if (there(node.camera, asset_.model.cameras.size(), "camera")) {
      if (cameras_++ == 0) read_camera(asset_, node.camera, to_world, report_, scene_);
    }
    const auto light = node.extensions.find("KHR_lights_punctual");
    if (light != node.extensions.end() && light->second.Has("light")) {
      const int wanted = light->second.Get("light").GetNumberAsInt();
      if (there(wanted, asset_.model.lights.size(), "light"))
        read_light(asset_, wanted, to_world, report_, scene_);
    }
    if (node.skin >= 0)
      report_.warn_counted(location, "skins are ignored: their meshes are in the pose in which they are stored");
    if (there(node.mesh, asset_.model.meshes.size(), "mesh")) read_mesh(node, index, to_world);
  }

  void read_mesh(const tinygltf::Node& node, std::size_t index, const glm::dmat4& to_world) {
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
      if (!primitive.targets.empty())
        report_.warn_counted(location, "morph targets are ignored: meshes have their first shape");
      if (primitive.material >= 0 && std::size_t(primitive.material) >= asset_.model.materials.size()) {
        report_.error(location, fmt::format("there is no material {}", primitive.material));
        continue;
      }
      if (scene_.shapes.size() >= kMostShapes) return report_.error(location, "more than a million shapes");
      add_primitive(primitive, location, name, to_world);
    }
  }

  void add_primitive(const tinygltf::Primitive& primitive, SourceLocation location, const std::string& name,
                     const glm::dmat4& to_world) {
    const SurfaceOfMaterial& surface =
        materials_.surface(primitive.material, primitive.attributes.contains("COLOR_0"));
    auto mesh = read_primitive(asset_, primitive, surface.texcoord);
    if (!mesh) return report_.error(location, fmt::format("'{}': {}", name, mesh.error().message));
    // A mirror turns glTF's winding round. Normals turn it here, where there are some.
    const bool faceted = mesh->normals.empty();
    if (faceted && is_mirror(to_world))
      for (glm::uvec3& t : mesh->triangles) std::swap(t.y, t.z);
    if (surface.has_normal_map) check_tangents(primitive, location);
    if (!report_.place(*mesh, to_world, faceted, name, location)) return;
    Shape shape;
    shape.name = shape.id = name;
    shape.geometry = std::move(*mesh);
    shape.front_bsdf = surface.front;
    shape.back_bsdf = surface.back;
    shape.radiance = surface.radiance;
    shape.radiance_texture = surface.radiance_texture;
    shape.two_sided_emission = surface.two_sided_emission;
    if (missing_for_textures(scene_, shape).coordinates)
      report_.warn(location,
                   fmt::format("'{}' has textures, but no texture coordinates {}; those of each triangle "
                               "are its barycentric ones",
                               name, surface.texcoord));
    scene_.shapes.push_back(std::move(shape));
  }

  /// Ours follow from the texture coordinates, as MikkTSpace's do, but for mirrored ones.
  void check_tangents(const tinygltf::Primitive& primitive, SourceLocation location) {
    if (primitive.attributes.contains("TANGENT"))
      report_.warn_counted(
          location,
          "TANGENT is ignored: the tangents of normal maps follow from the texture coordinates, "
          "and where those are mirrored, green counts the other way");
  }

  void finish_camera() {
    if (cameras_ > 1)
      report_.warn(asset_.place({"cameras"}), fmt::format("of {} cameras the first is used", cameras_));
    if (cameras_ > 0) return;
    report_.warn({asset_.json.get(), 0}, "the file has no camera; the whole scene is seen from in front");
    look_at_everything(scene_);
  }

  const Asset& asset_;
  ReaderReport& report_;
  SceneDescription& scene_;
  TextureBuilder textures_;
  MaterialBuilder materials_;
  std::vector<bool> visited_;
  int cameras_ = 0;
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
