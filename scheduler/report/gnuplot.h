// Plots through the program gnuplot.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

/// Where gnuplot is. Error: it is not in PATH; says how to get it.
Expected<std::filesystem::path> find_gnuplot();

struct GnuplotOutput {
  std::string svg;
  std::vector<std::uint8_t> png;
};

/// Runs a script that draws one plot and sets neither terminal nor output; text of users is in it by
/// gnuplot_quoted. Script, SVG and PNG stay in `folder` as NAME.gp, NAME.svg, NAME.png, see file_name_of.
/// Errors: what gnuplot says, or that it left no plot.
Expected<GnuplotOutput> run_gnuplot(const std::filesystem::path& gnuplot, const std::filesystem::path& folder,
                                    const std::string& name, const std::string& script, int width,
                                    int height);

}  // namespace penumbra
