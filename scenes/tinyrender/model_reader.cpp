#include "scenes/tinyrender/model_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <sstream>

#include "scenes/image/bitmap_files.h"
#include "scenes/mesh_reader.h"
#include "scenes/mesh_tools.h"
#include "scenes/tinyrender/mtl_reader.h"

namespace penumbra::tinyrender {
namespace {

namespace fs = std::filesystem;

/// TinyRender's interpretation of `illum`. All other numbers, including its mixture, 8, mean its Phong model
/// of Kd and Ks together.
constexpr std::int64_t kMirror = 5, kDiffuse = 7;

/// The placeholder for a material that is not read. Its colour is deliberately unnatural.
constexpr glm::vec3 kPlaceholderColour(0.8f, 0.2f, 0.8f);

bool is_black(const std::optional<glm::vec3>& colour) { return !colour || *colour == glm::vec3(0.0f); }

class ModelReader {
 public:
  ModelReader(const Context& context, const FileAccess& files, SceneDescription& scene)
      : context_(context), files_(files), scene_(scene), bitmaps_(files) {}

  void read() {
    Section input(context_, "input");
    input.require("objfile");
    const auto name = input.text("objfile");
    input.finish();
    if (!name) return;
    const SourceFile* source = open(*name, input.location("objfile"), kMaxMeshFileBytes);
    if (source == nullptr) return;
    auto model = read_obj_groups(*source);
    if (!model) {
      context_.diagnostics.error_text(fmt::format("{}\n  (which is named at {})", model.error().message,
                                                  describe(input.location("objfile"))));
      return;
    }
    if (model->groups.empty()) warn({source, 0}, "the file has no faces");
    for (const std::string& warning : model->warnings) warn({source, 0}, warning);
    for (const ObjName& library : model->libraries) read_library(library);
    for (ObjGroup& group : model->groups) {
      if (context_.diagnostics.full()) return;
      add_shape(group);
    }
    scene_.bitmaps = bitmaps_.take();
  }

 private:
  /// The file of that name in the folder of the file that contains `location`. Null, and an error, if it is
  /// missing.
  const SourceFile* open(const std::string& name, SourceLocation location, std::uint64_t max_bytes) {
    const std::array<fs::path, 1> folder = {location.file->path.parent_path()};
    const auto path = files_.find(name, folder);
    if (!path) {
      context_.diagnostics.error(location, path.error().message);
      return nullptr;
    }
    auto file = files_.read(*path, max_bytes);
    if (!file) {
      context_.diagnostics.error(location, file.error().message);
      return nullptr;
    }
    sources_.push_back(std::move(*file));
    return sources_.back().get();
  }

  /// The line names one file, whose name may contain blanks, or several, whose names do not.
  void read_library(const ObjName& line) {
    std::vector<std::string> names = {line.name};
    const std::array<fs::path, 1> folder = {line.location.file->path.parent_path()};
    if (line.name.find_first_of(" \t") != line.name.npos && !files_.find(line.name, folder)) {
      names.clear();
      std::istringstream words(line.name);
      for (std::string name; words >> name;) names.push_back(name);
    }
    for (const std::string& name : names) {
      if (std::ranges::find(libraries_, name) != libraries_.end()) continue;
      libraries_.push_back(name);
      const SourceFile* file = open(name, line.location, kMaxSceneFileBytes);
      if (file != nullptr) {
        read_mtl(*file, materials_, context_.diagnostics);
      } else {
        all_libraries_ = false;
      }
    }
  }

  struct Surface {
    int bsdf = kBlackBsdf;
    std::optional<glm::vec3> radiance;
  };

  const Surface& surface(const ObjGroup& group) {
    const std::string& name = group.material.name;
    const auto [entry, is_new] = surfaces_.try_emplace(name);
    if (is_new) entry->second = make_surface(group);
    return entry->second;
  }

