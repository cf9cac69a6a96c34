#include "scheduler/sets/set_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "kernels/host/console.h"
#include "scheduler/estimate/estimate_totals.h"
#include "scheduler/files/program_path.h"
#include "scheduler/run/render_preparation.h"
#include "scheduler/run/shared_scenes.h"
#include "scheduler/sets/failure_reasons.h"
#include "scheduler/sets/set_plan.h"

namespace penumbra {
namespace {

constexpr double kSetSeconds = 60;  // of measuring all renders

/// The scene and all parameters except the seed.
using MeasurementKey = std::pair<std::string, std::vector<std::pair<std::string, std::string>>>;

MeasurementKey key_of(const SetMember& member) {
  MeasurementKey key{member.options.scene.file, member.choices};
  std::erase_if(key.second, [](const auto& choice) { return choice.first == "seed"; });
  return key;
}

class SetEstimator {
 public:
  SetEstimator(const SetPlan& plan, std::string worker, const RenderOptions& options,
               const std::atomic<bool>& stop)
      : plan_(plan), worker_(std::move(worker)), options_(options), stop_(stop), scenes_(scenes_of(plan)) {
    for (const SetMember& member : plan.members) measured_[key_of(member)];
    seconds_ = std::min(kEstimateSeconds, kSetSeconds / double(measured_.size()));
  }

  ExitCode run() {
    std::size_t width = 6;
    for (const SetMember& member : plan_.members) width = std::max(width, member.name.size());
    for (const SetMember& member : plan_.members) {
      if (stop_) break;
      SetMemberEstimate& estimated =
          estimates_.emplace_back(SetMemberEstimate{member.name, member.options.scene.file, member.choices});
      try {
        estimate(member, estimated);
      } catch (const std::exception& error) {  // usually out of memory; other renders may need less
        fail_member(estimated, {error.what()}, kIncomplete);
      }
      if (!options_.json) print_rows(width);
    }
    // Where nothing could be measured there are reasons, and no figures.
    if (options_.json)
      print_answer(set_estimate_json(estimates_));
    else if (printed_ > 0)
      print_answer(totals_text(totals_of(estimates_), plan_.members.size()));
    for (const std::string& line : failures_.repeated()) print_error({line});
    if (stop_) print_error({"stopped by a signal before all renders were measured"});
    return stop_ ? kIncomplete : exit_code_;
  }

 private:
  /// The rows that are not printed yet, from the first render on that could be measured.
  void print_rows(std::size_t width) {
    if (printed_ == 0 && !estimates_.back().estimate) return;
    if (printed_ == 0) print_answer(estimate_heading(width));
    for (; printed_ < estimates_.size(); ++printed_) print_answer(estimate_row(estimates_[printed_], width));
  }

  void estimate(const SetMember& member, SetMemberEstimate& estimated) {
    RenderOptions options = member.options;
    options.writes_here = false;
    auto prepared = prepare_render(options, std::bind_front(&SharedScenes::load, &scenes_));
    if (!prepared) return fail_member(estimated, prepared.error(), kBadInput);
    if (const auto device = check_device(prepared->job.device); !device)
      return fail_member(estimated, device.error(), kBadInput);
    estimated.pieces = prepared->job.manifest->pieces;
    std::optional<RenderEstimate>& measured = measured_[key_of(member)];
    if (!measured) {
      for (const std::string& warning : prepared->scene.description.warnings) print_warning(warning);
      prepared->farm.worker_executable = worker_;
      auto result = measure_estimate(member.options, *prepared, seconds_, stop_);
      if (!result) return fail_member(estimated, result.error(), kIncomplete);
      measured = std::move(*result);
    }
    estimated.estimate = measured;
  }

  void fail_member(SetMemberEstimate& estimated, const Error& error, ExitCode code) {
    if (failures_.add(estimated.name, estimated.scene, error.message))
      print_error({fmt::format("{}: {}", estimated.name, error.message)});
    estimated.error = error.message;
    exit_code_ = std::max(exit_code_, code);
  }

  const SetPlan& plan_;
  const std::string worker_;
  const RenderOptions& options_;
  const std::atomic<bool>& stop_;
  SharedScenes scenes_;
  std::map<MeasurementKey, std::optional<RenderEstimate>> measured_;
  double seconds_ = 0;  // for each measurement
  std::vector<SetMemberEstimate> estimates_;
  std::size_t printed_ = 0;  // rows
  FailureReasons failures_;
  ExitCode exit_code_ = kAllDone;
};

}  // namespace

ExitCode estimate_set(const RenderOptions& options, const CommandLine& command,
                      const std::atomic<bool>& stop) {
  const auto plan = plan_set(options, command);
  if (!plan) return print_error(plan.error()), kBadInput;
  const auto worker = find_program("penumbra-worker");
  if (!worker) return print_error(worker.error()), kIncomplete;
  return SetEstimator(*plan, worker->string(), options, stop).run();
}

}  // namespace penumbra
