// The one error style of the project: a value with a text for people, carried by std::expected.
#pragma once

#include <expected>
#include <string>
#include <utility>

namespace penumbra {

/// What went wrong, where, and what would be right, as one message for the user (it may hold several lines:
/// an error in a scene file carries the source line and a caret). No trailing newline, no "error:" prefix
/// unless a file position precedes it.
struct Error {
  std::string message;
};

template <typename T>
using Expected = std::expected<T, Error>;

inline std::unexpected<Error> fail(std::string message) { return std::unexpected(Error{std::move(message)}); }

}  // namespace penumbra
