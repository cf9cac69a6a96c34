// Reading one plugin's parameters: each must be requested, so that an unknown name is an error.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/diagnostic.h"
#include "scenes/file_access.h"
#include "scenes/image/bitmap.h"
#include "scenes/mitsuba/object_tree.h"
#include "scenes/plugin_values.h"
#include "scenes/refractive_indices.h"
#include "scenes/scene_description.h"
#include "scenes/volumes.h"

namespace penumbra::mitsuba {

class MediumReader;
class TextureReader;
class VolumeReader;
enum class TextureUse;

/// What the readers of plugins share.
struct Context {
  ObjectTree& tree;
  Diagnostics& diagnostics;
  bool lenient = false;
  std::span<const std::pair<std::string, std::string>> settings = {};  ///< see ReadOptions
  bool media_seen = false;                                             ///< by the scene's integrator
  TextureReader* textures = nullptr;                                   ///< while a scene is built
  MediumReader* media = nullptr;                                       ///< likewise
  VolumeReader* volumes = nullptr;                                     ///< likewise
  const FileAccess* files = nullptr;                                   ///< likewise

  /// The object, or the one that is referred to; null, and an error, where there is none of that id.
  Object* resolve(const Child& child) const;

  /// Where the files that the object names are looked for: beside its own file, then where the scene says.
  [[nodiscard]] std::vector<std::filesystem::path> folders(const Object& object) const;

  /// "bsdf type 'x' is not one that Penumbra reads; …": an error, or with `lenient` a warning that ends in
  /// `instead`, "it is left out" for example.
  void unknown_plugin(const Object& object, std::span<const std::string> known,
                      std::string_view instead) const;

  /// What there is no counterpart for: an error, or with `lenient` a warning that ends in `instead`.
  void unsupported(SourceLocation location, std::string_view what, std::string_view instead) const;

  /// Whether faults that some programs pass over are warnings: where the program that the file is for does,
  /// or with `lenient`.
  [[nodiscard]] bool is_tolerant() const { return lenient || tree.is_tolerant; }
  /// Such a fault: a warning that ends in `instead`, once with its count, or an error that ends in `hint`.
  void tolerable(SourceLocation location, std::string_view what, std::string_view instead,
                 std::string_view hint = "") const;

  /// Whether the command line sets this, whatever the file says.
  [[nodiscard]] bool is_replaced(std::string_view key) const;
};

/// How a colour is made from a spectrum, and what values it may have.
enum class ColourRole {
  kReflectance,  ///< in [0, 1]
  kEmission,     ///< at least 0
  kIndex,        ///< likewise, without a colour of its own
};

class PluginReader {
 public:
  PluginReader(const Context& context, const Object& object);

  /// The value of a parameter, or `fallback` where it is not given; an error where it is of another kind.
  double number(std::string_view name, double fallback);
  bool boolean(std::string_view name, bool fallback);
  std::string text(std::string_view name, std::string_view fallback);
  std::optional<glm::dvec3> point(std::string_view name);
  glm::dmat4 transform(std::string_view name);
  /// Sets the colour, in linear Rec. 709, where it is given. A texture is none that can be read.
  void read_colour(std::string_view name, glm::vec3& colour, ColourRole role);

  /// See TextureReader::read_image.
  std::shared_ptr<const Bitmap> read_image(const std::string& filename);

  // Rows of parameters (bsdfs.h): sets what is given, if it is one of the values.
  void read(std::string_view name, TexturedColour& colour, const ColourWithin& values);
  void read(std::string_view name, TexturedColour& colour, const IndexColour& values);
  void read(std::string_view name, float& index, const RefractiveIndex& values);
  void read(std::string_view name, TexturedNumber& number, const NumberWithin& values);
  void read(std::string_view name, float& number, const NumberWithin& values);
  void read(std::string_view name, bool& value, const TrueOrFalse& values);
  void read(std::string_view name, glm::vec3& colour, const ColourWithin& values);
  void read(std::string_view name, glm::vec3& colour, const VolumeColour& values);
  void read(std::string_view name, GriddedColour& colour, const VolumeColour& values);
  void read(std::string_view name, glm::dvec3& value, AnyPoint values);
  void read(std::string_view name, double& value, AnyNumber values);
  void read(std::string_view name, glm::dmat4& value, AnyTransform values);
  void read(std::string_view name, std::string& value, FileName values);
  void read(std::string_view name, std::string& value, AnyText values);
  void read(std::string_view name, std::int64_t& value, const WholeNumber& values);
  template <typename T>
  void read(std::string_view name, T& value, const OneOf<T>& values) {
    if (!has(name)) return skip_parameter(name);
    const Expected<T> parsed = values.parse(text(name, ""));
    if (parsed) value = *parsed;
    if (!parsed) wrong_value(name, fmt::format("{}: {}", name, parsed.error().message));
  }

