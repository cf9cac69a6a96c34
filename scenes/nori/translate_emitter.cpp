#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scenes/names.h"
#include "scenes/nori/translate.h"
#include "scenes/transform.h"

namespace penumbra::nori {

using mitsuba::Child;
using mitsuba::Object;
using mitsuba::Parameter;
using mitsuba::RgbValue;

namespace {

/// Image-based light: the environment map of akaqyd's fork, whose y is up.
constexpr std::string_view kImageLight = "ibl";

bool is_spot(std::string_view plain) { return plain.starts_with("spot"); }
bool is_point(std::string_view plain) {
  return plain == "point" || plain == "pointlight" || plain == "pointemitter";
}
bool is_directional(std::string_view plain) {
  return plain.starts_with("directional") || plain.starts_with("distant") || plain == "sun" ||
         plain == "directionlight";
}

void scale_colour(Parameter& parameter, double factor) {
  if (auto* colour = std::get_if<RgbValue>(&parameter.value)) colour->rgb *= float(factor);
  if (auto* number = std::get_if<double>(&parameter.value)) *number *= factor;
}

/// Keeps an intensity, or computes it from a power and the solid angle. The default in Nori is 1, or no
/// light.
void settle_intensity(Object& light, double solid_angle) {
  if (Parameter* power = find(light, "power")) {
    power->name = "intensity";
    scale_colour(*power, 1.0 / solid_angle);
    return;
  }
  rename(light, {"radiance", "energy", "color"}, "intensity");
}

/// An angle from the axis in degrees, given as an angle or as its cosine. A cosine above 1 is an angle in
/// degrees: forks kept the parameter's name when they read it as one.
std::optional<double> angle_of(Object& light, std::initializer_list<std::string_view> angles,
                               std::initializer_list<std::string_view> cosines) {
  if (const auto cosine = take_any(light, cosines))
    if (const auto number = number_of(*cosine))
      return *number > 1.0 ? *number : std::acos(std::clamp(*number, -1.0, 1.0)) * 180 / std::numbers::pi;
  if (const auto angle = take_any(light, angles)) return number_of(*angle);
  return std::nullopt;
}

/// A factor of the light (akaqyd's fork).
void settle_strength(const Translation& t, Object& light, std::string_view light_parameter) {
  const auto strength = take(light, "strength");
  if (!strength) return;
  Parameter* const colour = find(light, light_parameter);
  if (const auto factor = number_of(*strength); colour != nullptr && factor)
    scale_colour(*colour, *factor);
  else
    t.report.error(strength->location,
                   fmt::format("strength multiplies the colour {}, which is not given", light_parameter));
}

/// The direction of a directional light by the angle theta of the light above the horizon and phi around the
/// y axis from x to z, in degrees (akaqyd's fork).
void settle_elevation(Object& light) {
  const auto theta = take(light, "theta"), phi = take(light, "phi");
  if (!theta || !phi || !number_of(*theta) || !number_of(*phi)) return;
  constexpr double kRadians = std::numbers::pi / 180;
  const double up = *number_of(*theta) * kRadians, around = *number_of(*phi) * kRadians;
  set(light, "direction",
      glm::dvec3(std::cos(around) * std::cos(up), -std::sin(up), std::sin(around) * std::cos(up)));
}

/// A frame from a direction or a target.
std::optional<glm::dmat4> frame_of(Object& light) {
  const auto position = take_any(light, {"position", "pos", "origin"});
  const auto direction = take_any(light, {"direction", "dir"});
  const auto target = take_any(light, {"target", "look_at", "lookat"});
  const glm::dvec3 at = position ? vector_of(*position).value_or(glm::dvec3(0.0)) : glm::dvec3(0.0);
  glm::dvec3 along(0.0, 0.0, 1.0);
  if (direction) along = vector_of(*direction).value_or(along);
  if (target) along = vector_of(*target).value_or(at + along) - at;
  if (!(glm::length(along) > 0.0)) return std::nullopt;
  const auto frame = look_at(at, at + glm::normalize(along), std::nullopt);
  return frame ? std::optional(*frame) : std::nullopt;
}

void translate_spot(const Translation& t, Object& light) {
  light.type = "spot";
  const double cutoff = angle_of(light,
                                 {"total_width", "totalwidth", "cutoff_angle", "cutoff", "theta", "angle",
                                  "cone_angle", "outer_angle"},
                                 {"cos_total_width", "cos_cutoff", "cos_theta"})
                            .value_or(30.0);
  double beam =
      angle_of(light,
               {"falloff_start", "falloffstart", "beam_width", "falloff", "theta_falloff", "inner_angle"},
               {"cos_falloff_start", "cos_falloff", "cos_theta_falloff"})
          .value_or(0.75 * cutoff);
  beam = std::clamp(beam, 0.0, cutoff);
  const double radians = std::numbers::pi / 180;
  // pbrt's formula, which forks use: as if the light extended to half way between both angles.
  settle_intensity(
      light, 2 * std::numbers::pi * (1 - 0.5 * (std::cos(cutoff * radians) + std::cos(beam * radians))));
  if (beam < cutoff)
    t.report.warn_counted(
        light.location,
        "forks of Nori differ in how a spot fades out; between its angles it is squared here");
  set(light, "cutoff_angle", cutoff);
  set(light, "beam_width", beam);
  set(light, "falloff", std::string("squared"));
  if (find(light, "to_world") != nullptr) return;
  if (const auto frame = frame_of(light))
    set(light, "to_world", *frame);
  else
    t.report.error(light.location, "the direction of a spot must have a length above 0");
}

/// The image of an environment, under any of its names. Nothing if it is constant.
void settle_image(const Translation& t, Object& light) {
  for (Child& child : light.children) {
    if (child.object->tag != "texture") continue;
    if (auto filename = take(*child.object, "filename")) {
      light.parameters.push_back(std::move(*filename));
      child.object = nullptr;
    }
  }
  std::erase_if(light.children, [](const Child& child) { return child.object == nullptr; });
  if (Parameter* image = image_name(light)) image->name = "filename";
  if (find(light, "filename") == nullptr) {
    light.type = "constant";
    rename(light, {"albedo", "color", "power", "intensity", "value", "background"}, "radiance");
    return;
  }
  const bool y_up = plain_name(light.type) == kImageLight;
  light.type = "envmap";
  rename(light,
         {"weight", "intensity", "strength", "radiance_scale", "intensity_scale", "multiplier",
          "exposure_scale"},
         "scale");
  if (const auto radiance = take_any(light, {"radiance", "color", "power"})) {
    const glm::vec3 colour = colour_of(*radiance).value_or(glm::vec3(1.0f));
    if (colour != glm::vec3(colour.x))
      t.report.warn(radiance->location, "an environment map is multiplied by a number; that of red counts");
    set_default(light, "scale", double(colour.x));
  }
  if (!y_up)
    t.report.warn_counted(
        light.location,
        fmt::format("forks of Nori differ in where environment maps begin; here {} is up, and "
                    "longitudes are Mitsuba's",
                    t.dialect == Dialect::kEth ? "z" : "y"));
  if (t.dialect != Dialect::kEth && !y_up) return;
  // From Mitsuba's axes of environment maps to those of Nori's spherical coordinates.
  glm::dmat4 z_up(0.0);
  z_up[0][1] = -1.0;
  z_up[1][2] = 1.0;
  z_up[2][0] = -1.0;
  z_up[3][3] = 1.0;
  Parameter* to_world = find(light, "to_world");
  const auto* given = to_world != nullptr ? std::get_if<glm::dmat4>(&to_world->value) : nullptr;
  if (y_up && given == nullptr) return;  // its default transform is the inverse of z_up
  set(light, "to_world", given != nullptr ? *given * z_up : z_up);
}

}  // namespace

bool is_environment(const Object& emitter) {
  const std::string plain = plain_name(emitter.type);
  return plain == "constant" || plain == "infinite" || plain == kImageLight || plain == "hdri" ||
         plain == "background" || plain.find("env") != plain.npos;
}

void translate_emitter(const Translation& t, Object& emitter, const Object* shape) {
  settle_textures(t, emitter);
  const std::string plain = plain_name(emitter.type);
  if (shape != nullptr && !is_environment(emitter)) {
    const bool own = plain.find("area") != plain.npos || plain == "parallelogramemitter" ||
                     find_any(emitter, {"radiance", "albedo"}) != nullptr ||
                     find_child(emitter, "texture") != nullptr;
    if (!own || plain.starts_with("vol")) return;  // the interior of the shape emits
    emitter.type = "area";
    rename(emitter, {"albedo", "texture", "emission", "color", "map", ""}, "radiance");
    settle_strength(t, emitter, "radiance");
    return;
  }
  if (is_point(plain)) {
    emitter.type = "point";
    rename(emitter, {"pos", "origin"}, "position");
    settle_intensity(emitter, 4 * std::numbers::pi);
  } else if (is_spot(plain)) {
    translate_spot(t, emitter);
  } else if (is_directional(plain)) {
    emitter.type = "directional";
    rename(emitter, {"dir"}, "direction");
    rename(emitter, {"radiance", "power", "intensity", "color"}, "irradiance");
    settle_strength(t, emitter, "irradiance");
    settle_elevation(emitter);
  } else if (is_environment(emitter)) {
    settle_image(t, emitter);
  }
}

}  // namespace penumbra::nori
