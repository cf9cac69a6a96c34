#include <fmt/format.h>

#include "scenes/mitsuba/value_reader.h"
#include "scenes/motion/keyed_transform.h"
#include "scenes/names.h"
#include "scenes/number.h"
#include "scenes/transform.h"

namespace penumbra::mitsuba {
namespace {

std::optional<double> read_number(const ElementReader& element, std::string_view attribute, double fallback) {
  if (!element.element().attribute(std::string(attribute).c_str())) return fallback;
  const auto text = element.attribute(attribute);
  if (!text) return std::nullopt;
  const auto number = parse_number(*text);
  if (!number) return element.wrong_value(attribute, number.error().message);
  return *number;
}

std::optional<glm::dvec3> read_numbers(const ElementReader& element, std::string_view attribute,
                                       bool one_for_all) {
  const auto text = element.required(attribute);
  if (!text) return std::nullopt;
  const auto numbers = parse_numbers(*text);
  if (!numbers) return element.wrong_value(attribute, numbers.error().message);
  if (numbers->size() == 1 && one_for_all) return glm::dvec3(numbers->front());
  if (numbers->size() != 3) {
    return element.wrong_value(
        attribute, fmt::format("{} numbers are wanted, not {}", one_for_all ? "one or three" : "three",
                               numbers->size()));
  }
  return glm::dvec3((*numbers)[0], (*numbers)[1], (*numbers)[2]);
}

/// x, y and z, each with a default, or all in `value`.
std::optional<glm::dvec3> read_xyz(const ElementReader& element, double fallback, bool one_for_all) {
  if (element.element().attribute("value")) {
    for (const char* axis : {"x", "y", "z"}) {
      if (element.element().attribute(axis))
        return element.wrong_value(axis, "either 'value' or x, y and z, not both");
    }
    return read_numbers(element, "value", one_for_all);
  }
  const auto x = read_number(element, "x", fallback);
  const auto y = read_number(element, "y", fallback);
  const auto z = read_number(element, "z", fallback);
  if (!x || !y || !z) return std::nullopt;
  return glm::dvec3(*x, *y, *z);
}

std::optional<glm::dmat4> read_rotation(const ElementReader& element) {
  // Nori's axis is a single attribute.
  const auto axis = element.element().attribute("axis") ? read_numbers(element, "axis", false)
                                                        : read_xyz(element, 0.0, false);
  if (!axis || !element.required("angle")) return std::nullopt;
  const auto angle = read_number(element, "angle", 0.0);
  if (!angle) return std::nullopt;
  if (!(glm::length(*axis) > 0.0)) return element.wrong("a rotation needs an axis: x, y and z, not all zero");
  return rotation(*axis, *angle);
}

std::optional<glm::dmat4> read_matrix(const ElementReader& element) {
  const auto text = element.required("value");
  if (!text) return std::nullopt;
  const auto numbers = parse_numbers(*text);
  if (!numbers) return element.wrong_value("value", numbers.error().message);
  const auto matrix = matrix_from_rows(*numbers);
  if (!matrix) return element.wrong_value("value", matrix.error().message);
  return *matrix;
}

std::optional<glm::dmat4> read_look_at(const ElementReader& element) {
  const auto origin = read_numbers(element, "origin", false);
  const auto target = read_numbers(element, "target", false);
  std::optional<glm::dvec3> up;
  if (element.element().attribute("up")) {
    up = read_numbers(element, "up", false);
    if (!up) return std::nullopt;
  }
  if (!origin || !target) return std::nullopt;
  const auto matrix = look_at(*origin, *target, up);
  if (!matrix) return element.wrong(matrix.error().message);
  return *matrix;
}

std::optional<glm::dmat4> read_step(const ElementReader& element) {
  const std::string tag = to_snake_case(element.element().name());
  if (tag == "translate") {
    if (!element.check_attributes({"value", "x", "y", "z"})) return std::nullopt;
    const auto offset = read_xyz(element, 0.0, false);
    if (!offset) return std::nullopt;
    return translation(*offset);
  }
  if (tag == "scale") {
    if (!element.check_attributes({"value", "x", "y", "z"})) return std::nullopt;
    const auto factors = read_xyz(element, 1.0, true);
    if (!factors) return std::nullopt;
    return scaling(*factors);
  }
  if (tag == "rotate") {
    if (!element.check_attributes({"value", "x", "y", "z", "angle", "axis"})) return std::nullopt;
    return read_rotation(element);
  }
  if (tag == "matrix") return element.check_attributes({"value"}) ? read_matrix(element) : std::nullopt;
  if (tag == "lookat" || tag == "look_at") {
    return element.check_attributes({"origin", "target", "up"}) ? read_look_at(element) : std::nullopt;
  }
  const std::vector<std::string> known = {"translate", "rotate", "scale", "matrix", "lookat"};
  return element.wrong(fmt::format("<{}> is not a step of a transform{}", element.element().name(),
                                   known_names(tag, known, "It has")));
}

}  // namespace

std::optional<glm::dmat4> read_transform(const ElementReader& element) {
  glm::dmat4 result(1.0);
  bool good = true;
  for (const pugi::xml_node& child : element.element().children()) {
    if (child.type() != pugi::node_element) continue;
    const auto step = read_step(element.child(child));
    good = good && step.has_value();
    if (step) result = *step * result;
  }
  if (!good) return std::nullopt;
  if (is_singular(result)) {
    return element.wrong(
        "the transform is singular (or overflows): it flattens everything to a plane, line or point");
  }
  return result;
}

std::optional<Value> read_animation(const ElementReader& element) {
  constexpr std::size_t kMostKeys = 4096;
  constexpr std::string_view kHolds = "<transform time=\"…\"> or <string time=\"…\" value=\"…\">";
  AnimationValue transforms;
  TextAnimationValue texts;
  std::vector<double> times;
  std::string kind;
  bool good = true;
  for (const pugi::xml_node& node : element.element().children()) {
    if (node.type() != pugi::node_element) continue;
    const ElementReader child = element.child(node);
    const std::string tag = to_snake_case(node.name());
    if (tag != "transform" && tag != "string")
      return child.wrong(fmt::format("<animation> holds {}, no <{}>", kHolds, node.name()));
    if (kind.empty()) kind = tag;
    if (tag != kind) return child.wrong(fmt::format("<animation> holds either {}, not both", kHolds));
    if (times.size() >= kMostKeys)
      return child.wrong(fmt::format("<animation> has more than {} keys", kMostKeys));
    const bool is_text = kind == "string";
    if (!(is_text ? child.check_attributes({"time", "value"}) : child.check_attributes({"time"})))
      return std::nullopt;
    if (!child.required("time")) return std::nullopt;
    const auto time = read_number(child, "time", 0.0);
    if (time && !times.empty() && !(*time > times.back()))
      return child.wrong_value(
          "time", fmt::format("the times of an animation must ascend; {} follows {}", *time, times.back()));
    if (time) times.push_back(*time);
    if (is_text) {
      auto text = child.required("value");
      good = good && time && text;
      if (good) texts.keys.push_back({*time, std::move(*text), child.value_location("value")});
    } else {
      const auto transform = read_transform(child);
      good = good && time && transform;
      if (good) transforms.keys.push_back({*time, *transform});
    }
  }
  if (!good) return std::nullopt;
  if (times.empty()) return element.wrong(fmt::format("<animation> holds at least one {}", kHolds));
  if (kind == "string") return Value(std::move(texts));
  if (const auto keyed = keyed_transform(transforms.keys); !keyed)
    return element.wrong(keyed.error().message);
  return Value(std::move(transforms));
}

}  // namespace penumbra::mitsuba
