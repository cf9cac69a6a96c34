// Reads the parameters of a plugin. Every parameter must be requested by its name, so that unknown parameters
// are detected.
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
  bool media_seen = false;            ///< the scene's integrator supports media
  TextureReader* textures = nullptr;  ///< set while a scene is built
  MediumReader* media = nullptr;      ///< set while a scene is built
  VolumeReader* volumes = nullptr;    ///< set while a scene is built
  const FileAccess* files = nullptr;  ///< set while a scene is built

  /// The nested object, or the one to which the reference points. Null, and an error, if no object has that
  /// id.
  Object* resolve(const Child& child) const;

  /// The folders in which files of the object are searched: that of its own source file, then those of the
  /// scene.
  [[nodiscard]] std::vector<std::filesystem::path> folders(const Object& object) const;

  /// Reports "bsdf type 'x' is not one that Penumbra reads; …": an error, or with `lenient` a warning that
  /// ends in `instead`, "it is left out" for example.
  void unknown_plugin(const Object& object, std::span<const std::string> known,
                      std::string_view instead) const;

  /// Reports a feature that is not supported: an error, or with `lenient` a warning that ends in `instead`.
  void unsupported(SourceLocation location, std::string_view what, std::string_view instead) const;

  /// Whether faults that some programs ignore are only warnings: because the program for which the file was
  /// written ignores them, or because of `lenient`.
  [[nodiscard]] bool is_tolerant() const { return lenient || tree.is_tolerant; }
  /// Reports such a fault: a warning that ends in `instead` and is shown once with its count, or an error
  /// that ends in `hint`.
  void tolerable(SourceLocation location, std::string_view what, std::string_view instead,
                 std::string_view hint = "") const;

  /// Whether the command line sets this setting and so overrides the file.
  [[nodiscard]] bool is_replaced(std::string_view key) const;
};

/// How a spectrum is converted to a colour, and the values that are valid.
enum class ColourRole {
  kReflectance,  ///< in [0, 1]
  kEmission,     ///< at least 0
  kIndex,        ///< at least 0; a quantity that is not a colour, such as a refractive index
};

class PluginReader {
 public:
  PluginReader(const Context& context, const Object& object);

  /// The value of a parameter, or `fallback` if it is not given. It is an error if it has another type.
  double number(std::string_view name, double fallback);
  bool boolean(std::string_view name, bool fallback);
  std::string text(std::string_view name, std::string_view fallback);
  std::optional<glm::dvec3> point(std::string_view name);
  glm::dmat4 transform(std::string_view name);
  /// Sets the colour, in linear Rec. 709, if the parameter is given. Textures are not accepted.
  void read_colour(std::string_view name, glm::vec3& colour, ColourRole role);

  /// See TextureReader::read_image.
  std::shared_ptr<const Bitmap> read_image(const std::string& filename);

  // For the rows of parameters (bsdfs.h): sets the member if the parameter is given and its value is valid.
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

  /// Reads all parameters of a struct that lists them as rows.
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

  /// Sets the setting "group.name" (see settings.h) for each parameter in `names` that is given. `prefix` is
  /// inserted before the parameter's name in the key.
  void settings(SceneDescription& scene, std::string_view group, std::span<const std::string> names,
                std::string_view prefix = "");

  /// Accepts parameters that have no effect on the image, for example those of the output file.
  void accept(std::initializer_list<std::string_view> names);

  /// Whether the file is of Mitsuba 0.x or of a program that reads such files.
  [[nodiscard]] bool is_of_version_0() const { return context_.tree.major_version == 0; }
  [[nodiscard]] bool has(std::string_view name) const;
  /// Whether there is a nested object of that name, for example a texture.
  [[nodiscard]] bool has_nested(std::string_view name) const;

  /// The nested objects of that kind in order, with references resolved.
  std::vector<const Object*> nested(std::string_view tag);

  /// The same with their names.
  std::vector<std::pair<std::string, const Object*>> named(std::string_view tag);

  /// The nested object of that kind, or null. More than one is an error.
  const Object* only_nested(std::string_view tag);

  /// Reports parameters and nested objects that were not requested.
  void finish();
  /// Suppresses these reports for an unknown plugin.
  void skip() { finished_ = true; }

  /// The location of the parameter's value, or of the plugin if the parameter is not given.
  [[nodiscard]] SourceLocation location_of(std::string_view parameter) const;
  /// Reports an error at location_of(parameter).
  void wrong(std::string_view parameter, std::string_view message) const;
  void wrong(std::string_view message) const;
  void warn(std::string_view message) const;

  [[nodiscard]] const Object& object() const { return object_; }
  /// "bsdf 'diffuse'".
  [[nodiscard]] std::string title() const;

 private:
  const Parameter* take(std::string_view name);
  /// Marks a parameter as requested that is known not to be given.
  void skip_parameter(std::string_view name) { known_.emplace_back(name); }
  void report(const Findings& findings) const;
  /// The texture given for a parameter: its index, or none after an error.
  struct TakenTexture {
    bool there = false;
    std::optional<int> index;
  };
  TakenTexture take_texture(std::string_view name, TextureUse use);
  void read_textured(std::string_view name, TexturedColour& colour, ColourRole role, const auto& values);
  /// Reads a colour that may be a volume. A grid is an error if `grid` is null.
  void read_volume(std::string_view name, glm::vec3& colour, GriddedColour* grid, const VolumeColour& values);
  void read_plain(std::string_view name, glm::vec3& colour, ColourRole role, const auto& values);
  template <typename T>
  const T* take_as(std::string_view name, std::string_view wanted);
  void wrong_kind(const Parameter& parameter, std::string_view wanted) const;
  std::optional<glm::vec3> colour_of(const Parameter& parameter, ColourRole role) const;
  std::optional<std::vector<SpectrumSample>> spectrum_of_file(const Parameter& parameter,
                                                              const std::string& filename) const;
  /// The number for a colour that is given in place of a number: the mean of its channels, as in Mitsuba 3.
  /// Nothing if the parameter is not a colour.
  std::optional<float> number_of_colour(std::string_view name);
  [[nodiscard]] const Object* colour_plugin(std::string_view name);
  void set_colour(std::string_view name, const glm::vec3& rgb, glm::vec3& colour, ColourRole role) const;
  [[nodiscard]] glm::vec3 tolerated(std::string_view name, glm::vec3 rgb, ColourRole role) const;
  /// Reports an invalid value. In lenient mode the default is used instead.
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

/// The row of the plugin with that type name. Each kind of object has a table of its plugins; a row usually
/// holds a function.
template <typename Rows>
auto find_plugin(const Rows& rows, std::string_view type) -> decltype(&*std::begin(rows)) {
  for (const auto& row : rows)
    if (row.type == type) return &row;
  return nullptr;
}

/// The type names of a table's rows, for messages.
template <typename Rows>
std::vector<std::string> plugin_types(const Rows& rows) {
  std::vector<std::string> types;
  for (const auto& row : rows) types.emplace_back(row.type);
  return types;
}

/// The object's id; if it has none, its type and location.
std::string name_of(const Object& object);

/// The placeholder colour of a material, light or texture that could not be read. It is deliberately
/// unnatural.
constexpr glm::vec3 kPlaceholderColour(0.8f, 0.2f, 0.8f);

}  // namespace penumbra::mitsuba
