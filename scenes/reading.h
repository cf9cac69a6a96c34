// Steps that the readers of all formats share before and after reading a scene file.
#pragma once

#include <string_view>

#include "scenes/diagnostic.h"
#include "scenes/file_access.h"
#include "scenes/reader_report.h"
#include "scenes/scene_description.h"
#include "scenes/scene_reader.h"

namespace penumbra {

/// The state of reading one scene file: the files opened, and the messages about them.
class Reading {
 public:
  explicit Reading(const ReadOptions& read_options)
      : options(read_options), files(read_options.confine_to), report(diagnostics, read_options.lenient) {}

  const ReadOptions& options;
  const FileAccess files;
  Diagnostics diagnostics;
  ReaderReport report;

  /// Reports variables defined by -D as errors, for a format that has no variables, such as "glTF".
  void refuse_variables(std::string_view format);

  [[nodiscard]] bool failed() const { return diagnostics.failed(); }
  /// The errors as a return value. Call it only after `failed()`.
  [[nodiscard]] std::unexpected<Error> error() const { return std::unexpected(diagnostics.error()); }

  /// The scene with its warnings, or the errors. Settings that contradict each other are an error at `root`,
  /// unless further settings (--set) are still to be applied, which may resolve it. Without a root,
  /// read_scene checks them.
  Expected<SceneDescription> finish(SceneDescription scene, SourceLocation root = {});
};

}  // namespace penumbra
