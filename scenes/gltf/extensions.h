// The glTF extensions that are supported, those that can be ignored because they do not affect the image, and
// what is lost without each of the others.
#pragma once

#include "scenes/gltf/asset.h"
#include "scenes/reader_report.h"

namespace penumbra::gltf {

/// Reports unsupported extensions: an error if the file requires the extension, a warning if it only uses it
/// and the image is affected.
void check_extensions(const Asset& asset, ReaderReport& report);

}  // namespace penumbra::gltf
