// Messages for the user about what went wrong during a render.
#pragma once

#include <functional>
#include <string>

#include "scheduler/plan/plan.h"
#include "worker/device.h"

namespace penumbra {

using WorkerName = std::function<std::string(WorkerId)>;  ///< e.g. "render1:4711"

/// "the tile of 64 x 64 pixels at (128, 0), samples 16 to 31". An empty unit is one that the job does not
/// have.
std::string unit_text(const RenderUnit& unit);

/// Why the plan dismissed a worker. `detail` is the message of the worker or about its result, or empty.
std::string dismissal_text(const DismissWorker& order, const RenderUnit& unit, const std::string& detail,
                           const WorkerName& name);

/// Which worker is overdue, and how long it will be waited for.
std::string overdue_text(const UnitOverdue& order, const RenderUnit& unit, const WorkerName& name);

/// Which unit is missing in the image, which workers failed on it, and the command that reproduces the
/// failure. `detail` as above.
std::string set_aside_text(const SetAside& order, const RenderUnit& unit, const std::string& detail,
                           const std::string& reproduce_command, const WorkerName& name);

}  // namespace penumbra
