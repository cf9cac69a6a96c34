// A film with a share of its width and height: `--scale`, and the smaller films of estimates.
#pragma once

#include <string_view>

#include "kernels/host/error.h"
#include "scenes/scene_description.h"
#include "scheduler/render/render_request.h"

namespace penumbra {

/// "25%" or "0.25". Errors: anything else, or a share outside 0.1% to 1000%.
Expected<double> parse_scale(std::string_view text);

/// Width and height times `scale`, rounded to the nearest pixel and at least 1. The crop window becomes the
/// smallest one that covers the same part of the image.
Film scaled_film(Film film, double scale);

/// The same part of a film that was scaled to `film`.
CropRectangle scaled_crop(const CropRectangle& crop, double scale, const Film& film);

}  // namespace penumbra
