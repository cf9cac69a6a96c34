#include "scheduler/cli/exit_code.h"

#include <fmt/format.h>

#include <cstdio>
#include <string_view>

namespace penumbra {
namespace {

/// Whether the first line reads `file:line:column: kind: …`.
bool names_its_place(std::string_view text, std::string_view kind) {
  const std::string_view first_line = text.substr(0, text.find('\n'));
  return first_line.find(fmt::format(": {}: ", kind)) != std::string_view::npos;
}

void print_message(std::string_view text, std::string_view kind) {
  if (names_its_place(text, kind)) {
    fmt::print(stderr, "{}\n", text);
  } else {
    fmt::print(stderr, "penumbra: {}: {}\n", kind, text);
  }
}

}  // namespace

void print_error(const Error& error) { print_message(error.message, "error"); }

void print_warning(std::string_view text) { print_message(text, "warning"); }

}  // namespace penumbra
