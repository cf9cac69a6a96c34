// Numbers of things, in words.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace penumbra {

/// "1 sample", "2 samples".
template <typename Integer>
std::string counted(Integer count, std::string_view thing) {
  return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

}  // namespace penumbra
