// The table as text, JSON and HTML.
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
/// Nothing failed, and not everything that could have been tested was skipped.
bool all_pass(const Counts& counts);

/// What the table was made on, a line each.
struct TableContext {
  std::vector<std::string> backends;  ///< their descriptions, or why one is skipped
  double seconds = 0;
};

/// "1.2345678901234567", "(0.1, 0.2, 0.3)", with so many digits.
std::string numbers_text(const Numbers& numbers, int digits);

/// A line for each case, outcomes that are the same in one: name, truth, result, error, allowed error and
/// why, verdict.
std::string table_text(std::span<const CaseResult> results, const TableContext& context);
nlohmann::ordered_json table_json(std::span<const CaseResult> results, const TableContext& context);
/// A page that needs no other file.
std::string table_html(std::span<const CaseResult> results, const TableContext& context);
/// Names and what is stiff about them.
std::string list_text(std::span<const Case> cases);

}  // namespace penumbra::stress
