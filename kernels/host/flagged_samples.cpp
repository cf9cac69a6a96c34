#include "kernels/host/flagged_samples.h"

#include <tuple>

namespace penumbra {

std::string_view source_name(int source) {
  switch (source) {
    case SOURCE_CAMERA:
      return "camera ray";
    case SOURCE_EMISSION:
      return "emission that the path found";
    case SOURCE_LIGHT:
      return "light sample";
    case SOURCE_DIRECTION:
      return "direction sample";
    case SOURCE_CLOSED_FORM:
      return "closed form of polygon lights";
    case SOURCE_CONTROL:
      return "control variate";
    case SOURCE_FILTER:
      return "film filter, or a layer";
    default:
      return "unknown source";
  }
}

void FlaggedSamples::add(const FlaggedSamples& others) {
  if (others.count == 0) return;
  const std::uint64_t all = count + others.count;
  if (count == 0 || std::tie(others.y, others.x, others.sample) < std::tie(y, x, sample)) *this = others;
  count = all;
}

bool is_possible(const FlaggedSamples& samples) {
  const int where = samples.source.where;
  return where >= SOURCE_UNKNOWN && where <= SOURCE_FILTER && samples.source.step >= 0 && samples.shape >= 0;
}

FlaggedSamples flagged_samples(const Unit& unit, const BadSamples& bad) {
  if (bad.count == 0) return {};
  return {.count = bad.count,
          .x = unit.x + int(bad.pixel) % unit.width,
          .y = unit.y + int(bad.pixel) / unit.width,
          .sample = unit.first_sample + bad.sample,
          .source = {},
          .shape = int(bad.shape)};
}

void add(FlaggedByKind& to, const FlaggedByKind& others) {
  for (std::size_t kind = 0; kind < to.size(); ++kind) to[kind].add(others[kind]);
}

std::uint64_t non_finite_count(const FlaggedByKind& flagged) {
  return flagged[BAD_NAN].count + flagged[BAD_INFINITE].count;
}

}  // namespace penumbra
