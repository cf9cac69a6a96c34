#include "scenes/names.h"

#include <fmt/format.h>

namespace penumbra {
namespace {

bool is_upper(char c) { return c >= 'A' && c <= 'Z'; }

}  // namespace

std::string to_snake_case(std::string_view name) {
  std::string result;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool starts_word =
        i > 0 && is_upper(name[i]) && !is_upper(name[i - 1]) && name[i - 1] != '_' && name[i - 1] != '.';
    if (starts_word) result += '_';
    result += is_upper(name[i]) ? static_cast<char>(name[i] - 'A' + 'a') : name[i];
  }
  return result;
}

Expected<void> check_name_length(std::string_view kind, std::string_view name) {
  if (name.size() <= kMaxNameBytes) return {};
  return fail(
      fmt::format("this {} has {} bytes; the most that are read are {}", kind, name.size(), kMaxNameBytes));
}

}  // namespace penumbra
