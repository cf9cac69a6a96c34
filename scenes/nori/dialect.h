// Nori's dialects: that of its original course, and that of the course at ETH Zurich.
#pragma once

#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>

#include "scenes/plugin_values.h"

namespace penumbra::nori {

/// The dialects differ in plugins and in the camera. In the original, camera space has +x to the left of the
/// image, as in Mitsuba. In ETH's it has +x to the right, which mirrors the image. Environment maps have y up
/// in the original and z up in ETH's.
enum class Dialect { kNori, kEth };

inline OneOf<Dialect> dialects() { return {{{"nori", Dialect::kNori}, {"nori-eth", Dialect::kEth}}}; }

struct DialectChoice {
  Dialect dialect = Dialect::kNori;
  std::string reason;  ///< for users: the feature that determined it
};

/// Determines the dialect from features that only one of them has. Without any such feature it is the
/// original.
DialectChoice dialect_of(const pugi::xml_node& root);

/// "nori-eth (it has a <mesh> of type 'sphere')".
std::string describe(const DialectChoice& choice);

}  // namespace penumbra::nori
