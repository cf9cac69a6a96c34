#include "scheduler/farm/problem_text.h"

#include <fmt/format.h>

namespace penumbra {
namespace {

std::string_view fault_text(Fault fault) {
  switch (fault) {
    case Fault::kDied:
      return "died";
    case Fault::kFailed:
      return "failed";
    case Fault::kHung:
      return "hung";
    case Fault::kCorrupt:
      return "sent a damaged result";
    case Fault::kDisputed:
      return "sent another result";
    case Fault::kUnprepared:
      return "was not ready";
  }
  return "failed";
}

std::string in_brackets(const std::string& detail) {
  return detail.empty() ? "" : fmt::format(" ({})", detail);
}

}  // namespace

std::string unit_text(const RenderUnit& unit) {
  if (unit.sample_count == 0) return "a unit that the job does not have";
  return fmt::format("the tile of {} x {} pixels at ({}, {}), samples {} to {}", unit.width, unit.height,
                     unit.x, unit.y, unit.first_sample, unit.first_sample + unit.sample_count - 1);
}

std::string dismissal_text(const DismissWorker& order, const RenderUnit& unit, const std::string& detail,
                           const WorkerName& name) {
  const std::string where = unit_text(unit);
  const std::string who = name(order.worker);
  switch (order.fault) {
    case Fault::kHung:
      return fmt::format("worker {} was ended: it hung at {}; others render what it held", who, where);
    case Fault::kFailed:
      return fmt::format("worker {} was ended: {} units in a row failed, the last {}{}", who,
                         kFailuresToDismiss, where, in_brackets(detail));
    case Fault::kCorrupt:
      return fmt::format("worker {} was ended: it sent a damaged result for {}{}; the unit is rendered again",
                         who, where, in_brackets(detail));
    case Fault::kDisputed:
      return fmt::format(
          "worker {} was ended: it and worker {} returned different results for {}; as either may "
          "compute wrongly, every tile that they worked on is rendered again",
          who, name(order.accuser.value_or(order.worker)), where);
    case Fault::kUnprepared:
      return fmt::format("worker {} was ended: it did not finish preparing a scene in time", who);
    case Fault::kDied:
      break;
  }
  return fmt::format("worker {} was ended at {}", who, where);
}

std::string overdue_text(const UnitOverdue& order, const RenderUnit& unit, const WorkerName& name) {
  return fmt::format("waiting for worker {}, which {} for {:.0f} s at {}; it counts as hung in {:.0f} s",
                     name(order.worker), order.is_silent ? "has not been heard of" : "has shown no progress",
                     order.since, unit_text(unit), order.until_hung);
}

std::string set_aside_text(const SetAside& order, const RenderUnit& unit, const std::string& detail,
                           const std::string& reproduce_command, const WorkerName& name) {
  std::string hands;
  for (const auto& [worker, fault] : order.faults) {
    hands += fmt::format("{}worker {} {}", hands.empty() ? "" : ", ", name(worker), fault_text(fault));
  }
  std::string text =
      fmt::format("{} are missing in the image: {}{}", unit_text(unit), hands, in_brackets(detail));
  if (!reproduce_command.empty()) {
    text += fmt::format("; to reproduce: {} --crop {},{},{},{}", reproduce_command, unit.x, unit.y,
                        unit.x + unit.width, unit.y + unit.height);
  }
  return text;
}

}  // namespace penumbra
