// Reads Mitsuba XML files to an object tree.
#pragma once

#include "scenes/file_access.h"
#include "scenes/mitsuba/object_tree.h"
#include "scenes/scene_reader.h"

namespace pugi {
class xml_document;
}

namespace penumbra::mitsuba {

/// Files of another program, nearly those of Mitsuba 0.x: they need no version.
struct XmlDialect {
  void (*adapt)(pugi::xml_document&);  ///< changes a document to one that Mitsuba knows
};

/// Reads `file` and the files that it includes. The root must be <scene version="…"> of a version from 0.4 to
/// 3. `$name` is substituted from `options.defines`, else from a preceding <default>. Problems are added to
/// `diagnostics`. The tree then holds whatever could be read, so that further problems can be found. Null:
/// the files are Mitsuba's own.
ObjectTree read_object_tree(const std::filesystem::path& file, const ReadOptions& options,
                            const FileAccess& files, Diagnostics& diagnostics,
                            const XmlDialect* dialect = nullptr);

}  // namespace penumbra::mitsuba
