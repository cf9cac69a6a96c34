#include "scenes/pbrt/light_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/angles.h"
#include "scenes/image/bitmap_values.h"
#include "scenes/punctual_lights.h"
#include "scenes/transform.h"

namespace penumbra::pbrt {
namespace {

/// A colour times `scale`.
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

/// Of the image's values, red, green and blue of Rec. 709.
double mean_luminance(const Bitmap& image) {
  const BitmapValues values(image, kSrgb);
  const auto channels = std::size_t(image.channels);
  const std::size_t texels = std::size_t(image.width) * std::size_t(image.height);
  double sum = 0;
  for (std::size_t i = 0; i < texels; ++i) {
    const auto value = [&](std::size_t c) {
      return double(values[i * channels + std::min(c, channels - 1)]);
    };
    sum += 0.212671 * value(0) + 0.71516 * value(1) + 0.072169 * value(2);
  }
  return texels > 0 ? sum / double(texels) : 0.0;
}

/// Given as `power` or `illuminance`, which replaces nothing but a factor: that of a light of unit strength.
double factor_of(Context& context, Parameters& parameters, std::string_view name, double of_unit) {
  if (!parameters.has(name)) return 1.0;
  const double value = parameters.number(name, -1.0, context.report);
  if (!(value > 0.0)) return 1.0;  // as in pbrt: not given
  return value / of_unit;
}

void read_point(Context& context, Parameters& parameters, const GraphicsState& state,
                SourceLocation location) {
  PunctualLight light;
  light.strength = emitted(context, parameters, "I", location);
  light.strength *= float(factor_of(context, parameters, "power", 4 * kPi));
  light.position = transform_point(state.ctm, parameters.point("from", glm::dvec3(0.0), context.report));
  add_punctual_light(light, context.scene);
}

/// From `from` to `to` in the world; none, and an error, where they are the same.
std::optional<glm::dvec3> direction_of(Context& context, Parameters& parameters, const GraphicsState& state,
                                       SourceLocation location, glm::dvec3& from) {
  from = parameters.point("from", glm::dvec3(0.0), context.report);
  const glm::dvec3 to = parameters.point("to", glm::dvec3(0.0, 0.0, 1.0), context.report);
  const glm::dvec3 way = transform_vector(state.ctm, to - from);
  from = transform_point(state.ctm, from);
  if (glm::length(way) > 0.0 && glm::length(way) < 1e150) return glm::normalize(way);
  context.report.error(location, "'from' and 'to' of a light must differ");
  return std::nullopt;
}

void read_spot(Context& context, Parameters& parameters, const GraphicsState& state,
               SourceLocation location) {
  PunctualLight light;
  light.kind = PunctualKind::kSpot;
  light.falloff = SpotFalloff::kSmoothstep;
  light.strength = emitted(context, parameters, "I", location);
  light.outer_angle = parameters.number("coneangle", 30.0, context.report);
  light.inner_angle = light.outer_angle - parameters.number("conedeltaangle", 5.0, context.report);
  if (!(light.inner_angle >= 0.0 && light.inner_angle <= light.outer_angle && light.outer_angle <= 180.0))
    return context.report.error(location, "a spot has 0 <= conedeltaangle <= coneangle <= 180");
  const double start = std::cos(light.inner_angle * kPi / 180), end = std::cos(light.outer_angle * kPi / 180);
  light.strength *=
      float(factor_of(context, parameters, "power", 2 * kPi * ((1 - start) + (start - end) / 2)));
  const auto direction = direction_of(context, parameters, state, location, light.position);
  if (!direction) return;
  light.direction = *direction;
  add_punctual_light(light, context.scene);
}

void read_distant(Context& context, Parameters& parameters, const GraphicsState& state,
                  SourceLocation location) {
  PunctualLight light;
  light.kind = PunctualKind::kDirectional;
  light.strength = emitted(context, parameters, "L", location);
  light.strength *= float(factor_of(context, parameters, "illuminance", 1.0));
  const auto direction = direction_of(context, parameters, state, location, light.position);
  if (!direction) return;
  light.direction = *direction;
  add_punctual_light(light, context.scene);
}

/// Of a plane below the octahedral image, half of what it is in truth: so pbrt counts it, and it is by this
/// that files give a sky's brightness.
double illuminance_of(const Bitmap& square) {
  const BitmapValues values(square, kSrgb);
  const auto channels = std::size_t(square.channels);
  double sum = 0;
  for (int y = 0; y < square.height; ++y)
    for (int x = 0; x < square.width; ++x) {
      // The diamond in the middle is the upper half; there areas are the sphere's, and z = 1 - r².
      const double r =
          std::abs(2 * (x + 0.5) / square.width - 1) + std::abs(2 * (y + 0.5) / square.height - 1);
      if (r >= 1) continue;
      const std::size_t at = (std::size_t(y) * std::size_t(square.width) + std::size_t(x)) * channels;
      const auto value = [&](std::size_t c) { return double(values[at + std::min(c, channels - 1)]); };
      sum += (1 - r * r) * (0.212671 * value(0) + 0.71516 * value(1) + 0.072169 * value(2));
    }
  return sum * 2 * kPi / (double(square.width) * square.height);
}

/// The octahedral image as one of longitudes and polar angles, y up, texels of half as many rows.
std::shared_ptr<const Bitmap> resampled(const Bitmap& square) {
  const int side = square.width, height = std::clamp(side, 2, 8192), width = 2 * height;
  const auto channels = std::size_t(square.channels);
  const auto texel = [&](int x, int y, int c) {
    // Beyond an edge, the other half of it, turned round.
    if (x < 0) x = -1 - x, y = side - 1 - y;
    if (x >= side) x = 2 * side - 1 - x, y = side - 1 - y;
    if (y < 0) y = -1 - y, x = side - 1 - x;
    if (y >= side) y = 2 * side - 1 - y, x = side - 1 - x;
    const std::size_t at = (std::size_t(y) * std::size_t(side) + std::size_t(x)) * channels;
    return bitmap_value(square, at + std::min(std::size_t(c), channels - 1), kSrgb);
  };
  std::vector<float> values;
  values.reserve(3 * std::size_t(width) * std::size_t(height));
  for (int row = 0; row < height; ++row) {
    const double theta = kPi * row / (height - 1);
    for (int column = 0; column < width; ++column) {
      // Texel (x, y) of ours is at longitude 2 pi (x + 1/2) / W, see kernels/light/envmap_grid.h: z towards
      // -y.
      const double phi = 2 * kPi * (column + 0.5) / width;
      const glm::dvec3 direction(std::sin(phi) * std::sin(theta), std::cos(theta),
                                 -std::cos(phi) * std::sin(theta));
      const glm::dvec2 at = octahedral_square(direction) * double(side) - 0.5;
      const int x = int(std::floor(at.x)), y = int(std::floor(at.y));
      const double u = at.x - x, v = at.y - y;
      for (int c = 0; c < 3; ++c)
        values.push_back(float((1 - v) * ((1 - u) * texel(x, y, c) + u * texel(x + 1, y, c)) +
                               v * ((1 - u) * texel(x, y + 1, c) + u * texel(x + 1, y + 1, c))));
    }
  }
  return std::make_shared<const Bitmap>(float_bitmap(square.name, width, height, 3, values));
}

void read_infinite(Context& context, TextureReader& textures, Parameters& parameters,
                   const GraphicsState& state, SourceLocation location) {
  ReaderReport& report = context.report;
  const auto other = std::ranges::find_if(context.scene.emitters, is_sky);
  const std::string file = parameters.text("filename", "", report);
  glm::vec3 radiance = emitted(context, parameters, "L", location);
  if (parameters.has("portal")) {
    parameters.take("portal");
    report.warn(parameters.location("portal", location),
                "portals are ignored: the light comes from everywhere");
  }
  auto* constant =
      other != context.scene.emitters.end() ? std::get_if<ConstantEnvironment>(&*other) : nullptr;
  if (other != context.scene.emitters.end() && (constant == nullptr || !file.empty())) {
    parameters.accept({"illuminance", "filename"});
    return report.unsupported(location,
                              "a second infinite light is not read, unless both are the same everywhere",
                              "it is left out");
  }
  if (constant != nullptr) {
    constant->radiance += radiance * float(factor_of(context, parameters, "illuminance", kPi));
    return;
  }
  if (file.empty()) {
    radiance *= float(factor_of(context, parameters, "illuminance", kPi));
    context.scene.emitters.emplace_back(ConstantEnvironment{radiance});
    return;
  }
  const auto image = textures.image(file, parameters.location("filename", location));
  if (image == nullptr) {
    context.scene.emitters.emplace_back(ConstantEnvironment{kUnreadColour});
    return;
  }
  if (image->width != image->height || image->width > 16384)
    return report.error(parameters.location("filename", location),
                        fmt::format("an image of {} x {}; one of all directions is square, up to 16384",
                                    image->width, image->height));
  report.warn_counted(location, "images of all directions are resampled, from octahedral to longitudes");
  EnvironmentMapLight sky;
  sky.filename = file;
  sky.image = resampled(*image);
  sky.scale = radiance.x * float(factor_of(context, parameters, "illuminance", illuminance_of(*image)));
  sky.to_world = glm::dmat4(glm::dmat3(state.ctm));
  context.scene.emitters.emplace_back(std::move(sky));
}

}  // namespace

glm::dvec2 octahedral_square(glm::dvec3 direction) {
  const glm::dvec3 d = glm::abs(direction) / glm::length(direction);
  const double r = std::sqrt(std::max(1.0 - d.z, 0.0));
  const double phi = d.x == 0.0 && d.y == 0.0 ? 0.0 : std::atan2(d.y, d.x) * 2 / kPi;
  double v = phi * r, u = r - v;
  if (direction.z < 0.0) {
    std::swap(u, v);
    u = 1.0 - u;
    v = 1.0 - v;
  }
  return {0.5 * (std::copysign(u, direction.x) + 1.0), 0.5 * (std::copysign(v, direction.y) + 1.0)};
}

void read_light(Context& context, TextureReader& textures, const std::string& type, Parameters& parameters,
                const GraphicsState& state, SourceLocation location) {
  if (type == "point") {
    read_point(context, parameters, state, location);
  } else if (type == "spot") {
    read_spot(context, parameters, state, location);
  } else if (type == "distant") {
    read_distant(context, parameters, state, location);
  } else if (type == "infinite") {
    read_infinite(context, textures, parameters, state, location);
  } else {
    const std::vector<std::string> known = {"point", "spot", "distant", "infinite"};
    return context.report.unsupported(location,
                                      fmt::format("light '{}' is not one that Penumbra reads{}", type,
                                                  known_names(type, known, "It reads")),
                                      "it is left out");
  }
  parameters.finish(fmt::format("the light '{}'", type), context.report);
}

std::shared_ptr<const AreaLight> read_area_light(Context& context, TextureReader& textures,
                                                 const std::string& type, Parameters& parameters,
                                                 SourceLocation location) {
  ReaderReport& report = context.report;
  if (type != "diffuse") {
    report.unsupported(location, fmt::format("area light '{}' is not read; 'diffuse' is", type),
                       "it is left out");
    return nullptr;
  }
  AreaLight light;
  light.location = location;
  light.radiance = emitted(context, parameters, "L", location);
  light.two_sided = parameters.boolean("twosided", false, report);
  if (parameters.has("power")) {
    const double power = parameters.number("power", -1.0, report);
    if (power > 0.0) light.power = power;
  }
  if (parameters.has("spread")) {
    parameters.take("spread");
    report.warn(parameters.location("spread", location),
                "the spread of area lights is ignored: they shine in all directions");
  }
  if (const std::string file = parameters.text("filename", "", report); !file.empty()) {
    const auto image = textures.light_image(file, parameters.location("filename", location));
    if (image) {
      light.image = *image;
      light.image_mean = mean_luminance(textures.bitmap_of(*image));
    }
    if (light.power && !(light.image_mean > 0.0)) light.image_mean = 1.0;
  }
  parameters.finish("the area light", report);
  return std::make_shared<AreaLight>(light);
}

}  // namespace penumbra::pbrt
