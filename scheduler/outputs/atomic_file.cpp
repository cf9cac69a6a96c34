#include "scheduler/outputs/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>

namespace penumbra {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// A name beside `path` that no other process or thread uses.
fs::path aside_name(const fs::path& path) {
  static std::atomic<unsigned> counter{0};
  return folder_of(path) / fmt::format(".{}.{}-{}.part", path.filename().string(), getpid(), counter++);
}

/// An open file that is removed again unless it has been renamed into place.
class AsideFile {
 public:
  explicit AsideFile(const fs::path& target) : name_(aside_name(target)) {
    descriptor_ = open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  }
  AsideFile(const AsideFile&) = delete;
  AsideFile& operator=(const AsideFile&) = delete;
  ~AsideFile() {
    const bool created = created_or_open();
    close_descriptor();
    if (created && !renamed_) unlink(name_.c_str());
  }

  [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }

  /// All four return false with errno set.
  bool write_all(std::span<const std::uint8_t> bytes) {
    while (!bytes.empty()) {
      const ssize_t written = write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) return false;
      bytes = bytes.subspan(std::size_t(written));
    }
    return true;
  }
  bool flush() { return fsync(descriptor_) == 0 || errno == EINVAL || errno == EROFS; }
  bool close_descriptor() {
    if (descriptor_ < 0) return true;
    created_ = true;
    const int result = close(descriptor_);
    descriptor_ = -1;
    return result == 0;
  }
  bool rename_to(const fs::path& target) {
    renamed_ = rename(name_.c_str(), target.c_str()) == 0;
    return renamed_;
  }

 private:
  [[nodiscard]] bool created_or_open() const { return created_ || descriptor_ >= 0; }

  fs::path name_;
  int descriptor_ = -1;
  bool created_ = false;
  bool renamed_ = false;
};

std::unexpected<Error> fail_with_errno(const fs::path& path, int error) {
  const fs::path folder = folder_of(path);
  std::error_code ignored;
  if (error == ENOENT && !fs::exists(folder, ignored)) {
    return fail(fmt::format("cannot write {}: the folder {} does not exist", path.string(), folder.string()));
  }
  if (error == ENOTDIR) {
    return fail(fmt::format("cannot write {}: {} is not a folder", path.string(), folder.string()));
  }
  return fail(fmt::format("cannot write {}: {}", path.string(), std::strerror(error)));
}

}  // namespace

Expected<void> write_file_atomically(const fs::path& path, std::span<const std::uint8_t> bytes) {
  AsideFile file(path);
  if (!file.is_open()) return fail_with_errno(path, errno);
  if (!file.write_all(bytes) || !file.flush() || !file.close_descriptor() || !file.rename_to(path)) {
    return fail_with_errno(path, errno);
  }
  return {};
}

Expected<void> check_writable(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    return fail(fmt::format("cannot write {}: it is a folder", path.string()));
  }
  const AsideFile probe(path);
  if (!probe.is_open()) return fail_with_errno(path, errno);
  return {};
}

}  // namespace penumbra
