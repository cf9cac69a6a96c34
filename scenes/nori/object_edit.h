// Helpers that rename and change the parameters and nested objects of a Nori file until Mitsuba's reader
// understands them.
#pragma once

#include <glm/glm.hpp>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "scenes/mitsuba/object_tree.h"
#include "scenes/nori/dialect.h"
#include "scenes/reader_report.h"

namespace penumbra::nori {

/// What the functions that translate objects share.
struct Translation {
  mitsuba::ObjectTree& tree;
  ReaderReport& report;
  Dialect dialect;

  [[nodiscard]] mitsuba::Object& new_object(const char* tag, const char* type,
                                            SourceLocation location) const {
    return tree.new_object(tag, type, location);
  }
};

void add_child(mitsuba::Object& parent, mitsuba::Object& object, std::string name = "");

mitsuba::Parameter* find(mitsuba::Object& object, std::string_view name);
/// The first of these parameters that is given; null if none is.
mitsuba::Parameter* find_any(mitsuba::Object& object, std::initializer_list<std::string_view> names);
mitsuba::Child* find_child(mitsuba::Object& object, std::string_view tag);
/// The first nested object of that kind that has one of these names; null if there is none.
mitsuba::Child* find_child(mitsuba::Object& object, std::string_view tag,
                           std::initializer_list<std::string_view> names);

/// Renames a parameter or texture with one of the names `from` to `to`, unless `to` already exists. A texture
/// takes precedence over a parameter.
void rename(mitsuba::Object& object, std::initializer_list<std::string_view> from, const char* to);
void set(mitsuba::Object& object, const char* name, mitsuba::Value value);
/// Sets a parameter that is not given.
void set_default(mitsuba::Object& object, const char* name, mitsuba::Value value);
std::optional<mitsuba::Parameter> take(mitsuba::Object& object, std::string_view name);
std::optional<mitsuba::Parameter> take_any(mitsuba::Object& object,
                                           std::initializer_list<std::string_view> names);
std::optional<mitsuba::Child> take_child(mitsuba::Object& object, std::string_view tag,
                                         std::initializer_list<std::string_view> names);

/// The value of an integer or a number; nothing for other types.
std::optional<double> number_of(const mitsuba::Parameter& parameter);
/// The value of a colour, a number, or three numbers; nothing for other types.
std::optional<glm::vec3> colour_of(const mitsuba::Parameter& parameter);
std::optional<glm::dvec3> vector_of(const mitsuba::Parameter& parameter);

/// The name in lower case, without - and _, for comparing names of plugins, which forks spell differently.
std::string plain_name(std::string_view name);

}  // namespace penumbra::nori
