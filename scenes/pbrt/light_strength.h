// The brightness of pbrt's lights.
#pragma once

#include <string_view>

#include "scenes/image/bitmap.h"
#include "scenes/pbrt/colours.h"
#include "scenes/pbrt/state.h"

namespace penumbra::pbrt {

/// The colour of that name, by the film's white balance, times the light's `scale` and the film's exposure.
glm::vec3 emitted(Context& context, Parameters& parameters, std::string_view name, SourceLocation location);
/// A colour of an image of lights, by the film's white balance.
glm::dvec3 balanced(const Context& context, const glm::dvec3& colour);
/// The light's `scale` and the film's exposure, for a light whose colour is an image's.
double emitted_scale(Context& context, Parameters& parameters, SourceLocation location);
/// pbrt has a colour or an image. An error if both are given.
void refuse_colour_of_image(Context& context, const Parameters& parameters, std::string_view name);

/// The factor that gives a light the value of its parameter `power` or `illuminance`; 1 if that is not given.
/// `of_unit` is the value for a light of unit strength.
double factor_of(Context& context, Parameters& parameters, std::string_view name, double of_unit);

/// The mean luminance over all texels of an image.
double mean_luminance(const Bitmap& image);

}  // namespace penumbra::pbrt
