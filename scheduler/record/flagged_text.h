// Messages about invalid samples.
#pragma once

#include <string>
#include <string_view>

#include "kernels/host/flagged_samples.h"

namespace penumbra {

/// The command that reproduces the first invalid sample, for a job with this `RenderJob::reproduce_command`.
std::string repeat_sample_command(const FlaggedSamples& samples, const std::string& reproduce_command);

/// The names of the kinds in files: "nan", "infinite", "contradictory_boundary".
std::string_view flagged_name(int kind);

/// The number of samples of the kind BAD_*, the position of the first, and how to reproduce it. `shape`: for
/// BAD_BOUNDARY the name of the shape.
std::string flagged_text(int kind, const FlaggedSamples& samples, std::string_view shape,
                         const std::string& reproduce_command);

}  // namespace penumbra
