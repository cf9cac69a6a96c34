#include "scenes/image/radiance_format.h"

#include <algorithm>
#include <cstring>
#include <memory>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#include <stb/stb_image.h>

namespace penumbra {
namespace {

struct Stream {
  std::string_view left;
  bool ended_early = false;  ///< more was asked for than there is
};

// stb asks for more only if it needs more. After the end of a file it would wait for its data for ever, or
// take zeros for them. Line ends instead end its header and let every run of texels get on.
int read_bytes(void* user, char* to, int count) {
  auto& stream = *static_cast<Stream*>(user);
  const std::size_t given = std::min(std::size_t(count), stream.left.size());
  std::memcpy(to, stream.left.data(), given);
  stream.left.remove_prefix(given);
  if (given > 0) return int(given);
  stream.ended_early = true;
  std::memset(to, '\n', std::size_t(count));
  return count;
}
void skip_bytes(void* user, int count) {
  auto& stream = *static_cast<Stream*>(user);
  stream.left.remove_prefix(std::min(std::size_t(std::max(count, 0)), stream.left.size()));
}
int is_at_end(void* user) { return static_cast<Stream*>(user)->left.empty() ? 1 : 0; }

}  // namespace

bool read_radiance(std::string_view contents, std::size_t most_bytes, ImageContents& image) {
  const stbi_io_callbacks calls{read_bytes, skip_bytes, is_at_end};
  Stream header{contents}, stream{contents};
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_callbacks(&calls, &header, &width, &height, &channels) == 0 || channels != 3 ||
      width <= 0 || height <= 0)
    return false;
  const double bytes = double(width) * double(height) * 3 * sizeof(float);
  if (bytes > double(most_bytes)) return false;
  const std::unique_ptr<float, decltype(&stbi_image_free)> texels(
      stbi_loadf_from_callbacks(&calls, &stream, &width, &height, &channels, 3), stbi_image_free);
  if (!texels || stream.ended_early) return false;
  image.width = width;
  image.height = height;
  image.channels = {"R", "G", "B"};
  image.type = TexelType::kFloat;
  image.bytes.resize(std::size_t(bytes));
  std::memcpy(image.bytes.data(), texels.get(), image.bytes.size());
  return true;
}

}  // namespace penumbra
