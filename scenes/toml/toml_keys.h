// What a TOML parser that nests as deep as its text says cannot be given.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace penumbra {

/// Parts that a dotted key may have. Each is a table inside the one before it.
constexpr int kMaxKeyParts = 8;

/// Where the first dotted key, of a value or a table, with more parts than that begins. Text that is no TOML
/// is told apart up to where it ceases to be.
std::optional<std::size_t> find_deep_key(std::string_view text);

}  // namespace penumbra
