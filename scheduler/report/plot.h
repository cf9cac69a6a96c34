// The plots of a report: error against run time and against samples, log-log.
#pragma once

#include <filesystem>

#include "scheduler/report/report_data.h"

namespace penumbra {

/// What one plot shows, as a gnuplot script without terminal and output.
std::string time_plot_script(const ReportData& report, const SceneReport& scene);
std::string spp_plot_script(const SceneReport& scene);
/// Bias^2 and variance of each curve with two seeds or more against samples; empty where there is nothing to
/// show.
std::string bias_plot_script(const SceneReport& scene);
/// MSE of the samplers against samples, with the orders expected of them as dashed lines; empty where there
/// are fewer than two samplers.
std::string sampler_plot_script(const SceneReport& scene);

/// All plots of the scene, drawn by gnuplot into `folder`.
Expected<std::vector<Plot>> draw_plots(const std::filesystem::path& gnuplot,
                                       const std::filesystem::path& folder, const ReportData& report,
                                       const SceneReport& scene);

/// Colours of curves, for the eight that most people tell apart (Okabe and Ito 2008), as #rrggbb.
std::string curve_color(std::size_t index);

}  // namespace penumbra
