// The value elements of Mitsuba XML: <float>, <rgb>, <transform>, …
#pragma once

#include <functional>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>

#include "scenes/diagnostic.h"
#include "scenes/mitsuba/object_tree.h"

namespace penumbra::mitsuba {

/// An element of a file, with its attributes filled in and their use checked.
class ElementReader {
 public:
  /// Fills in `$variables` of a text; reports what is wrong at the place and returns nothing.
  using Substitute = std::function<std::optional<std::string>(std::string_view, SourceLocation)>;

  ElementReader(const SourceFile& file, const pugi::xml_node& element, const Substitute& substitute,
                Diagnostics& diagnostics)
      : file_(file), element_(element), substitute_(substitute), diagnostics_(diagnostics) {}

  /// The attribute, if it is there.
  std::optional<std::string> attribute(std::string_view name) const;
  /// The attribute; an error if it is not there.
  std::optional<std::string> required(std::string_view name) const;
  /// Reports every attribute that is not one of `known`, and one that is there twice.
  bool check_attributes(std::initializer_list<std::string_view> known) const;

  /// Reports at the element; returns nothing, for `return wrong(...)`.
  std::nullopt_t wrong(std::string_view message) const;
  std::nullopt_t wrong_value(std::string_view attribute, std::string_view message) const;

  [[nodiscard]] SourceLocation location() const;
  [[nodiscard]] SourceLocation value_location(std::string_view attribute) const;
  [[nodiscard]] const pugi::xml_node& element() const { return element_; }
  [[nodiscard]] ElementReader child(const pugi::xml_node& element) const {
    return {file_, element, substitute_, diagnostics_};
  }

 private:
  const SourceFile& file_;
  pugi::xml_node element_;
  const Substitute& substitute_;
  Diagnostics& diagnostics_;
};

/// Whether elements of this name are values. A <spectrum> with a type is a plugin, and none.
bool is_value(const pugi::xml_node& element);

/// The names that `is_value` knows.
const std::vector<std::string>& value_tags();

/// Reads one; what is wrong is reported, and nothing returned.
std::optional<Parameter> read_value(const ElementReader& element);

/// Reads the <transform time="…"> of an <animation>.
std::optional<AnimationValue> read_animation(const ElementReader& element);

/// Reads the steps of a <transform>, each applied after those before it.
std::optional<glm::dmat4> read_transform(const ElementReader& element);

}  // namespace penumbra::mitsuba
