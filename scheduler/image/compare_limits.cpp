#include "scheduler/image/compare_limits.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "kernels/host/text.h"
#include "scenes/number.h"

namespace penumbra {
namespace {

double largest_magnitude(const ChannelValues& values) {
  double largest = 0;
  for (const double value : values.channels) {
    if (std::isnan(value)) return value;
    largest = std::max(largest, std::abs(value));
  }
  return largest;
}

struct Metric {
  const char* name;
  enum { kAlways, kFlip, kZTest } needs;
  double (*value)(const Comparison&);
};

constexpr Metric kMetrics[] = {
    {"relmse", Metric::kAlways, [](const Comparison& c) { return c.relative_mse.overall; }},
    {"trimmed_relmse", Metric::kAlways, [](const Comparison& c) { return c.trimmed_relative_mse.overall; }},
    {"block_relmse", Metric::kAlways, [](const Comparison& c) { return c.block_relative_mse.overall; }},
    {"mse", Metric::kAlways, [](const Comparison& c) { return c.mse.overall; }},
    {"mape", Metric::kAlways, [](const Comparison& c) { return c.mape.overall; }},
    {"smape", Metric::kAlways, [](const Comparison& c) { return c.smape.overall; }},
    {"bias", Metric::kAlways, [](const Comparison& c) { return largest_magnitude(c.bias); }},
    {"relative_bias", Metric::kAlways,
     [](const Comparison& c) { return largest_magnitude(c.relative_bias); }},
    {"max", Metric::kAlways, [](const Comparison& c) { return c.largest.overall; }},
    {"flip", Metric::kFlip, [](const Comparison& c) { return c.flip->mean; }},
    {"max_flip", Metric::kFlip, [](const Comparison& c) { return c.flip->largest; }},
    {"max_z", Metric::kZTest, [](const Comparison& c) { return std::abs(c.z_test->largest.z); }},
    {"block_z", Metric::kZTest, [](const Comparison& c) { return std::abs(c.z_test->block_mean.z); }},
    {"mean_z", Metric::kZTest, [](const Comparison& c) { return std::abs(c.z_test->image_mean.z); }},
    {"z_above_1.96", Metric::kZTest, [](const Comparison& c) { return c.z_test->share_above_1_96; }},
    {"z_above_2.58", Metric::kZTest, [](const Comparison& c) { return c.z_test->share_above_2_58; }}};

}  // namespace

std::vector<std::string> limit_metrics() {
  std::vector<std::string> names;
  for (const Metric& metric : kMetrics) names.emplace_back(metric.name);
  return names;
}

Expected<CompareLimit> parse_limit(std::string_view text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos)
    return fail(fmt::format("'{}' is not of the form METRIC=VALUE", text));
  CompareLimit limit{.metric = std::string(text.substr(0, equals))};
  if (std::ranges::none_of(kMetrics, [&](const Metric& m) { return limit.metric == m.name; })) {
    return fail(fmt::format("there is no metric '{}'{}; there are {}", limit.metric,
                            suggestion(limit.metric, limit_metrics()), fmt::join(limit_metrics(), ", ")));
  }
  const std::string_view number = text.substr(equals + 1);
  const auto value = parse_number(number);
  if (!value || *value < 0) return fail(fmt::format("'{}' is not a number from 0 up", number));
  limit.value = *value;
  return limit;
}

Expected<double> limited_value(const Comparison& comparison, std::string_view name) {
  for (const Metric& metric : kMetrics) {
    if (metric.name != name) continue;
    if (metric.needs == Metric::kFlip && !comparison.flip) {
      return fail(fmt::format("{} is not known: {}", name, comparison.flip_left_out));
    }
    if (metric.needs == Metric::kZTest && !comparison.z_test) {
      return fail(fmt::format("{} is not known: {}", name, comparison.z_test_left_out));
    }
    return metric.value(comparison);
  }
  return fail(fmt::format("there is no metric '{}'", name));
}

}  // namespace penumbra
