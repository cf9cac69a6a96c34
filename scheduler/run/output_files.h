// Chooses the files that a render writes.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/run/render_options.h"

namespace penumbra {

struct OutputFiles {
  std::optional<std::filesystem::path> exr, png, statistics;
  std::optional<std::filesystem::path> denoised_exr, denoised_png;

  /// The files that are set.
  [[nodiscard]] std::vector<std::filesystem::path> all() const;
};

/// Chooses files from -o, --statistics, --no-statistics and the scene's name. With `--pixel` only explicitly
/// requested files are written. Errors: an extension other than .exr or .png; two outputs to the same file.
Expected<OutputFiles> choose_output_files(const RenderOptions& options);

/// x.exr and x.png for x.exr, x.png for x.png. Error: another extension.
Expected<OutputFiles> image_files(const std::filesystem::path& out);

/// NAME-denoised.exr for NAME.exr.
std::filesystem::path denoised_name(const std::filesystem::path& image);
/// Adds the denoised image beside each image.
void add_denoised_files(OutputFiles& files);

/// Creates missing folders. Call it only when there is something to write. Error: a folder cannot be created,
/// or another output has its name.
Expected<void> make_folders(const OutputFiles& files);

}  // namespace penumbra
