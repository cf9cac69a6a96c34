// Changing the parameters and nested objects of what a Nori file holds, until Mitsuba's reader understands
// them.
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

/// What the translators of objects share.
struct Translation {
  mitsuba::ObjectTree& tree;
  ReaderReport& report;
  Dialect dialect;

  [[nodiscard]] mitsuba::Object& new_object(const char* tag, const char* type, SourceLocation location) const;
};

void add_child(mitsuba::Object& parent, mitsuba::Object& object, std::string name = "");

mitsuba::Parameter* find(mitsuba::Object& object, std::string_view name);
/// The first of these that is given.
mitsuba::Parameter* find_any(mitsuba::Object& object, std::initializer_list<std::string_view> names);
mitsuba::Child* find_child(mitsuba::Object& object, std::string_view tag);
/// The first nested object of that kind whose name is one of these.
mitsuba::Child* find_child(mitsuba::Object& object, std::string_view tag,
                           std::initializer_list<std::string_view> names);

/// Parameters and textures that have one of the names `from` are called `to`, unless something is already; a
/// texture counts before a parameter.
void rename(mitsuba::Object& object, std::initializer_list<std::string_view> from, const char* to);
void set(mitsuba::Object& object, const char* name, mitsuba::Value value);
/// Sets what is not given.
void set_default(mitsuba::Object& object, const char* name, mitsuba::Value value);
std::optional<mitsuba::Parameter> take(mitsuba::Object& object, std::string_view name);
std::optional<mitsuba::Parameter> take_any(mitsuba::Object& object,
                                           std::initializer_list<std::string_view> names);
std::optional<mitsuba::Child> take_child(mitsuba::Object& object, std::string_view tag,
                                         std::initializer_list<std::string_view> names);

/// Of a number, whole or not.
std::optional<double> number_of(const mitsuba::Parameter& parameter);
/// Of a colour, a number, or three numbers.
std::optional<glm::vec3> colour_of(const mitsuba::Parameter& parameter);
std::optional<glm::dvec3> vector_of(const mitsuba::Parameter& parameter);

/// For comparing names of plugins, which forks spell differently: in lower case, without - and _.
std::string plain_name(std::string_view name);

}  // namespace penumbra::nori
