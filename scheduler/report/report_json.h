// report.json and report.csv: all numbers of a report, for programs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "scheduler/report/report_data.h"

namespace penumbra {

/// Fields and units are explained in the README of this folder. What is not known is null.
nlohmann::ordered_json report_data_json(const ReportData& report);

/// One line for each image, with a header line; RFC 4180: fields with commas, quotes or line ends in quotes.
/// What is not known is empty.
std::string report_csv(const ReportData& report);

}  // namespace penumbra
