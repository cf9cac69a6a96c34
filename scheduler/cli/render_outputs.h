// What a render that is over leaves: its files, and what is printed.
#pragma once

#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/cli/render_preparation.h"

namespace penumbra {

/// Image files and statistics, with the record of as many samples as the render came to. Uses up the record.
Expected<void> write_outputs(PreparedRender& prepared, const RenderOutcome& outcome,
                             const std::vector<std::string>& command_line);

void print_summary(const RenderOutcome& outcome, const OutputFiles& files);

/// Non-finite samples, and variances that no file holds, as warnings or as errors; whether there are any.
bool print_non_finite(const FilmAccumulator& film, const std::string& reproduce_command, bool strict);

/// What went wrong, and how incomplete the image is.
void print_problems(const RenderOutcome& outcome, bool stopped);

}  // namespace penumbra
