// From Nori's XML to the tree of Mitsuba's objects that mean the same.
#pragma once

#include "scenes/file_access.h"
#include "scenes/mitsuba/object_tree.h"
#include "scenes/reader_report.h"

namespace penumbra::nori {

/// Problems go to the report; the tree then holds what could be read.
mitsuba::ObjectTree read_tree(const std::filesystem::path& file, const FileAccess& files,
                              Diagnostics& diagnostics, ReaderReport& report);

}  // namespace penumbra::nori
