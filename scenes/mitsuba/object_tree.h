// The contents of a Mitsuba XML file after all XML processing: includes are merged, $variables substituted,
// names normalised to snake_case, and values parsed. The meaning of plugins is not known here.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <glm/glm.hpp>
#include <initializer_list>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "scenes/diagnostic.h"
#include "scenes/motion/keyed_transform.h"
#include "scenes/spectrum.h"

namespace penumbra::mitsuba {

/// <rgb> and <srgb>, linear Rec. 709.
struct RgbValue {
  glm::vec3 rgb{0.0f};
};

/// <spectrum>: constant over wavelength (no samples), tabulated, or tabulated in a file.
struct SpectrumValue {
  double constant = 0.0;
  std::vector<SpectrumSample> samples;
  std::string filename;
};

/// <animation>: keys that keyed_transform accepts.
struct AnimationValue {
  std::vector<TransformKey> keys;
};

/// <animation> of strings: at least one, with finite, ascending times.
struct TextKey {
  double time = 0.0;  ///< in seconds
  std::string text;
  SourceLocation location;  ///< of the text
};
struct TextAnimationValue {
  std::vector<TextKey> keys;
};

/// <integer>, <float>, <boolean>, <string>, <point> or <vector>, <rgb> or <srgb>, <spectrum>, <transform>,
/// <animation>.
using Value = std::variant<std::int64_t, double, bool, std::string, glm::dvec3, RgbValue, SpectrumValue,
                           glm::dmat4, AnimationValue, TextAnimationValue>;

struct Parameter {
  std::string name;  ///< snake_case
  std::string tag;   ///< the element it came from, for messages
  Value value;
  std::string text;               ///< for a scalar: the text as written, for settings
  SourceLocation location;        ///< of the element
  SourceLocation value_location;  ///< of the `value` attribute, or else of the element
};

struct Object;

/// A nested object, or a <ref> to one.
struct Child {
  std::string name;  ///< snake_case; often empty
  Object* object = nullptr;
  std::string reference;  ///< the referenced id, if there is no object
  SourceLocation location;
};

/// A plugin, for example <bsdf type="diffuse" id="white">….
struct Object {
  std::string tag;   ///< bsdf, shape, …
  std::string type;  ///< diffuse, obj, …; empty for <scene>
  std::string id;
  SourceLocation location;
  SourceLocation type_location;
  std::vector<Parameter> parameters;
  std::vector<Child> children;
};

struct ObjectTree {
  std::vector<std::unique_ptr<SourceFile>> files;  ///< the source files; locations point into them
  std::deque<Object> objects;                      ///< a deque, so that addresses stay valid
  Object scene;                    ///< its children are the top-level objects of all included files
  std::int64_t major_version = 3;  ///< of the scene file
  /// The program for which the file was written ignores unknown parameters and similar faults.
  bool is_tolerant = false;
  bool uses_variables = false;           ///< see SceneDescription
  bool faceted_without_normals = false;  ///< meshes whose files have no normals are faceted (Nori)
  std::map<std::string, Object*> by_id;
  std::vector<std::filesystem::path>
      folders;  ///< folders in which files are searched: that of the scene file, then each <path>

  /// Adds an object that nothing holds yet.
  Object& new_object(std::string_view tag, std::string_view type, SourceLocation location) {
    Object& object = objects.emplace_back();
    object.tag = tag;
    object.type = type;
    object.location = object.type_location = location;
    return object;
  }
};

/// The object with other names of its parameters and of the objects inside it: what each was, and is.
inline Object renamed(const Object& object,
                      std::initializer_list<std::pair<std::string_view, const char*>> names) {
  Object result = object;
  const auto rename = [&](auto& named) {
    for (const auto& [from, to] : names)
      if (named.name == from) {
        named.name = to;
        return;
      }
  };
  for (Parameter& parameter : result.parameters) rename(parameter);
  for (Child& child : result.children) rename(child);
  return result;
}

}  // namespace penumbra::mitsuba
