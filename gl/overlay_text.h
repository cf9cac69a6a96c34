// Texts of the panel for numbers and states.
#pragma once

#include <string>
#include <string_view>

#include "gl/view_model.h"

namespace penumbra {

/// "35 ms", "1.7 s", "48 s", "1 min 05 s", "3 h 05 min", "2 d 4 h"; "unknown" for negative or non-finite
/// numbers.
std::string duration_text(double seconds);

/// With three digits and k, M or G: "950", "12.3 M"; "unknown" likewise.
std::string count_text(double count);

/// A fraction as "12 %", "1.2 %", "0.012 %"; "unknown" likewise.
std::string percent_text(double fraction);

/// "connected", "connection lost, reconnecting", …
std::string connection_text(const ViewStatus& status);

/// The label of a key: "+" for "plus", "page up" for "page_up".
std::string key_text(std::string_view key);

enum class MessageKind { kPlain, kWarning, kError };
/// The kind of a message by its first word, see ViewStatus::messages.
MessageKind message_kind(std::string_view message);

/// Why a part of the panel does not apply at the moment; empty if it does.
std::string why_no_closed_form(const ViewStatus& status);
std::string why_no_alpha(const ViewStatus& status);
std::string why_no_camera(const ViewStatus& status);
std::string why_no_reload(const ViewStatus& status);
std::string why_no_more_samples(const ViewStatus& status);
std::string why_no_copy(const ViewStatus& status);
std::string why_no_save(const ViewStatus& status);

}  // namespace penumbra
