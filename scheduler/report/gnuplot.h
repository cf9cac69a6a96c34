// Draws plots with the program gnuplot.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

/// Finds gnuplot. Error: it is not in PATH; the message says how to install it.
Expected<std::filesystem::path> find_gnuplot();

struct GnuplotOutput {
  std::string svg;
  std::vector<std::uint8_t> png;
};

/// Runs a script that draws one plot and sets neither terminal nor output. Text of users must be quoted with
/// gnuplot_quoted. Script, SVG and PNG are stored in `folder` as NAME.gp, NAME.svg, NAME.png; see
/// file_name_of. Errors: gnuplot's message, or that it produced no plot.
Expected<GnuplotOutput> run_gnuplot(const std::filesystem::path& gnuplot, const std::filesystem::path& folder,
                                    const std::string& name, const std::string& script, int width,
                                    int height);

}  // namespace penumbra
