// What the reader of every format does before and after it reads a scene file.
#pragma once

#include <string_view>

#include "scenes/diagnostic.h"
#include "scenes/file_access.h"
#include "scenes/reader_report.h"
#include "scenes/scene_description.h"
#include "scenes/scene_reader.h"

namespace penumbra {

/// The reading of one scene file: files that it opens, and what is said of them.
class Reading {
 public:
  explicit Reading(const ReadOptions& read_options)
      : options(read_options), files(read_options.confine_to), report(diagnostics, read_options.lenient) {}

  const ReadOptions& options;
  const FileAccess files;
  Diagnostics diagnostics;
  ReaderReport report;

  /// Variables that are defined for a scene of the format, "glTF" for example, which has none, are errors.
  void refuse_variables(std::string_view format);

  [[nodiscard]] bool failed() const { return diagnostics.failed(); }
  /// Only after `failed()`.
  [[nodiscard]] std::unexpected<Error> error() const { return std::unexpected(diagnostics.error()); }

  /// The scene with what there is to say of it, or the errors. Settings that contradict each other are one at
  /// `root`, unless others are still to be applied, which may put it right; without a root that is left to
  /// read_scene.
  Expected<SceneDescription> finish(SceneDescription scene, SourceLocation root = {});
};

}  // namespace penumbra
