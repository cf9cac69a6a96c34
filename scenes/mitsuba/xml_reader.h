// Reads Mitsuba XML files to an object tree.
#pragma once

#include "scenes/file_access.h"
#include "scenes/mitsuba/object_tree.h"
#include "scenes/scene_reader.h"

namespace penumbra::mitsuba {

/// Reads `file` and the files that it includes. The root must be <scene version="…"> of a version from 0.4 to
/// 3. `$name` is substituted from `options.defines`, else from a preceding <default>. Problems are added to
/// `diagnostics`. The tree then holds whatever could be read, so that further problems can be found.
ObjectTree read_object_tree(const std::filesystem::path& file, const ReadOptions& options,
                            const FileAccess& files, Diagnostics& diagnostics);

}  // namespace penumbra::mitsuba
