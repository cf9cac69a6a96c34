#include "scheduler/sets/failure_reasons.h"

#include <fmt/format.h>

namespace penumbra {

bool FailureReasons::add(const std::string& render, const std::string& scene, const std::string& reason) {
  std::string same = reason;
  for (std::size_t at = 0; !scene.empty() && (at = same.find(scene, at)) != std::string::npos;)
    same.erase(at, scene.size());
  Renders& of_reason = renders_[same];
  of_reason.last = render;
  if (++of_reason.count == 2) of_reason.second = render;
  if (of_reason.count > 1) return false;
  of_reason.first = render;
  of_reason.reason = reason;
  reasons_.push_back(same);
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
        of_reason.first, which, of_reason.reason.substr(0, of_reason.reason.find('\n'))));
  }
  return lines;
}

}  // namespace penumbra
