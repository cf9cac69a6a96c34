#include "scenes/image/bitmap_files.h"

#include <xxhash.h>

namespace penumbra {

Expected<BitmapFiles::Entry> BitmapFiles::read(const std::filesystem::path& file, BitmapChannels channels) {
  std::error_code ignored;
  const std::pair key(std::filesystem::weakly_canonical(file, ignored).string(), channels);
  if (const auto known = by_path_.find(key); known != by_path_.end()) {
    if (!known->second) return std::unexpected(known->second.error());
    return Entry{*known->second, {}};
  }
  Expected<Entry> entry = read_new(file, channels);
  by_path_.emplace(key, entry ? Expected<int>(entry->bitmap) : std::unexpected(entry.error()));
  return entry;
}

Expected<BitmapFiles::Entry> BitmapFiles::read_new(const std::filesystem::path& file,
                                                   BitmapChannels channels) {
  const Expected<std::string> contents = files_.read_bytes(file, kMaxImageFileBytes);
  if (!contents) return std::unexpected(contents.error());
  return read_contents(file.string(), *contents, channels);
}

Expected<BitmapFiles::Entry> BitmapFiles::read_contents(const std::string& name, std::string_view contents,
                                                        BitmapChannels channels) {
  const XXH128_hash_t digest = XXH3_128bits(contents.data(), contents.size());
  const std::pair key(Digest(digest.high64, digest.low64), channels);
  if (const auto known = by_contents_.find(key); known != by_contents_.end()) return Entry{known->second, {}};
  Entry entry;
  Expected<Bitmap> bitmap = read_bitmap(name, contents, channels, entry.findings);
  if (!bitmap) return std::unexpected(bitmap.error());
  std::error_code ignored;
  if (!std::filesystem::exists(name, ignored))
    bitmap->contents = std::make_shared<const std::string>(contents);
  entry.bitmap = add(std::move(*bitmap));
  by_contents_.emplace(key, entry.bitmap);
  return entry;
}

int BitmapFiles::add(Bitmap bitmap) {
  bitmaps_.push_back(std::make_shared<const Bitmap>(std::move(bitmap)));
  return int(bitmaps_.size()) - 1;
}

}  // namespace penumbra
