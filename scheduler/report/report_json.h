// report.json and report.csv: all numbers of a report, for programs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "scheduler/report/report_data.h"

namespace penumbra {

/// The README of this folder explains the fields and units. Unknown values are null.
nlohmann::ordered_json report_data_json(const ReportData& report);

/// CSV (RFC 4180) with a header line and one line per image. Unknown values are empty.
std::string report_csv(const ReportData& report);

}  // namespace penumbra
