// Texts in messages. Protobuf texts must be UTF-8, and peers reject messages with other bytes. File names and
// a compiler's log are arbitrary bytes of any length.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace penumbra {

constexpr std::size_t kLongestName = 256;       ///< of the name of a host, device or worker
constexpr std::size_t kLongestText = 16 << 10;  ///< of a message text, such as a compiler's log
constexpr int kMostWarnings = 32;               ///< per worker

/// Converts a text to UTF-8 of at most `longest` bytes. Invalid bytes become '?', and a cut end becomes
/// "...". Call it wherever a text is put into a message or stored from one.
std::string wire_text(std::string_view text, std::size_t longest);

}  // namespace penumbra
