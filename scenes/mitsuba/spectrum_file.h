// Reads spectra from text files.
#pragma once

#include <vector>

#include "kernels/host/error.h"
#include "scenes/diagnostic.h"
#include "scenes/spectrum.h"

namespace penumbra::mitsuba {

constexpr std::uint64_t kMaxSpectrumFileBytes = std::uint64_t{1} << 20;

/// Reads two numbers per line: a wavelength in nm and a value. Wavelengths must ascend. `#` begins a comment.
/// Errors, with line and column: anything else, fewer than two lines.
Expected<std::vector<SpectrumSample>> read_spectrum_file(const SourceFile& file);

}  // namespace penumbra::mitsuba
