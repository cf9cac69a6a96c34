#include "scheduler/record/non_finite_text.h"

#include <fmt/format.h>

namespace penumbra {

std::string repeat_sample_command(const NonFiniteSamples& samples, const std::string& reproduce_command) {
  return fmt::format("{} --pixel {},{}", reproduce_command, samples.x, samples.y);
}

std::string non_finite_text(const NonFiniteSamples& samples, std::string_view kind,
                            const std::string& reproduce_command) {
  return fmt::format(
      "{} {} sample{} as black; the first is sample {} of pixel ({}, {}), in the {} of step {}; to repeat "
      "it: {}",
      samples.count, kind, samples.count == 1 ? " counts" : "s count", samples.sample, samples.x, samples.y,
      source_name(samples.source.where), samples.source.step,
      repeat_sample_command(samples, reproduce_command));
}

}  // namespace penumbra
