#include <nlohmann/json.hpp>

#include <cmath>

#include "scheduler/stress/table.h"

namespace penumbra::stress {
namespace {

using nlohmann::ordered_json;

/// JSON has no NaN and no infinities, so they become strings.
ordered_json number(double x) {
  if (std::isnan(x)) return "nan";
  if (std::isinf(x)) return x > 0 ? "inf" : "-inf";
  return x;
}

ordered_json numbers(const Numbers& values) {
  ordered_json list = ordered_json::array();
  for (const double x : values) list.push_back(number(x));
  return list;
}

ordered_json outcome_json(const Outcome& o) {
  ordered_json json;
  json["backend"] = o.backend;
  json["verdict"] = verdict_name(o.verdict);
  json["result"] = numbers(o.value);
  json["error"] = number(o.error);
  if (!o.note.empty()) json["note"] = o.note;
  json["seconds"] = o.seconds;
  return json;
}

ordered_json case_json(const CaseResult& r) {
  const Case& c = *r.tested;
  ordered_json json;
  json["name"] = c.name;
  json["group"] = group_of(c);
  json["stiff"] = c.stiff;
  json["quantity"] = c.quantity;
  json["verdict"] = verdict_name(r.verdict);
  if (const auto* kernel = std::get_if<KernelMeasurement>(&c.measurement))
    json["inputs"] = numbers(kernel->inputs);
  json["truth"] = numbers(r.truth);
  json["truth_by"] = c.truth.how;
  json["allowed_error"] = number(r.allowed);
  json["allowed_because"] = c.allowed.why;
  json["same_bits"] = r.same_bits;
  json["outcomes"] = ordered_json::array();
  for (const Outcome& o : r.outcomes) json["outcomes"].push_back(outcome_json(o));
  return json;
}

}  // namespace

ordered_json table_json(std::span<const CaseResult> results, const TableContext& context) {
  const Counts counts = count(results);
  ordered_json json;
  json["penumbra"] = context.version;
  json["host"] = context.host;
  json["date"] = context.date;
  json["backends"] = context.backends;
  json["seconds"] = context.seconds;
  json["passed"] = counts.passed;
  json["failed"] = counts.failed;
  json["skipped"] = counts.skipped;
  json["cases"] = ordered_json::array();
  for (const CaseResult& r : results) json["cases"].push_back(case_json(r));
  return json;
}

}  // namespace penumbra::stress
