#include "scenes/pbrt/light_strength.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/image/bitmap_values.h"

namespace penumbra::pbrt {

glm::vec3 emitted(Context& context, Parameters& parameters, std::string_view name, SourceLocation location) {
  glm::vec3 colour(1.0f);
  if (const Parameter* given = parameters.take(name))
    colour =
        colour_of(*given, ColourOf::kLight, context.files, context.folder, context.report).value_or(colour);
  const glm::dvec3 result =
      emitted_scale(context, parameters, location) * balanced(context, glm::dvec3(colour));
  if (std::max({result.x, result.y, result.z}) < 1e37) return glm::vec3(result);
  context.report.error(parameters.location(name, location), "a light's strength must be finite");
  return glm::vec3(0.0f);
}

glm::dvec3 balanced(const Context& context, const glm::dvec3& colour) {
  return context.balance == glm::dmat3(1.0) ? colour : glm::max(context.balance * colour, 0.0);
}

double emitted_scale(Context& context, Parameters& parameters, SourceLocation location) {
  const double scale = parameters.number("scale", 1.0, context.report);
  if (scale >= 0.0 && scale < 1e37) return scale * context.exposure();
  context.report.error(parameters.location("scale", location),
                       "a light's scale must be at least 0, and finite");
  return 0.0;
}

void refuse_colour_of_image(Context& context, const Parameters& parameters, std::string_view name) {
  if (parameters.has(name) && parameters.has("filename"))
    context.report.error(parameters.location(name, {}),
                         fmt::format("a light with an image has the image's colours: '{}' and 'filename' "
                                     "exclude each other",
                                     name));
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
