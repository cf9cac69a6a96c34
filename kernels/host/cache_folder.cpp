#include "kernels/host/cache_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <tuple>
#include <vector>

#include "kernels/host/plain_file.h"
#include "kernels/host/process.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kAside = "-aside";
// A temporary file older than this belongs to a process that died before renaming it.
constexpr auto kTimeToBeRenamed = std::chrono::hours(1);

std::string error_text(const fs::path& path) {
  return fmt::format("cannot write {}: {}", path.string(), std::strerror(errno));
}

bool is_writable_by_others(mode_t mode) { return (mode & (S_IWGRP | S_IWOTH)) != 0; }

}  // namespace

CacheFile::CacheFile(const fs::path& path, int flags)
    : descriptor_(open(path.c_str(), flags | O_CLOEXEC, 0600)) {}

bool CacheFile::close() { return descriptor_ < 0 || ::close(std::exchange(descriptor_, -1)) == 0; }

Expected<std::uint64_t> CacheFile::size() const {
  struct stat status {};
  if (fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) return fail("is no file");
  return std::uint64_t(status.st_size);
}

bool CacheFile::is_own() const {
  struct stat status {};
  return fstat(descriptor_, &status) == 0 && status.st_uid == geteuid() &&
         !is_writable_by_others(status.st_mode);
}

std::size_t CacheFile::read(void* to, std::size_t bytes) {
  std::size_t got = 0;
  while (got < bytes) {
    const ssize_t n = ::read(descriptor_, static_cast<char*>(to) + got, bytes - got);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    got += std::size_t(n);
  }
  return got;
}

bool CacheFile::write(const void* from, std::size_t bytes) {
  return write_whole(descriptor_, {static_cast<const std::uint8_t*>(from), bytes});
}

void CacheFile::touch() { futimens(descriptor_, nullptr); }

fs::path CacheFolder::file_of(std::string_view name) const { return folder_ / (std::string(name) + suffix_); }

Expected<void> CacheFolder::write(std::string_view name,
                                  std::span<const std::span<const std::uint8_t>> parts) const {
  if (!enabled()) return {};
  std::error_code error;
  if (fs::create_directories(folder_, error)) fs::permissions(folder_, fs::perms::owner_all, error);
  if (error) return fail(fmt::format("cannot make the folder {}: {}", folder_.string(), error.message()));
  static std::atomic<unsigned> count{0};
  const fs::path path = file_of(name),
                 aside = folder_ / fmt::format(".{}.{}.{}{}{}", name, getpid(), count++, suffix_, kAside);
  CacheFile file(aside, O_WRONLY | O_CREAT | O_EXCL);
  if (!file.is_open()) return fail(error_text(aside));
  // No fsync: the checksum detects what a crash of the machine leaves half written.
  const bool is_written =
      std::ranges::all_of(parts, [&](const auto& part) { return file.write(part.data(), part.size()); });
  if (!is_written || !file.close() || rename(aside.c_str(), path.c_str()) != 0) {
    auto failed = fail(error_text(path));
    unlink(aside.c_str());
    return failed;
  }
  return {};
}

void CacheFolder::remove(std::string_view name) const {
  if (!enabled()) return;
  std::error_code error;
  fs::remove(file_of(name), error);
}

void CacheFolder::remove_oldest(std::uint64_t room) const {
  if (!enabled()) return;
  const std::uint64_t most_bytes = limits_.most_bytes - std::min(room, limits_.most_bytes);
  using Entry = std::tuple<fs::file_time_type, fs::path, std::uint64_t>;
  std::vector<Entry> files;
  std::uint64_t bytes = 0;
  std::error_code error;
  const auto now = fs::file_time_type::clock::now();
  for (fs::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    const bool is_aside = name.ends_with(suffix_ + std::string(kAside));
    if (!is_aside && !name.ends_with(suffix_)) continue;
    std::error_code gone;  // removed by another process
    const auto time = at->last_write_time(gone);
    const std::uint64_t size = gone ? 0 : at->file_size(gone);
    if (gone) continue;
    if (!is_aside) {
      files.emplace_back(time, at->path(), size);
      bytes += size;
    } else if (now - time > kTimeToBeRenamed) {
      fs::remove(at->path(), gone);
    }
  }
  if (files.size() <= limits_.most_files && bytes <= most_bytes) return;
  std::ranges::sort(files);
  std::size_t left = files.size();
  for (const auto& [time, path, size] : files) {
    if (left <= limits_.most_files && bytes <= most_bytes) break;
    fs::remove(path, error);
    --left;
    bytes -= size;
  }
}

Expected<void> check_cache_folder(const fs::path& folder) {
  struct stat status {};
  if (folder.empty() || stat(folder.c_str(), &status) != 0) return {};
  const char* why = status.st_uid != geteuid()              ? "another user owns it"
                    : is_writable_by_others(status.st_mode) ? "others may write to it (chmod go-w)"
                                                            : nullptr;
  if (why == nullptr) return {};
  return fail(fmt::format("the cache {} is not used: {}", folder.string(), why));
}

fs::path cache_folder(const char* variable, std::string_view name) {
  if (const char* wanted = std::getenv(variable); wanted && *wanted)
    return std::string_view(wanted) == "off" ? fs::path() : fs::path(wanted);
  const fs::path folder = user_folder("XDG_CACHE_HOME", ".cache");
  return folder.empty() ? folder : folder / "penumbra" / name;
}

}  // namespace penumbra
