#include "scenes/pbrt/light_strength.h"

#include <algorithm>

#include "scenes/image/bitmap_values.h"

namespace penumbra::pbrt {

glm::vec3 emitted(Context& context, Parameters& parameters, std::string_view name, SourceLocation location) {
  glm::vec3 colour(1.0f);
  if (const Parameter* given = parameters.take(name))
    colour =
        colour_of(*given, ColourOf::kLight, context.files, context.folder, context.report).value_or(colour);
  const double scale = parameters.number("scale", 1.0, context.report);
  const glm::dvec3 result = scale * context.exposure * glm::dvec3(colour);
  if (!(scale >= 0.0 && std::max({result.x, result.y, result.z}) < 1e37)) {
    context.report.error(parameters.location("scale", location),
                         "a light's scale must be at least 0, and finite");
    return glm::vec3(0.0f);
  }
  return glm::vec3(result);
}

double factor_of(Context& context, Parameters& parameters, std::string_view name, double of_unit) {
  if (!parameters.has(name)) return 1.0;
  const double value = parameters.number(name, -1.0, context.report);
  if (!(value > 0.0)) return 1.0;  // as in pbrt, this means not given
  return value / of_unit;
}

double mean_luminance(const Bitmap& image) {
  const BitmapValues values(image, kSrgb);
  const auto channels = std::size_t(image.channels);
  const std::size_t texels = std::size_t(image.width) * std::size_t(image.height);
  double sum = 0;
  for (std::size_t i = 0; i < texels; ++i) {
    const auto value = [&](std::size_t c) {
      return double(values[i * channels + std::min(c, channels - 1)]);
    };
    sum += luminance({value(0), value(1), value(2)});
  }
  return texels > 0 ? sum / double(texels) : 0.0;
}

}  // namespace penumbra::pbrt
