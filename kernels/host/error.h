// The error type of the project: a message for users, returned by std::expected.
#pragma once

#include <expected>
#include <string>
#include <utility>

namespace penumbra {

/// What went wrong, where, and what would be right, as one message for the user. It may have several lines:
/// an error in a scene file includes the source line and a caret. No trailing newline, and no "error:" prefix
/// unless a file position precedes it.
struct Error {
  std::string message;
};

template <typename T>
using Expected = std::expected<T, Error>;

inline std::unexpected<Error> fail(std::string message) { return std::unexpected(Error{std::move(message)}); }

}  // namespace penumbra
