// Nori's dialects: that of the course that it was written for, and that of ETH Zurich's.
#pragma once

#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>

#include "scenes/plugin_values.h"

namespace penumbra::nori {

/// They differ in plugins, and in the camera: +x of its space is to the left of the image in the first, as in
/// Mitsuba, and to the right in the second, which mirrors the image. Environment maps of the first have y up,
/// those of the second z.
enum class Dialect { kNori, kEth };

inline OneOf<Dialect> dialects() { return {{{"nori", Dialect::kNori}, {"nori-eth", Dialect::kEth}}}; }

struct DialectChoice {
  Dialect dialect = Dialect::kNori;
  std::string reason;  ///< for people: what tells it
};

/// By what only one of them has; where there is nothing of the kind it is the first.
DialectChoice dialect_of(const pugi::xml_node& root);

/// "nori-eth (it has a <mesh> of type 'sphere')".
std::string describe(const DialectChoice& choice);

}  // namespace penumbra::nori
