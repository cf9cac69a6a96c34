#include "scenes/mitsuba/spectrum_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/number.h"

namespace penumbra::mitsuba {

Expected<std::vector<SpectrumSample>> read_spectrum_file(const SourceFile& file) {
  std::vector<SpectrumSample> samples;
  const std::string_view text = file.text;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view whole = text.substr(at, end - at);
    const std::string_view line = trim(whole.substr(0, whole.find('#')));
    const auto wrong = [&](const std::string& message) {
      return fail(format_diagnostic({&file, std::size_t(line.data() - text.data())}, "error", message));
    };
    at = end + 1;
    if (line.empty()) continue;
    const Expected<std::vector<double>> numbers = parse_numbers(line);
    if (!numbers) return wrong(numbers.error().message);
    if (numbers->size() != 2)
      return wrong(fmt::format("a line has a wavelength and a value, not {} numbers", numbers->size()));
    const SpectrumSample sample{(*numbers)[0], (*numbers)[1]};
    if (!samples.empty() && !(sample.wavelength > samples.back().wavelength))
      return wrong(fmt::format("the wavelengths of a spectrum must ascend; {} follows {}", sample.wavelength,
                               samples.back().wavelength));
    samples.push_back(sample);
  }
  if (samples.size() < 2)
    return fail(format_diagnostic({&file, 0}, "error", "a spectrum's file has at least two wavelengths"));
  return samples;
}

}  // namespace penumbra::mitsuba
