// The plots of a report, all log-log: error against render time and against samples.
#pragma once

#include <filesystem>

#include "scheduler/report/report_data.h"

namespace penumbra {

// The gnuplot scripts of the plots, without terminal and output. `report` is for the axes: plots of one kind
// have the same in all scenes of the report. Error bars are standard errors over the seeds.

/// relMSE over time, and a line of slope -1.
std::string time_plot_script(const ReportData& report, const SceneReport& scene);
std::string spp_plot_script(const ReportData& report, const SceneReport& scene);
/// Bias^2 and variance against samples, for each curve with at least two seeds. Empty if there is nothing to
/// show.
std::string bias_plot_script(const ReportData& report, const SceneReport& scene);
/// MSE against samples for each sampler, with the expected convergence rates as dashed lines. Empty for fewer
/// than two samplers.
std::string sampler_plot_script(const ReportData& report, const SceneReport& scene);

/// Draws all plots of the scene into `folder` with gnuplot. `report` holds this scene and the others.
Expected<std::vector<Plot>> draw_plots(const std::filesystem::path& gnuplot,
                                       const std::filesystem::path& folder, const ReportData& report,
                                       const SceneReport& scene);

}  // namespace penumbra
