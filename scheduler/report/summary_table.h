// The table of methods: its cells as text, and the whole of it for papers.
#pragma once

#include <optional>
#include <string>

#include "scheduler/report/report_data.h"

namespace penumbra {

/// "relMSE 0.001".
std::string target_name(const Target& target);
/// "1.5 s", "< 0.02 s", "not reached in 3 s"; "–" if nothing is known.
std::string target_text(const std::optional<TimeToTarget>& time);
/// The index of the curve that certainly reaches the target first; see fastest().
std::optional<std::size_t> fastest_curve(const SceneReport& scene, std::size_t target);

/// A line for each scene, method and target.
std::string summary_csv(const ReportData& report);

/// The first line of summary_latex.
constexpr const char* kLatexMarker = "% penumbra report";

/// A tabular for each scene; needs no packages.
std::string summary_latex(const ReportData& report);

}  // namespace penumbra
