// Spectra that are plugins of their own: <spectrum type="blackbody">, <blackbody>, …
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "scenes/mitsuba/object_tree.h"
#include "scenes/mitsuba/plugin.h"

namespace penumbra::mitsuba {

/// The colour of <spectrum type="…"> or <blackbody> as what `role` says, in linear Rec. 709; where something
/// is wrong none, and an error (with `lenient` a warning, for a type that is not known).
std::optional<glm::vec3> read_spectrum_plugin(const Context& context, const Object& object, ColourRole role);

/// A table as a colour. An error names what is not allowed: "the value 2 at 500 nm is not between 0 and 1".
Expected<glm::vec3> table_to_rgb(std::span<const SpectrumSample> samples, ColourRole role);

}  // namespace penumbra::mitsuba
