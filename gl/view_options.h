// The options of `penumbra-view`.
#pragma once

#include <string>
#include <vector>

#include "scheduler/run/render_options.h"
#include "worker/cli/command_line.h"
#include "worker/work_unit.h"

namespace penumbra {

struct ViewOptions {
  RenderOptions preview;  ///< of the scheduler that is started; no scene with `connect`
  std::string connect;
  JobId job = 0;  ///< of a service at `connect`; 0: the oldest unfinished one
  std::string script, screenshot;
  std::string reference;  ///< image to compare with
  int width = 1280, height = 800;
  bool hidden = false, gl_debug = false;
};

void add_view_options(CommandLine& app, ViewOptions& options);

/// The arguments that the user gave for `penumbra preview`.
std::vector<std::string> preview_arguments(const CommandLine& app);

}  // namespace penumbra
