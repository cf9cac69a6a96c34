// The reference of all plugins that are read, made from the rows of their parameters.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra {

struct PluginParameter {
  std::string name;
  std::string values;         ///< what is right, in words
  std::string default_value;  ///< empty: there is none, or an empty text
  std::string text;           ///< what it is
};

struct PluginEntry {
  std::string kind;  ///< the tag in Mitsuba's files: "bsdf"
  std::string name;
  std::string text;  ///< up to its first semicolon a phrase for a list
  std::vector<PluginParameter> parameters;
  std::vector<std::string> aliases = {};   ///< other names, read as this one
  std::vector<std::string> replaces = {};  ///< plugins that this one renders instead, with a warning

  [[nodiscard]] std::string phrase() const { return text.substr(0, text.find(';')); }
  /// Whether it is called so in files, also by another name.
  [[nodiscard]] bool is_called(std::string_view other) const;
};

/// All that Mitsuba's files may hold, by kind.
std::span<const PluginEntry> all_plugins();

}  // namespace penumbra
