// Protects the TOML parser, which recurses as deep as the text nests, from deep keys.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace penumbra {

/// The largest number of parts of a dotted key. Each part is a table inside the one before it.
constexpr int kMaxKeyParts = 8;

/// The offset of the first dotted key, of a value or a table, with more than kMaxKeyParts parts. Malformed
/// text is scanned up to the error.
std::optional<std::size_t> find_deep_key(std::string_view text);

}  // namespace penumbra
