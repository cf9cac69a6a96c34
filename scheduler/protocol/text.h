// Texts in messages. Protobuf's texts are UTF-8, and a peer rejects messages with other bytes; file names and
// a compiler's log are arbitrary bytes of any length.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace penumbra {

constexpr std::size_t kLongestName = 256;       ///< of a host, a device, a worker
constexpr std::size_t kLongestText = 16 << 10;  ///< of a message text, such as a compiler's log
constexpr int kMostWarnings = 32;               ///< of one worker

/// The text as UTF-8 of at most so many bytes: what is not valid becomes '?', what is too much "...". Called
/// wherever a text is put into a message, and wherever one from elsewhere is kept.
std::string wire_text(std::string_view text, std::size_t longest);

}  // namespace penumbra
