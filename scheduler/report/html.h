// index.html: the report as one page that needs nothing else, no network either.
#pragma once

#include <string>

#include "scheduler/report/report_data.h"

namespace penumbra {

/// In every page, and so in none of another program.
constexpr const char* kReportPageMarker = "<meta name=\"generator\" content=\"penumbra report\">";

std::string report_html(const ReportData& report);

/// One scene's section, without its head.
std::string scene_tables_html(const ReportData& report, const SceneReport& scene);
std::string scene_crops_html(const SceneReport& scene);

}  // namespace penumbra
