// Reads pictures of Radiance (.hdr).
#pragma once

#include <cstddef>
#include <string_view>

#include "kernels/host/error.h"
#include "scenes/image/image_module.h"

namespace penumbra {

bool is_radiance(std::string_view contents);

/// The picture upright, as the resolution line says how its scanlines lie. Values are mantissa x
/// 2^(exponent - 136) as in Radiance's color.h, without half a step added; EXPOSURE is not divided out, as
/// Mitsuba does not. Both run-length codes are read. (Ward, "Real Pixels", Graphics Gems II; Radiance's
/// filefmts.pdf.) Errors: colours other than RGBE, a resolution line of another form, damaged or incomplete,
/// more than `most_bytes`.
Expected<ImageContents> read_radiance(std::string_view contents, std::size_t most_bytes);

}  // namespace penumbra
