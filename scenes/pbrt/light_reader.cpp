#include "scenes/pbrt/light_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/angles.h"
#include "scenes/pbrt/image_lights.h"
#include "scenes/pbrt/light_strength.h"
#include "scenes/punctual_lights.h"
#include "scenes/transform.h"

namespace penumbra::pbrt {
namespace {

void read_point(Context& context, Parameters& parameters, const GraphicsState& state,
                SourceLocation location) {
  PunctualLight light;
  light.strength = emitted(context, parameters, "I", location);
  light.strength *= float(factor_of(context, parameters, "power", 4 * kPi));
  light.position =
      transform_point(state.ctm.start, parameters.point("from", glm::dvec3(0.0), context.report));
  add_punctual_light(light, context.scene);
}

/// The direction from `from` to `to` in world space. Nothing, and an error, if they are equal.
std::optional<glm::dvec3> direction_of(Context& context, Parameters& parameters, const GraphicsState& state,
                                       SourceLocation location, glm::dvec3& from) {
  from = parameters.point("from", glm::dvec3(0.0), context.report);
  const glm::dvec3 to = parameters.point("to", glm::dvec3(0.0, 0.0, 1.0), context.report);
  const glm::dvec3 way = transform_vector(state.ctm.start, to - from);
  from = transform_point(state.ctm.start, from);
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

}  // namespace

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
  } else if (type == "projection") {
    read_projection(context, textures, parameters, state, location);
  } else if (type == "goniometric") {
    read_goniometric(context, textures, parameters, state, location);
  } else {
    const std::vector<std::string> known = {"point",    "spot",       "distant",
                                            "infinite", "projection", "goniometric"};
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
  refuse_colour_of_image(context, parameters, "L");
  light.radiance = parameters.has("filename") ? glm::vec3(float(emitted_scale(context, parameters, location)))
                                              : emitted(context, parameters, "L", location);
  light.two_sided = parameters.boolean("twosided", false, report);
  if (parameters.has("power")) {
    const double power = parameters.number("power", -1.0, report);
    if (power > 0.0) light.power = power;  // as in pbrt, otherwise not given
  }
  if (parameters.has("spread")) {
    parameters.take("spread");
    report.warn(parameters.location("spread", location),
                "the spread of area lights is ignored: they shine in all directions");
  }
  if (const std::string file = parameters.text("filename", "", report); !file.empty()) {
    const auto image = textures.light_image(file, parameters.location("filename", location));
    if (image) {
      light.image = textures.balanced(*image);
      light.image_mean = mean_luminance(textures.bitmap_of(*image));
    }
    if (light.power && !(light.image_mean > 0.0)) light.image_mean = 1.0;
  }
  parameters.finish("the area light", report);
  return std::make_shared<AreaLight>(light);
}

}  // namespace penumbra::pbrt
