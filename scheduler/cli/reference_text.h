// What `penumbra plugins` and `penumbra settings` print, for a terminal of so many columns.
#pragma once

#include <string>

#include "kernels/host/error.h"

namespace penumbra {

/// A line for each plugin, by kind.
std::string plugins_overview(int columns);
/// All of the plugins of that name, other name or kind. The error suggests one.
Expected<std::string> plugins_text(const std::string& name, int columns);

/// A line for each setting, by group.
std::string settings_overview(int columns);
/// All of the setting of that key, with or without its group, or of the settings of that group. The error
/// suggests one.
Expected<std::string> settings_text(const std::string& name, int columns);

}  // namespace penumbra
