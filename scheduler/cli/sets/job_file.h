// Job files: TOML that says which renders there are to be.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "scheduler/cli/sets/render_axes.h"

namespace penumbra {

struct JobFile {
  std::unique_ptr<SourceFile> source;  ///< patterns refer to it
  std::vector<RenderPattern> patterns;
};

/// Whether it looks like one: TinyRender's scenes are TOML too, but have no [[render]].
bool is_job_file(const std::filesystem::path& file);

/// Reads the [[render]] tables with what [defaults] gives them. Errors, each at its place: what is not TOML,
/// a key that no render has, a value that its option does not take, an empty list, a pattern that no file
/// matches, a setting that does not exist.
Expected<JobFile> read_job_file(const std::filesystem::path& file);

}  // namespace penumbra
