// A method of a report as given on the command line: an integrator with settings and a label.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

struct Method {
  std::string label;                  ///< shown in plots and tables
  std::string integrator;             ///< empty: the scene's own
  std::vector<std::string> settings;  ///< integrator.key=value, as for --set
};

/// Parses [LABEL=]NAME[:KEY=VALUE,…]. Keys without a dot are parameters of the integrator. Without LABEL= the
/// label is the text itself. Errors: an unknown integrator (suggests the nearest), a setting without a value.
/// The scene reader checks later whether the settings exist.
Expected<Method> parse_method(std::string_view text);

/// Parses budgets in samples per pixel, ascending: "4..64" doubles from 4 up to at most 64; "1,2,8" is a
/// list. Errors: a number that is not a positive integer, duplicates, a range whose first number exceeds the
/// second.
Expected<std::vector<std::uint32_t>> parse_budgets(std::string_view text);

/// "relmse=1e-3", "mse=0.01" or "block_relmse=1e-3".
struct Target {
  bool relative = true;  ///< relMSE, else MSE
  double error = 0;
  bool blocks = false;  ///< relMSE of block means; see block_relative_mse
};
Expected<Target> parse_target(std::string_view text);

}  // namespace penumbra
