#include "scheduler/image/image_reader.h"

#include <fmt/format.h>

#include "kernels/host/module.h"

namespace penumbra {

Expected<Image> read_image(const std::filesystem::path& path) {
  static const Expected<const void*> reader =
      load_module("libpenumbra_image_reader.so", "penumbra_image_reader");
  if (!reader) return fail(fmt::format("cannot load what reads images: {}", reader.error().message));
  return static_cast<const ImageReader*>(*reader)->read(path);
}

}  // namespace penumbra
