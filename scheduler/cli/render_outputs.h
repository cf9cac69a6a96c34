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

enum class RenderEndKind { kDone, kIncomplete, kFailed };
struct RenderEnd {
  RenderEndKind kind = RenderEndKind::kDone;
  std::string error = {};  ///< why it is not done
};
/// Of one of several renders: writes what there is of it into folders that are made for it, and prints what
/// is to be said, after `name`. The checkpoint stays, until the caller has noted the end. `strict`:
/// such samples make it incomplete.
RenderEnd finish_render(PreparedRender& prepared, const RenderOutcome& outcome,
                        const std::vector<std::string>& command_line, const std::string& name, bool strict,
                        bool stopped);

/// Files, size, samples, time; says so where a time budget has ended it.
void print_summary(const RenderOutcome& outcome, const PreparedRender& prepared);

/// A line for somebody whose scene file asks for independent samples.
void print_sampler_advice();

/// Samples that are not as they should be, and variances that no file holds, as warnings, or as errors with
/// `strict` and where more than 1 % of the samples are not finite; whether there are errors.
bool print_flagged(const PreparedRender& prepared, const FilmAccumulator& film, bool strict);

/// That a render came to no sample; why.
Error nothing_to_write(bool stopped);

/// What went wrong, and how incomplete the image is.
void print_problems(const RenderOutcome& outcome, bool stopped);

}  // namespace penumbra
