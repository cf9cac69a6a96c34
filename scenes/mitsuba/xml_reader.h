// From Mitsuba XML files to an object tree.
#pragma once

#include "scenes/file_access.h"
#include "scenes/mitsuba/object_tree.h"
#include "scenes/scene_reader.h"

namespace penumbra::mitsuba {

/// Reads `file` and what it includes. The root must be <scene version="…"> of a version from 0.4 to 3.
/// `$name` is filled in from `options.defines`, else from the <default> before it. Problems go to
/// `diagnostics`; the tree then holds what could be read, for the messages' sake.
ObjectTree read_object_tree(const std::filesystem::path& file, const ReadOptions& options,
                            const FileAccess& files, Diagnostics& diagnostics);

}  // namespace penumbra::mitsuba
