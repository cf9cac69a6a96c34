// One XML file: parsed, checked, and with a position in the text for every element and attribute.
#pragma once

#include <pugixml.hpp>
#include <string_view>

#include "kernels/host/error.h"
#include "scenes/diagnostic.h"

namespace penumbra::mitsuba {

/// Parses UTF-8 text. Errors, with position: other text, not well-formed, a document type with entities (they
/// could expand without bound), elements nested too deep, text between elements.
Expected<void> parse_xml(const SourceFile& file, pugi::xml_document& document);

/// Of the element's name.
SourceLocation locate(const SourceFile& file, const pugi::xml_node& element);

/// Of the attribute's value, in the text as written; the element if it has none of that name.
SourceLocation locate_value(const SourceFile& file, const pugi::xml_node& element,
                            std::string_view attribute);

/// Of the attribute's name.
SourceLocation locate_attribute(const SourceFile& file, const pugi::xml_node& element,
                                std::string_view attribute);

}  // namespace penumbra::mitsuba
