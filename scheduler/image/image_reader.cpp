#include "scheduler/image/image_reader.h"

#include <dlfcn.h>
#include <fmt/format.h>

namespace penumbra {
namespace {

constexpr const char* kModule = "libpenumbra_image_reader.so";

/// From beside the executable, else from where the system looks for libraries.
Expected<const ImageReader*> load() {
  std::error_code unknown;
  const auto beside = std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path() / kModule;
  const bool installed = !std::filesystem::exists(beside, unknown);
  void* module = dlopen(installed ? kModule : beside.c_str(), RTLD_LAZY | RTLD_LOCAL);
  const void* table = module != nullptr ? dlsym(module, "penumbra_image_reader") : nullptr;
  if (table == nullptr) return fail(fmt::format("cannot load what reads images: {}", dlerror()));
  return static_cast<const ImageReader*>(table);
}

}  // namespace

Expected<Image> read_image(const std::filesystem::path& path) {
  static const Expected<const ImageReader*> reader = load();
  if (!reader) return std::unexpected(reader.error());
  return (*reader)->read(path);
}

}  // namespace penumbra
