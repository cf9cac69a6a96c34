// By which a file that has changed is told from what it was.
#pragma once

#include <cstdint>
#include <filesystem>

namespace penumbra {

struct FileStamp {
  std::filesystem::file_time_type time{};
  std::uintmax_t size = 0;
  bool operator==(const FileStamp&) const = default;
};

/// Of a file that is not there, the same stamp always.
inline FileStamp stamp_of(const std::filesystem::path& file) {
  std::error_code gone;
  const FileStamp stamp{std::filesystem::last_write_time(file, gone), std::filesystem::file_size(file, gone)};
  return gone ? FileStamp{} : stamp;
}

}  // namespace penumbra
