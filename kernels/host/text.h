// Helpers for the text of messages.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
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

/// A size in powers of 1000: "512 B", "1.2 MB".
std::string size_text(double bytes);

/// The hash as 16 hexadecimal digits.
std::string hash_text(std::uint64_t hash);

/// Number of bytes of the well-formed UTF-8 character (RFC 3629) at `at`, which must be inside of the text; 0
/// if there is none.
std::size_t character_length(std::string_view text, std::size_t at);

/// The candidate with the smallest edit distance to `name` (insertions, deletions, replacements, swaps of
/// neighbours; case ignored), if it is small enough for a likely misspelling.
std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string> candidates);

/// "; did you mean 'x'?", or empty.
std::string suggestion(std::string_view name, std::span<const std::string> candidates);

}  // namespace penumbra
