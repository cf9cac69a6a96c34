// The brightness of pbrt's lights.
#pragma once

#include <string_view>

#include "scenes/image/bitmap.h"
#include "scenes/pbrt/colours.h"
#include "scenes/pbrt/state.h"

namespace penumbra::pbrt {

/// The colour of that name, times the light's `scale` and the film's exposure.
glm::vec3 emitted(Context& context, Parameters& parameters, std::string_view name, SourceLocation location);

/// The factor that gives a light the value of its parameter `power` or `illuminance`; 1 if that is not given.
/// `of_unit` is the value for a light of unit strength.
double factor_of(Context& context, Parameters& parameters, std::string_view name, double of_unit);

/// The mean luminance over all texels of an image.
double mean_luminance(const Bitmap& image);

}  // namespace penumbra::pbrt
