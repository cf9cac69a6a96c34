#include "scheduler/report/summary_table.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "scheduler/files/html_text.h"
#include "scheduler/files/quoting.h"

namespace penumbra {
namespace {

std::string metric_name(const Target& target) {
  return target.blocks ? "relMSE of blocks" : target.relative ? "relMSE" : "MSE";
}

/// The longest run, null for a curve without points.
const CurvePoint* longest(const ReportData& report, const ErrorCurve& curve) {
  const CurvePoint* found = nullptr;
  for (const CurvePoint& point : curve.points)
    if (found == nullptr || report.seconds(point.seconds) > report.seconds(found->seconds)) found = &point;
  return found;
}

/// The shortest digits that read back as the same number.
std::string exact(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

void add_slope(const Slope& slope, std::vector<std::string>& fields) {
  const SlopeFit fit = slope.fit.value_or(SlopeFit{NAN, NAN, NAN, NAN});
  fields.insert(fields.end(),
                {exact(fit.slope), exact(fit.low), exact(fit.high), csv_quoted(slope.none_because)});
}

/// 0.012, or $1.2\cdot10^{-5}$.
std::string latex_number(double value) {
  if (!std::isfinite(value)) return "--";
  const std::string text = fmt::format("{:.3g}", value);
  const std::size_t e = text.find('e');
  if (e == std::string::npos) return "$" + text + "$";
  const std::string digits = text.substr(0, e);
  return fmt::format("${}10^{{{}}}$", digits == "1" ? "" : digits + "\\cdot", std::stoi(text.substr(e + 1)));
}

std::string latex_slope(const Slope& slope) {
  if (!slope.fit) return "--";
  return fmt::format("${:.2f}$ [${:.2f}$, ${:.2f}$]", slope.fit->slope, slope.fit->low, slope.fit->high);
}

std::string latex_time(const std::optional<TimeToTarget>& time) {
  using Kind = TimeToTarget::Kind;
  if (!time) return "--";
  switch (time->kind) {
    case Kind::kShorter:
      return "$<$ " + latex_number(time->cost);
    case Kind::kNotReached:
      return "$>$ " + latex_number(time->cost);
    case Kind::kMeasured:
      break;
  }
  return latex_number(time->cost);
}

std::string latex_scene(const ReportData& report, const SceneReport& scene) {
  std::string columns = "lllrr", head = "method & slope of MSE over $T$ & over samples & $T$ in s & relMSE";
  for (const Target& target : scene.targets) {
    columns += 'r';
    head += fmt::format(" & $T$ to {} {}", metric_name(target), latex_number(target.error));
  }
  std::string rows;
  for (std::size_t i = 0; i < scene.curves.size(); ++i) {
    const ErrorCurve& curve = scene.curves[i];
    const CurvePoint* last = longest(report, curve);
    rows += fmt::format("{} & {} & {} & {} & {}", latex_escaped(curve.name.label),
                        latex_slope(curve.mse_over_time), latex_slope(curve.mse_over_spp),
                        latex_number(last != nullptr ? report.seconds(last->seconds) : NAN),
                        latex_number(last != nullptr ? last->errors.relative_mse : NAN));
    for (std::size_t t = 0; t < scene.targets.size(); ++t) {
      const std::string time = latex_time(curve.to_target[t]);
      rows += " & " + (fastest_curve(scene, t) == i ? "\\textbf{" + time + "}" : time);
    }
    rows += " \\\\\n";
  }
  return fmt::format(
      "\n% {}\n\\begin{{tabular}}{{{}}}\n\\hline\n{} \\\\\n\\hline\n{}\\hline\n\\end{{tabular}}\n",
      latex_escaped(scene.name), columns, head, rows);
}

}  // namespace

std::string target_name(const Target& target) {
  return metric_name(target) + " " + number_text(target.error);
}

std::string target_text(const std::optional<TimeToTarget>& time) {
  using Kind = TimeToTarget::Kind;
  if (!time) return "–";
  switch (time->kind) {
    case Kind::kShorter:
      return "< " + seconds_text(time->cost);
    case Kind::kNotReached:
      return "not reached in " + seconds_text(time->cost);
    case Kind::kMeasured:
      break;
  }
  return seconds_text(time->cost);
}

std::optional<std::size_t> fastest_curve(const SceneReport& scene, std::size_t target) {
  std::vector<std::optional<TimeToTarget>> times;
  for (const ErrorCurve& curve : scene.curves) times.push_back(curve.to_target[target]);
  return fastest(times);
}

std::string summary_csv(const ReportData& report) {
  using Kind = TimeToTarget::Kind;
  std::string csv = csv_line(std::vector<std::string>{
      "scene", "method", "slope_mse_over_time", "slope_mse_over_time_low", "slope_mse_over_time_high",
      "no_slope_over_time_because", "slope_mse_over_spp", "slope_mse_over_spp_low", "slope_mse_over_spp_high",
      "no_slope_over_spp_because", "longest_seconds", "relmse", "relmse_standard_error", "efficiency",
      "target", "target_error", "seconds", "shorter_than", "longer_than"});
  for (const SceneReport& scene : report.scenes)
    for (const ErrorCurve& curve : scene.curves) {
      std::vector<std::string> fields = {csv_quoted(scene.name), csv_quoted(curve.name.label)};
      add_slope(curve.mse_over_time, fields);
      add_slope(curve.mse_over_spp, fields);
      const CurvePoint* last = longest(report, curve);
      fields.push_back(last != nullptr ? exact(report.seconds(last->seconds)) : "");
      fields.push_back(last != nullptr ? exact(last->errors.relative_mse) : "");
      fields.push_back(last != nullptr ? exact(last->relative_mse_error) : "");
      fields.push_back(curve.efficiency ? exact(*curve.efficiency) : "");
      for (std::size_t t = 0; t < scene.targets.size(); ++t) {
        const auto& time = curve.to_target[t];
        std::vector<std::string> line = fields;
        line.insert(line.end(), {metric_name(scene.targets[t]), exact(scene.targets[t].error)});
        for (const Kind kind : {Kind::kMeasured, Kind::kShorter, Kind::kNotReached})
          line.push_back(time && time->kind == kind ? exact(time->cost) : "");
        csv += csv_line(line);
      }
      if (scene.targets.empty()) {
        fields.resize(fields.size() + 5);
        csv += csv_line(fields);
      }
    }
  return csv;
}

std::string summary_latex(const ReportData& report) {
  std::string text = fmt::format(
      "{}: {} {}\n% T: {} time in seconds; slopes with their 95 % interval; -- where none can be fitted.\n"
      "% T to an error: < and > are bounds from the shortest and the longest run.\n",
      kLatexMarker, latex_escaped(report.host), report.finished, report.total_time ? "total" : "render");
  for (const SceneReport& scene : report.scenes) text += latex_scene(report, scene);
  return text;
}

}  // namespace penumbra
