#include "scheduler/cli/sets/failure_reasons.h"

#include <fmt/format.h>

#include "kernels/host/text.h"

namespace penumbra {

bool FailureReasons::add(const std::string& render, const std::string& reason) {
  Renders& of_reason = renders_[reason];
  of_reason.last = render;
  if (++of_reason.count == 2) of_reason.second = render;
  if (of_reason.count > 1) return false;
  of_reason.first = render;
  reasons_.push_back(reason);
  return true;
}

std::vector<std::string> FailureReasons::repeated() const {
  std::vector<std::string> lines;
  for (const std::string& reason : reasons_) {
    const Renders& of_reason = renders_.at(reason);
    if (of_reason.count < 2) continue;
    const std::string which = of_reason.count == 2
                                  ? of_reason.second
                                  : fmt::format("from {} to {}", of_reason.second, of_reason.last);
    lines.push_back(fmt::format(
        "{} failed like {}, {}: {}",
        of_reason.count == 2 ? "1 more render" : fmt::format("{} more renders", of_reason.count - 1),
        of_reason.first, which, reason.substr(0, reason.find('\n'))));
  }
  return lines;
}

}  // namespace penumbra
