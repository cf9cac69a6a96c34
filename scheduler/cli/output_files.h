// Which files a render writes.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/cli/render_options.h"

namespace penumbra {

struct OutputFiles {
  std::optional<std::filesystem::path> exr, png, statistics;

  /// Those that there are.
  [[nodiscard]] std::vector<std::filesystem::path> all() const;
};

/// From -o, --statistics, --no-statistics and the scene's name. `--pixel` writes only what it is told to.
/// Errors: an extension that is neither .exr nor .png, two outputs in one file.
Expected<OutputFiles> choose_output_files(const RenderOptions& options);

/// Makes the folders that are missing, once there is something to render. Error: one cannot be made, or
/// another output is in its place.
Expected<void> make_folders(const OutputFiles& files);

}  // namespace penumbra
