// The output of `penumbra plugins` and `penumbra settings`, for a terminal of `columns` columns.
#pragma once

#include <string>

#include "kernels/host/error.h"

namespace penumbra {

/// One line per plugin, grouped by kind.
std::string plugins_overview(int columns);
/// The full descriptions of the plugins with that name, alias or kind. The error suggests a similar name.
Expected<std::string> plugins_text(const std::string& name, int columns);

/// One line per setting, by group.
std::string settings_overview(int columns);
/// The full description of a setting, given with or without its group, or of all settings of a group. The
/// error suggests a similar name.
Expected<std::string> settings_text(const std::string& name, int columns);

}  // namespace penumbra
