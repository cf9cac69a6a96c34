#include "scenes/tensor_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <iterator>
#include <optional>
#include <utility>

namespace penumbra {
namespace {

constexpr std::string_view kMagic{"tensor_file\0", 12};
constexpr std::size_t kMostDimensions = 8;
/// Bytes of a number of each type. There is no type 0.
constexpr std::uint64_t kTypeBytes[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8};

/// The next number of a file, or nothing at its end.
template <typename T>
std::optional<T> take(std::string_view bytes, std::size_t& at) {
  if (bytes.size() - at < sizeof(T)) return std::nullopt;
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  at += sizeof value;
  if constexpr (std::endian::native == std::endian::big) return std::byteswap(value);
  return value;
}

/// The bytes of a tensor of `size` bytes per number, unless that is more than `most`.
std::optional<std::uint64_t> bytes_of(const std::vector<std::uint64_t>& shape, std::uint64_t size,
                                      std::uint64_t most) {
  for (const std::uint64_t side : shape) {
    if (side == 0) return 0;
    if (size > most / side) return std::nullopt;
    size *= side;
  }
  return size;
}

}  // namespace

std::string print_shape(const std::vector<std::uint64_t>& shape) {
  return fmt::to_string(fmt::join(shape, " x "));
}

Expected<Tensors> read_tensors(const std::string& name, std::string_view bytes) {
  const auto wrong = [&](const std::string& what) { return fail(fmt::format("{}: {}", name, what)); };
  if (!bytes.starts_with(kMagic))
    return wrong("it is no file of measured material, which begins with tensor_file and a zero byte");
  std::size_t at = kMagic.size();
  const auto major = take<std::uint8_t>(bytes, at), minor = take<std::uint8_t>(bytes, at);
  if (!minor) return wrong("the file ends within its header");
  if (*major != 1 || *minor != 0)
    return wrong(fmt::format("its version is {}.{}; 1.0 is read", *major, *minor));
  const auto count = take<std::uint32_t>(bytes, at);
  if (!count) return wrong("the file ends within its header");
  Tensors tensors;
  for (std::uint32_t i = 0; i < *count; ++i) {
    const auto ends = [&] {
      return wrong(fmt::format("the file ends within the description of field {} of {}", i + 1, *count));
    };
    const auto length = take<std::uint16_t>(bytes, at);
    if (!length || bytes.size() - at < *length) return ends();
    const std::string field(bytes.substr(at, *length));
    at += *length;
    Tensor tensor;
    const auto dimensions = take<std::uint16_t>(bytes, at);
    const auto type = take<std::uint8_t>(bytes, at);
    const auto offset = take<std::uint64_t>(bytes, at);
    if (!offset) return ends();
    if (*dimensions > kMostDimensions)
      return wrong(fmt::format("field '{}' has {} dimensions; {} at most are read", field, *dimensions,
                               kMostDimensions));
    for (int k = 0; k < *dimensions; ++k) {
      const auto side = take<std::uint64_t>(bytes, at);
      if (!side) return ends();
      tensor.shape.push_back(*side);
    }
    if (*type == 0 || *type >= std::size(kTypeBytes))
      return wrong(fmt::format("field '{}' has the type {}; types are 1 to {}", field, *type,
                               std::size(kTypeBytes) - 1));
    tensor.type = *type;
    const auto size = bytes_of(tensor.shape, kTypeBytes[*type], bytes.size());
    if (!size || *offset > bytes.size() || *size > bytes.size() - *offset)
      return wrong(
          fmt::format("field '{}' of {} numbers of {} bytes from byte {} on goes beyond the file's {} bytes",
                      field, print_shape(tensor.shape), kTypeBytes[*type], *offset, bytes.size()));
    tensor.bytes = bytes.substr(*offset, *size);
    if (!tensors.emplace(field, std::move(tensor)).second)
      return wrong(fmt::format("field '{}' is there twice", field));
  }
  return tensors;
}

}  // namespace penumbra
