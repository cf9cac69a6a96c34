// Words and characters of messages.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace penumbra {

/// "1 sample", "2 samples".
template <typename Integer>
std::string counted(Integer count, std::string_view thing) {
  return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

/// Bytes of the well-formed UTF-8 (RFC 3629) character at `at`, which is inside the text; 0 where there is
/// none.
std::size_t character_length(std::string_view text, std::size_t at);

/// The candidate with the fewest edits (insertions, deletions, replacements, swaps of neighbours; case
/// ignored) to `name`, if it is near enough to be a likely misspelling.
std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string> candidates);

/// "; did you mean 'x'?" or nothing.
std::string suggestion(std::string_view name, std::span<const std::string> candidates);

}  // namespace penumbra
