#include "scheduler/estimate/estimate_totals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "kernels/host/text.h"
#include "scheduler/estimate/estimate_text.h"
#include "scheduler/files/json_number.h"
#include "scheduler/run/progress.h"

namespace penumbra {
namespace {

using Json = nlohmann::ordered_json;

std::string error_text(double relative_error) {
  return std::isfinite(relative_error) ? fmt::format("{:.2g}%", relative_error * 100) : "not known";
}

Json json_of(const EstimateTotals& totals) {
  Json wall = Json::array();
  for (const WallTime& time : totals.wall)
    wall.push_back({{"workers", time.workers}, {"seconds", time.seconds}});
  return {{"renders", totals.renders},
          {"samples", totals.samples},
          {"units", totals.units},
          {"core_seconds", totals.core_seconds},
          {"wall", wall},
          {"relative_error", json_number(totals.relative_error)},
          {"result_bytes", totals.result_bytes},
          {"scene_bytes", totals.scene_bytes},
          {"image_bytes", totals.image_bytes},
          {"worker_memory_bytes", totals.worker_memory_bytes},
          {"scheduler_memory_bytes", totals.scheduler_memory_bytes}};
}

}  // namespace

EstimateTotals totals_of(const std::vector<SetMemberEstimate>& members) {
  EstimateTotals totals;
  std::set<std::string> sent;
  for (const SetMemberEstimate& member : members) {
    if (!member.estimate) continue;
    const RenderEstimate& e = *member.estimate;
    ++totals.renders;
    totals.samples += e.samples;
    totals.core_seconds += e.core_seconds;
    totals.units += e.plan.units;
    totals.result_bytes += e.plan.result_bytes;
    totals.image_bytes += e.plan.image_bytes;
    for (const AssetPiece& piece : member.pieces)
      if (sent.insert(piece.hash).second) totals.scene_bytes += piece.size;
    if (totals.wall.empty())
      totals.wall = e.wall;
    else  // of as many workers, because the renders share them
      for (std::size_t i = 0; i < e.wall.size(); ++i) totals.wall[i].seconds += e.wall[i].seconds;
    totals.worker_memory_bytes = std::max(totals.worker_memory_bytes, e.measured.worker_memory_bytes);
    totals.scheduler_memory_bytes = std::max(totals.scheduler_memory_bytes, e.plan.scheduler_memory_bytes);
    // A NaN remains.
    if (!(e.relative_error <= totals.relative_error)) totals.relative_error = e.relative_error;
  }
  return totals;
}

std::string estimate_heading(std::size_t width) {
  return fmt::format("{:{}}  {:>9}  {:>10}  {:>9}  {:>8}  {:>8}  {:>8}  {}\n", "render", width, "samples",
                     "core-hours", "error", "results", "scene", "worker", "measured");
}

std::string estimate_row(const SetMemberEstimate& member, std::size_t width) {
  if (!member.estimate)
    return fmt::format("{:{}}  {}\n", member.name, width, member.error.substr(0, member.error.find('\n')));
  const RenderEstimate& e = *member.estimate;
  return fmt::format("{:{}}  {:>9.4g}  {:>10.3g}  {:>9}  {:>8}  {:>8}  {:>8}  {}\n", member.name, width,
                     e.samples, e.core_seconds / 3600, error_text(e.relative_error),
                     size_text(double(e.plan.result_bytes)), size_text(double(e.plan.scene_bytes)),
                     size_text(double(e.measured.worker_memory_bytes)), measured_image_text(e.measured));
}

std::string totals_text(const EstimateTotals& totals, std::size_t members) {
  std::string text = totals.renders == members
                         ? fmt::format("Total of {}\n", counted(members, "render"))
                         : fmt::format("Total of {} of {}\n", totals.renders, counted(members, "render"));
  const auto add = [&](const char* name, const std::string& figure) { text += estimate_line(name, figure); };
  add("samples", fmt::format("{:.4g} in {} units", totals.samples, totals.units));
  add("core time", core_time_text(totals.core_seconds));
  for (const WallTime& wall : totals.wall)
    add("wall time", fmt::format("{} with {}", clock_text(wall.seconds), counted(wall.workers, "worker")));
  add("error", std::isfinite(totals.relative_error) ? error_text(totals.relative_error) + " at most"
                                                    : "not known of all");
  add("results", size_text(double(totals.result_bytes)) + " from workers to the scheduler");
  add("scenes", size_text(double(totals.scene_bytes)) + " to each worker, equal parts once");
  if (totals.image_bytes > 0)
    add("EXR files", size_text(double(totals.image_bytes)) + " or less, compressed");
  add("worker", size_text(double(totals.worker_memory_bytes)) + " of memory at most");
  add("scheduler", size_text(double(totals.scheduler_memory_bytes)) + " of memory for the largest render");
  return text;
}

std::string set_estimate_json(const std::vector<SetMemberEstimate>& members) {
  Json json = {{"renders", Json::array()}, {"totals", json_of(totals_of(members))}};
  for (const SetMemberEstimate& member : members) {
    Json render = {{"name", member.name}, {"scene", member.scene}, {"options", Json::object()}};
    for (const auto& [name, value] : member.choices) render["options"][name] = value;
    if (member.estimate)
      render.update(estimate_json(*member.estimate));
    else
      render["error"] = member.error;
    json["renders"].push_back(std::move(render));
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace penumbra
