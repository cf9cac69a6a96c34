#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "scheduler/stress/table.h"

namespace penumbra::stress {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// Outcomes with the same verdict and value, with the names of all their backends.
struct Row {
  const Outcome* outcome;
  std::vector<std::string> backends;
};

std::vector<Row> rows_of(const CaseResult& result) {
  std::vector<Row> rows;
  for (const Outcome& o : result.outcomes) {
    if (o.verdict == Verdict::kSkipped && result.verdict != Verdict::kSkipped) continue;
    const auto same = std::find_if(rows.begin(), rows.end(), [&](const Row& row) {
      return row.outcome->verdict == o.verdict && row.outcome->note == o.note &&
             have_same_bits({*row.outcome, o});
    });
    if (same != rows.end())
      same->backends.push_back(o.backend);
    else
      rows.push_back({&o, {o.backend}});
  }
  return rows;
}

std::string short_numbers(const Numbers& numbers) {
  return numbers_text(numbers, numbers.size() > 1 ? 6 : 15);
}

}  // namespace

std::string numbers_text(const Numbers& numbers, int digits) {
  if (numbers.empty()) return "-";
  std::string text;
  for (const double x : numbers) text += fmt::format("{}{:.{}g}", text.empty() ? "" : ", ", x, digits);
  return numbers.size() > 1 ? "(" + text + ")" : text;
}

Counts count(std::span<const CaseResult> results) {
  Counts counts;
  for (const CaseResult& r : results) {
    counts.passed += r.verdict == Verdict::kPass;
    counts.failed += r.verdict == Verdict::kFail;
    counts.skipped += r.verdict == Verdict::kSkipped;
  }
  return counts;
}

bool all_pass(const Counts& counts) {
  return counts.failed == 0 && (counts.passed > 0 || counts.skipped == 0);
}

std::string table_text(std::span<const CaseResult> results, const TableContext& context) {
  std::string text;
  const auto out = std::back_inserter(text);
  for (const std::string& backend : context.backends) fmt::format_to(out, "{}\n", backend);
  std::size_t width = 20;
  for (const CaseResult& r : results) width = std::max(width, r.tested->name.size());
  const std::string header = fmt::format("{:<{}}  {:<7}  {:<24}  {:<24}  {:>8}  {:>8}  {}", "case", width,
                                         "verdict", "truth", "result", "error", "allowed", "because of");
  std::string group;
  for (const CaseResult& r : results) {
    const Case& c = *r.tested;
    if (group_of(c) != group) fmt::format_to(out, "\n{}\n", header);
    group = group_of(c);
    const std::vector<Row> rows = rows_of(r);
    for (const Row& row : rows) {
      const bool first = &row == rows.data();
      fmt::format_to(out, "{:<{}}  {:<7}  {:<24}  {:<24}  {:>8.1e}  {:>8.1e}  {}\n", first ? c.name : "",
                     width, verdict_name(row.outcome->verdict), first ? short_numbers(r.truth) : "",
                     short_numbers(row.outcome->value), row.outcome->error, r.allowed,
                     first ? c.allowed.why : "");
      if (rows.size() > 1) fmt::format_to(out, "{:<{}}    on {}\n", "", width, joined(row.backends));
      if (!row.outcome->note.empty()) fmt::format_to(out, "{:<{}}    {}\n", "", width, row.outcome->note);
    }
    if (r.verdict == Verdict::kFail)
      fmt::format_to(out, "{:<{}}    {}: {}; truth by {}\n", "", width, c.quantity, c.stiff, c.truth.how);
  }
  const Counts counts = count(results);
  std::vector<std::string> failed;
  for (const CaseResult& r : results) {
    if (r.verdict == Verdict::kFail) failed.push_back(r.tested->name);
  }
  if (!failed.empty()) fmt::format_to(out, "\nfailed: {}\n", joined(failed));
  const auto same = std::count_if(results.begin(), results.end(),
                                  [](const CaseResult& r) { return r.outcomes.size() > 1 && r.same_bits; });
  const auto several = std::count_if(results.begin(), results.end(),
                                     [](const CaseResult& r) { return r.outcomes.size() > 1; });
  fmt::format_to(out,
                 "\n{} passed, {} failed, {} skipped; {} of {} with the same bits on all "
                 "backends; {:.1f} s\n",
                 counts.passed, counts.failed, counts.skipped, same, several, context.seconds);
  return text;
}

std::string list_text(std::span<const Case> cases) {
  std::size_t width = 20;
  for (const Case& c : cases) width = std::max(width, c.name.size());
  std::string text;
  for (const Case& c : cases) text += fmt::format("{:<{}}  {}\n", c.name, width, c.stiff);
  return text;
}

}  // namespace penumbra::stress
