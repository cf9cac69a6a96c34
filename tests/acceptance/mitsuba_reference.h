// Reference images by other renderers.
#pragma once

#include <filesystem>

#include "tests/support/image_test.h"

namespace penumbra {

/// The colours of an image. Throws std::runtime_error.
statistics::Image read_rgb(const std::filesystem::path& path);

/// What Mitsuba has for blocks of 4 x 4 pixels of the scene in that folder. Throws std::runtime_error.
statistics::Estimate mitsuba_blocks(const std::filesystem::path& folder);

}  // namespace penumbra
