// Reads spectra: plugins (<spectrum type="blackbody">, <blackbody>, …) and text files.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "scenes/mitsuba/object_tree.h"
#include "scenes/mitsuba/plugin.h"
#include "scenes/spectrum.h"

namespace penumbra::mitsuba {

/// Converts <spectrum type="…"> or <blackbody> to linear Rec. 709, according to `role`. Nothing after an
/// error (with `lenient` after a warning, if only the type is unknown).
std::optional<glm::vec3> read_spectrum_plugin(const Context& context, const Object& object, ColourRole role);

/// Converts a tabulated spectrum. Errors name the invalid value: "the value 2 at 500 nm is not between 0 and
/// 1".
Expected<glm::vec3> table_to_rgb(std::span<const SpectrumSample> samples, ColourRole role);

constexpr std::uint64_t kMaxSpectrumFileBytes = std::uint64_t{1} << 20;

/// Reads two numbers per line: a wavelength in nm and a value. Wavelengths must ascend. `#` begins a comment.
/// Errors, with line and column: anything else, fewer than two lines.
Expected<std::vector<SpectrumSample>> read_spectrum_file(const SourceFile& file);

}  // namespace penumbra::mitsuba
