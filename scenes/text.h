// Text from files, made safe to show on a terminal or in a report.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace penumbra {

/// Well-formed UTF-8 in which every character is a tab or takes one column. Control characters become their
/// pictures (U+2400 …). Invalid UTF-8, and characters that would reorder or move their neighbours, become
/// U+FFFD. So the text cannot control a terminal.
std::string visible(std::string_view text);

/// The text, or if it is longer than about `bytes` bytes, its beginning and a note of its length.
std::string shortened(std::string_view text, std::size_t bytes);

}  // namespace penumbra
