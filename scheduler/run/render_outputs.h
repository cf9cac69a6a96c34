// Writes the files of a finished render and prints its results.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/denoise/denoise_image.h"
#include "scheduler/files/output_batch.h"
#include "scheduler/image/image.h"
#include "scheduler/run/render_preparation.h"

namespace penumbra {

/// Writes image files and statistics. The record in them has the number of samples that were actually
/// rendered. Consumes the record.
Expected<void> write_outputs(PreparedRender& prepared, const RenderOutcome& outcome,
                             const std::vector<std::string>& command_line);

/// Adds image files in the film's format, with a warning if it clamps values. Each is encoded on its own
/// thread; the image must stay valid until then.
void add_images(const Image& image, const Film& format, const std::optional<std::filesystem::path>& exr,
                const std::optional<std::filesystem::path>& png, OutputBatch& batch);
/// How images of this film are denoised: natively, on all cores. Native code is everywhere, and has the same
/// bits.
DenoiseOptions denoise_options(const Film& film);
void add_statistics(const nlohmann::ordered_json& statistics, const std::filesystem::path& path,
                    OutputBatch& batch);

/// What ended a render before it was done.
enum class StoppedBy { kNothing, kSignal, kCancel };

enum class RenderEndKind { kDone, kIncomplete, kFailed };
struct RenderEnd {
  RenderEndKind kind = RenderEndKind::kDone;
  std::string error = {};  ///< why it is not complete
};
/// For one of several renders: creates its folders, writes its files, and prints messages that begin with
/// `name`. The checkpoint is kept until the caller has recorded the end.
RenderEnd finish_render(PreparedRender& prepared, const RenderOutcome& outcome,
                        const std::vector<std::string>& command_line, const std::string& name,
                        StoppedBy stopped);

/// Prints files, size, samples and time, and whether a time budget has ended the render.
void print_summary(const RenderOutcome& outcome, const PreparedRender& prepared);

/// Says that Sobol points replace the scene's independent samples, once for a render or a set of them.
void print_sampler_note();

/// Whether the time budget ended the render before its last sample.
bool ended_by_budget(const RenderOutcome& outcome, const RenderJob& job);

/// Prints invalid samples, and variances that no file can hold, as warnings. They are errors with
/// --strict-numerics, or if more than 1 % of the samples are not finite. Returns whether there are errors.
bool print_flagged(const PreparedRender& prepared, const FilmAccumulator& film);

/// The error for a render without any samples, with the reason.
Error nothing_to_write(bool stopped);

/// Prints the problems of the render and how incomplete the image is.
void print_problems(const RenderOutcome& outcome, bool stopped);

}  // namespace penumbra
