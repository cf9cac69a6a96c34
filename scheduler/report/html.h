// Writes index.html: the report as a self-contained page that needs no network.
#pragma once

#include <string>

#include "scheduler/report/report_data.h"

namespace penumbra {

/// Marks the pages of this program; it is in every page.
constexpr const char* kReportPageMarker = "<meta name=\"generator\" content=\"penumbra report\">";

std::string report_html(const ReportData& report);

/// Parts of the section of one scene: the table of methods, the pictures, the other tables.
std::string scene_summary_html(const SceneReport& scene);
std::string scene_crops_html(const SceneReport& scene);
std::string scene_tables_html(const ReportData& report, const SceneReport& scene);

/// The whole images of reference and methods in one place, between which clicks and keys switch. Without
/// scripts they are below each other.
std::string flip_html(const CropSet& crops);
/// The script for that, a <script> element.
std::string flip_script();

}  // namespace penumbra
