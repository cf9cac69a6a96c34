#include "scenes/gltf/gltf_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "scenes/gltf/animation_reader.h"
#include "scenes/gltf/asset.h"
#include "scenes/gltf/deformation_reader.h"
#include "scenes/gltf/extensions.h"
#include "scenes/gltf/material_builder.h"
#include "scenes/gltf/moving_nodes.h"
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
constexpr double kDefaultTime = 0.0;  ///< seconds, of a still

KeyedValue<double> scaled(KeyedValue<double> keys, double factor) {
  for (auto* numbers : {&keys.values, &keys.in_tangents, &keys.out_tangents})
    for (double& number : *numbers) number *= factor;
  return keys;
}

/// Where a primitive's mesh comes: its place now, and the node with which it moves.
struct MeshPlace {
  glm::dmat4 to_world{1.0};
  std::optional<NodePlace> moving{};
  int group = -1;  ///< that holds the shapes, or -1: the scene
};

/// `asset` shows the animation at the default time.
class SceneBuilder {
 public:
  SceneBuilder(const Asset& asset, const Animation& animation, const FileAccess& files, ReaderReport& report,
               SceneDescription& scene)
      : asset_(asset),
        animation_(animation),
        report_(report),
        scene_(scene),
        textures_(asset, files, report, scene),
        materials_(asset, report, textures_, scene),
        node_to_world_(world_transforms(asset)),
        moving_(asset, animation, node_to_world_) {}

  void build() {
    check_extensions(asset_, report_);
    for (const int root : root_nodes(asset_, report_)) visit(root);
    finish_motion();
    finish_camera();
    textures_.install();
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

  /// Of a node: what is above it hides it, or hides it at times.
  struct Visibility {
    bool ever = true;
    std::vector<const KeyedValue<double>*> keys{};
  };
  struct Pending {
    int node;
    glm::dmat4 parent;
    Visibility visibility;
  };

  /// Traverses depth first without recursion, so that deep nesting cannot overflow the stack. A node that is
  /// reached twice is an error, and so are cycles.
  void visit(int root) {
    if (visited_.empty()) visited_.assign(asset_.model.nodes.size(), false);
    std::vector<Pending> stack = {{root, glm::dmat4(1.0), {}}};
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
      const Visibility visibility = visibility_of(node, index, next.visibility);
      read_node(node, index, to_world, visibility);
      for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
        stack.push_back({*child, to_world, visibility});
    }
  }

  /// KHR_node_visibility also hides all descendants.
  [[nodiscard]] Visibility visibility_of(const tinygltf::Node& node, std::size_t index,
                                         Visibility above) const {
    const auto keys = animation_.nodes.find(index);
    if (keys != animation_.nodes.end() && keys->second.visible) {
      const KeyedValue<double>& visible = *keys->second.visible;
      if (visible.varies())
        above.keys.push_back(&visible);
      else
        above.ever = above.ever && visible.values[0] != 0.0;
    } else {
      above.ever = above.ever && is_visible(node);
    }
    return above;
  }
  static bool is_visible(const tinygltf::Node& node) {
    const auto found = node.extensions.find("KHR_node_visibility");
    if (found == node.extensions.end() || !found->second.Has("visible")) return true;
    const tinygltf::Value& visible = found->second.Get("visible");
    return !visible.IsBool() || visible.Get<bool>();
  }

  void read_node(const tinygltf::Node& node, std::size_t index, const glm::dmat4& to_world,
                 const Visibility& visibility) {
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
    const bool has_light = there(light, asset_.model.lights.size(), "light") && visibility.ever;
    const bool has_mesh = there(node.mesh, asset_.model.meshes.size(), "mesh") && visibility.ever;
    // The joints of a skin place its mesh, not the node.
    const bool is_flat = is_singular(to_world) && !moving_.moves(index) &&
                         (has_camera || has_light || (has_mesh && node.skin < 0));
    if (is_flat && (has_camera || has_light || !keeps_areas(to_world)))
      return report_.warn(
          asset_.place({"nodes", index}),
          fmt::format("node {} is flattened by its transform, and what it holds is left out", index));
    if (has_camera && cameras_++ == 0) place_camera(std::size_t(node.camera), index, to_world);
    if (has_light) place_light(std::size_t(light), moving_place(index, to_world, visibility), to_world);
    if (has_mesh) place_mesh_of(node, index, to_world, visibility);
  }

  /// The place of what moves with a node, or is not always visible there. Without a node it is in the world.
  std::optional<NodePlace> moving_place(std::optional<std::size_t> node, const glm::dmat4& to_world,
                                        const Visibility& visibility) {
    const bool moves = node && moving_.moves(*node);
    if (!moves && visibility.keys.empty()) return std::nullopt;
    NodePlace place = moves ? NodePlace{moving_.index_of(*node)} : NodePlace{-1, to_world};
    for (const KeyedValue<double>* visible : visibility.keys) place = moving_.shown_with(*visible, place);
    return place;
  }

