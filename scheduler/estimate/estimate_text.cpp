#include "scheduler/estimate/estimate_text.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "kernels/host/text.h"
#include "scheduler/files/json_number.h"
#include "scheduler/run/progress.h"

namespace penumbra {

using Json = nlohmann::ordered_json;

std::string estimate_line(const char* name, const std::string& text) {
  return fmt::format("  {:<18} {}\n", name, text);
}

std::string core_time_text(double core_seconds) {
  return fmt::format("{:.0f} core-seconds, {:.2f} core-hours", core_seconds, core_seconds / 3600);
}

std::string measured_image_text(const MeasuredWork& measured) {
  const std::string image = fmt::format("{} x {} pixels", measured.width, measured.height);
  return measured.covered < 1 ? fmt::format("{:.0f}% of {}", measured.covered * 100, image) : image;
}

double cores_of_a_gigabit(const RenderEstimate& e) {
  constexpr double kBytesPerSecond = 1e9 / 8;
  const double result_bytes = double(e.plan.result_bytes) * e.samples / double(e.plan.samples);
  return e.core_seconds * kBytesPerSecond / result_bytes;
}

std::string estimate_text(const RenderEstimate& e) {
  std::string text = "Plan\n";
  text += estimate_line("samples", fmt::format("{:.4g}", double(e.plan.samples)));
  text += estimate_line("units",
                        fmt::format("{}: {} tiles, {} passes", e.plan.units, e.plan.tiles, e.plan.passes));
  text += estimate_line("results", size_text(double(e.plan.result_bytes)) + " from workers to the scheduler");
  text += estimate_line("scene", size_text(double(e.plan.scene_bytes)) + " to each worker that has it not");
  text += estimate_line("scheduler", size_text(double(e.plan.scheduler_memory_bytes)) + " of memory");
  if (e.plan.image_bytes > 0)
    text += estimate_line("EXR file", size_text(double(e.plan.image_bytes)) + " or less, compressed");
  text += "Measured here\n";
  text += estimate_line("samples", fmt::format("{:.4g} in {:.1f} s, of {}", double(e.measured.samples),
                                               e.measured.seconds, measured_image_text(e.measured)));
  text +=
      estimate_line("worker", size_text(double(e.measured.worker_memory_bytes)) +
                                  fmt::format(" of memory, ready after {:.2f} s", e.measured.start_seconds));
  text += "Estimate\n";
  if (e.samples < double(e.plan.samples))
    text += estimate_line("samples", fmt::format("{:.4g}, until the target error", e.samples));
  text += estimate_line("core time", core_time_text(e.core_seconds));
  if (const double cores = cores_of_a_gigabit(e); cores >= 1)
    text +=
        estimate_line("network", fmt::format("a link of 1 Gbit/s to the scheduler is full with {:.0f} cores, "
                                             "one of 10 Gbit/s with {:.0f}",
                                             cores, 10 * cores));
  for (const WallTime& wall : e.wall)
    text += estimate_line("wall time", fmt::format("{} with {} x {} threads", clock_text(wall.seconds),
                                                   wall.workers, e.measured.threads));
  text += estimate_line("error", std::isfinite(e.relative_error)
                                     ? fmt::format("{:.2g}%, or less", e.relative_error * 100)
                                     : "not known");
  return text;
}

Json estimate_json(const RenderEstimate& e) {
  Json wall = Json::array();
  for (const WallTime& time : e.wall)
    wall.push_back({{"workers", time.workers}, {"threads", e.measured.threads}, {"seconds", time.seconds}});
  return {{"plan",
           {{"samples", e.plan.samples},
            {"tiles", e.plan.tiles},
            {"passes", e.plan.passes},
            {"units", e.plan.units},
            {"result_bytes", e.plan.result_bytes},
            {"scene_bytes", e.plan.scene_bytes},
            {"image_bytes", e.plan.image_bytes},
            {"scheduler_memory_bytes", e.plan.scheduler_memory_bytes}}},
          {"measured",
           {{"samples", e.measured.samples},
            {"width", e.measured.width},
            {"height", e.measured.height},
            {"covered", e.measured.covered},
            {"seconds", e.measured.seconds},
            {"start_seconds", e.measured.start_seconds},
            {"core_seconds", e.measured.core_seconds},
            {"threads", e.measured.threads},
            {"worker_memory_bytes", e.measured.worker_memory_bytes},
            {"relative_error", json_number(e.measured.relative_error)}}},
          {"estimate",
           {{"samples", e.samples},
            {"core_seconds", e.core_seconds},
            {"cores_of_a_gigabit", json_number(cores_of_a_gigabit(e))},
            {"wall", wall},
            {"relative_error", json_number(e.relative_error)}}}};
}

}  // namespace penumbra
