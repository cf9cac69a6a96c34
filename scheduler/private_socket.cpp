#include "scheduler/private_socket.h"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>

namespace penumbra {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "penumbra-";
constexpr std::string_view kSocketName = "socket";
constexpr std::size_t kLongestSocketPath = sizeof(sockaddr_un::sun_path) - 1;  // 107
constexpr std::chrono::minutes kAbandonedAge{
    1};  // between bind and listen a socket looks abandoned for a moment

bool nobody_listens(const fs::path& socket_path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (socket_path.native().size() > kLongestSocketPath) return false;
  std::memcpy(address.sun_path, socket_path.c_str(), socket_path.native().size() + 1);
  const int descriptor = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) return false;
  const bool refused =
      connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 &&
      errno == ECONNREFUSED;
  close(descriptor);
  return refused;
}

bool is_mine(const fs::path& path) {
  struct stat status {};
  return lstat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode) && status.st_uid == geteuid();
}

void remove_abandoned(const fs::path& parent) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(parent, error)) {
    if (!entry.path().filename().native().starts_with(kPrefix) || !is_mine(entry.path())) continue;
    const auto changed = fs::last_write_time(entry.path(), error);
    if (error || fs::file_time_type::clock::now() - changed < kAbandonedAge) continue;
    if (nobody_listens(entry.path() / kSocketName)) fs::remove_all(entry.path(), error);
  }
}

}  // namespace

Expected<PrivateSocket> PrivateSocket::create() {
  std::string problems;
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  for (const std::string& parent : {std::string(runtime == nullptr ? "" : runtime), std::string("/tmp")}) {
    if (parent.empty() || parent.front() != '/') continue;
    std::string name = fmt::format("{}/{}XXXXXX", parent, kPrefix);
    if (name.size() + 1 + kSocketName.size() > kLongestSocketPath) continue;
    remove_abandoned(parent);
    if (mkdtemp(name.data()) != nullptr) return PrivateSocket(std::move(name));
    problems += fmt::format("{}cannot make a directory in {}: {}", problems.empty() ? "" : "; ", parent,
                            std::strerror(errno));
  }
  return fail("no place for the socket of the workers: " + problems);
}

PrivateSocket::PrivateSocket(PrivateSocket&& other) noexcept
    : directory_(std::exchange(other.directory_, {})) {}

PrivateSocket::~PrivateSocket() {
  if (directory_.empty()) return;
  std::error_code ignored;
  fs::remove_all(directory_, ignored);
}

std::string PrivateSocket::address() const { return fmt::format("unix:{}/{}", directory_, kSocketName); }

}  // namespace penumbra
