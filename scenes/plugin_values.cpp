#include "scenes/plugin_values.h"

#include <fmt/format.h>

namespace penumbra {

std::string ColourWithin::values() const {
  if (high == kAnyNumber) return fmt::format("colour, {} or more", low);
  return fmt::format("colour in [{}, {}]", low, high);
}

std::string NumberWithin::values() const {
  if (high == kAnyNumber)
    return end == LowEnd::kOpen ? fmt::format("number above {}", low)
                                : fmt::format("number, {} or more", low);
  return fmt::format("number in {}{}, {}]", end == LowEnd::kOpen ? '(' : '[', low, high);
}

}  // namespace penumbra