  Surface make_surface(const ObjGroup& group) {
    const auto found = materials_.find(group.material.name);
    if (found == materials_.end()) {
      missing_material(group);
      return {install("placeholder", DiffuseBsdf{kPlaceholderColour}), std::nullopt};
    }
    const MtlMaterial& material = found->second;
    Surface result;
    if (!is_black(material.emission)) result.radiance = material.emission;
    if (material.illum == kMirror) {
      // A mirror without Ks reflects all light.
      const glm::vec3 reflectance = material.specular.value_or(glm::vec3(1.0f));
      ConductorBsdf mirror;
      mirror.specular_reflectance = energy_scale(found->first, material.location, reflectance) * reflectance;
      result.bsdf = install(found->first, mirror);
      return result;
    }
    const bool glossy = material.illum != kDiffuse && !is_black(material.specular);
    const glm::vec3 diffuse = material.diffuse.value_or(glm::vec3(material.diffuse_map ? 1.0f : 0.0f));
    const glm::vec3 specular = glossy && material.exponent ? *material.specular : glm::vec3(0.0f);
    if (glossy && !material.exponent)
      warn(material.location, fmt::format("'{}' has Ks but no Ns; Ks is left out", found->first));
    const float scale = energy_scale(found->first, material.location, diffuse + specular);
    if (specular != glm::vec3(0.0f)) {
      PhongBsdf phong{scale * diffuse, scale * specular, *material.exponent};
      set_map(phong.diffuse, material.diffuse_map);
      set_map(phong.specular, material.specular_map);
      set_map(phong.exponent, material.exponent_map);
      result.bsdf = install(found->first, phong);
    } else if (diffuse != glm::vec3(0.0f)) {
      DiffuseBsdf plain{scale * diffuse};
      set_map(plain.reflectance, material.diffuse_map);
      result.bsdf = install(found->first, plain);
    }
    return result;
  }

  /// Sets the image times the constant value. Colours are sRGB-encoded, as programs write them; exponents are
  /// linear.
  template <typename Parameter>
  void set_map(Parameter& parameter, const std::optional<MtlMap>& map) {
    if (!map) return;
    const bool is_number = std::is_same_v<Parameter, TexturedNumber>;
    std::optional<int> texture = read_map(*map, is_number);
    if (!texture) return;
    if (parameter.value != decltype(parameter.value)(1.0f)) {
      scene_.textures.push_back({map->name, ScaleTexture{glm::vec3(parameter.value), *texture}});
      texture = int(scene_.textures.size()) - 1;
    }
    parameter.texture = *texture;
  }

  std::optional<int> read_map(const MtlMap& map, bool raw) {
    const std::array<fs::path, 1> folder = {map.location.file->path.parent_path()};
    const auto path = files_.find(map.name, folder);
    BitmapTexture bitmap;
    bitmap.filename = map.name;
    bitmap.wrap = bitmap.wrap_u = bitmap.wrap_v = map.clamp ? WRAP_CLAMP : WRAP_REPEAT;
    bitmap.gamma = raw ? 1.0f : kSrgb;
    const auto entry = path ? bitmaps_.read(*path, BitmapChannels::kAll) : std::unexpected(path.error());
    SceneTexture texture{map.name, bitmap};
    if (entry) {
      std::get<BitmapTexture>(texture.model).bitmap = entry->bitmap;
      // v counts from the bottom, the rows of a bitmap from the top.
      texture.to_uv = glm::dmat3(glm::dvec3(map.scale.x, 0, 0), glm::dvec3(0, -map.scale.y, 0),
                                 glm::dvec3(map.offset.x, 1 - map.offset.y, 1));
      for (const std::string& finding : describe(entry->findings, map.name)) warn(map.location, finding);
    } else {
      context_.unknown(map.location, entry.error().message, "a magenta checkerboard stands in for it");
      CheckerboardTexture placeholder;
      placeholder.color0 = kPlaceholderColour;
      texture.model = placeholder;
    }
    scene_.textures.push_back(std::move(texture));
    return int(scene_.textures.size()) - 1;
  }

  /// The factor by which TinyRender scales reflectances.
  float energy_scale(const std::string& name, SourceLocation location, glm::vec3 sum) {
    const float most = std::max({sum.x, sum.y, sum.z});
    if (!(most > 1.0f)) return 1.0f;
    const float scale = 0.99f / most;
    warn(location,
         fmt::format("'{}' would reflect {} of the light it receives; Kd and Ks are scaled by {:.3g}, "
                     "as TinyRender does",
                     name, most, scale));
    return scale;
  }

