// Converts Nori's XML to a tree of the equivalent Mitsuba objects.
#pragma once

#include <optional>
#include <string>

#include "scenes/file_access.h"
#include "scenes/mitsuba/object_tree.h"
#include "scenes/nori/dialect.h"
#include "scenes/reader_report.h"

namespace penumbra::nori {

struct Tree {
  mitsuba::ObjectTree objects;
  DialectChoice dialect;
};

struct TreeOptions {
  std::optional<Dialect> dialect = std::nullopt;  ///< none: determined from the file
  /// For a file whose root is <test>: the number of the scene, from 1 on.
  std::optional<int> test_scene = std::nullopt;
};

/// Problems are added to the report. The tree then holds whatever could be read.
Tree read_tree(const std::filesystem::path& file, const TreeOptions& options, const FileAccess& files,
               Diagnostics& diagnostics, ReaderReport& report);

}  // namespace penumbra::nori
