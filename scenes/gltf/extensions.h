// Which extensions of glTF are read, which change nothing that is seen, and what the others leave out.
#pragma once

#include "scenes/gltf/asset.h"
#include "scenes/reader_report.h"

namespace penumbra::gltf {

/// Those that the file requires and that are not read are errors; those that it uses, and that change what is
/// seen, warnings.
void check_extensions(const Asset& asset, ReaderReport& report);

}  // namespace penumbra::gltf
