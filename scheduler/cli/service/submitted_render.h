// A render on its way to a service and back: what is sent of a prepared render, and a prepared render made of
// that.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scheduler/cli/render_preparation.h"
#include "scheduler/cli/sets/set_plan.h"
#include "scheduler/service/spool.h"
#include "scheduler/service/submission.h"

namespace penumbra {

/// All but the scene's data.
Submission submission_of(const PreparedRender& prepared, const SetMember& member,
                         const std::vector<std::string>& command_line);

/// Its files are in `folder`; `threads` and `workers` are the service's. Errors: a scene and a record that do
/// not belong together, more pixels than memory.
Expected<PreparedRender> prepared_of(const Submission& submission, StoredScene stored,
                                     const std::filesystem::path& folder, int threads, int workers);

}  // namespace penumbra
