// The plots of a report, all log-log: error against render time and against samples.
#pragma once

#include <filesystem>

#include "scheduler/report/report_data.h"

namespace penumbra {

/// The gnuplot script of the plot over time, without terminal and output.
std::string time_plot_script(const ReportData& report, const SceneReport& scene);
std::string spp_plot_script(const SceneReport& scene);
/// Bias^2 and variance against samples, for each curve with at least two seeds. Empty if there is nothing to
/// show.
std::string bias_plot_script(const SceneReport& scene);
/// MSE against samples for each sampler, with the expected convergence rates as dashed lines. Empty for fewer
/// than two samplers.
std::string sampler_plot_script(const SceneReport& scene);

/// Draws all plots of the scene into `folder` with gnuplot.
Expected<std::vector<Plot>> draw_plots(const std::filesystem::path& gnuplot,
                                       const std::filesystem::path& folder, const ReportData& report,
                                       const SceneReport& scene);

/// The colour of a curve as #rrggbb, from the eight colours of Okabe and Ito (2008), which most people can
/// distinguish.
std::string curve_color(std::size_t index);

}  // namespace penumbra
