// Numbers in text. They are read the same way in every locale. The whole token must be a number, and it must
// be finite.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

/// A finite number, "1", "-.5", "+3e-008". Numbers too small for a double are 0.
/// Errors: anything else in the text, overflow, nan, inf.
Expected<double> parse_number(std::string_view text);

/// A decimal integer in [low, high].
Expected<std::int64_t> parse_integer(std::string_view text, std::int64_t low = INT64_MIN,
                                     std::int64_t high = INT64_MAX);

/// "true" or "false" in any case.
Expected<bool> parse_boolean(std::string_view text);

/// Numbers separated by white space, a comma, or both.
Expected<std::vector<double>> parse_numbers(std::string_view text);

/// Splits at white space, a comma, or both. Errors: two commas in a row, a comma at either end.
Expected<std::vector<std::string_view>> split_list(std::string_view text);

/// Without white space at either end.
std::string_view trim(std::string_view text);

}  // namespace penumbra
