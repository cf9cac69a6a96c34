// The parameters that vary within a set of renders, each with its list of values.
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
  kFrame,    ///< frame number of an image sequence
  kDefine,   ///< $NAME in the scene file, as by -D
  kSetting,  ///< as by --set
  kOption,   ///< option of `penumbra render` with a value
  kFlag,     ///< option of `penumbra render` that is "true" or "false"
};

/// A parameter and its list of values.
struct RenderAxis {
  AxisKind kind = AxisKind::kOption;
  /// "scene", "frame", or the name of the variable, setting or option: "integrator.max_depth"
  std::string name;
  std::vector<std::string> values;
};

/// The renders of one [[render]] table of a job file, or of the scenes of a command line: all combinations of
/// the axes' values, with the last axis varying fastest.
struct RenderPattern {
  std::vector<RenderAxis> axes = {};    ///< at most one for each kind and name; the first is kScene
  std::optional<std::string> out = {};  ///< pattern for the image's name, with fields
  int priority = 0;
  std::string name = {};                ///< by which others come after it; empty: none
  std::vector<std::string> after = {};  ///< names of those that must be done before
  std::filesystem::path folder = {};    ///< relative names are relative to this folder
  SourceLocation location = {};         ///< where the pattern is defined, for errors
};

/// Replaces the axis of the same kind and name, or adds it.
void set_axis(std::vector<RenderAxis>& axes, RenderAxis axis);

/// The number of combinations; 0 if it exceeds `most`.
std::size_t count_combinations(const std::vector<RenderAxis>& axes, std::size_t most);

/// One value for each axis.
using RenderChoice = std::vector<std::string>;

/// All combinations, with the last axis varying fastest.
std::vector<RenderChoice> all_choices(const std::vector<RenderAxis>& axes);

/// The values of fields in a name, keyed by the axes' names.
using NameFields = std::map<std::string, std::string, std::less<>>;

/// Substitutes the fields of a text: {name}, or for an integer {name:N} and {name:0N}, at least N wide, the
/// latter with leading zeros. Errors: an unknown field, an unbalanced brace, a width for something that is
/// not a number.
Expected<std::string> fill_in(std::string_view text, const NameFields& fields);

/// Whether the text contains the field {name}.
bool has_field(std::string_view text, std::string_view name);

/// The numbers of a range "FIRST..LAST" or "FIRST..LASTxSTEP", at most a million. Nothing if the text is not
/// a range.
std::optional<std::vector<std::string>> range_of(std::string_view text);

}  // namespace penumbra
