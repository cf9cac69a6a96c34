#include "scenes/names.h"

#include <fmt/format.h>

#include <algorithm>

namespace penumbra {
namespace {

bool is_upper(char c) { return c >= 'A' && c <= 'Z'; }
char to_lower(char c) { return is_upper(c) ? static_cast<char>(c - 'A' + 'a') : c; }

}  // namespace

std::string to_snake_case(std::string_view name) {
  std::string result;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool starts_word =
        i > 0 && is_upper(name[i]) && !is_upper(name[i - 1]) && name[i - 1] != '_' && name[i - 1] != '.';
    if (starts_word) result += '_';
    result += to_lower(name[i]);
  }
  return result;
}

std::string to_lower_case(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), to_lower);
  return result;
}

std::string extension_of(const std::filesystem::path& path) {
  return to_lower_case(path.extension().string());
}

bool is_place_name(std::string_view name) {
  if (name.ends_with(')')) name = name.substr(0, name.rfind(" ("));
  for (int number = 0; number < 2; ++number) {
    const std::size_t colon = name.rfind(':');
    if (colon == std::string_view::npos || colon + 1 == name.size() ||
        name.find_first_not_of("0123456789", colon + 1) != std::string_view::npos)
      return false;
    name = name.substr(0, colon);
  }
  return name.find(" at ") != std::string_view::npos;
}

Expected<void> check_name_length(std::string_view kind, std::string_view name) {
  if (name.size() <= kMaxNameBytes) return {};
  return fail(
      fmt::format("this {} has {} bytes; the most that are read are {}", kind, name.size(), kMaxNameBytes));
}

}  // namespace penumbra