  void place_camera(std::size_t camera, std::size_t node, const glm::dmat4& to_world) {
    const bool moves = moving_.moves(node);
    // A camera that is flattened now may be seen through at another time.
    read_camera(asset_, int(camera), moves && is_singular(to_world) ? glm::dmat4(1.0) : to_world, report_,
                scene_);
    const auto found = animation_.cameras.find(camera);
    const CameraKeys keys = found != animation_.cameras.end() ? found->second : CameraKeys{};
    MovingCamera moving;
    if (varies(keys.yfov)) moving.fov = scaled(*keys.yfov, kDegrees);
    // Negative values mean the same view.
    const auto sign = [](const KeyedValue<double>& magnification) {
      return magnification.values[0] < 0.0 ? -1.0 : 1.0;
    };
    const double aspect = double(scene_.film.width) / scene_.film.height;
    if (varies(keys.xmag)) moving.scale_x = scaled(*keys.xmag, sign(*keys.xmag));
    if (varies(keys.ymag)) moving.scale_y = scaled(*keys.ymag, sign(*keys.ymag) * aspect);
    if (!moves && !moving.fov && !moving.scale_x && !moving.scale_y) return;
    moving.place =
        moves ? NodePlace{moving_.index_of(node), camera_space()} : NodePlace{-1, scene_.camera.to_world};
    motion_.camera = std::move(moving);
  }

  void place_light(std::size_t light, const std::optional<NodePlace>& place, const glm::dmat4& to_world) {
    const std::size_t emitter = scene_.emitters.size();
    read_light(asset_, int(light), place ? glm::dmat4(1.0) : to_world, report_, scene_);
    const auto found = animation_.lights.find(light);
    const LightKeys keys = found != animation_.lights.end() ? found->second : LightKeys{};
    const bool changes = varies(keys.colour) || varies(keys.intensity);
    if (emitter == scene_.emitters.size() || (!place && !changes)) return;
    MovingEmitter moving{emitter, scene_.emitters[emitter], place.value_or(NodePlace{})};
    if (changes) {
      const tinygltf::Light& now = asset_.model.lights[light];
      moving.colour = keys.colour.value_or(KeyedValue<glm::dvec3>::constant(colour_of(now)));
      moving.strength =
          scaled(keys.intensity.value_or(KeyedValue<double>::constant(now.intensity)), 1.0 / kLumensPerWatt);
    }
    motion_.emitters.push_back(std::move(moving));
  }

  void place_mesh_of(const tinygltf::Node& node, std::size_t index, const glm::dmat4& to_world,
                     const Visibility& visibility) {
    const auto instances = node_instances(asset_, node);
    if (!instances)
      return report_.error(asset_.place({"nodes", index}),
                           fmt::format("node {}: {}", index, instances.error().message));
    if (!*instances) {
      // The joints of a skin place its mesh, not the node.
      const bool skinned = node.skin >= 0;
      const glm::dmat4 own = skinned ? glm::dmat4(1.0) : to_world;
      const auto moving = moving_place(skinned ? std::nullopt : std::optional(index), own, visibility);
      return read_mesh(node, index, {own, moving}, false, scene_.shapes);
    }
    const auto moving = moving_place(index, to_world, visibility);
    std::string name = node.name.empty() ? fmt::format("node {}", index) : node.name;
    // Mirrored instances have other bitangents.
    std::optional<int> groups[2];
    const auto group_of = [&](bool mirrored) {
      if (groups[mirrored]) return *groups[mirrored];
      ShapeGroup shapes{mirrored ? name + " (mirrored)" : name, {}, {}};
      read_mesh(node, index, {.group = int(scene_.groups.size())}, mirrored, shapes.shapes);
      groups[mirrored] = shapes.shapes.empty() ? -1 : int(scene_.groups.size());
      if (!shapes.shapes.empty()) scene_.groups.push_back(std::move(shapes));
      return *groups[mirrored];
    };
    const bool has_tangents = this->has_tangents(asset_.model.meshes[std::size_t(node.mesh)]);
    std::size_t flat = 0;
    for (const glm::dmat4& instance : **instances) {
      const glm::dmat4 placed = to_world * instance;
      if (is_singular(moving ? instance : placed)) {
        ++flat;
        continue;
      }
      const int group = group_of(has_tangents && is_mirror(placed));
      if (group < 0) continue;
      if (moving)
        motion_.instances.push_back({scene_.instances.size(), {moving->node, moving->to_node * instance}});
      scene_.instances.push_back({name, group, placed});
    }
    if (flat > 0)
      report_.warn(asset_.place({"nodes", index}),
                   fmt::format("node {}: {} of {} instances are flattened by their transforms, and left out",
                               index, flat, (*instances)->size()));
  }

  /// Whether a material may refer to tangents.
  [[nodiscard]] bool has_tangents(const tinygltf::Mesh& mesh) const {
    const auto& materials = asset_.model.materials;
    return std::ranges::any_of(mesh.primitives, [&](const tinygltf::Primitive& primitive) {
      if (primitive.material < 0 || std::size_t(primitive.material) >= materials.size()) return false;
      const tinygltf::Material& material = materials[std::size_t(primitive.material)];
      return material.normalTexture.index >= 0 || material.extensions.contains("KHR_materials_anisotropy");
    });
  }

