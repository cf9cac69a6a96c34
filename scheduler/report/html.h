// Writes index.html: the report as a self-contained page that needs no network.
#pragma once

#include <string>

#include "scheduler/report/report_data.h"

namespace penumbra {

/// Marks the pages of this program; it is in every page.
constexpr const char* kReportPageMarker = "<meta name=\"generator\" content=\"penumbra report\">";

std::string report_html(const ReportData& report);

/// The section of one scene, without its heading.
std::string scene_tables_html(const ReportData& report, const SceneReport& scene);
std::string scene_crops_html(const SceneReport& scene);

}  // namespace penumbra
