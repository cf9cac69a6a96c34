// Samples that are not as they should be, in words for the user.
#pragma once

#include <string>
#include <string_view>

#include "kernels/host/flagged_samples.h"

namespace penumbra {

/// The command that repeats the first of them, of a job with this `RenderJob::reproduce_command`.
std::string repeat_sample_command(const FlaggedSamples& samples, const std::string& reproduce_command);

/// The kinds' names in files: "nan", "infinite", "contradictory_boundary".
std::string_view flagged_name(int kind);

/// How many there are of the kind, BAD_*, where the first is, and how to repeat it. `shape`: of BAD_BOUNDARY,
/// the name of its shape.
std::string flagged_text(int kind, const FlaggedSamples& samples, std::string_view shape,
                         const std::string& reproduce_command);

}  // namespace penumbra
