#include "scheduler/report/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <set>

#include "scheduler/files/quoting.h"
#include "scheduler/report/curve_builder.h"
#include "scheduler/report/gnuplot.h"
#include "scheduler/report/sampler_orders.h"

namespace penumbra {
namespace {

constexpr int kWidth = 760, kHeight = 430;  // without the legend
constexpr double kClearBias = 3;            // in standard errors

constexpr std::string_view kLegendRows = "# rows of the legend: ";

int plot_height(const std::string& script) {
  constexpr int kRowHeight = 18;
  const bool told = script.starts_with(kLegendRows);
  return kHeight + (told ? kRowHeight * std::atoi(script.c_str() + kLegendRows.size()) : 0);
}

/// Collects the data blocks and plot commands of a script.
class Script {
 public:
  Script(const std::string& x_label, const std::string& y_label) {
    text_ = fmt::format(
        "set logscale xy\nset format x '10^{{%T}}'\nset format y '10^{{%T}}'\nset xlabel {}\nset ylabel {}\n"
        "set grid xtics ytics mxtics mytics lc rgb '#dddddd' lw 1, lc rgb '#eeeeee' lw 1\n"
        "set border lc rgb '#777777'\nset key outside above left horizontal samplen 2 reverse "
        "Left\n"
        "set tics textcolor rgb '#333333'\n",
        gnuplot_quoted(x_label), gnuplot_quoted(y_label));
  }
  void line(const std::string& text) { text_ += text + "\n"; }

  /// Adds points; `with` is gnuplot's plot style. Points without a logarithm are not drawn.
  void add(const std::vector<CostError>& points, const std::string& with, const std::string& title) {
    std::string rows;
    for (const CostError& point : points) {
      if (!(point.cost > 0 && point.error > 0) || !std::isfinite(point.error)) continue;
      rows += fmt::format("{:.9g} {:.9g}\n", point.cost, point.error);
    }
    if (rows.empty()) return;
    const std::string name = fmt::format("$d{}", blocks_++);
    text_ += fmt::format("{} << EOD\n{}EOD\n", name, rows);
    if (!title.empty()) titles_.push_back(title);
    plots_ += fmt::format("{}{} using 1:2 with {} {}", plots_.empty() ? "plot " : ", \\\n     ", name, with,
                          title.empty() ? "notitle" : "title " + gnuplot_quoted(title));
  }
  [[nodiscard]] bool empty() const { return plots_.empty(); }
  /// The legend is above the plot, in as many columns as fit. Its rows increase the height; see plot_height.
  [[nodiscard]] std::string text() const {
    if (empty()) return "";
    std::size_t longest = 1;
    for (const std::string& title : titles_) longest = std::max(longest, title.size());
    const std::size_t columns = std::clamp<std::size_t>(kWidth / (8 * longest + 50), 1, 4);
    const std::size_t rows = (titles_.size() + columns - 1) / columns;
    return fmt::format("{}{}\n{}set key maxcols {}\n{}\n", kLegendRows, rows, text_, columns, plots_);
  }

