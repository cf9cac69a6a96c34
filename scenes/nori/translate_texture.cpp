#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "scenes/names.h"
#include "scenes/nori/translate.h"

namespace penumbra::nori {

using mitsuba::Child;
using mitsuba::Object;
using mitsuba::Parameter;

namespace {

constexpr const char* kConstant = "constant";

bool names_image(const Parameter& parameter) {
  static constexpr std::string_view kExtensions[] = {".png", ".jpg", ".jpeg", ".exr",  ".hdr", ".pfm",
                                                     ".tga", ".bmp", ".tif",  ".tiff", ".ppm", ".webp"};
  const auto* text = std::get_if<std::string>(&parameter.value);
  if (text == nullptr) return false;
  return std::ranges::find(kExtensions, to_lower_case(extension_of(*text))) != std::end(kExtensions);
}

/// "albedo_texture", "albedo_map" → "albedo".
std::string without_suffix(std::string name) {
  static constexpr std::string_view kSuffixes[] = {"_filename", "_file", "_path", "_texture", "_tex", "_map"};
  for (const std::string_view suffix : kSuffixes)
    if (name.size() > suffix.size() && name.ends_with(suffix)) name.resize(name.size() - suffix.size());
  return name;
}

/// Images that are not colours are not sRGB-encoded.
bool is_colour(std::string_view name) {
  static constexpr std::string_view kNumbers[] = {
      "roughness", "metallic", "metalness", "normal",   "normals",     "bump",  "displacement",
      "height",    "alpha",    "opacity",   "specular", "anisotropic", "sheen", "clearcoat"};
  return std::ranges::find(kNumbers, name) == std::end(kNumbers);
}

/// Two numbers, or one for both.
glm::dvec2 pair_of(const std::optional<Parameter>& parameter, double fallback) {
  if (!parameter) return glm::dvec2(fallback);
  if (const auto number = number_of(*parameter)) return glm::dvec2(*number);
  if (const auto vector = vector_of(*parameter)) return glm::dvec2(*vector);
  return glm::dvec2(fallback);
}

void set_to_uv(Object& texture, glm::dvec2 factors, glm::dvec2 offsets) {
  if (factors == glm::dvec2(1.0) && offsets == glm::dvec2(0.0)) return;
  glm::dmat4 to_uv(1.0);
  to_uv[0][0] = factors.x;
  to_uv[1][1] = factors.y;
  to_uv[3] = glm::dvec4(offsets, 0.0, 1.0);
  set(texture, "to_uv", to_uv);
}

/// Squares of side `scale` with offset `delta`: value1 where the integer parts of u / scale - delta sum to an
/// even number. Our v is 1 - v, and our squares have half the side.
void translate_checkerboard(Object& texture) {
  const bool number = texture.type.ends_with("float");
  const glm::dvec2 delta = pair_of(take_any(texture, {"delta", "offset", "shift"}), 0.0);
  auto scale = take(texture, "scale");
  glm::dvec2 side = pair_of(scale, 1.0);
  if (!scale) {
    const auto x = take_any(texture, {"scalex", "scale_x"}), y = take_any(texture, {"scaley", "scale_y"});
    side = 1.0 / glm::dvec2(pair_of(x, 1.0).x, pair_of(y, 1.0).x);  // how many there are
  }
  texture.type = "checkerboard";
  // The colours of a checkerboard used as a number are exchanged; see TextureReader.
  const char* const first = number ? "color1" : "color0";
  const char* const second = number ? "color0" : "color1";
  rename(texture, {"value1", "color_1", "albedo1", "tex1", "value_1"}, first);
  rename(texture, {"value2", "color_2", "albedo2", "tex2", "value_2"}, second);
  set_default(texture, first, 0.0);
  set_default(texture, second, 1.0);
  set_to_uv(texture, glm::dvec2(0.5, -0.5) / side, 0.5 * (glm::dvec2(0.0, 1.0) / side - delta));
}

void translate_image(Object& texture, Parameter& filename) {
  texture.type = "bitmap";
  filename.name = "filename";
  if (auto wrap = take_any(texture, {"wrap", "wrap_mode", "wrapping"})) {
    const auto* text = std::get_if<std::string>(&wrap->value);
    const std::string mode = text != nullptr ? to_lower_case(*text) : "";
    if (mode.find("clamp") != mode.npos) set(texture, "wrap_mode", std::string("clamp"));
    if (mode.find("mirror") != mode.npos) set(texture, "wrap_mode", std::string("mirror"));
  }
  const auto scale = take_any(texture, {"scale", "tiling"});
  const auto shift = take_any(texture, {"shift", "offset", "delta"});
  const glm::dvec2 factors = pair_of(scale, 1.0), offsets = pair_of(shift, 0.0);
  // In our v, which is 1 - v.
  set_to_uv(texture, factors, {offsets.x, 1.0 - factors.y - offsets.y});
  take_any(texture, {"filter_type", "interpolation"});
}

}  // namespace

Parameter* image_name(Object& object) {
  static constexpr std::string_view kNames[] = {"filename", "file_name", "file", "path", "image"};
  const auto named = std::ranges::find_if(object.parameters, [](const Parameter& parameter) {
    return std::holds_alternative<std::string>(parameter.value) &&
           std::ranges::find(kNames, parameter.name) != std::end(kNames);
  });
  if (named != object.parameters.end()) return &*named;
  const auto image = std::ranges::find_if(object.parameters, names_image);
  return image != object.parameters.end() ? &*image : nullptr;
}

void translate_texture(const Translation&, Object& texture) {
  const std::string plain = plain_name(texture.type);
  if (plain.starts_with("constant")) {
    texture.type = kConstant;
    return;
  }
  if (plain.find("checker") != plain.npos) return translate_checkerboard(texture);
  Parameter* const filename = image_name(texture);
  if (filename != nullptr) translate_image(texture, *filename);
}

void settle_textures(const Translation& t, Object& object) {
  const auto is_constant = [](const Child& c) {
    return c.object->tag == "texture" && c.object->type == kConstant;
  };
  for (const Child& child : object.children) {
    if (!is_constant(child)) continue;
    auto value = take_any(*child.object, {"value", "color", "colour", "albedo"});
    if (!value) continue;
    value->name = child.name.empty() ? "albedo" : child.name;
    if (find(object, value->name) == nullptr) object.parameters.push_back(std::move(*value));
  }
  std::erase_if(object.children, is_constant);
  // An image by its name alone.
  for (std::size_t i = object.parameters.size(); i-- > 0;) {
    Parameter& parameter = object.parameters[i];
    if (object.tag != "bsdf" || !names_image(parameter)) continue;
    Object& texture = t.new_object("texture", "bitmap", parameter.location);
    const std::string name = without_suffix(parameter.name);
    parameter.name = "filename";
    texture.parameters.push_back(std::move(parameter));
    object.parameters.erase(object.parameters.begin() + std::ptrdiff_t(i));
    take(object, name);
    add_child(object, texture, name);
  }
  for (Child& child : object.children) {
    if (child.object->tag != "texture") continue;
    child.name = without_suffix(child.name);
    if (child.object->type == "bitmap" && !is_colour(child.name)) set_default(*child.object, "raw", true);
  }
}

}  // namespace penumbra::nori
