#include "scheduler/advise/advice_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "scheduler/render/render_option.h"

namespace penumbra {
namespace {

using Json = nlohmann::ordered_json;

bool is_compared(const AdviceRow& row) { return row.candidate.not_because.empty(); }

}  // namespace

std::string choice_options(const Technique& choice) {
  std::string text;
  for (const auto& [key, value] : choice.settings) {
    const auto options = all_render_options();
    const auto option = std::ranges::find(options, key, &RenderOption::sets);
    text += text.empty() ? "" : " ";
    text += option != options.end() ? fmt::format("{} {}", option->word(), value)
                                    : fmt::format("--set {}={}", key, value);
  }
  return text;
}

std::string choice_line(const Advice& advice) {
  std::string text = "auto: " + advice.choice().name;
  if (advice.chosen > 0)
    text += fmt::format("; {} would take {:.2g} times the work", advice.rows.front().candidate.name,
                        advice.rows.front().factor);
  return text;
}

std::string advice_table(const Advice& advice) {
  std::size_t width = 9;
  for (const AdviceRow& row : advice.rows) width = std::max(width, row.candidate.name.size());
  std::string text =
      fmt::format("{:{}}  {:>9}  {:>6}  {:>15}\n", "candidate", width, "error", "work", "to equal error");
  for (const AdviceRow& row : advice.rows) {
    if (!is_compared(row)) {
      text += fmt::format("{:{}}  not compared: {}\n", row.candidate.name, width, row.candidate.not_because);
      continue;
    }
    const std::string factor = &row == &advice.rows[advice.chosen]
                                   ? "1"
                                   : fmt::format("{:.3g} ± {:.0f}%", row.factor, row.doubt * 100);
    text += fmt::format("{:{}}  {:>9.3g}  {:>6.3g}  {:>15}\n", row.candidate.name, width, row.error, row.work,
                        factor);
  }
  return text;
}

Json advice_json(const Advice& advice) {
  Json rows = Json::array();
  for (const AdviceRow& row : advice.rows) {
    Json json = {{"name", row.candidate.name}, {"options", choice_options(row.candidate)}};
    if (is_compared(row))
      json.update({{"error", row.error},
                   {"work", row.work},
                   {"work_to_equal_error", row.factor},
                   {"standard_error_of_log", row.doubt}});
    else
      json["not_compared"] = row.candidate.not_because;
    rows.push_back(std::move(json));
  }
  return {{"candidates", rows},
          {"chosen", advice.choice().name},
          {"options", choice_options(advice.choice())},
          {"seconds", advice.seconds}};
}

}  // namespace penumbra
