#include "scheduler/image/image_reader.h"

#include <fmt/format.h>

#include <utility>

#include "kernels/host/module.h"
#include "kernels/host/plain_file.h"
#include "scheduler/image/exr_reader.h"

namespace penumbra {

namespace {

/// Error if there is no such file, or no reader.
Expected<const ImageReader*> image_reader(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    return fail(fmt::format("{}: no such file{}", path.string(), file_suggestion(path)));
  static const Expected<const void*> reader =
      load_module("libpenumbra_image_reader.so", "penumbra_image_reader");
  if (!reader) return fail(fmt::format("cannot load what reads images: {}", reader.error().message));
  return static_cast<const ImageReader*>(*reader);
}

}  // namespace

Expected<Image> read_image(const std::filesystem::path& path) {
  if (auto plain = read_plain_exr(path, true)) return std::move(*plain);
  const auto reader = image_reader(path);
  if (!reader) return std::unexpected(reader.error());
  return (*reader)->read(path);
}

Expected<Image> read_image_header(const std::filesystem::path& path) {
  if (auto plain = read_plain_exr(path, false)) return std::move(*plain);
  const auto reader = image_reader(path);
  if (!reader) return std::unexpected(reader.error());
  return (*reader)->read_header(path);
}

}  // namespace penumbra