  void missing_material(const ObjGroup& group) {
    if (!all_libraries_) return;  // it may be defined in the missing library
    const char* const instead = "a magenta diffuse stands in for it";
    if (group.material.name.empty()) {
      context_.unknown(group.location, "this face has no material: there is no usemtl before it", instead);
      return;
    }
    std::vector<std::string> known;
    for (const auto& [name, material] : materials_) known.push_back(name);
    context_.unknown(group.material.location,
                     fmt::format("the material '{}' is not defined{}", group.material.name,
                                 known_names(group.material.name, known, "The MTL files define")),
                     instead);
  }

  template <typename Model>
  int install(const std::string& name, Model model) {
    scene_.bsdfs.push_back({name, model});
    return int(scene_.bsdfs.size()) - 1;
  }

  void add_shape(ObjGroup& group) {
    const std::string name = name_of(group);
    const Surface& material = surface(group);
    report_odd_faces(group, name, material.radiance.has_value());
    const auto cleaning = place_mesh(group.mesh, glm::dmat4(1.0), group.mesh.normals.empty());
    if (!cleaning) {
      context_.diagnostics.error(group.location, fmt::format("'{}': {}", name, cleaning.error().message));
      return;
    }
    for (const std::string& text : describe(*cleaning))
      warn(group.location, fmt::format("'{}': {}", name, text));
    if (group.mesh.triangles.empty()) {
      warn(group.location, fmt::format("'{}' has no triangles; it is left out{}", name,
                                       material.radiance ? ", and its light with it" : ""));
      return;
    }
    if (has_map(group.material.name) && group.mesh.texcoords.empty())
      warn(group.location,
           fmt::format("'{}' has textures, but no texture coordinates; those of each triangle are "
                       "its barycentric ones",
                       name));
    drop_face_normals(group.mesh);
    Shape shape;
    shape.name = shape.id = name;
    shape.geometry = std::move(group.mesh);
    shape.front_bsdf = shape.back_bsdf = material.bsdf;
    shape.radiance = material.radiance;
    scene_.shapes.push_back(std::move(shape));
  }

  void report_odd_faces(const ObjGroup& group, const std::string& name, bool is_light) {
    if (const OddFaces& warped = group.faces.warped; warped.count > 0)
      warn(warped.first, fmt::format("'{}': {}", name, describe_warped(group.faces)));
    if (const OddFaces& tangled = group.faces.tangled; tangled.count > 0) {
      if (is_light) {
        context_.diagnostics.error(
            tangled.first, fmt::format("'{}': this face of a light crosses itself or folds back on itself, "
                                       "so that its light is not defined",
                                       name));
      } else {
        warn(tangled.first, fmt::format("'{}': {}", name, describe_tangled(group.faces)));
      }
    }
    if (const OddFaces& odd = group.faces.too_short; odd.count > 0)
      warn(odd.first, fmt::format("'{}': {}", name, describe_too_short(group.faces)));
    if (const OddFaces& odd = group.faces.untextured; odd.count > 0)
      warn(odd.first, fmt::format("'{}': {}", name, describe_untextured(group.faces)));
  }

  [[nodiscard]] bool has_map(const std::string& material) const {
    const auto found = materials_.find(material);
    return found != materials_.end() && (found->second.diffuse_map || found->second.specular_map);
  }

  static std::string name_of(const ObjGroup& group) {
    if (group.object.empty()) return group.material.name;
    if (group.material.name.empty()) return group.object;
    return fmt::format("{} ({})", group.object, group.material.name);
  }

  void warn(SourceLocation location, std::string_view message) {
    context_.diagnostics.warn(location, message);
  }

  const Context& context_;
  const FileAccess& files_;
  SceneDescription& scene_;
  BitmapFiles bitmaps_;
  std::vector<std::unique_ptr<SourceFile>> sources_;
  std::vector<std::string> libraries_;  ///< libraries that were read or searched
  bool all_libraries_ = true;           ///< whether no library was missing
  MtlMaterials materials_;
  std::map<std::string, Surface> surfaces_;  ///< keyed by the material's name
};

}  // namespace

void read_model(const Context& context, const FileAccess& files, SceneDescription& scene) {
  ModelReader(context, files, scene).read();
}

}  // namespace penumbra::tinyrender
