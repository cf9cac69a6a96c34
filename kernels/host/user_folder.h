// Where programs of a user keep what is theirs.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string_view>

namespace penumbra {

/// What the variable says, as XDG_CACHE_HOME, where that is absolute (a relative one is to be ignored, XDG
/// Base Directory Specification); else that folder of the user's home; empty without a home.
inline std::filesystem::path user_folder(const char* variable, std::string_view within_home) {
  if (const char* folder = std::getenv(variable); folder != nullptr && *folder == '/') return folder;
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    return std::filesystem::path(home) / within_home;
  return {};
}

}  // namespace penumbra
