#include "scenes/mitsuba/shape_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <type_traits>

#include "kernels/host/parallel.h"
#include "scenes/heightfield.h"
#include "scenes/instances.h"
#include "scenes/mesh_reader.h"
#include "scenes/mesh_tools.h"
#include "scenes/mikktspace.h"
#include "scenes/mitsuba/emitter_reader.h"
#include "scenes/mitsuba/medium_reader.h"
#include "scenes/mitsuba/mesh_attribute_names.h"
#include "scenes/mitsuba/shape_parameters.h"
#include "scenes/mitsuba/tessellated_shapes.h"
#include "scenes/mitsuba/texture_reader.h"
#include "scenes/names.h"
#include "scenes/texture_needs.h"
#include "scenes/traceable.h"
#include "scenes/transform.h"

namespace penumbra::mitsuba {
namespace {

/// A shape's plugin, and what reading its geometry requires.
struct ShapeInput {
  const Context& context;
  const FileAccess& files;
  MeshesAhead& meshes;
  PluginReader& plugin;
  bool& flip_normals;                               ///< reading the geometry may toggle it
  std::span<const TransformKey> keys;               ///< of its to_world, if that moves
  bool& computed_normals;                           ///< set for a mesh whose normals are not its file's
  std::span<const TextKey> over_time;               ///< the files of a mesh, if it has several over time
  std::shared_ptr<const DeformingMesh>& deforming;  ///< set for a mesh of several files over time
  bool& mirrors_maps;                               ///< see Shape; set for a mesh of a file
};

/// Whether that is so of the transform, and of all keys of one that moves.
template <typename Condition>
bool always(const ShapeInput& input, const glm::dmat4& to_world, const Condition& holds) {
  return holds(to_world) &&
         std::ranges::all_of(input.keys, [&](const TransformKey& key) { return holds(key.transform); });
}

/// Whether lengths change between the keys.
bool stretches(std::span<const TransformKey> keys) {
  return std::ranges::any_of(keys, [&](const TransformKey& key) {
    const glm::dmat3 m(key.transform), first(keys.front().transform);
    const glm::dmat3 squares = glm::transpose(m) * m, before = glm::transpose(first) * first;
    const double size = std::max({before[0].x, before[1].y, before[2].z});
    for (int i = 0; i < 3; ++i)
      if (!(glm::length(squares[i] - before[i]) < 1e-6 * size)) return true;
    return false;
  });
}

void warn_about(const Context& context, const Object& object, const MeshCleaning& cleaning,
                const FaceFindings& faces, std::string_view file) {
  for (const std::string& text : describe(faces))
    context.diagnostics.warn(object.location, fmt::format("{}: {}", file, text));
  for (const std::string& text : describe(cleaning))
    context.diagnostics.warn(object.location, fmt::format("{}: {}", file, text));
}

/// Opens the file that is named there, as text.
std::unique_ptr<SourceFile> open(const ShapeInput& input, const std::string& name, SourceLocation place) {
  const auto path = input.files.find(name, input.context.folders(input.plugin.object()));
  if (!path) {
    input.context.unsupported(place, path.error().message, "the shape is left out");
    return nullptr;
  }
  auto file = input.files.read(*path, kMaxMeshFileBytes);
  if (!file) {
    input.context.unsupported(place, file.error().message, "the shape is left out");
    return nullptr;
  }
  return std::move(*file);
}

template <typename Parameters>
Parameters read_parameters(const ShapeInput& input) {
  Parameters parameters;
  input.plugin.read_parameters(parameters);
  // Parameters for differentiation, for storing vertices, and for materials of the mesh file, which is not
  // used.
  input.plugin.accept({"silhouette_sampling_weight", "collapse", "load_materials"});
  input.flip_normals = parameters.flip_normals;
  return parameters;
}

Expected<MeshFile> read_file(MeshesAhead& meshes, const ObjShape&, const SourceFile& file,
                             const MeshAttributeNames&) {
  return meshes.read({file.path, MeshRequest::Format::kObj}, file);
}
Expected<MeshFile> read_file(MeshesAhead& meshes, const PlyShape&, const SourceFile& file,
                             const MeshAttributeNames& attributes) {
  return meshes.read({file.path, MeshRequest::Format::kPly, attributes}, file);
}
Expected<MeshFile> read_file(MeshesAhead&, const SerializedShape& shape, const SourceFile& file,
                             const MeshAttributeNames& attributes) {
  Expected<MeshFile> read = read_serialized(file, shape.shape_index);
  if (read && attributes.vertex != "color") read->mesh.colours.clear();
  return read;
}

/// The file of a mesh. Null, and an error, if it is missing.
template <typename Parameters>
std::unique_ptr<SourceFile> mesh_file(const ShapeInput& input, const Parameters& given) {
  if (input.plugin.has("filename")) return open(input, given.filename, input.plugin.location_of("filename"));
  input.plugin.wrong(fmt::format("{} needs a <string name=\"filename\" …>", input.plugin.title()));
  return nullptr;
}

void report_mesh_error(const ShapeInput& input, const Error& error) {
  if (input.context.lenient)
    return input.context.diagnostics.warn(input.plugin.object().location,
                                          fmt::format("{}; the shape is left out", error.message));
  input.context.diagnostics.error_text(
      fmt::format("{}\n  (which is named at {})", error.message, describe(input.plugin.object().location)));
}

/// What `read` makes of the later files of a mesh that has several over time. Nothing after a reported error.
template <typename Made>
std::optional<std::vector<Made>> read_later(const ShapeInput& input,
                                            const std::function<Expected<Made>(const SourceFile&)>& read) {
  std::vector<Made> all;
  for (std::size_t k = 1; k < input.over_time.size(); ++k) {
    const auto file = open(input, input.over_time[k].text, input.over_time[k].location);
    if (!file) return std::nullopt;
    auto made = read(*file);
    if (!made) {
      report_mesh_error(input, made.error());
      return std::nullopt;
    }
    all.push_back(std::move(*made));
  }
  return all;
}

/// Transforms the mesh to world space. `later`: its other files over time. Nothing after a reported error.
template <typename Parameters>
std::optional<Mesh> placed_mesh(const ShapeInput& input, const Parameters& given, MeshFile read,
                                std::vector<Mesh> later) {
  const std::string& name = given.filename;
  Mesh& mesh = read.mesh;
  if (given.flip_tex_coords) {
    for (glm::vec2& uv : mesh.texcoords) uv.y = 1.0f - uv.y;
  }
  const bool faceted = given.face_normals || read.face_normals ||
                       (input.context.tree.faceted_without_normals && mesh.normals.empty());
  const bool has_edges = given.max_smooth_angle > 0;
  input.computed_normals = mesh.normals.empty() && !faceted && !has_edges;
  input.mirrors_maps = given.mirrored_maps;
  const bool computes_tangents = given.mikktspace && mesh.tangents.empty() && !mesh.texcoords.empty();
  mesh.computes_tangents = computes_tangents && !has_edges;
  if (!later.empty()) {
    if (has_edges) {
      input.plugin.wrong(
          "max_smooth_angle",
          "a mesh of several files over time has their normals, or face_normals, or smooth ones");
      return std::nullopt;
    }
    later.insert(later.begin(), mesh);
    if (faceted)
      for (Mesh& each : later) each.normals.clear();
    input.deforming =
        deforming_mesh(std::move(later), input.over_time, given.to_world, input.context.diagnostics);
    if (input.deforming == nullptr) return std::nullopt;
  }
  const auto cleaning = place_mesh(mesh, given.to_world, faceted || has_edges);
  if (!cleaning) {
    input.plugin.wrong("filename", fmt::format("{}: {}", name, cleaning.error().message));
    return std::nullopt;
  }
  if (has_edges) smooth_up_to(mesh, given.max_smooth_angle);
  if (has_edges && computes_tangents) mesh.tangents = mikktspace_tangents(mesh);
  for (const std::string& warning : read.warnings) input.plugin.warn(fmt::format("{}: {}", name, warning));
  warn_about(input.context, input.plugin.object(), *cleaning, read.faces, name);
  return std::move(mesh);
}

/// Whether a mesh that was read has no triangles at any time.
bool is_nothing(const ShapeInput& input, const Mesh& mesh) {
  return mesh.triangles.empty() && (input.deforming == nullptr || input.deforming->rest.triangles.empty());
}

void warn_of_no_triangles(const ShapeInput& input, const std::string& name) {
  input.context.diagnostics.warn(input.plugin.object().location,
                                 fmt::format("{}: the shape has no triangles; it is left out", name));
}

template <typename Parameters>
std::optional<Geometry> read_mesh(const ShapeInput& input) {
  const auto given = read_parameters<Parameters>(input);
  auto file = mesh_file(input, given);
  if (!file) return std::nullopt;
  auto read =
      read_file(input.meshes, given, *file, mesh_attribute_names(input.context, input.plugin.object()));
  if (!read) {
    report_mesh_error(input, read.error());
    return std::nullopt;
  }
  // Free the text, which may take more memory than the mesh.
  file.reset();
  const auto others = read_later<MeshFile>(input, [&](const SourceFile& text) {
    return read_file(input.meshes, given, text, mesh_attribute_names(input.context, input.plugin.object()));
  });
  if (!others) return std::nullopt;
  std::vector<Mesh> later;
  for (const MeshFile& each : *others) later.push_back(each.mesh);
  auto mesh = placed_mesh(input, given, std::move(*read), std::move(later));
  if (mesh && is_nothing(input, *mesh)) {
    warn_of_no_triangles(input, given.filename);
    return std::nullopt;
  }
  if (!mesh) return std::nullopt;
  return std::move(*mesh);
}

/// One part of an OBJ file, with one material.
struct MeshPart {
  std::string material;  ///< the name in `usemtl`; empty: none
  Mesh mesh;
  bool computed_normals;                           ///< see ShapeInput
  std::shared_ptr<const DeformingMesh> deforming;  ///< likewise
};
std::vector<MeshPart> read_obj_parts(const ShapeInput& input) {
  const auto given = read_parameters<ObjShape>(input);
  const auto file = mesh_file(input, given);
  if (!file) return {};
  auto model = read_obj_groups(*file);
  if (!model) {
    report_mesh_error(input, model.error());
    return {};
  }
  for (const std::string& warning : model->warnings)
    input.plugin.warn(fmt::format("{}: {}", given.filename, warning));
  auto later = read_later<ObjModel>(input, read_obj_groups);
  if (!later) return {};
  const auto materials = [](const ObjModel& of) {
    std::vector<std::string> names;
    for (const ObjGroup& group : of.groups) names.push_back(group.material.name);
    return names;
  };
  for (std::size_t k = 0; k < later->size(); ++k) {
    if (materials((*later)[k]) == materials(*model)) continue;
    const auto& [time, name, location] = input.over_time[k + 1];
    input.context.diagnostics.error(
        location, fmt::format("'{}' has other objects or materials than '{}' at {} s", name, given.filename,
                              input.over_time.front().time));
    return {};
  }
  std::vector<MeshPart> parts;
  for (std::size_t g = 0; g < model->groups.size(); ++g) {
    ObjGroup& group = model->groups[g];
    std::vector<Mesh> others;
    for (ObjModel& each : *later) others.push_back(std::move(each.groups[g].mesh));
    input.deforming = nullptr;
    auto mesh = placed_mesh(input, given, {.mesh = std::move(group.mesh), .faces = std::move(group.faces)},
                            std::move(others));
    if (mesh && !is_nothing(input, *mesh))
      parts.push_back({group.material.name, std::move(*mesh), input.computed_normals, input.deforming});
  }
  if (parts.empty() && !input.context.diagnostics.failed()) warn_of_no_triangles(input, given.filename);
  return parts;
}

std::optional<Geometry> checked(const PluginReader& plugin, Geometry geometry) {
  if (const auto traceable = check_traceable(geometry); !traceable) {
    plugin.wrong(traceable.error().message);
    return std::nullopt;
  }
  return geometry;
}

/// The transformed first two axes, made orthonormal. The transform must be (nearly) a similarity.
std::pair<glm::dvec3, glm::dvec3> frame_axes(const glm::dmat4& to_world) {
  const glm::dvec3 x = glm::normalize(glm::dvec3(to_world[0])), y(to_world[1]);
  return {x, glm::normalize(y - glm::dot(x, y) * x)};
}

std::optional<Geometry> read_sphere(const ShapeInput& input) {
  PluginReader& plugin = input.plugin;
  const auto given = read_parameters<SphereShape>(input);
  const glm::dmat4& to_world = given.to_world;
  const glm::dvec3& center = given.center;
  const double radius = given.radius;
  if (!(radius > 0.0)) {
    plugin.wrong("radius", fmt::format("a radius must be above 0, not {}", radius));
    return std::nullopt;
  }
  const auto scale = uniform_scale(to_world);
  if (!always(input, to_world, [](const glm::dmat4& m) { return uniform_scale(m).has_value(); })) {
    plugin.wrong("to_world", "a sphere's transform must scale all directions alike");
    return std::nullopt;
  }
  // As in Mitsuba 3, a mirroring transform turns a sphere's normals inwards.
  if (is_mirror(to_world)) input.flip_normals = !input.flip_normals;
  const auto [x_axis, y_axis] = frame_axes(to_world);
  const double side = is_mirror(to_world) ? -1.0 : 1.0;
  const Sphere sphere{transform_point(to_world, center), radius * *scale, x_axis, y_axis,
                      side * glm::cross(x_axis, y_axis)};
  return checked(plugin, sphere);
}

std::optional<Geometry> read_disk(const ShapeInput& input) {
  PluginReader& plugin = input.plugin;
  const glm::dmat4 to_world = read_parameters<DiskShape>(input).to_world;
  const auto radius = uniform_scale(to_world, 2);
  if (!always(input, to_world, [](const glm::dmat4& m) { return uniform_scale(m, 2).has_value(); }))
    return checked(plugin, make_elliptic_disk(to_world));
  const auto [x_axis, y_axis] = frame_axes(to_world);
  const Disk disk{transform_point(to_world, glm::dvec3(0.0)),
                  glm::normalize(normal_matrix(to_world) * glm::dvec3(0.0, 0.0, 1.0)), *radius, x_axis,
                  y_axis};
  return checked(plugin, disk);
}

std::optional<Geometry> read_cylinder(const ShapeInput& input) {
  PluginReader& plugin = input.plugin;
  const auto given = read_parameters<CylinderShape>(input);
  if (!(given.radius > 0.0)) {
    plugin.wrong("radius", fmt::format("a radius must be above 0, not {}", given.radius));
    return std::nullopt;
  }
  const double length = glm::distance(given.p0, given.p1);
  if (!(length > 0.0) || !std::isfinite(length)) {
    plugin.wrong("p1", "the ends of a cylinder must be apart");
    return std::nullopt;
  }
  const glm::dvec3 axis = (given.p1 - given.p0) / length;
  // Mitsuba's frame about the axis (Duff et al. 2017).
  const double sign = axis.z >= 0 ? 1.0 : -1.0, a = -1 / (sign + axis.z), b = axis.x * axis.y * a;
  const Cylinder own{given.p0,
                     axis,
                     given.radius,
                     length,
                     {1 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x},
                     {b, sign + axis.y * axis.y * a, -axis.y}};
  const auto placed = placed_cylinder(own, given.to_world);
  if (!always(input, given.to_world,
              [&](const glm::dmat4& m) { return placed_cylinder(own, m).has_value(); })) {
    plugin.wrong("to_world", "a cylinder's transform must scale all directions across its axis alike");
    return std::nullopt;
  }
  return checked(plugin, *placed);
}

std::optional<Geometry> read_rectangle(const ShapeInput& input) {
  return checked(input.plugin, make_rectangle(read_parameters<RectangleShape>(input).to_world));
}

std::optional<Geometry> read_cube(const ShapeInput& input) {
  return checked(input.plugin, make_cube(read_parameters<CubeShape>(input).to_world));
}

/// The image of a height field: its own file, or the nested texture.
TextureImage heights_of(const ShapeInput& input, const HeightfieldShape& given) {
  const Object* texture = input.plugin.only_nested("texture");
  input.plugin.nested("rfilter");
  const bool named = input.plugin.has("filename");
  if (named == (texture != nullptr)) {
    input.plugin.wrong(named ? "a height field has a filename or a texture, not both"
                             : "heightfield needs a <string name=\"filename\" …> or a bitmap <texture>");
    return {};
  }
  TextureReader& textures = *input.context.textures;
  return named ? TextureImage{textures.read_image(input.plugin, given.filename)}
               : textures.read_texture_image(*texture);
}

std::optional<Geometry> read_heightfield(const ShapeInput& input) {
  const auto given = read_parameters<HeightfieldShape>(input);
  // Parameters for textures that are not bitmaps.
  input.plugin.accept({"width", "height"});
  const TextureImage image = heights_of(input, given);
  if (image.bitmap == nullptr) return std::nullopt;
  Expected<Mesh> mesh =
      make_heightfield(*image.bitmap, image.gamma, given.scale * double(image.scale), given.shading_normals);
  const std::string parameter = given.filename.empty() ? "" : "filename", &name = image.bitmap->name;
  const auto wrong = [&](const Error& error) {
    input.plugin.wrong(parameter, fmt::format("{}: {}", name, error.message));
    return std::nullopt;
  };
  if (!mesh) return wrong(mesh.error());
  const auto cleaning = place_mesh(*mesh, given.to_world, !given.shading_normals);
  if (!cleaning) return wrong(cleaning.error());
  warn_about(input.context, input.plugin.object(), *cleaning, {}, name);
  return std::move(*mesh);
}

/// Whether the shape has an object of the kind, directly or by reference.
bool has_nested(const ShapeInput& input, std::string_view tag) {
  return std::ranges::any_of(input.plugin.object().children, [&](const Child& child) {
    const Object* inside = input.context.resolve(child);
    return inside != nullptr && inside->tag == tag;
  });
}

/// Reads shapes defined by formulas, and curves that emit, move or bound media, as triangles.
template <typename Parameters>
std::optional<Geometry> read_tessellated(const ShapeInput& input) {
  const auto given = read_parameters<Parameters>(input);
  const auto file = mesh_file(input, given);
  if (!file) return std::nullopt;
  if constexpr (requires { curves_of(given, *file); }) {
    if (input.keys.empty() && !has_nested(input, "emitter") && !has_nested(input, "medium")) {
      auto curves = curves_of(given, *file);
      if (curves) return std::move(*curves);
      report_mesh_error(input, curves.error());
      return std::nullopt;
    }
  }
  if (!std::is_same_v<Parameters, SdfGridShape> && stretches(input.keys))
    input.plugin.warn("its radii, which transforms do not change, grow and shrink as it moves");
  auto made = tessellated(input.plugin, given, *file);
  if (!made) {
    report_mesh_error(input, made.error());
    return std::nullopt;
  }
  input.computed_normals = made->mesh.normals.empty();
  const auto cleaning = place_mesh(made->mesh, made->to_world, false);
  if (!cleaning) {
    input.plugin.wrong("filename", fmt::format("{}: {}", given.filename, cleaning.error().message));
    return std::nullopt;
  }
  if (made->mesh.triangles.empty()) {
    warn_of_no_triangles(input, given.filename);
    return std::nullopt;
  }
  return std::move(made->mesh);
}

struct ShapePlugin {
  std::string_view type;
  std::optional<Geometry> (*read)(const ShapeInput&);
};
constexpr ShapePlugin kShapes[] = {{ObjShape::kPlugin, read_mesh<ObjShape>},
                                   {PlyShape::kPlugin, read_mesh<PlyShape>},
                                   {SerializedShape::kPlugin, read_mesh<SerializedShape>},
                                   {RectangleShape::kPlugin, read_rectangle},
                                   {CubeShape::kPlugin, read_cube},
                                   {HeightfieldShape::kPlugin, read_heightfield},
                                   {BsplineCurveShape::kPlugin, read_tessellated<BsplineCurveShape>},
                                   {LinearCurveShape::kPlugin, read_tessellated<LinearCurveShape>},
                                   {SdfGridShape::kPlugin, read_tessellated<SdfGridShape>},
                                   {SphereShape::kPlugin, read_sphere},
                                   {CylinderShape::kPlugin, read_cylinder},
                                   {DiskShape::kPlugin, read_disk}};

}  // namespace

ShapeReader::ShapeReader(const Context& context, const FileAccess& files, MaterialReader& materials,
                         Animations& animations, SceneDescription& scene)
    : context_(context),
      files_(files),
      materials_(materials),
      animations_(animations),
      scene_(scene),
      meshes_(meshes_named(), files, unsigned(core_count()) - 1) {}

/// The meshes that the shapes of all files name, by a guess at their parameters.
std::vector<MeshRequest> ShapeReader::meshes_named() const {
  const FileAccess files = files_;  // a copy, so that what it would remark upon is remarked upon in order
  std::vector<MeshRequest> meshes;
  for (const Object& object : context_.tree.objects) {
    const bool is_ply = object.type == PlyShape::kPlugin;
    if (object.tag != "shape" || (!is_ply && object.type != ObjShape::kPlugin)) continue;
    if (!is_ply && names_materials(object)) continue;
    for (const Parameter& parameter : object.parameters) {
      const auto* name = std::get_if<std::string>(&parameter.value);
      if (parameter.name != "filename" || name == nullptr) continue;
      std::vector<std::string> named{*name};
      const auto over_time = animations_.files_of(object);
      for (std::size_t k = 1; k < over_time.size(); ++k) named.push_back(over_time[k].text);
      for (const std::string& each : named)
        if (auto path = files.find(each, context_.folders(object)))
          meshes.push_back({*path, is_ply ? MeshRequest::Format::kPly : MeshRequest::Format::kObj});
    }
  }
  return meshes;
}

void ShapeReader::read(const Object& object) {
  if (object.type == ShapeGroupShape::kPlugin) {
    group_of(object);
    return;
  }
  Holder holder{std::move(scene_.shapes), std::move(scene_.instances), std::move(sources_),
                std::move(instance_objects_)};
  read_into(object, holder);
  scene_.shapes = std::move(holder.shapes);
  scene_.instances = std::move(holder.instances);
  sources_ = std::move(holder.sources);
  instance_objects_ = std::move(holder.instance_objects);
}

void ShapeReader::read_into(const Object& object, Holder& holder) {
  if (object.type == InstanceShape::kPlugin)
    read_instance(object, holder);
  else if (object.type == MergeShape::kPlugin)
    read_merged(object, holder);
  else
    read_shape(object, holder);
}

/// Whether the nested object may be read: it must not be in the process of being read, and not nested too
/// deep.
bool ShapeReader::begin(PluginReader& plugin, std::string_view if_cyclic) {
  const bool is_new = reading_.insert(&plugin.object()).second;
  if (is_new && reading_.size() <= std::size_t(kMaxGroupLevels)) return true;
  plugin.wrong(is_new ? fmt::format("shapes within shapes of more than {} levels", kMaxGroupLevels)
                      : std::string(if_cyclic));
  plugin.skip();
  if (is_new) reading_.erase(&plugin.object());
  return false;
}

/// Shapes keep their materials, so there is nothing to merge.
void ShapeReader::read_merged(const Object& object, Holder& holder) {
  PluginReader plugin(context_, object);
  const std::vector<const Object*> inside = plugin.nested("shape");
  plugin.finish();
  if (!begin(plugin, "the shape holds itself")) return;
  for (const Object* shape : inside) read_into(*shape, holder);
  reading_.erase(&object);
}

void ShapeReader::read_instance(const Object& object, Holder& holder) {
  PluginReader plugin(context_, object);
  InstanceShape parameters;
  plugin.read_parameters(parameters);
  const Object* group = plugin.only_nested("shape");
  plugin.finish();
  if (group == nullptr || group->type != ShapeGroupShape::kPlugin)
    return plugin.wrong("an instance needs a <shape type=\"shapegroup\">, or a <ref> to one");
  const int index = group_of(*group);
  if (index < 0) return;
  holder.instances.push_back({name_of(object), index, parameters.to_world});
  holder.instance_objects.push_back(&object);
}

int ShapeReader::group_of(const Object& object) {
  if (const auto known = groups_.find(&object); known != groups_.end()) return known->second;
  PluginReader plugin(context_, object);
  if (!begin(plugin, "the group holds an instance of itself")) return -1;
  Holder holder;
  for (const Object* shape : plugin.nested("shape")) {
    if (shape->type == ShapeGroupShape::kPlugin)
      plugin.wrong("a group holds no groups, but may hold instances of them");
    else
      read_into(*shape, holder);
  }
  plugin.finish();
  reading_.erase(&object);
  const int index = int(scene_.groups.size());
  scene_.groups.push_back({name_of(object), std::move(holder.shapes), std::move(holder.instances)});
  group_sources_.push_back(std::move(holder.sources));
  for (const Object* inside : holder.instance_objects)
    if (!animations_.keys_of(*inside).empty())
      context_.diagnostics.warn(
          inside->location,
          fmt::format("an instance within a group does not move; it is as at {} s, when the "
                      "shutter opens",
                      animations_.time()));
  groups_.emplace(&object, index);
  return index;
}

void ShapeReader::read_shape(const Object& object, Holder& holder) {
  const ShapePlugin* known = find_plugin(kShapes, object.type);
  if (known == nullptr) {
    std::vector<std::string> types = plugin_types(kShapes);
    for (const char* other : {ShapeGroupShape::kPlugin, InstanceShape::kPlugin, MergeShape::kPlugin})
      types.emplace_back(other);
    context_.unknown_plugin(object, types, "it is left out");
    return;
  }
  if (object.type == ObjShape::kPlugin && names_materials(object)) return read_parts(object, holder);
  PluginReader plugin(context_, object);
  Shape shape;
  shape.name = name_of(object);
  shape.id = object.id;
  Source source{&object};
  auto geometry = known->read({context_, files_, meshes_, plugin, shape.flip_normals,
                               animations_.keys_of(object), source.computed_normals,
                               animations_.files_of(object), source.deforming, shape.mirrors_maps});
  const Object* bsdf = plugin.only_nested("bsdf");
  const Object* emitter = plugin.only_nested("emitter");
  context_.media->install(plugin, shape, scene_);
  for (const Object* inside : plugin.nested("subsurface"))
    context_.unknown_plugin(*inside, {}, "it is left out");
  plugin.finish();
  if (bsdf != nullptr) materials_.read(*bsdf);
  if (geometry) shape.geometry = std::move(*geometry);
  if (emitter != nullptr) read_area_light(context_, *emitter, shape);
  if (!geometry) return;
  const bool is_tube =
      (object.type == BsplineCurveShape::kPlugin || object.type == LinearCurveShape::kPlugin) &&
      std::holds_alternative<Mesh>(shape.geometry);
  std::tie(shape.front_bsdf, shape.back_bsdf) = materials_.install(bsdf, shape, scene_, is_tube);
  shape.material = materials_.id_of(bsdf);
  holder.shapes.push_back(std::move(shape));
  holder.sources.push_back(source);
}

/// Whether its BSDFs are assigned by name to the materials of its file, as in Mitsuba 0.6: there are several,
/// and some have names.
bool ShapeReader::names_materials(const Object& object) const {
  int count = 0, named = 0;
  for (const Child& child : object.children) {
    const Object* inside = context_.resolve(child);
    if (inside == nullptr || inside->tag != "bsdf") continue;
    ++count;
    named += child.name.empty() ? 0 : 1;
  }
  return count > 1 && named > 0;
}

void ShapeReader::read_parts(const Object& object, Holder& holder) {
  PluginReader plugin(context_, object);
  Shape whole;
  whole.name = name_of(object);
  whole.id = object.id;
  Source source{&object};
  std::vector<MeshPart> parts = read_obj_parts(
      {context_, files_, meshes_, plugin, whole.flip_normals, animations_.keys_of(object),
       source.computed_normals, animations_.files_of(object), source.deforming, whole.mirrors_maps});
  plugin.nested("bsdf");
  const Object* emitter = plugin.only_nested("emitter");
  context_.media->install(plugin, whole, scene_);
  plugin.finish();
  if (emitter != nullptr) read_area_light(context_, *emitter, whole);
  const Object* others = nullptr;  // for materials without a BSDF of their name
  std::map<std::string, const Object*> by_name;
  for (const Child& child : object.children) {
    const Object* bsdf = context_.resolve(child);
    if (bsdf == nullptr || bsdf->tag != "bsdf") continue;
    materials_.read(*bsdf);
    if (child.name.empty())
      others = bsdf;
    else if (!by_name.emplace(child.name, bsdf).second)
      plugin.wrong(fmt::format("two BSDFs are named '{}'", child.name));
  }
  std::set<std::string> used;
  for (MeshPart& part : parts) {
    const auto named = by_name.find(to_snake_case(part.material));
    const Object* bsdf = named != by_name.end() ? named->second : others;
    if (named != by_name.end()) used.insert(named->first);
    Shape shape = whole;
    if (!part.material.empty()) shape.name += fmt::format(" ({})", part.material);
    shape.geometry = std::move(part.mesh);
    std::tie(shape.front_bsdf, shape.back_bsdf) = materials_.install(bsdf, shape, scene_);
    shape.material = materials_.id_of(bsdf);
    holder.shapes.push_back(std::move(shape));
    holder.sources.push_back({&object, part.computed_normals, part.deforming});
  }
  for (const auto& [name, bsdf] : by_name)
    if (!parts.empty() && !used.contains(name))
      plugin.warn(fmt::format("no faces of the file have the material '{}'", name));
}

void ShapeReader::check_textures() const {
  const auto check = [&](const std::vector<Shape>& shapes, const std::vector<Source>& sources) {
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const TextureNeeds missing = missing_for_textures(scene_, shapes[i]);
      const std::string& name = shapes[i].name;
      if (missing.coordinates) {
        context_.diagnostics.warn(
            sources[i].object->location,
            fmt::format("shape '{}' has textures, but no texture coordinates; those of each triangle are its "
                        "barycentric ones",
                        name));
      }
      for (const MeshAttribute attribute : missing.attributes) {
        const MeshAttributeNames names = mesh_attribute_names(context_, *sources[i].object);
        const std::string shown =
            attribute == MeshAttribute::kFaceColour ? "face_" + names.face : "vertex_" + names.vertex;
        const std::string text =
            fmt::format("a texture shows '{}' of the shape '{}', which has none", shown, name);
        if (context_.lenient)
          context_.diagnostics.warn(sources[i].object->location, text + "; it is black");
        else
          context_.diagnostics.error(sources[i].object->location, text);
      }
    }
  };
  check(scene_.shapes, sources_);
  for (std::size_t g = 0; g < scene_.groups.size(); ++g) check(scene_.groups[g].shapes, group_sources_[g]);
}

void ShapeReader::add_motion() {
  const auto add = [&](int group, const std::vector<Source>& sources) {
    for (std::size_t i = 0; i < sources.size(); ++i)
      animations_.add_shape(*sources[i].object, group, i, sources[i].computed_normals,
                            sources[i].deforming.get());
  };
  add(-1, sources_);
  for (std::size_t g = 0; g < group_sources_.size(); ++g) add(int(g), group_sources_[g]);
  for (std::size_t i = 0; i < instance_objects_.size(); ++i)
    animations_.add_instance(*instance_objects_[i], i);
}

}  // namespace penumbra::mitsuba
