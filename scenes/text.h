// Text of files as it may be shown: on a terminal, in a report.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace penumbra {

/// Well-formed UTF-8 in which every character takes a column or is a tab: control characters as their
/// pictures (U+2400 …), and what is no UTF-8, or would change the order or the place of what is beside it, as
/// U+FFFD. A terminal obeys nothing of it.
std::string visible(std::string_view text);

/// The text, or its beginning of about `bytes` bytes and how long it is.
std::string shortened(std::string_view text, std::size_t bytes);

}  // namespace penumbra
