// The options of `penumbra report` as the user gave them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/report/crop_choice.h"
#include "scheduler/report/method.h"
#include "scheduler/run/render_options.h"
#include "worker/cli/command_line.h"

namespace penumbra {

struct ReportOptions {
  std::vector<std::string> scenes;
  std::string out;
  std::vector<Method> methods;  ///< empty: the scene's own integrator
  std::vector<std::string> samplers, backends;
  std::vector<std::uint32_t> budgets;
  int seeds = 3, repeats = 1;
  std::vector<std::string> references{}, second_references{};  ///< FILE, SCENE=FILE, auto
  std::uint32_t reference_spp = 0;                             ///< of both halves together; 0: chosen by rule
  std::vector<Method> reference_methods;
  std::vector<std::string> peers;  ///< DIR, SCENE=DIR
  std::vector<Target> targets;
  CropChoice crop;
  std::optional<double> crop_seconds;
  double exposure = 0;
  double epsilon = 0.01;
  std::string time = "render";
  RenderOptions render;  ///< options that all cells share: -D, --set, workers, threads, …
  bool no_plots = false, quiet = false;
};

void add_report_options(CommandLine& command, ReportOptions& options);

/// The value for this scene from a list of "SCENE=VALUE…" and "VALUE": the last one that names the scene,
/// else the last one without a scene. Nothing if there is none. `scenes`: the names that may stand before
/// '='.
std::optional<std::string> value_for_scene(const std::vector<std::string>& values, const std::string& scene,
                                           const std::vector<std::string>& scenes);

}  // namespace penumbra
