// Reference images by other renderers.
#pragma once

#include <filesystem>

#include "tests/support/image_test.h"

namespace penumbra {

/// The colours of an image. Throws std::runtime_error.
statistics::Image read_rgb(const std::filesystem::path& path);

/// What Mitsuba has for blocks of `size` x `size` pixels, a multiple of 4, of the scene in that folder.
/// Throws std::runtime_error.
statistics::Estimate mitsuba_blocks(const std::filesystem::path& folder, int size = 4);

}  // namespace penumbra
