// How bright lights of pbrt are.
#pragma once

#include <string_view>

#include "scenes/image/bitmap.h"
#include "scenes/pbrt/colours.h"
#include "scenes/pbrt/state.h"

namespace penumbra::pbrt {

/// The colour of that name times the light's `scale` and the film's exposure.
glm::vec3 emitted(Context& context, Parameters& parameters, std::string_view name, SourceLocation location);

/// Given as `power` or `illuminance`, which replaces nothing but a factor: that of a light of unit strength.
double factor_of(Context& context, Parameters& parameters, std::string_view name, double of_unit);

/// The mean luminance of an image.
double mean_luminance(const Bitmap& image);

}  // namespace penumbra::pbrt
