#include "kernels/host/checked_cache.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>

#include "kernels/host/content_hash.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint32_t kVersion = 2;
constexpr char kMagic[8] = {'P', 'E', 'N', 'U', 'M', 'B', 'C', 'C'};
constexpr std::size_t kKeyDigits = 2 * sizeof(ContentDigest);

/// Precedes the content of a file, in the machine's byte order: cache files are not moved to other machines.
struct Header {
  char magic[8];
  std::uint32_t version;
  std::uint32_t reserved;  ///< 0
  char key[kKeyDigits];
  std::uint64_t size;      ///< bytes that follow
  std::uint64_t checksum;  ///< XXH3-64 of them
};
static_assert(sizeof(Header) == 96);

/// The content of the file. Errors: what is wrong with it.
Expected<std::vector<std::uint8_t>> read_content(CacheFile& file, std::string_view key) {
  const auto size = file.size();
  if (!size) return std::unexpected(size.error());
  if (!file.is_own()) return fail("may be another user's");
  Header header;
  if (file.read(&header, sizeof header) != sizeof header) return fail("is cut short");
  if (std::memcmp(header.magic, kMagic, sizeof kMagic) != 0) return fail("is no file of a cache");
  if (header.version != kVersion || header.reserved != 0)
    return fail(fmt::format("has the format {}", header.version));
  if (std::string_view(header.key, kKeyDigits) != key) return fail("is another file than its name says");
  if (header.size != *size - sizeof header) return fail("has not the size that it states");
  std::vector<std::uint8_t> content(header.size);
  if (file.read(content.data(), content.size()) != content.size()) return fail("is cut short");
  if (XXH3_64bits(content.data(), content.size()) != header.checksum) return fail("is damaged");
  return content;
}

std::uint64_t checksum_of(std::span<const Bytes> parts) {
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
  XXH3_64bits_reset(state.get());
  for (const Bytes part : parts) XXH3_64bits_update(state.get(), part.data(), part.size());
  return XXH3_64bits_digest(state.get());
}

}  // namespace

CheckedCache::CheckedCache(fs::path folder, std::string suffix, CacheLimits limits)
    : files_(std::move(folder), std::move(suffix), limits) {}

std::string CheckedCache::key_of(std::span<const std::string> parts) {
  std::string all;
  for (const std::string& part : parts) all += fmt::format("{}:{}", part.size(), part);
  return content_hash({reinterpret_cast<const std::uint8_t*>(all.data()), all.size()});
}

CheckedCache::Found CheckedCache::find(std::string_view key) const {
  if (!enabled()) return {};
  if (const auto checked = check_cache_folder(files_.path()); !checked) return {{}, checked.error().message};
  const fs::path path = file_of(key);
  CacheFile file(path, O_RDONLY | O_NONBLOCK);
  if (!file.is_open()) return {};
  Expected<std::vector<std::uint8_t>> content = read_content(file, key);
  if (!content) {
    remove(key);
    return {{}, fmt::format("the cache's {} {} and was removed", path.string(), content.error().message)};
  }
  file.touch();
  return {std::move(*content), {}};
}

Expected<void> CheckedCache::keep(std::string_view key, std::span<const Bytes> parts) const {
  if (!enabled()) return {};
  if (auto checked = check_cache_folder(files_.path()); !checked) return checked;
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.version = kVersion;
  std::memcpy(header.key, key.data(), std::min(key.size(), kKeyDigits));
  for (const Bytes part : parts) header.size += part.size();
  header.checksum = checksum_of(parts);
  std::vector<Bytes> file = {{reinterpret_cast<const std::uint8_t*>(&header), sizeof header}};
  file.insert(file.end(), parts.begin(), parts.end());
  if (auto written = files_.write(key, file); !written) return written;
  files_.remove_oldest();
  return {};
}

Expected<void> CheckedCache::keep(std::string_view key, Bytes bytes) const {
  return keep(key, std::span(&bytes, 1));
}

}  // namespace penumbra
