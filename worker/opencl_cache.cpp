#include "worker/opencl_cache.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <utility>

namespace penumbra {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kVersion = 1;
constexpr char kMagic[8] = {'P', 'E', 'N', 'U', 'M', 'B', 'C', 'L'};
constexpr std::size_t kKeyDigits = 32;
constexpr std::string_view kSuffix = ".clbin", kAsideSuffix = ".clbin-aside";
// A file that a process wrote aside and never renamed, since it died.
constexpr auto kTimeToBeRenamed = std::chrono::hours(1);

/// In front of the binary in a file, in the machine's byte order: a cache is not carried around.
struct Header {
  char magic[8];
  std::uint32_t version;
  std::uint32_t reserved;  ///< 0
  char key[kKeyDigits];
  std::uint64_t size;      ///< bytes that follow
  std::uint64_t checksum;  ///< XXH3-64 of them
};
static_assert(sizeof(Header) == 64);

class File {
 public:
  File(const fs::path& path, int flags) : descriptor_(open(path.c_str(), flags | O_CLOEXEC, 0600)) {}
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() { close(); }

  [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }
  [[nodiscard]] int descriptor() const { return descriptor_; }
  bool close() { return descriptor_ < 0 || ::close(std::exchange(descriptor_, -1)) == 0; }

  /// How many bytes there were to read, at most so many.
  std::size_t read(void* to, std::size_t bytes) {
    std::size_t got = 0;
    while (got < bytes) {
      const ssize_t n = ::read(descriptor_, static_cast<char*>(to) + got, bytes - got);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) break;
      got += std::size_t(n);
    }
    return got;
  }

  bool write(const void* from, std::size_t bytes) {
    std::size_t put = 0;
    while (put < bytes) {
      const ssize_t n = ::write(descriptor_, static_cast<const char*>(from) + put, bytes - put);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return false;
      put += std::size_t(n);
    }
    return true;
  }

 private:
  int descriptor_;
};

/// The binary in the file, or what is wrong with it.
Expected<std::vector<unsigned char>> read_binary(File& file, std::string_view key) {
  struct stat status {};
  if (fstat(file.descriptor(), &status) != 0 || !S_ISREG(status.st_mode)) return fail("is no file");
  Header header;
  if (file.read(&header, sizeof header) != sizeof header) return fail("is cut short");
  if (std::memcmp(header.magic, kMagic, sizeof kMagic) != 0) return fail("holds no kernels");
  if (header.version != kVersion || header.reserved != 0)
    return fail(fmt::format("has the format {}", header.version));
  if (std::string_view(header.key, kKeyDigits) != key) return fail("holds other kernels than its name says");
  if (header.size != std::uint64_t(status.st_size) - sizeof header)
    return fail("has not the size that it states");
  std::vector<unsigned char> binary(header.size);
  if (file.read(binary.data(), binary.size()) != binary.size()) return fail("is cut short");
  if (XXH3_64bits(binary.data(), binary.size()) != header.checksum) return fail("is damaged");
  return binary;
}

std::string error_text(const fs::path& path) {
  return fmt::format("cannot write {}: {}", path.string(), std::strerror(errno));
}

}  // namespace

fs::path default_kernel_cache() {
  if (const char* wanted = std::getenv("PENUMBRA_KERNEL_CACHE"); wanted && *wanted)
    return std::string_view(wanted) == "off" ? fs::path() : fs::path(wanted);
  // A relative XDG_CACHE_HOME is to be ignored (XDG Base Directory Specification).
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache == '/')
    return fs::path(cache) / "penumbra" / "kernels";
  if (const char* home = std::getenv("HOME"); home && *home)
    return fs::path(home) / ".cache" / "penumbra" / "kernels";
  return {};
}

KernelCache::KernelCache(fs::path folder, int most_files)
    : folder_(std::move(folder)), most_files_(most_files) {}

std::string KernelCache::key_of(std::span<const std::string> parts) {
  std::string all;
  for (const std::string& part : parts) all += fmt::format("{}:", part.size()) + part;
  const XXH128_hash_t hash = XXH3_128bits(all.data(), all.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

fs::path KernelCache::file_of(std::string_view key) const {
  return folder_ / (std::string(key) + std::string(kSuffix));
}

KernelCache::Found KernelCache::find(std::string_view key) const {
  if (!enabled()) return {};
  const fs::path path = file_of(key);
  File file(path, O_RDONLY | O_NONBLOCK);
  if (!file.is_open()) return {};
  Expected<std::vector<unsigned char>> binary = read_binary(file, key);
  if (!binary) {
    remove(key);
    return {{},
            fmt::format("the kernel cache's {} {} and was removed", path.string(), binary.error().message)};
  }
  futimens(file.descriptor(), nullptr);  // used last; fails without harm in another user's folder
  return {std::move(*binary), {}};
}

Expected<void> KernelCache::keep(std::string_view key, std::span<const unsigned char> binary) const {
  if (!enabled()) return {};
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) return fail(fmt::format("cannot make the folder {}: {}", folder_.string(), error.message()));
  static std::atomic<unsigned> count{0};
  const fs::path path = file_of(key),
                 aside = folder_ / fmt::format(".{}.{}.{}{}", key, getpid(), count++, kAsideSuffix);
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.version = kVersion;
  std::memcpy(header.key, key.data(), std::min(key.size(), kKeyDigits));
  header.size = binary.size();
  header.checksum = XXH3_64bits(binary.data(), binary.size());
  File file(aside, O_WRONLY | O_CREAT | O_EXCL);
  if (!file.is_open()) return fail(error_text(aside));
  // No fsync: what a crash of the machine leaves half written, the checksum finds.
  if (!file.write(&header, sizeof header) || !file.write(binary.data(), binary.size()) || !file.close() ||
      rename(aside.c_str(), path.c_str()) != 0) {
    auto failed = fail(error_text(path));
    unlink(aside.c_str());
    return failed;
  }
  remove_oldest();
  return {};
}

void KernelCache::remove(std::string_view key) const {
  if (!enabled()) return;
  std::error_code error;
  fs::remove(file_of(key), error);
}

void KernelCache::remove_oldest() const {
  using Entry = std::pair<fs::file_time_type, fs::path>;
  std::vector<Entry> files;
  std::error_code error;
  const auto now = fs::file_time_type::clock::now();
  for (fs::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    std::error_code gone;  // by another process
    const auto time = at->last_write_time(gone);
    if (gone) continue;
    const std::string name = at->path().filename().string();
    if (name.ends_with(kSuffix)) {
      files.emplace_back(time, at->path());
    } else if (name.ends_with(kAsideSuffix) && now - time > kTimeToBeRenamed) {
      fs::remove(at->path(), gone);
    }
  }
  if (files.size() <= std::size_t(most_files_)) return;
  const auto kept = files.end() - most_files_;
  std::ranges::nth_element(files, kept);
  for (auto file = files.begin(); file != kept; ++file) fs::remove(file->second, error);
}

}  // namespace penumbra
