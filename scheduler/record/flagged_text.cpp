#include "scheduler/record/flagged_text.h"

#include <fmt/format.h>

#include "kernels/host/text.h"

namespace penumbra {

std::string repeat_sample_command(const FlaggedSamples& samples, const std::string& reproduce_command) {
  return fmt::format("{} --pixel {},{}", reproduce_command, samples.x, samples.y);
}

std::string_view flagged_name(int kind) {
  constexpr std::string_view kNames[BAD_KINDS] = {"nan", "infinite", "contradictory_boundary"};
  return kNames[kind];
}

std::string flagged_text(int kind, const FlaggedSamples& samples, std::string_view shape,
                         const std::string& reproduce_command) {
  const std::string place =
      fmt::format("the first is sample {} of pixel ({}, {})", samples.sample, samples.x, samples.y);
  const std::string repeat = "to repeat it: " + repeat_sample_command(samples, reproduce_command);
  if (kind == BAD_BOUNDARY) {
    return fmt::format(
        "the paths of {} crossed boundaries of media that contradict each other, and may be wrong; {}, at "
        "shape '{}'. Media that overlap in part, a boundary that is not closed, another medium outside than "
        "is named there, or a camera that does not name its medium are such; {}",
        counted(samples.count, "sample"), place, shape, repeat);
  }
  return fmt::format("{} {} sample{} as black; {}, in the {} of step {}; {}", samples.count,
                     kind == BAD_NAN ? "NaN" : "infinite", samples.count == 1 ? " counts" : "s count", place,
                     source_name(samples.source.where), samples.source.step, repeat);
}

}  // namespace penumbra
