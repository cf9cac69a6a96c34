// A method as named on the command line: an integrator with settings and a label.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

struct Method {
  std::string label;                  ///< in plots and tables
  std::string integrator;             ///< empty: the scene's own
  std::vector<std::string> settings;  ///< integrator.key=value, as for --set
};

/// [LABEL=]NAME[:KEY=VALUE,…]; keys without a dot are the integrator's. The label is the text without LABEL=
/// unless given. Errors: an unknown integrator (names the nearest), a setting without a value. What settings
/// there are is the scene reader's to say.
Expected<Method> parse_method(std::string_view text);

/// Budgets in samples per pixel, ascending: "4..64" doubles from 4 up to at most 64; "1,2,8" is a list.
/// Errors: no positive whole numbers, the same twice, the first of a range above the second.
Expected<std::vector<std::uint32_t>> parse_budgets(std::string_view text);

/// "relmse=1e-3", "mse=0.01" or "block_relmse=1e-3".
struct Target {
  bool relative = true;  ///< of relMSE, else of MSE
  double error = 0;
  bool blocks = false;  ///< relMSE of the means of blocks, see block_relative_mse
};
Expected<Target> parse_target(std::string_view text);

}  // namespace penumbra
