// The options of `penumbra-view`.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "scheduler/cli/render_options.h"
#include "scheduler/plan/work_unit.h"

namespace penumbra {

struct ViewOptions {
  RenderOptions preview;  ///< of the scheduler that is started; its scene is empty with `connect`
  std::string connect;
  JobId job = 0;  ///< of a service at `connect`; 0: the oldest that is not over
  std::string script, screenshot;
  int width = 1280, height = 800;
  bool hidden = false, gl_debug = false;
};

void add_view_options(CLI::App& app, ViewOptions& options);

/// What the user gave that is `penumbra preview`'s, word by word.
std::vector<std::string> preview_arguments(const CLI::App& app);

}  // namespace penumbra
