// Reads spectra that are plugins: <spectrum type="blackbody">, <blackbody>, ….
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "scenes/mitsuba/object_tree.h"
#include "scenes/mitsuba/plugin.h"

namespace penumbra::mitsuba {

/// Converts <spectrum type="…"> or <blackbody> to linear Rec. 709, according to `role`. Nothing after an
/// error (with `lenient` after a warning, if only the type is unknown).
std::optional<glm::vec3> read_spectrum_plugin(const Context& context, const Object& object, ColourRole role);

/// Converts a tabulated spectrum. Errors name the invalid value: "the value 2 at 500 nm is not between 0 and
/// 1".
Expected<glm::vec3> table_to_rgb(std::span<const SpectrumSample> samples, ColourRole role);

}  // namespace penumbra::mitsuba
