// Job files: TOML files that describe sets of renders.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "scheduler/sets/render_axes.h"

namespace penumbra {

struct JobFile {
  std::unique_ptr<SourceFile> source;  ///< the patterns' locations refer to it
  std::vector<RenderPattern> patterns;
};

/// Whether a file is a job file: TOML with [[render]] tables. TinyRender's scenes are TOML too, but have
/// none.
bool is_job_file(const std::filesystem::path& file);

/// Reads the [[render]] tables, with the values of [defaults]. Errors, each with its location: not TOML, an
/// unknown key, a value that the option does not accept, an empty list, a pattern that matches no file, a
/// setting that does not exist.
Expected<JobFile> read_job_file(const std::filesystem::path& file);

}  // namespace penumbra
