#include "scheduler/outputs/image_io.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include "scheduler/outputs/image_files.h"

namespace penumbra {
namespace {

constexpr const char* kModule = "libpenumbra_image_io.so";

Expected<const ImageIo*> load() {
  std::error_code unknown;
  const auto beside = std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path() / kModule;
  void* module = dlopen(beside.c_str(), RTLD_LAZY | RTLD_LOCAL);
  if (module == nullptr && !std::filesystem::exists(beside, unknown))
    module = dlopen(kModule, RTLD_LAZY | RTLD_LOCAL);
  const auto table = module != nullptr ? dlsym(module, "penumbra_image_io") : nullptr;
  if (table == nullptr) return fail(fmt::format("cannot load what reads and writes images: {}", dlerror()));
  return static_cast<const ImageIo*>(table);
}

}  // namespace

Expected<const ImageIo*> image_io() {
  static const Expected<const ImageIo*> loaded = load();
  return loaded;
}

Expected<Image> read_image(const std::filesystem::path& path) {
  const auto io = image_io();
  if (!io) return std::unexpected(io.error());
  return (*io)->read(path);
}

Expected<std::vector<std::uint8_t>> encode_exr(const Image& image) {
  const auto io = image_io();
  if (!io) return std::unexpected(io.error());
  return (*io)->encode_exr(image);
}

Expected<std::vector<std::uint8_t>> encode_png(const Image& image) {
  const auto io = image_io();
  if (!io) return std::unexpected(io.error());
  return (*io)->encode_png(image);
}

}  // namespace penumbra
