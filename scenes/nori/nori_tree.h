// From Nori's XML to the tree of Mitsuba's objects that mean the same.
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
  std::optional<Dialect> dialect = std::nullopt;  ///< none: told by the file
  std::optional<int> test_scene = std::nullopt;   ///< of a file whose root is <test>: which, from 1 on
};

/// Problems go to the report; the tree then holds what could be read.
Tree read_tree(const std::filesystem::path& file, const TreeOptions& options, const FileAccess& files,
               Diagnostics& diagnostics, ReaderReport& report);

}  // namespace penumbra::nori