  /// `mirrored`: further transforms mirror the shapes.
  void read_mesh(const tinygltf::Node& node, std::size_t index, const MeshPlace& place, bool mirrored,
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
      auto posed = read_posed(index, primitive, surface.texcoord, surface.has_tangents, pose_);
      if (!posed) {
        report_.error(location, fmt::format("'{}': {}", name, posed.error().message));
        continue;
      }
      warn_of_opacity(asset_, primitive, location, report_);
      const auto add = [&](Mesh part, const SurfaceOfMaterial& with) {
        add_mesh({std::move(part), posed->deformation}, with, place, location, name, shapes);
      };
      if (!surface.has_tangents) {
        add(std::move(posed->mesh), surface);
        continue;
      }
      const bool own = primitive.attributes.contains("TANGENT") && !posed->mesh.normals.empty();
      auto reversed = mirrored_triangles(posed->mesh, own);
      if (mirrored != is_mirror(place.to_world)) reversed.flip();
      const auto count = std::size_t(std::ranges::count(reversed, true));
      if (count == 0) {
        add(std::move(posed->mesh), surface);
        continue;
      }
      where.mirrored = true;
      const SurfaceOfMaterial& other = materials_.surface(primitive.material, where);
      if (count == reversed.size()) {
        add(std::move(posed->mesh), other);
        continue;
      }
      std::array<std::vector<std::size_t>, 2> parts;
      for (std::size_t t = 0; t < reversed.size(); ++t) parts[reversed[t] ? 1 : 0].push_back(t);
      // What deforms keeps all vertices, which its targets and its skin count.
      const auto part = [&](const std::vector<std::size_t>& triangles) {
        if (posed->deformation == nullptr) return part_of(posed->mesh, triangles);
        Mesh result = posed->mesh;
        result.triangles.clear();
        result.tangents.clear();
        for (const std::size_t t : triangles) {
          result.triangles.push_back(posed->mesh.triangles[t]);
          if (!posed->mesh.tangents.empty()) result.tangents.push_back(posed->mesh.tangents[t]);
        }
        return result;
      };
      add(part(parts[1]), other);
      add(part(parts[0]), surface);
    }
  }

  void add_mesh(PosedMesh posed, const SurfaceOfMaterial& surface, const MeshPlace& place,
                SourceLocation location, const std::string& name, std::vector<Shape>& shapes) {
    Mesh& mesh = posed.mesh;
    // What moves is placed when its time is known.
    const bool moves = (place.moving || posed.deformation != nullptr) && !mesh.triangles.empty();
    if (!moves && !place_now(mesh, place.to_world, name, location)) return;
    if (moves)
      motion_.shapes.push_back({place.group, shapes.size(), mesh,
                                place.moving.value_or(NodePlace{-1, place.to_world}),
                                std::move(posed.deformation)});
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

  /// Brings a mesh that does not move to the world. Returns whether it can be rendered.
  bool place_now(Mesh& mesh, glm::dmat4 to_world, const std::string& name, SourceLocation location) {
    if (is_singular(to_world)) {
      // The normals of a flattened mesh are those of its plane.
      for (glm::dvec3& position : mesh.positions) position = transform_point(to_world, position);
      mesh.normals.clear();
      to_world = glm::dmat4(1.0);
    }
    // A mirroring transform reverses glTF's winding. If there are normals, they determine it here.
    const bool faceted = mesh.normals.empty();
    if (faceted && is_mirror(to_world))
      for (std::size_t i = 0; i < mesh.triangles.size(); ++i) turn_over(mesh, i);
    return report_.place(mesh, to_world, faceted, name, location);
  }

  void finish_motion() {
    if (animation_.clip < 0 || report_.full()) return;
    const bool moves =
        !motion_.shapes.empty() || !motion_.instances.empty() || !motion_.emitters.empty() || motion_.camera;
    if (!moves)
      return report_.warn(asset_.place({"animations", std::size_t(animation_.clip)}),
                          fmt::format("the animation '{}' moves nothing that is shown",
                                      animation_.clips[std::size_t(animation_.clip)].name));
    motion_.clips = animation_.clips;
    motion_.default_time = kDefaultTime;
    motion_.nodes = moving_.nodes();
    scene_.motion = std::make_shared<const SceneMotion>(std::move(motion_));
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
  const Animation& animation_;
  ReaderReport& report_;
  SceneDescription& scene_;
  TextureBuilder textures_;
  MaterialBuilder materials_;
  const std::vector<glm::dmat4> node_to_world_;
  MovingNodes moving_;
  const PoseReading pose_{asset_, animation_, node_to_world_, moving_};
  SceneMotion motion_;
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
  const Animation animation = read_animation(**asset, options.clip, reading.report);
  show(animation, kDefaultTime, (*asset)->model);
  SceneDescription scene;
  scene.source = file.string();
  SceneBuilder(**asset, animation, reading.files, reading.report, scene).build();
  return reading.finish(std::move(scene));
}

}  // namespace penumbra::gltf
