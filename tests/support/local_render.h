// A job together with the farm that renders it.
#pragma once

#include <atomic>
#include <functional>

#include "scheduler/farm/render_farm.h"

namespace penumbra {

struct LocalRender : RenderJob, FarmOptions {};

inline Expected<RenderOutcome> run_render(
    const LocalRender& render, const std::atomic<bool>& stop,
    const std::function<void(const RenderProgress&)>& on_progress = {}) {
  return run_render(render, render, stop, on_progress);
}

}  // namespace penumbra
