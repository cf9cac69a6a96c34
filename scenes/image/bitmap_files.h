// The image files of a scene, each read once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/file_access.h"
#include "scenes/image/bitmap_reader.h"

namespace penumbra {

class BitmapFiles {
 public:
  explicit BitmapFiles(const FileAccess& files) : files_(files) {}

  struct Entry {
    int bitmap = -1;
    BitmapFindings findings;  ///< at the first reading alone
  };
  /// The index of a bitmap among those of the scene. Files of the same contents are one, whatever their
  /// names. Errors: see FileAccess::read_bytes and read_bitmap, the same for the same file.
  Expected<Entry> read(const std::filesystem::path& file, BitmapChannels channels);

  /// The same of contents that are in memory; `name` is the file that has them, or for messages, and its
  /// ending may say the format.
  Expected<Entry> read_contents(const std::string& name, std::string_view contents, BitmapChannels channels);
  /// One that was made.
  int add(Bitmap bitmap);

  [[nodiscard]] const Bitmap& bitmap(int index) const { return *bitmaps_[std::size_t(index)]; }
  [[nodiscard]] std::shared_ptr<const Bitmap> shared(int index) const { return bitmaps_[std::size_t(index)]; }
  [[nodiscard]] std::vector<std::shared_ptr<const Bitmap>> take() { return std::move(bitmaps_); }

 private:
  Expected<Entry> read_new(const std::filesystem::path& file, BitmapChannels channels);

  const FileAccess& files_;
  std::vector<std::shared_ptr<const Bitmap>> bitmaps_;
  using Digest = std::pair<std::uint64_t, std::uint64_t>;
  std::map<std::pair<std::string, BitmapChannels>, Expected<int>> by_path_;
  std::map<std::pair<Digest, BitmapChannels>, int> by_contents_;
};

}  // namespace penumbra
