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

/// JSON: an array of all settings with `key`, `kind` (integer, number, boolean, text), `values` (in words),
/// `choices`, `help`, `default` (null: none), `integrators` (empty: all), `option` (null: none).
std::string settings_description();
/// The same of all plugins: `kind` (the tag in scene files), `name`, `aliases`, `replaces` (rendered as this
/// one, with a warning), `help`, `parameters` with `name`, `values`, `default`, `help`.
std::string plugins_description();

}  // namespace penumbra
