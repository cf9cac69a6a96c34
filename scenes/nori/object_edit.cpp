#include "scenes/nori/object_edit.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "scenes/names.h"

namespace penumbra::nori {

using mitsuba::Child;
using mitsuba::Object;
using mitsuba::Parameter;
using mitsuba::RgbValue;
using mitsuba::Value;

namespace {

std::string text_of(const Value& value) {
  if (const auto* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *whole);
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  return "";
}

/// The element that values of this kind come from.
const char* tag_of(const Value& value) {
  static constexpr const char* kValueTags[] = {"integer", "float",    "boolean",   "string",   "point",
                                               "rgb",     "spectrum", "transform", "animation"};
  return kValueTags[value.index()];
}

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::ranges::find(names, name) != names.end();
}

}  // namespace

void add_child(Object& parent, Object& object, std::string name) {
  parent.children.push_back({std::move(name), &object, "", object.location});
}

Parameter* find(Object& object, std::string_view name) {
  const auto found = std::ranges::find(object.parameters, name, &Parameter::name);
  return found == object.parameters.end() ? nullptr : &*found;
}

Parameter* find_any(Object& object, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names)
    if (Parameter* parameter = find(object, name)) return parameter;
  return nullptr;
}

Child* find_child(Object& object, std::string_view tag) {
  const auto found =
      std::ranges::find_if(object.children, [&](const Child& c) { return c.object->tag == tag; });
  return found == object.children.end() ? nullptr : &*found;
}

Child* find_child(Object& object, std::string_view tag, std::initializer_list<std::string_view> names) {
  const auto found = std::ranges::find_if(
      object.children, [&](const Child& c) { return c.object->tag == tag && is_one_of(c.name, names); });
  return found == object.children.end() ? nullptr : &*found;
}

void rename(Object& object, std::initializer_list<std::string_view> from, const char* to) {
  if (find_child(object, "texture", {to}) != nullptr) return;
  if (Child* texture = find_child(object, "texture", from)) {
    texture->name = to;
    take(object, to);
  } else if (find(object, to) == nullptr) {
    if (Parameter* parameter = find_any(object, from)) parameter->name = to;
  }
}

void set(Object& object, const char* name, Value value) {
  Parameter parameter{name, tag_of(value), value, text_of(value), object.location, object.location};
  if (Parameter* given = find(object, name)) {
    parameter.location = given->location;
    parameter.value_location = given->value_location;
    *given = std::move(parameter);
    return;
  }
  object.parameters.push_back(std::move(parameter));
}

void set_default(Object& object, const char* name, Value value) {
  if (find(object, name) == nullptr) set(object, name, std::move(value));
}

std::optional<Parameter> take(Object& object, std::string_view name) {
  const auto found = std::ranges::find(object.parameters, name, &Parameter::name);
  if (found == object.parameters.end()) return std::nullopt;
  Parameter result = std::move(*found);
  object.parameters.erase(found);
  return result;
}

std::optional<Parameter> take_any(Object& object, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names)
    if (auto parameter = take(object, name)) return parameter;
  return std::nullopt;
}

std::optional<Child> take_child(Object& object, std::string_view tag,
                                std::initializer_list<std::string_view> names) {
  const Child* child = find_child(object, tag, names);
  if (child == nullptr) return std::nullopt;
  Child result = *child;
  object.children.erase(object.children.begin() + (child - object.children.data()));
  return result;
}

std::optional<double> number_of(const Parameter& parameter) {
  if (const auto* number = std::get_if<double>(&parameter.value)) return *number;
  if (const auto* whole = std::get_if<std::int64_t>(&parameter.value)) return double(*whole);
  return std::nullopt;
}

std::optional<glm::vec3> colour_of(const Parameter& parameter) {
  if (const auto* colour = std::get_if<RgbValue>(&parameter.value)) return colour->rgb;
  if (const auto* triple = std::get_if<glm::dvec3>(&parameter.value)) return glm::vec3(*triple);
  if (const auto number = number_of(parameter)) return glm::vec3(float(*number));
  return std::nullopt;
}

std::optional<glm::dvec3> vector_of(const Parameter& parameter) {
  if (const auto* triple = std::get_if<glm::dvec3>(&parameter.value)) return *triple;
  if (const auto* colour = std::get_if<RgbValue>(&parameter.value)) return glm::dvec3(colour->rgb);
  return std::nullopt;
}

std::string plain_name(std::string_view name) {
  std::string plain = to_lower_case(name);
  std::erase_if(plain, [](char c) { return c == '_' || c == '-'; });
  return plain;
}

}  // namespace penumbra::nori
