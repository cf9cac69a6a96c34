// The reference of all supported plugins, generated from the table rows of their parameters.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra {

struct PluginParameter {
  std::string name;
  std::string values;         ///< the accepted values, in words
  std::string default_value;  ///< empty: no default, or the empty text
  std::string text;           ///< description
};

struct PluginEntry {
  std::string kind;  ///< the tag in Mitsuba's files: "bsdf"
  std::string name;
  std::string text;  ///< description; the part before its first semicolon is short enough for a list
  std::vector<PluginParameter> parameters;
  std::vector<std::string> aliases = {};   ///< other names of the same plugin
  std::vector<std::string> replaces = {};  ///< plugins that are rendered as this one, with a warning

  [[nodiscard]] std::string phrase() const { return text.substr(0, text.find(';')); }
  /// Whether `other` is the plugin's name in scene files or one of its aliases.
  [[nodiscard]] bool is_called(std::string_view other) const;
};

/// All supported plugins of Mitsuba's scene files, sorted by kind.
std::span<const PluginEntry> all_plugins();

}  // namespace penumbra
