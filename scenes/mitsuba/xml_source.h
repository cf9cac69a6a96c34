// Parses one XML file and finds the source location of its elements and attributes.
#pragma once

#include <pugixml.hpp>
#include <string_view>

#include "kernels/host/error.h"
#include "scenes/diagnostic.h"

namespace penumbra::mitsuba {

/// Parses UTF-8 text. Errors, with their location: other encodings, text that is not well-formed, a document
/// type with entities (which could expand without bound), elements nested too deep, text between elements.
Expected<void> parse_xml(const SourceFile& file, pugi::xml_document& document);

/// The location of the element's name.
SourceLocation locate(const SourceFile& file, const pugi::xml_node& element);

/// The location of the attribute's value in the source text, or of the element if it has no such attribute.
SourceLocation locate_value(const SourceFile& file, const pugi::xml_node& element,
                            std::string_view attribute);

/// The location of the attribute's name.
SourceLocation locate_attribute(const SourceFile& file, const pugi::xml_node& element,
                                std::string_view attribute);

}  // namespace penumbra::mitsuba
