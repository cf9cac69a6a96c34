// Formats the results as text, JSON and HTML.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "scheduler/stress/backend.h"
#include "scheduler/stress/verdict.h"

namespace penumbra::stress {

struct Counts {
  int passed = 0, failed = 0, skipped = 0;
};
Counts count(std::span<const CaseResult> results);
/// True if nothing failed, and at least something was not skipped.
bool all_pass(const Counts& counts);

/// The environment of the run, one line each.
struct TableContext {
  std::vector<std::string> backends;  ///< descriptions of the backends, or why one is skipped
  double seconds = 0;
  std::string host, date, version;
};

/// Numbers with `digits` digits: "1.2345678901234567", "(0.1, 0.2, 0.3)".
std::string numbers_text(const Numbers& numbers, int digits);

/// One line per case, or per group of equal outcomes: name, truth, result, error, allowed error and its
/// reason, verdict.
std::string table_text(std::span<const CaseResult> results, const TableContext& context);
nlohmann::ordered_json table_json(std::span<const CaseResult> results, const TableContext& context);
/// A self-contained page: failures, groups, then all cases with a filter.
std::string table_html(std::span<const CaseResult> results, const TableContext& context);
/// The names of cases and why they are hard.
std::string list_text(std::span<const Case> cases);

}  // namespace penumbra::stress
