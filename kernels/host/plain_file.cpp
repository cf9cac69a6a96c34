#include "kernels/host/plain_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

#include "kernels/host/text.h"

namespace penumbra {
namespace {

struct Descriptor {
  explicit Descriptor(const std::filesystem::path& file)
      : number(open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
  }  // O_NONBLOCK: open() of a pipe might wait
  ~Descriptor() {
    if (number >= 0) close(number);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  const int number;
};

constexpr std::size_t kMostNames = 10'000;  // of a folder that is looked through

/// The names in the folder, sorted.
std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    names.push_back(at->path().filename().string());
    if (names.size() > kMostNames) return {};
  }
  std::ranges::sort(names);
  return names;
}

}  // namespace

std::string file_suggestion(const std::filesystem::path& file) {
  std::error_code ignored;
  std::filesystem::path found;
  bool is_other = false;
  for (const std::filesystem::path& part : file) {
    if (part.empty() || std::filesystem::exists(found / part, ignored)) {
      found /= part;
      continue;
    }
    const auto nearest = nearest_name(part.string(), names_in(found.empty() ? "." : found));
    if (!nearest) return {};
    found /= *nearest;
    is_other = true;
  }
  return is_other ? fmt::format("; did you mean '{}'?", found.string()) : std::string();
}

Expected<std::string> read_plain_file(const std::filesystem::path& file, std::uint64_t max_bytes) {
  const auto unreadable = [&](int error) {
    return fail(fmt::format("cannot read '{}': {}", file.string(), std::strerror(error)));
  };
  const Descriptor descriptor(file);
  if (descriptor.number < 0 && errno == ENOENT)
    return fail(fmt::format("there is no file '{}'{}", file.string(), file_suggestion(file)));
  if (descriptor.number < 0) return unreadable(errno);
  struct stat status {};
  if (fstat(descriptor.number, &status) != 0) return unreadable(errno);
  if (!S_ISREG(status.st_mode)) return fail(fmt::format("'{}' is not a plain file", file.string()));
  const auto size = std::uint64_t(status.st_size);
  if (size > max_bytes)
    return fail(
        fmt::format("'{}' has {} bytes; the most that is read is {}", file.string(), size, max_bytes));
  std::string text(size, '\0');
  for (std::size_t got = 0; got < text.size();) {
    const ssize_t count = read(descriptor.number, text.data() + got, text.size() - got);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return unreadable(errno);
    if (count == 0) return fail(fmt::format("'{}' became shorter while it was read", file.string()));
    got += std::size_t(count);
  }
  return text;
}

bool write_whole(int descriptor, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes = bytes.subspan(std::size_t(count));
  }
  return true;
}

}  // namespace penumbra
