#include "worker/opencl_cache.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace penumbra {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kVersion = 1;
constexpr char kMagic[8] = {'P', 'E', 'N', 'U', 'M', 'B', 'C', 'L'};
constexpr std::size_t kKeyDigits = 32;
constexpr const char* kSuffix = ".clbin";

/// Precedes the binary in a file, in the machine's byte order: cache files are not moved to other machines.
struct Header {
  char magic[8];
  std::uint32_t version;
  std::uint32_t reserved;  ///< 0
  char key[kKeyDigits];
  std::uint64_t size;      ///< bytes that follow
  std::uint64_t checksum;  ///< XXH3-64 of them
};
static_assert(sizeof(Header) == 64);

/// The binary in the file. Errors: what is wrong with it.
Expected<std::vector<unsigned char>> read_binary(CacheFile& file, std::string_view key) {
  const auto size = file.size();
  if (!size) return std::unexpected(size.error());
  Header header;
  if (file.read(&header, sizeof header) != sizeof header) return fail("is cut short");
  if (std::memcmp(header.magic, kMagic, sizeof kMagic) != 0) return fail("holds no kernels");
  if (header.version != kVersion || header.reserved != 0)
    return fail(fmt::format("has the format {}", header.version));
  if (std::string_view(header.key, kKeyDigits) != key) return fail("holds other kernels than its name says");
  if (header.size != *size - sizeof header) return fail("has not the size that it states");
  std::vector<unsigned char> binary(header.size);
  if (file.read(binary.data(), binary.size()) != binary.size()) return fail("is cut short");
  if (XXH3_64bits(binary.data(), binary.size()) != header.checksum) return fail("is damaged");
  return binary;
}

}  // namespace

fs::path default_kernel_cache() {
  if (const char* wanted = std::getenv("PENUMBRA_KERNEL_CACHE"); wanted && *wanted)
    return std::string_view(wanted) == "off" ? fs::path() : fs::path(wanted);
  return user_cache("kernels");
}

KernelCache::KernelCache(fs::path folder, int most_files)
    : files_(std::move(folder), kSuffix, {.most_files = std::size_t(most_files)}) {}

std::string KernelCache::key_of(std::span<const std::string> parts) {
  std::string all;
  for (const std::string& part : parts) all += fmt::format("{}:", part.size()) + part;
  const XXH128_hash_t hash = XXH3_128bits(all.data(), all.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

KernelCache::Found KernelCache::find(std::string_view key) const {
  if (!enabled()) return {};
  const fs::path path = file_of(key);
  CacheFile file(path, O_RDONLY | O_NONBLOCK);
  if (!file.is_open()) return {};
  Expected<std::vector<unsigned char>> binary = read_binary(file, key);
  if (!binary) {
    remove(key);
    return {{},
            fmt::format("the kernel cache's {} {} and was removed", path.string(), binary.error().message)};
  }
  file.touch();
  return {std::move(*binary), {}};
}

Expected<void> KernelCache::keep(std::string_view key, std::span<const unsigned char> binary) const {
  if (!enabled()) return {};
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.version = kVersion;
  std::memcpy(header.key, key.data(), std::min(key.size(), kKeyDigits));
  header.size = binary.size();
  header.checksum = XXH3_64bits(binary.data(), binary.size());
  const std::span<const std::uint8_t> parts[] = {
      {reinterpret_cast<const std::uint8_t*>(&header), sizeof header}, binary};
  if (auto written = files_.write(key, parts); !written) return written;
  files_.remove_oldest();
  return {};
}

}  // namespace penumbra
