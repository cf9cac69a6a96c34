#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "scheduler/files/html_text.h"
#include "scheduler/files/quoting.h"
#include "scheduler/stress/table.h"

namespace penumbra::stress {
namespace {

constexpr const char* kStyle = R"css(
body { max-width: 1400px; font-size: 14px; }
h2 { margin: 36px 0 6px; } p { margin: 6px 0; max-width: 90ch; }
table { width: 100%; }
th, td { text-align: left; vertical-align: top; padding: 5px 12px 5px 0; border-bottom: 1px solid var(--line); }
th { font-weight: 600; color: var(--quiet); border-bottom-color: var(--quiet); } td { overflow-wrap: anywhere; }
td.n { font: 13px/1.5 ui-monospace, monospace; }
small { font-size: 12.5px; color: var(--quiet); display: block; }
.pass { color: var(--good); } .skipped { color: var(--quiet); }
.FAIL { color: #fff; background: #b3202a; padding: 1px 6px; border-radius: 3px; font-weight: 600; }
.failed { border: 2px solid var(--bad); border-radius: 6px; padding: 2px 14px 10px; margin: 20px 0; } .failed h2 { margin: 10px 0 2px; color: var(--bad); }
.meter { display: block; position: relative; width: 100%; min-width: 60px; max-width: 240px; height: 10px; margin: 5px 0;
  background: var(--soft); border: 1px solid var(--quiet); border-radius: 2px; overflow: hidden; }
.meter span { display: block; height: 100%; background: var(--good); } .meter .over { background: var(--bad); }
.groups { max-width: 900px; } .groups td:first-child { white-space: nowrap; } .groups .meter { display: inline-block; width: 200px; margin: 0 10px 0 0; }
.groups small { display: inline; } .cases { table-layout: fixed; } .cases th:nth-child(1) { width: 70px; } .cases th:nth-child(2) { width: 23%; } .cases th:nth-child(6) { width: 13%; }
.filter { position: sticky; top: 0; background: var(--page); padding: 10px 0; z-index: 1; }
.filter input { font: inherit; font-size: 16px; color: var(--text); background: var(--page); border: 1px solid var(--quiet); border-radius: 5px;
  padding: 7px 10px; width: 100%; max-width: 420px; } .filter input::placeholder { color: var(--quiet); opacity: 1; } .filter output { color: var(--quiet); display: inline-block; padding: 4px 0; }
@media (max-width: 800px) {
  .cases thead { display: none; } .cases, .cases tbody, .cases tr, .cases td { display: block; }
  .cases tr { border: 1px solid var(--line); border-radius: 6px; padding: 8px 12px; margin: 8px 0; } .cases tr[hidden] { display: none; }
  .cases td { border: 0; padding: 3px 0; } .cases td[data-label]::before { content: attr(data-label) ": "; color: var(--quiet); font: 12.5px/1.5 system-ui, sans-serif; }
  .groups td, .groups th { padding-right: 8px; } .groups .meter { display: block; width: 100%; margin: 5px 0; }
}
)css";

/// Hides the rows in which not all words of the filter occur, and groups without rows.
constexpr const char* kScript = R"js(<script>
const filter = document.querySelector(".filter"), words = filter.querySelector("input"), count = filter.querySelector("output");
const groups = [...document.querySelectorAll("section.group")].map(section =>
  ({section, rows: [...section.querySelectorAll("tbody tr")].map(row => ({row, text: row.textContent.toLowerCase()}))}));
const update = () => {
  const wanted = words.value.toLowerCase().split(/\s+/).filter(word => word);
  let shown = 0;
  for (const {section, rows} of groups) {
    let any = false;
    for (const {row, text} of rows) {
      row.hidden = !wanted.every(word => text.includes(word));
      if (!row.hidden) { any = true; ++shown; }
    }
    section.hidden = !any;
  }
  count.textContent = shown + (shown === 1 ? " case" : " cases");
};
words.addEventListener("input", update);
filter.hidden = false;
update();
</script>
)js";

/// The error over the allowed error: NaN without an error, infinite for an error where none is allowed.
double share(double error, double allowed) {
  if (error == 0) return 0;
  return allowed > 0 ? error / allowed : error * INFINITY;
}

/// The largest share of a case's outcomes that were not skipped; NaN if one has no error, or there are none.
double largest_share(const CaseResult& r) {
  double largest = NAN;
  for (const Outcome& o : r.outcomes) {
    if (o.verdict == Verdict::kSkipped) continue;
    const double here = share(o.error, r.allowed);
    if (std::isnan(here)) return NAN;
    largest = std::isnan(largest) ? here : std::max(largest, here);
  }
  return largest;
}

/// The same to compare cases by: nothing is worse than no error.
double badness(const CaseResult& r) {
  const double part = largest_share(r);
  return std::isnan(part) ? INFINITY : part;
}

std::string percent(double part) {
  if (!std::isfinite(part)) return std::isnan(part) ? "–" : "∞";
  return part == 0      ? "0"
         : part < 0.001 ? "< 0.1 %"
                        : fmt::format("{:.{}f} %", 100 * part, part < 0.1 ? 1 : 0);
}

/// A bar that is full where the error is the allowed one, and red above.
std::string meter(double part) {
  const double width = std::isnan(part) ? 100 : 100 * std::clamp(part, 0.0, 1.0);
  return fmt::format(
      "<span class=\"meter\" aria-hidden=\"true\"><span{} style=\"width:{:.3g}%\"></span></span>",
      part <= 1 ? "" : " class=\"over\"", width);
}

std::string error_cell(const CaseResult& r) {
  std::string html = r.verdict == Verdict::kSkipped ? "" : meter(largest_share(r));
  const bool alike = r.same_bits && r.verdict == Verdict::kPass;
  for (const Outcome& o : r.outcomes) {
    if (o.verdict == Verdict::kSkipped) continue;
    html += fmt::format("{:.1e}{}", o.error, alike ? "" : "<small>" + html_escaped(o.backend) + "</small>");
    if (alike) break;
  }
  return html + fmt::format("<small>of {:.1e} allowed</small>", r.allowed);
}

std::string result_cell(const CaseResult& r) {
  std::string html;
  for (const Outcome& o : r.outcomes) {
    if (r.same_bits && r.verdict == Verdict::kPass) {
      if (o.verdict != Verdict::kSkipped) return numbers_text(o.value, 12);
      continue;
    }
    html += fmt::format("{}<small>{}{}{}</small>", numbers_text(o.value, 12), html_escaped(o.backend),
                        o.note.empty() ? "" : ": ", html_escaped(o.note));
  }
  return html;
}

void add_case(const CaseResult& r, std::string& html) {
  const Case& c = *r.tested;
  fmt::format_to(
      std::back_inserter(html),
      "<tr><td><span class=\"{0}\">{0}</span></td><td>{1}<small>{2}</small></td>"
      "<td data-label=\"quantity\">{3}<small>truth by {4}</small></td>"
      "<td class=\"n\" data-label=\"truth\">{5}</td><td class=\"n\" data-label=\"result\">{6}</td>"
      "<td class=\"n\" data-label=\"error\">{7}</td><td data-label=\"allowed for\">{8}</td></tr>\n",
      verdict_name(r.verdict), html_escaped(c.name), html_escaped(c.stiff), html_escaped(c.quantity),
      html_escaped(c.truth.how), numbers_text(r.truth, 12), result_cell(r), error_cell(r),
      html_escaped(c.allowed.why));
}

constexpr const char* kTableBegin =
    "<table class=\"cases\"><thead><tr><th scope=\"col\">verdict</th><th scope=\"col\">case</th><th "
    "scope=\"col\">quantity</th><th scope=\"col\">truth</th><th scope=\"col\">result</th><th "
    "scope=\"col\">error</th><th scope=\"col\">allowed for</th></tr></thead><tbody>\n";
constexpr const char* kTableEnd = "</tbody></table>\n";

std::string failures_html(std::span<const CaseResult> results) {
  const int failed = count(results).failed;
  if (failed == 0) return "<p>No case failed.</p>\n";
  std::string html = fmt::format("<div class=\"failed\"><h2>Failed: {}</h2>\n{}", failed, kTableBegin);
  for (const CaseResult& r : results)
    if (r.verdict == Verdict::kFail) add_case(r, html);
  return html + kTableEnd + "</div>\n";
}

/// The results of each group. They are beside each other in the table.
std::vector<std::span<const CaseResult>> groups_of(std::span<const CaseResult> results) {
  std::vector<std::span<const CaseResult>> groups;
  for (std::size_t begin = 0, end = 0; begin < results.size(); begin = end) {
    while (end < results.size() && group_of(*results[end].tested) == group_of(*results[begin].tested)) ++end;
    groups.push_back(results.subspan(begin, end - begin));
  }
  return groups;
}

/// Of each group, with the case whose error is the largest part of the allowed one.
std::string groups_html(const std::vector<std::span<const CaseResult>>& groups) {
  std::string html =
      "<h2>Groups</h2>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Groups\"><table "
      "class=\"groups\"><thead><tr><th scope=\"col\">group</th><th scope=\"col\">cases</th><th "
      "scope=\"col\">failed</th><th scope=\"col\">skipped</th><th scope=\"col\">largest error over "
      "allowed</th></tr></thead><tbody>\n";
  for (const auto& group : groups) {
    const Counts counts = count(group);
    const CaseResult* worst = nullptr;
    for (const CaseResult& r : group) {
      if (r.verdict == Verdict::kSkipped) continue;
      if (worst == nullptr || badness(r) > badness(*worst)) worst = &r;
    }
    html += fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
        html_escaped(group_of(*group.front().tested)), group.size(),
        counts.failed > 0 ? fmt::format("<span class=\"FAIL\">{}</span>", counts.failed) : "0",
        counts.skipped,
        worst == nullptr ? "–"
                         : fmt::format("{}<small>{}, {}</small>", meter(largest_share(*worst)),
                                       percent(largest_share(*worst)), html_escaped(worst->tested->name)));
  }
  return html + "</tbody></table></div>\n";
}

}  // namespace

