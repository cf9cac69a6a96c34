// Reads the value elements of Mitsuba XML: <float>, <rgb>, <transform>, ….
#pragma once

#include <functional>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>

#include "scenes/diagnostic.h"
#include "scenes/mitsuba/object_tree.h"

namespace penumbra::mitsuba {

/// An element of a file. Its attributes have $variables substituted, and unknown attributes can be detected.
class ElementReader {
 public:
  /// Substitutes `$variables` in a text. On failure it reports an error at the location and returns nothing.
  using Substitute = std::function<std::optional<std::string>(std::string_view, SourceLocation)>;

  ElementReader(const SourceFile& file, const pugi::xml_node& element, const Substitute& substitute,
                Diagnostics& diagnostics)
      : file_(file), element_(element), substitute_(substitute), diagnostics_(diagnostics) {}

  /// The attribute, or nothing if it is missing.
  std::optional<std::string> attribute(std::string_view name) const;
  /// The attribute; it is an error if it is missing.
  std::optional<std::string> required(std::string_view name) const;
  /// Reports every attribute that is not in `known` or that occurs twice.
  bool check_attributes(std::initializer_list<std::string_view> known) const;

  /// Reports an error at the element. Returns nothing, for `return wrong(...)`.
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

/// Whether an element of this name is a value. A <spectrum> with a type is a plugin, not a value.
bool is_value(const pugi::xml_node& element);

/// The names that `is_value` knows.
const std::vector<std::string>& value_tags();

/// Reads one value. Returns nothing after a reported error.
std::optional<Parameter> read_value(const ElementReader& element);

/// Reads the <transform time="…">, or the <string time="…" value="…">, of an <animation>.
std::optional<Value> read_animation(const ElementReader& element);

/// Reads the steps of a <transform>, each applied after those before it.
std::optional<glm::dmat4> read_transform(const ElementReader& element);

}  // namespace penumbra::mitsuba