 private:
  std::string text_, plots_;
  std::vector<std::string> titles_;
  int blocks_ = 0;
};

/// Readable ticks: powers of ten as numbers, or 1-2-5 steps for short ranges.
void set_axis(Script& script, char axis, const std::vector<double>& values) {
  double low = INFINITY, high = 0;
  for (const double value : values) {
    if (!(value > 0) || !std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (!(high > 0)) return;
  low /= 1.35;
  high *= 1.35;
  const double decades = std::log10(high / low);
  std::string ticks;
  for (int e = int(std::floor(std::log10(low))); e <= int(std::ceil(std::log10(high))); ++e)
    for (const double digit : {1.0, 2.0, 5.0}) {
      if (digit > 1 && decades > 3.2) continue;
      const double value = digit * std::pow(10.0, e);
      if (value < low || value > high) continue;
      ticks += fmt::format("{}'{:g}' {:g}", ticks.empty() ? "" : ", ", value, value);
    }
  script.line(fmt::format("set {}range [{:.6g}:{:.6g}]", axis, low, high));
  script.line(fmt::format("set {}tics ({})", axis, ticks));
}

/// Ticks at the budgets in samples per pixel, or at every second, fourth, … of them.
void set_budget_axis(Script& script, const std::vector<double>& values) {
  const std::set<double> budgets(values.begin(), values.end());
  if (budgets.empty()) return;
  constexpr std::size_t kMostTicks = 10;
  const std::size_t stride = (budgets.size() + kMostTicks - 1) / kMostTicks;
  std::string ticks;
  std::size_t i = 0;
  for (const double budget : budgets) {
    if (i++ % stride == 0)
      ticks += fmt::format("{}'{:.10g}' {:.10g}", ticks.empty() ? "" : ", ", budget, budget);
  }
  script.line(fmt::format("set xrange [{:.6g}:{:.6g}]", *budgets.begin() / 1.35, *budgets.rbegin() * 1.35));
  script.line(fmt::format("set xtics ({})", ticks));
}

enum class Cost { kSeconds, kSamples };

void set_axes(Script& script, Cost cost, const std::vector<std::vector<CostError>>& curves) {
  std::vector<double> x, y;
  for (const auto& curve : curves)
    for (const CostError& point : curve) {
      if (!(point.cost > 0 && point.error > 0)) continue;
      x.push_back(point.cost);
      y.push_back(point.error);
    }
  if (cost == Cost::kSamples) {
    set_budget_axis(script, x);
  } else {
    set_axis(script, 'x', x);
  }
  set_axis(script, 'y', y);
}

/// Peers have open symbols, so that they can be distinguished in grey print.
std::string style(const Curve& curve, std::size_t index) {
  static constexpr int kFilled[] = {7, 5, 9, 11, 13, 15}, kOpen[] = {6, 4, 8, 10, 12, 14};
  const int point = (curve.name.peer ? kOpen : kFilled)[index % 6];
  return fmt::format("linespoints lc rgb '{}' lw 2 pt {} ps 0.8{}", curve_color(index), point,
                     curve.name.peer ? " dt 2" : "");
}

std::string legend(const Curve& curve, const std::optional<SlopeFit>& fit) {
  return fit ? fmt::format("{} ({:.2f})", curve.name.label, fit->slope) : curve.name.label;
}

std::string curves_script(const SceneReport& scene, Cost cost, const std::string& x_label,
                          const std::function<std::vector<CostError>(const Curve&)>& points_of,
                          std::optional<SlopeFit> Curve::*fit) {
  std::vector<std::vector<CostError>> all;
  for (const Curve& curve : scene.curves) all.push_back(points_of(curve));
  Script script(x_label, "relMSE");
  set_axes(script, cost, all);
  for (std::size_t i = 0; i < all.size(); ++i)
    script.add(all[i], style(scene.curves[i], i), legend(scene.curves[i], scene.curves[i].*fit));
  if (scene.reference.noise_relmse && !script.empty()) {
    script.line(
        fmt::format("set arrow from graph 0, first {0:.6g} to graph 1, first {0:.6g} nohead dt 3 lc rgb "
                    "'#777777'",
                    *scene.reference.noise_relmse));
    script.line(
        fmt::format("set label 'noise of the reference' at graph 0.01, first {:.6g} offset 0,0.5 tc rgb "
                    "'#777777'",
                    *scene.reference.noise_relmse));
  }
  return script.text();
}

/// A line of this slope through the first point, over the range of the points.
std::vector<CostError> order_line(const std::vector<CostError>& points, double slope) {
  const auto usable =
      std::ranges::find_if(points, [](const CostError& p) { return p.cost > 0 && p.error > 0; });
  if (usable == points.end()) return {};
  std::vector<CostError> line;
  for (const CostError& point : points)
    line.push_back({point.cost, usable->error * std::pow(point.cost / usable->cost, slope)});
  return line;
}

}  // namespace

std::string curve_color(std::size_t index) {
  static constexpr const char* kColors[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                            "#e69f00", "#56b4e9", "#000000", "#b59f00"};
  return kColors[index % std::size(kColors)];
}

std::string time_plot_script(const ReportData& report, const SceneReport& scene) {
  return curves_script(
      scene, Cost::kSeconds, report.total_time ? "total time in seconds" : "render time in seconds",
      [&](const Curve& curve) { return over_time(report, curve, true); }, &Curve::relmse_over_time);
}

std::string spp_plot_script(const SceneReport& scene) {
  return curves_script(
      scene, Cost::kSamples, "samples per pixel", [](const Curve& curve) { return over_spp(curve, true); },
      &Curve::relmse_over_spp);
}

std::string bias_plot_script(const SceneReport& scene) {
  std::vector<std::vector<CostError>> variances, biases;
  for (const Curve& curve : scene.curves) {
    std::vector<CostError> variance, bias;
    for (const CurvePoint& point : curve.points) {
      if (point.spp == 0 || point.images.size() < 2) continue;
      variance.push_back({double(point.spp), point.relative.variance});
      // A bias that is not clearly larger than its standard error is only known to be small.
      const bool clear = point.relative.bias_squared > kClearBias * point.relative.bias_squared_error;
      bias.push_back({double(point.spp), clear ? point.relative.bias_squared : 0});
    }
    variances.push_back(std::move(variance));
    biases.push_back(std::move(bias));
  }
  std::vector<std::vector<CostError>> all = variances;
  all.insert(all.end(), biases.begin(), biases.end());
  Script script("samples per pixel", "relative variance, relative bias²");
  set_axes(script, Cost::kSamples, all);
  for (std::size_t i = 0; i < variances.size(); ++i) {
    const Curve& curve = scene.curves[i];
    script.add(variances[i], style(curve, i), curve.name.label + ": variance");
    script.add(biases[i], fmt::format("linespoints lc rgb '{}' lw 2 dt 2 pt 2 ps 1.1", curve_color(i)),
               curve.name.label + ": bias²");
  }
  return script.text();
}

std::string sampler_plot_script(const SceneReport& scene) {
  std::set<std::string> samplers;
  for (const Curve& curve : scene.curves) {
    if (!curve.name.peer) samplers.insert(curve.name.sampler);
  }
  if (samplers.size() < 2) return "";
  std::vector<std::vector<CostError>> all;
  for (const Curve& curve : scene.curves) all.push_back(over_spp(curve, false));
  Script script("samples per pixel", "MSE");
  set_axes(script, Cost::kSamples, all);
  std::map<double, std::string> orders;  // the samplers with that slope
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Curve& curve = scene.curves[i];
    if (curve.name.peer || all[i].empty()) continue;
    script.add(all[i], style(curve, i), legend(curve, curve.mse_over_spp));
    const auto order = expected_order(curve.name.sampler);
    if (!order) continue;
    for (const double slope : {order->smooth, order->edges}) {
      if (!orders.emplace(slope, curve.name.sampler).second) continue;
      const std::vector<CostError> line = order_line(all[i], slope);
      if (line.empty()) continue;
      script.add(line, "lines lc rgb '#888888' lw 1.5 dt (8,6)", fmt::format("expected order {:g}", slope));
    }
  }
  return script.text();
}

Expected<std::vector<Plot>> draw_plots(const std::filesystem::path& gnuplot,
                                       const std::filesystem::path& folder, const ReportData& report,
                                       const SceneReport& scene) {
  const Plot wanted[] = {
      {"time", "Error against time", time_plot_script(report, scene), {}},
      {"spp", "Error against samples per pixel", spp_plot_script(scene), {}},
      {"bias", "Bias² and variance", bias_plot_script(scene), {}},
      {"samplers", "Convergence of samplers", sampler_plot_script(scene), {}},
  };
  std::vector<Plot> plots;
  for (const Plot& plot : wanted) {
    if (plot.svg.empty()) continue;
    auto drawn =
        run_gnuplot(gnuplot, folder, scene.name + "-" + plot.name, plot.svg, kWidth, plot_height(plot.svg));
    if (!drawn) return std::unexpected(drawn.error());
    plots.push_back({plot.name, plot.title, std::move(drawn->svg), std::move(drawn->png)});
  }
  return plots;
}

}  // namespace penumbra
