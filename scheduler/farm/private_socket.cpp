#include "scheduler/farm/private_socket.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>

#include "scheduler/farm/unix_socket.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "penumbra-";
constexpr std::string_view kSocketName = "socket";
constexpr std::size_t kLongestSocketPath = sizeof(sockaddr_un::sun_path) - 1;  // 107
constexpr std::string_view kRandom = "XXXXXX";                                 // of mkdtemp
// A directory looks abandoned between its creation and its locking, so only older ones are removed.
constexpr std::chrono::minutes kAbandonedAge{1};

/// Locks a directory until this process ends. Returns -1 if another process holds the lock.
int lock_directory(const fs::path& directory) {
  const int descriptor = open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) return -1;
  if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
  close(descriptor);
  return -1;
}

/// Whether `create` of this user may have made it.
bool is_mine(const fs::path& path) {
  const std::string name = path.filename();
  struct stat status {};
  return name.starts_with(kPrefix) && name.size() == kPrefix.size() + kRandom.size() &&
         lstat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode) && status.st_uid == geteuid();
}

/// An empty directory is abandoned too: its process may have died before it listened.
bool holds_nothing_in_use(const fs::path& directory) {
  std::error_code error;
  return fs::is_empty(directory, error) || probe_unix_socket(directory / kSocketName) == ECONNREFUSED;
}

void remove_abandoned(const fs::path& parent) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(parent, error)) {
    if (!is_mine(entry.path())) continue;
    const auto changed = fs::last_write_time(entry.path(), error);
    if (error || fs::file_time_type::clock::now() - changed < kAbandonedAge) continue;
    const int lock = lock_directory(entry.path());
    if (lock < 0) continue;
    if (holds_nothing_in_use(entry.path())) fs::remove_all(entry.path(), error);
    close(lock);
  }
}

}  // namespace

Expected<PrivateSocket> PrivateSocket::create() {
  std::string problems;
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  for (const std::string& parent : {std::string(runtime == nullptr ? "" : runtime), std::string("/tmp")}) {
    if (parent.empty() || parent.front() != '/') continue;
    std::string name = fmt::format("{}/{}{}", parent, kPrefix, kRandom);
    if (name.size() + 1 + kSocketName.size() > kLongestSocketPath) continue;
    remove_abandoned(parent);
    if (mkdtemp(name.data()) != nullptr) {
      const int lock = lock_directory(name);
      if (lock >= 0) return PrivateSocket(std::move(name), lock);
      const int error = errno;
      rmdir(name.c_str());
      errno = error;
    }
    problems += fmt::format("{}cannot make a directory in {}: {}", problems.empty() ? "" : "; ", parent,
                            std::strerror(errno));
  }
  return fail("no place for the socket of the workers: " + problems);
}

PrivateSocket::PrivateSocket(PrivateSocket&& other) noexcept
    : directory_(std::exchange(other.directory_, {})), lock_(std::exchange(other.lock_, -1)) {}

PrivateSocket::~PrivateSocket() {
  if (directory_.empty()) return;
  std::error_code ignored;
  fs::remove_all(directory_, ignored);
  close(lock_);
}

std::string PrivateSocket::address() const { return fmt::format("unix:{}/{}", directory_, kSocketName); }

}  // namespace penumbra
