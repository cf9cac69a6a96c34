#include <fmt/format.h>

#include <iterator>

#include "scheduler/files/html_text.h"
#include "scheduler/files/quoting.h"
#include "scheduler/stress/table.h"

namespace penumbra::stress {
namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: light dark; }
body { font: 14px/1.45 system-ui, sans-serif; margin: 2em auto; max-width: 90em; padding: 0 1em; }
h2 { margin: 1.6em 0 .3em; font-size: 1.1em; }
table { border-collapse: collapse; width: 100%; }
th, td { text-align: left; vertical-align: top; padding: .3em .8em .3em 0; border-bottom: 1px solid #8884; }
th { font-weight: 600; }
td.n { font-family: ui-monospace, monospace; font-size: .92em; white-space: nowrap; }
small { color: #888; display: block; }
.pass { color: #2a8a3e; } .FAIL { color: #fff; background: #c0262d; padding: 0 .4em; } .skipped { color: #888; }
)";

void add_outcomes(const CaseResult& r, std::string& html) {
  const auto out = std::back_inserter(html);
  if (r.same_bits && r.verdict == Verdict::kPass) {
    const Outcome* shown = nullptr;
    for (const Outcome& o : r.outcomes) {
      if (!shown && o.verdict != Verdict::kSkipped) shown = &o;
    }
    if (!shown) return;
    fmt::format_to(out, "<td class=n>{}</td><td class=n>{:.1e}</td>", numbers_text(shown->value, 12),
                   shown->error);
    return;
  }
  std::string values, errors;
  for (const Outcome& o : r.outcomes) {
    values += fmt::format("{} <small>{}{}{}</small>", numbers_text(o.value, 12), html_escaped(o.backend),
                          o.note.empty() ? "" : ": ", html_escaped(o.note));
    errors += fmt::format("{:.1e}<small>&nbsp;</small>", o.error);
  }
  fmt::format_to(out, "<td class=n>{}</td><td class=n>{}</td>", values, errors);
}

void add_case(const CaseResult& r, std::string& html) {
  const Case& c = *r.tested;
  const auto out = std::back_inserter(html);
  fmt::format_to(out, "<tr><td><span class={0}>{0}</span></td><td>{1}<small>{2}</small></td>",
                 verdict_name(r.verdict), html_escaped(c.name), html_escaped(c.stiff));
  fmt::format_to(out, "<td>{}<small>truth by {}</small></td><td class=n>{}</td>", html_escaped(c.quantity),
                 html_escaped(c.truth.how), numbers_text(r.truth, 12));
  add_outcomes(r, html);
  fmt::format_to(out, "<td class=n>{:.1e}</td><td>{}</td></tr>\n", r.allowed, html_escaped(c.allowed.why));
}

}  // namespace

std::string table_html(std::span<const CaseResult> results, const TableContext& context) {
  const Counts counts = count(results);
  std::string html = fmt::format(
      "<h1>Stiff and extreme cases</h1>\n<p>{} passed, <b>{} failed</b>, {} skipped, in "
      "{:.1f} s. A result is shown once where all backends have the same bits.</p>\n",
      counts.passed, counts.failed, counts.skipped, context.seconds);
  for (const std::string& backend : context.backends) html += "<div>" + html_escaped(backend) + "</div>\n";
  std::string group;
  for (const CaseResult& r : results) {
    if (group_of(*r.tested) != group) {
      if (!group.empty()) html += "</table>\n";
      group = group_of(*r.tested);
      html += "<h2>" + html_escaped(group) +
              "</h2>\n<table><tr><th>verdict<th>case<th>quantity<th>truth<th>result<th>error<th>allowed<th>"
              "because of</tr>\n";
    }
    add_case(r, html);
  }
  if (!group.empty()) html += "</table>\n";
  return html_page("Penumbra: stiff and extreme cases", kStyle, "", html);
}

}  // namespace penumbra::stress
