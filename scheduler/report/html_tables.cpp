#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "scheduler/files/html_text.h"
#include "scheduler/files/quoting.h"
#include "scheduler/report/curve_builder.h"
#include "scheduler/report/html.h"
#include "scheduler/report/plot_svg.h"
#include "scheduler/report/sampler_orders.h"
#include "scheduler/report/summary_table.h"

namespace penumbra {
namespace {

std::string swatch(std::size_t index, const std::string& label) {
  return fmt::format("<span class=\"swatch\" style=\"background:var({})\"></span>{}",
                     curve_color_variable(index), html_escaped(label));
}

std::string fit_text(const Slope& slope) {
  if (!slope.fit)
    return slope.none_because.empty()
               ? "–"
               : "<span class=\"why\">no slope: " + html_escaped(slope.none_because) + "</span>";
  return fmt::format("{:.2f} [{:.2f}, {:.2f}]", slope.fit->slope, slope.fit->low, slope.fit->high);
}

/// One row per curve, one column per budget.
std::string equal_sample_table(const SceneReport& scene) {
  std::set<std::uint32_t> budgets;
  for (const ErrorCurve& curve : scene.curves)
    for (const CurvePoint& point : curve.points)
      if (point.spp > 0) budgets.insert(point.spp);
  std::vector<std::string> header = {"relMSE at spp"};
  for (const std::uint32_t spp : budgets) header.push_back(fmt::to_string(spp));
  HtmlTable table("At equal samples", header);
  for (std::size_t i = 0; i < scene.curves.size(); ++i) {
    if (scene.curves[i].name.peer) continue;
    std::vector<std::string> cells = {swatch(i, scene.curves[i].name.label)};
    for (const std::uint32_t spp : budgets) {
      const auto& points = scene.curves[i].points;
      const auto found = std::ranges::find(points, spp, &CurvePoint::spp);
      cells.push_back(found == points.end() ? "–" : number_text(found->errors.relative_mse));
    }
    table.add(cells);
  }
  return "<h3>At equal samples</h3>\n" + table.text();
}

/// relMSE at times a factor of two apart, interpolated in log-log.
std::string equal_time_table(const ReportData& report, const SceneReport& scene) {
  double low = INFINITY, high = 0;
  for (const ErrorCurve& curve : scene.curves)
    for (const CurvePoint& point : curve.points) {
      low = std::min(low, report.seconds(point.seconds));
      high = std::max(high, report.seconds(point.seconds));
    }
  if (!(low > 0) || !std::isfinite(low)) return {};
  constexpr double kMostColumns = 9;
  const double step = std::max(2.0, std::pow(high / low, 1 / kMostColumns));
  std::vector<double> times;
  for (double time = low * std::sqrt(step); time < high; time *= step) times.push_back(time);
  if (times.empty()) return {};
  std::vector<std::string> header = {"relMSE at T"};
  for (const double time : times) header.push_back(seconds_text(time));
  HtmlTable table("At equal time", header);
  for (std::size_t i = 0; i < scene.curves.size(); ++i) {
    std::vector<std::string> cells = {swatch(i, scene.curves[i].name.label)};
    for (const double time : times)
      cells.push_back(number_text(error_at_time(report, scene.curves[i], time)));
    table.add(cells);
  }
  return "<h3>At equal time</h3>\n" + table.text() +
         "<p class=\"quiet\">Interpolated between budgets; – outside of them.</p>\n";
}

std::string split_text(const ErrorSplit& split) {
  return fmt::format("{} ± {}", number_text(split.bias_squared), number_text(split.bias_squared_error));
}

std::string bias_table(const SceneReport& scene) {
  HtmlTable table("Bias and variance",
                  {"method", "spp", "relMSE", "variance", "bias²", "bias² in standard errors", "mean error"});
  bool any = false;
  for (std::size_t i = 0; i < scene.curves.size(); ++i)
    for (const CurvePoint& point : scene.curves[i].points) {
      if (point.images.size() < 2) continue;
      any = true;
      const ErrorSplit& split = point.relative;
      const double z = split.bias_squared_error > 0 ? split.bias_squared / split.bias_squared_error : 0;
      const std::string z_text = fmt::format("{:.1f}", z);
      table.add({swatch(i, scene.curves[i].name.label), fmt::to_string(point.spp), number_text(split.error),
                 number_text(split.variance), split_text(split), z > 4 ? "<b>" + z_text + "</b>" : z_text,
                 number_text(point.errors.bias)});
    }
  if (!any) return {};
  return "<details><summary>Bias² and variance</summary>\n" + table.text() +
         "<p class=\"quiet\">Relative, as relMSE. What is within a few standard errors of 0 is no sign of "
         "bias.</p></details>\n";
}

std::string points_table(const SceneReport& scene) {
  HtmlTable table("All budgets",
                  {"method", "spp", "images", "build", "transfer", "render", "total", "MSE", "relMSE",
                   "trimmed", "of blocks", "MAPE", "SMAPE", "largest", "left out", "load"});
  for (std::size_t i = 0; i < scene.curves.size(); ++i) {
    const ErrorCurve& curve = scene.curves[i];
    const bool peer = curve.name.peer;
    for (const CurvePoint& point : curve.points) {
      double load = 0;
      for (const ImageResult& image : point.images) load = std::max(load, image.load_after);
      const auto known = [&](const std::string& text) { return peer ? std::string("–") : text; };
      const ImageErrors& e = point.errors;
      table.add({swatch(i, curve.name.label), point.spp > 0 ? fmt::to_string(point.spp) : "–",
                 fmt::to_string(point.images.size()), known(seconds_text(point.seconds.build)),
                 known(seconds_text(point.seconds.transfer)), known(seconds_text(point.seconds.render)),
                 seconds_text(point.seconds.total), number_text(e.mse), number_text(e.relative_mse),
                 number_text(e.trimmed_relative_mse), number_text(e.block_relative_mse), number_text(e.mape),
                 number_text(e.smape), number_text(e.largest), fmt::to_string(e.non_finite),
                 known(fmt::format("{:.1f}", load))});
    }
  }
  return "<details><summary>All budgets: times and errors</summary>\n" + table.text() +
         "<p class=\"quiet\">Trimmed: relMSE without the worst 0.1 % of the pixels. Of blocks: relMSE of the "
         "means of 4 × 4 pixels. Left out: pixels that "
         "are NaN "
         "or infinite. Load: the largest load average after an image.</p></details>\n";
}

std::string sampler_table(const SceneReport& scene) {
  std::set<std::string> samplers;
  for (const ErrorCurve& curve : scene.curves)
    if (!curve.name.peer) samplers.insert(curve.name.sampler);
  if (samplers.size() < 2) return {};
  HtmlTable table("Samplers", {"sampler", "slope of MSE over spp", "expected: smooth", "expected: edges"});
  for (std::size_t i = 0; i < scene.curves.size(); ++i) {
    const ErrorCurve& curve = scene.curves[i];
    if (curve.name.peer) continue;
    const auto order = expected_order(curve.name.sampler);
    table.add({swatch(i, curve.name.label), fit_text(curve.mse_over_spp),
               order ? fmt::format("{:g}", order->smooth) : "–",
               order ? fmt::format("{:g}", order->edges) : "–"});
  }
  return "<h3>Convergence of samplers</h3>\n" + table.text() +
         "<p class=\"quiet\">Expected of one pixel with a smooth integrand, and of one with an edge, in two "
         "dimensions; more dimensions and paths of many vertices lie between these and −1.</p>\n";
}

}  // namespace

std::string scene_summary_html(const SceneReport& scene) {
  std::vector<std::string> header = {"method", "slope of MSE over T", "slope of relMSE over T",
                                     "slope of MSE over spp"};
  for (const Target& target : scene.targets) header.push_back("T to " + target_name(target));
  header.insert(header.end(), {"efficiency 1 / (MSE T)", "estimates"});
  HtmlTable table("Methods", header);
  for (std::size_t i = 0; i < scene.curves.size(); ++i) {
    const ErrorCurve& curve = scene.curves[i];
    std::vector<std::string> cells = {swatch(i, curve.name.label), fit_text(curve.mse_over_time),
                                      fit_text(curve.relmse_over_time), fit_text(curve.mse_over_spp)};
    for (std::size_t t = 0; t < scene.targets.size(); ++t) {
      const std::string text = html_escaped(target_text(curve.to_target[t]));
      cells.push_back(fastest_curve(scene, t) == i ? "<b>" + text + "</b>" : text);
    }
    cells.push_back(curve.efficiency ? number_text(*curve.efficiency) : "– (" + curve.no_efficiency + ")");
    cells.push_back(curve.name.peer ? "another renderer’s images" : html_escaped(curve.name.quantity));
    table.add(cells);
  }
  return "<h3>Methods</h3>\n" + table.text() +
         (scene.target_chosen
              ? "<p class=\"quiet\">The target is the smallest relMSE that the longest runs of "
                "all methods reach (--target sets others).</p>\n"
              : "");
}

std::string scene_tables_html(const ReportData& report, const SceneReport& scene) {
  return equal_sample_table(scene) + equal_time_table(report, scene) + sampler_table(scene) +
         bias_table(scene) + points_table(scene);
}

}  // namespace penumbra
