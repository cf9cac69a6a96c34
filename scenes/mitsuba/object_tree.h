// A Mitsuba XML file after everything that is XML about it is done: includes joined, $variables filled in,
// names spelt one way, values parsed. What the plugins mean is not known here.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "scenes/diagnostic.h"
#include "scenes/spectrum.h"

namespace penumbra::mitsuba {

/// <rgb> and <srgb>, linear Rec. 709.
struct RgbValue {
  glm::vec3 rgb{0.0f};
};

/// <spectrum>: the same at all wavelengths (no samples), tabulated, or tabulated in a file.
struct SpectrumValue {
  double constant = 0.0;
  std::vector<SpectrumSample> samples;
  std::string filename;
};

/// <animation>: transforms at times that ascend, at least one.
struct AnimationValue {
  struct Key {
    double time;
    glm::dmat4 transform;
  };
  std::vector<Key> keys;
};

/// <integer>, <float>, <boolean>, <string>, <point> or <vector>, <rgb> or <srgb>, <spectrum>, <transform>,
/// <animation>.
using Value = std::variant<std::int64_t, double, bool, std::string, glm::dvec3, RgbValue, SpectrumValue,
                           glm::dmat4, AnimationValue>;

struct Parameter {
  std::string name;  ///< snake_case
  std::string tag;   ///< the element it came from, for messages
  Value value;
  std::string text;               ///< of a scalar value, as written, for settings
  SourceLocation location;        ///< of the element
  SourceLocation value_location;  ///< of its value attribute, or the element
};

struct Object;

/// An object nested in another, or a <ref> to one.
struct Child {
  std::string name;  ///< snake_case; often empty
  Object* object = nullptr;
  std::string reference;  ///< the id, where there is no object
  SourceLocation location;
};

/// A plugin: <bsdf type="diffuse" id="white">…
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
  std::vector<std::unique_ptr<SourceFile>> files;  ///< that the locations point into
  std::deque<Object> objects;                      ///< addresses stay valid
  Object scene;                                    ///< its children are the top level of all included files
  std::int64_t major_version = 3;                  ///< of the scene file
  /// The program that the file is for passes over parameters that it does not know, and the like.
  bool is_tolerant = false;
  bool faceted_without_normals = false;  ///< meshes whose files have no normals (Nori)
  std::map<std::string, Object*> by_id;
  std::vector<std::filesystem::path>
      folders;  ///< of the scene file, then of each <path>: where files are looked for
};

}  // namespace penumbra::mitsuba
