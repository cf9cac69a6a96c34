// What the renders of a set are given: each thing with the values that it takes in turn.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/diagnostic.h"

namespace penumbra {

enum class AxisKind {
  kScene,    ///< the scene file
  kFrame,    ///< number of a picture of a sequence
  kDefine,   ///< $NAME of the scene file, as by -D
  kSetting,  ///< as by --set
  kOption,   ///< of `penumbra render`, with a value
  kFlag,     ///< of `penumbra render`, "true" or "false"
};

/// One thing, and the values that it takes in turn.
struct RenderAxis {
  AxisKind kind = AxisKind::kOption;
  std::string name;  ///< "scene", "frame", or the variable's, setting's or option's: "integrator.max_depth"
  std::vector<std::string> values;
};

/// The renders of one [[render]] of a job file, or of the scenes of a command line: all combinations of the
/// axes' values, the last axis changing fastest.
struct RenderPattern {
  std::vector<RenderAxis> axes = {};    ///< one of each kind and name; the first is kScene
  std::optional<std::string> out = {};  ///< name of the images before its fields are filled in
  int priority = 0;
  std::filesystem::path folder = {};  ///< relative names are in it
  SourceLocation location = {};       ///< of its description, for errors
};

/// Replaces or adds.
void set_axis(std::vector<RenderAxis>& axes, RenderAxis axis);

/// How many renders these come to; 0 if they are more than `most`.
std::size_t count_combinations(const std::vector<RenderAxis>& axes, std::size_t most);

/// One value of each axis.
using RenderChoice = std::vector<std::string>;

/// All of them, the last axis changing fastest.
std::vector<RenderChoice> all_choices(const std::vector<RenderAxis>& axes);

/// What the fields of a name stand for, by axis.
using NameFields = std::map<std::string, std::string, std::less<>>;

/// The text with its fields filled in: {name}, or for a whole number {name:N} and {name:0N}, at least N wide,
/// with zeros before it. Errors: no such field, a brace without the other, a width for what is no number.
Expected<std::string> fill_in(std::string_view text, const NameFields& fields);

/// Whether the text has this field.
bool has_field(std::string_view text, std::string_view name);

/// The numbers of "FIRST..LAST" or "FIRST..LASTxSTEP", at most a million; nothing if the text is not that.
std::optional<std::vector<std::string>> range_of(std::string_view text);

}  // namespace penumbra