  /// All the parameters of a struct of rows.
  template <typename Model>
  void read_parameters(Model& model) {
    if constexpr (requires { model.written_for(context_.tree.major_version); })
      model.written_for(context_.tree.major_version);
    Model::parameters([&](const char* name, auto member, const auto& values, const char*) {
      read(name, model.*member, values);
    });
    Findings findings;
    const auto given = [&](std::string_view name) { return has(name) || has_nested(name); };
    if constexpr (requires { model.complete(findings, given); })
      model.complete(findings, given);
    else if constexpr (requires { model.complete(findings); })
      model.complete(findings);
    report(findings);
  }

  /// Sets every parameter among `names` that is given, as "group.name" (see settings.h). `prefix` goes before
  /// the parameter's name in the key.
  void settings(SceneDescription& scene, std::string_view group, std::span<const std::string> names,
                std::string_view prefix = "");

  /// Known, but without effect on the image: how a file is written, for example.
  void accept(std::initializer_list<std::string_view> names);

  [[nodiscard]] bool has(std::string_view name) const;
  /// A nested object of that name: a texture, for example.
  [[nodiscard]] bool has_nested(std::string_view name) const;

  /// The nested objects of that kind, in order, references followed.
  std::vector<const Object*> nested(std::string_view tag);

  /// The same with their names.
  std::vector<std::pair<std::string, const Object*>> named(std::string_view tag);

  /// The only nested object of that kind, if there is one; more are an error.
  const Object* only_nested(std::string_view tag);

  /// Reports parameters and nested objects that were not requested.
  void finish();
  /// The same for a plugin that is not known: what it has goes unread.
  void skip() { finished_ = true; }

  /// Of the parameter's value, or of the plugin if the parameter is not given.
  [[nodiscard]] SourceLocation location_of(std::string_view parameter) const;
  /// There.
  void wrong(std::string_view parameter, std::string_view message) const;
  void wrong(std::string_view message) const;
  void warn(std::string_view message) const;

  [[nodiscard]] const Object& object() const { return object_; }
  /// "bsdf 'diffuse'".
  [[nodiscard]] std::string title() const;

 private:
  const Parameter* take(std::string_view name);
  /// Known, and not given.
  void skip_parameter(std::string_view name) { known_.emplace_back(name); }
  void report(const Findings& findings) const;
  /// The texture that stands for the parameter, if one does: its index, or none and an error.
  struct TakenTexture {
    bool there = false;
    std::optional<int> index;
  };
  TakenTexture take_texture(std::string_view name, TextureUse use);
  void read_textured(std::string_view name, TexturedColour& colour, ColourRole role, const auto& values);
  /// Without `grid` a grid is an error.
  void read_volume(std::string_view name, glm::vec3& colour, GriddedColour* grid, const VolumeColour& values);
  void read_plain(std::string_view name, glm::vec3& colour, ColourRole role, const auto& values);
  template <typename T>
  const T* take_as(std::string_view name, std::string_view wanted);
  void wrong_kind(const Parameter& parameter, std::string_view wanted) const;
  std::optional<glm::vec3> colour_of(const Parameter& parameter, ColourRole role) const;
  std::optional<std::vector<SpectrumSample>> spectrum_of_file(const Parameter& parameter,
                                                              const std::string& filename) const;
  /// The one number that stands for a colour where a number is wanted, as in Mitsuba 3: the mean of its
  /// channels. Nothing where the parameter is no colour.
  std::optional<float> number_of_colour(std::string_view name);
  [[nodiscard]] const Object* colour_plugin(std::string_view name);
  void set_colour(std::string_view name, const glm::vec3& rgb, glm::vec3& colour, ColourRole role) const;
  [[nodiscard]] glm::vec3 tolerated(std::string_view name, glm::vec3 rgb, ColourRole role) const;
  /// A value that the parameter cannot have: with leniency its default stands in for it.
  void wrong_value(std::string_view name, std::string_view message) const;

  struct Nested {
    const Object* object;
    std::string name;
    SourceLocation location;
    bool taken = false;
  };

  const Context& context_;
  const Object& object_;
  std::vector<bool> taken_;
  std::vector<Nested> nested_;
  std::vector<std::string> known_;
  bool finished_ = false;
};

/// A plugin that is read, by its type: each kind of object has a table of them. Rows have what their kind
/// needs, a function as a rule.
template <typename Rows>
auto find_plugin(const Rows& rows, std::string_view type) -> decltype(&*std::begin(rows)) {
  for (const auto& row : rows)
    if (row.type == type) return &row;
  return nullptr;
}

/// For messages.
template <typename Rows>
std::vector<std::string> plugin_types(const Rows& rows) {
  std::vector<std::string> types;
  for (const auto& row : rows) types.emplace_back(row.type);
  return types;
}

/// The object's id, or what and where it is.
std::string name_of(const Object& object);

/// What stands in for a material, light colour or texture that is not read: nothing in nature has this
/// colour.
constexpr glm::vec3 kPlaceholderColour(0.8f, 0.2f, 0.8f);

}  // namespace penumbra::mitsuba
