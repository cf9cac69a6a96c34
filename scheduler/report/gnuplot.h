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

/// One plot. The script sets neither terminal nor output; text of users in it must be quoted with
/// gnuplot_quoted.
struct GnuplotInput {
  std::string script;
  std::string title, description;  ///< for screen readers
  int width = 0, height = 0;       ///< of the SVG in pixels; the PNG has twice as many
};

/// Draws a plot. Script, SVG and PNG are stored in `folder` as NAME.gp, NAME.svg, NAME.png; see file_name_of.
/// Errors: gnuplot's message, or that it produced no plot.
Expected<GnuplotOutput> run_gnuplot(const std::filesystem::path& gnuplot, const std::filesystem::path& folder,
                                    const std::string& name, const GnuplotInput& input);

}  // namespace penumbra
