// Converts a prepared render to a submission for a service, and back.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scheduler/run/render_preparation.h"
#include "scheduler/service/spool.h"
#include "scheduler/service/submission.h"
#include "scheduler/sets/set_plan.h"

namespace penumbra {

/// Everything except the scene's data, and except its group and the jobs that it comes after.
Submission submission_of(const PreparedRender& prepared, const SetMember& member,
                         const std::vector<std::string>& command_line);

/// The prepared render of a submission, with its files in `folder`. `threads` and `workers` are the
/// service's. Errors: scene and record do not match; more pixels than fit into memory.
Expected<PreparedRender> prepared_of(const Submission& submission, StoredScene stored,
                                     const std::filesystem::path& folder, int threads, int workers);

}  // namespace penumbra
