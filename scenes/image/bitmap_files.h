// The image files of a scene. Each is read only once.
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
    BitmapFindings findings;  ///< only for the first reading
  };
  /// The index of a bitmap in the scene. Files with the same contents share a bitmap, whatever their names.
  /// Errors: those of FileAccess::read_bytes and read_bitmap; the same file always gives the same error.
  Expected<Entry> read(const std::filesystem::path& file, BitmapChannels channels);

  /// The same for contents in memory. `name` is used for messages, and its extension may determine the
  /// format.
  Expected<Entry> read_contents(const std::string& name, std::string_view contents, BitmapChannels channels);
  /// Adds a computed bitmap and returns its index.
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
