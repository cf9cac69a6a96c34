// Where the characters of a text end that may be any bytes.
#pragma once

#include <cstddef>
#include <string_view>

namespace penumbra {

/// Bytes of the well-formed UTF-8 (RFC 3629) character at `at`, which is inside the text; 0 where there is
/// none.
std::size_t character_length(std::string_view text, std::size_t at);

}  // namespace penumbra
