// Non-finite samples, in words for the user.
#pragma once

#include <string>
#include <string_view>

#include "kernels/host/non_finite.h"

namespace penumbra {

/// The command that repeats the first of them, of a job with this `RenderJob::reproduce_command`.
std::string repeat_sample_command(const NonFiniteSamples& samples, const std::string& reproduce_command);

/// How many there are, where the first is, and how to repeat it; `kind` is "NaN" or "infinite".
std::string non_finite_text(const NonFiniteSamples& samples, std::string_view kind,
                            const std::string& reproduce_command);

}  // namespace penumbra
