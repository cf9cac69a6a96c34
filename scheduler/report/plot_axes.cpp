#include "scheduler/report/plot_axes.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <vector>

namespace penumbra {
namespace {

constexpr double kMargin = 1.5;  ///< ratio of the end of an axis to the outermost value

std::string superscript(int number) {
  static constexpr const char* kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = number < 0 ? "⁻" : "";
  for (const char digit : fmt::to_string(std::abs(number))) text += kDigits[digit - '0'];
  return text;
}

/// The values DIGIT · 10^e within the range, where e is a multiple of `stride`.
std::vector<double> values_in(const AxisRange& range, std::initializer_list<int> digits, int stride) {
  std::vector<double> values;
  for (int e = int(std::floor(std::log10(range.low))); e <= int(std::ceil(std::log10(range.high))); ++e) {
    if (e % stride != 0) continue;
    for (const int digit : digits) {
      const double value = digit * std::pow(10.0, e);
      if (value >= range.low && value <= range.high) values.push_back(value);
    }
  }
  return values;
}

std::vector<double> labelled_values(const AxisRange& range, int most_labels) {
  for (const auto digits : {std::initializer_list<int>{1, 2, 5}, {1, 3}, {1}}) {
    auto values = values_in(range, digits, 1);
    if (int(values.size()) <= most_labels) return values;
  }
  const int decades = int(std::ceil(std::log10(range.high / range.low)));
  return values_in(range, {1}, 1 + decades / most_labels);
}

}  // namespace

void AxisRange::include(double value) {
  if (!(value > 0) || !std::isfinite(value)) return;
  low = std::min(low, value);
  high = std::max(high, value);
}

AxisRange AxisRange::widened() const { return {low / kMargin, high * kMargin}; }

std::string tick_text(double value) {
  const int exponent = int(std::floor(std::log10(value) + 1e-9));
  if (exponent >= -3 && exponent <= 4) return fmt::format("{:g}", value);
  const double digit = value / std::pow(10.0, exponent);
  const std::string power = "10" + superscript(exponent);
  return std::abs(digit - 1) < 1e-6 ? power : fmt::format("{:g}·{}", digit, power);
}

std::string axis_script(char axis, const AxisRange& range, int most_labels) {
  if (range.empty()) return "";
  const AxisRange wide = range.widened();
  std::string ticks;
  const auto add = [&](const std::string& label, double value, int level) {
    ticks += fmt::format("{}'{}' {:g} {}", ticks.empty() ? "" : ", ", label, value, level);
  };
  for (const double value : labelled_values(wide, most_labels)) add(tick_text(value), value, 0);
  constexpr double kMinorTicksUpTo = 1e4;
  if (wide.high / wide.low < kMinorTicksUpTo)
    for (const double value : values_in(wide, {1, 2, 3, 4, 5, 6, 7, 8, 9}, 1)) add("", value, 1);
  return fmt::format("set {0}range [{1:.6g}:{2:.6g}]\nset {0}tics ({3})\n", axis, wide.low, wide.high, ticks);
}

std::string budget_axis_script(const std::set<double>& budgets) {
  if (budgets.empty()) return "";
  constexpr std::size_t kMostTicks = 7;
  const std::size_t stride = (budgets.size() + kMostTicks - 1) / kMostTicks;
  std::string ticks;
  std::size_t i = 0;
  for (const double budget : budgets) {
    if (i++ % stride == 0)
      ticks += fmt::format("{}'{:.10g}' {:.10g}", ticks.empty() ? "" : ", ", budget, budget);
  }
  const AxisRange range = AxisRange{*budgets.begin(), *budgets.rbegin()}.widened();
  return fmt::format("set xrange [{:.6g}:{:.6g}]\nset xtics ({})\n", range.low, range.high, ticks);
}

}  // namespace penumbra
