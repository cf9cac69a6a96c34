#include "scenes/statement_scanner.h"

#include <fmt/format.h>

#include "scenes/number.h"

namespace penumbra {

Expected<int> StatementScanner::numbers(std::string_view statement, int least, int most,
                                        std::span<double> values) {
  int count = 0;
  for (std::string_view text = token(); !text.empty(); text = token()) {
    if (count == most) return wrong(fmt::format("'{}' takes at most {} numbers", statement, most));
    const auto value = parse_number(text);
    if (!value) return wrong(value.error().message);
    values[std::size_t(count++)] = *value;
  }
  if (count < least)
    return wrong(fmt::format("'{}' takes at least {} numbers, not {}", statement, least, count));
  return count;
}

}  // namespace penumbra