std::string table_html(std::span<const CaseResult> results, const TableContext& context) {
  const Counts counts = count(results);
  std::string html = fmt::format(
      "<h1>Stiff and extreme cases</h1>\n<p><b>{} passed, {} failed, {} skipped</b> in {:.1f} s, on {}, {}, "
      "Penumbra {}.</p>\n",
      counts.passed, counts.failed, counts.skipped, context.seconds, html_escaped(context.host),
      html_escaped(context.date), html_escaped(context.version));
  for (const std::string& backend : context.backends)
    html += "<div class=\"quiet\">" + html_escaped(backend) + "</div>\n";
  const auto groups = groups_of(results);
  html += failures_html(results) + groups_html(groups);
  html +=
      "<h2>Cases</h2>\n<p class=\"quiet\">A result is shown once where all backends have the same bits.</p>\n"
      "<div class=\"filter\" hidden><input type=\"search\" aria-label=\"Filter cases\" placeholder=\"Filter "
      "by "
      "words of a row\"> <output></output></div>\n";
  for (const auto& group : groups) {
    html += fmt::format("<section class=\"group\"><h2>{}</h2>\n{}",
                        html_escaped(group_of(*group.front().tested)), kTableBegin);
    for (const CaseResult& r : group) add_case(r, html);
    html += std::string(kTableEnd) + "</section>\n";
  }
  return html_page("Penumbra: stiff and extreme cases", kStyle, "", html + kScript);
}

}  // namespace penumbra::stress
