#include "scenes/gltf/accessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace penumbra::gltf {
namespace {

constexpr std::size_t kMostElements = std::size_t{1} << 28;
/// Limits accessors whose zeros are not in the file.
constexpr std::size_t kMostWithoutBuffer = std::size_t{1} << 24;

template <typename T>
double number_at(std::string_view bytes, std::size_t at, double most) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return most > 0 ? std::max(double(value) / most, -1.0) : double(value);
}

/// The divisor of normalised numbers of the type; 0 for types that are never normalised.
double largest_of(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return 127;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 255;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return 32767;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 65535;
    default:
      return 0;
  }
}

double component(std::string_view bytes, std::size_t at, int type, bool normalised) {
  const double most = normalised ? largest_of(type) : 0.0;
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return number_at<std::int8_t>(bytes, at, most);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return number_at<std::uint8_t>(bytes, at, most);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return number_at<std::int16_t>(bytes, at, most);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return number_at<std::uint16_t>(bytes, at, most);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return number_at<std::uint32_t>(bytes, at, 0);
    default:
      return number_at<float>(bytes, at, 0);
  }
}

/// 0 for unknown types.
std::size_t bytes_of(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

/// Reads `count` elements of a view, from `offset` on. A stride of 0 means packed elements.
Expected<std::vector<double>> read_packed(const Asset& asset, int view, std::size_t offset,
                                          std::size_t stride, std::size_t count, std::size_t components,
                                          int type, bool normalised) {
  const auto bytes = asset.view(view);
  if (!bytes) return std::unexpected(bytes.error());
  const std::size_t size = bytes_of(type);
  if (size == 0) return fail(fmt::format("{} is no component type", type));
  const std::size_t element = size * components, step = stride == 0 ? element : stride;
  if (step < element) return fail(fmt::format("a stride of {} bytes for elements of {}", step, element));
  if (count == 0) return std::vector<double>{};
  if (offset > bytes->size() || bytes->size() - offset < element ||
      (bytes->size() - offset - element) / step < count - 1)
    return fail(
        fmt::format("{} elements end beyond the {} bytes of buffer view {}", count, bytes->size(), view));
  std::vector<double> numbers;
  numbers.reserve(count * components);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t c = 0; c < components; ++c)
      numbers.push_back(component(*bytes, offset + i * step + c * size, type, normalised));
  return numbers;
}

Expected<void> apply_sparse(const Asset& asset, const tinygltf::Accessor& accessor, AccessorValues& values) {
  const auto& sparse = accessor.sparse;
  if (sparse.count < 0 || std::size_t(sparse.count) > values.count || sparse.indices.byteOffset < 0 ||
      sparse.values.byteOffset < 0)
    return fail(fmt::format("{} sparse elements of {}", sparse.count, values.count));
  const auto count = std::size_t(sparse.count);
  if (sparse.indices.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT)
    return fail("sparse indices are whole numbers");
  const auto where = read_packed(asset, sparse.indices.bufferView, std::size_t(sparse.indices.byteOffset), 0,
                                 count, 1, sparse.indices.componentType, false);
  if (!where) return std::unexpected(where.error());
  const auto what = read_packed(asset, sparse.values.bufferView, std::size_t(sparse.values.byteOffset), 0,
                                count, values.components, accessor.componentType, accessor.normalized);
  if (!what) return std::unexpected(what.error());
  for (std::size_t i = 0; i < count; ++i) {
    if (!((*where)[i] >= 0 && (*where)[i] < double(values.count)))
      return fail(fmt::format("a sparse element {} of {}", (*where)[i], values.count));
    std::copy_n(what->begin() + std::ptrdiff_t(i * values.components), values.components,
                values.numbers.begin() + std::ptrdiff_t(std::size_t((*where)[i]) * values.components));
  }
  return {};
}

Expected<const tinygltf::Accessor*> accessor_of(const Asset& asset, int index, std::size_t least,
                                                std::size_t most) {
  constexpr std::size_t kMatrix = 16;
  const auto& accessors = asset.model.accessors;
  if (index < 0 || std::size_t(index) >= accessors.size())
    return fail(fmt::format("there is no accessor {}", index));
  const tinygltf::Accessor& accessor = accessors[std::size_t(index)];
  const int components = tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type));
  const bool is_matrix = accessor.type >= TINYGLTF_TYPE_MAT2 && accessor.type <= TINYGLTF_TYPE_MAT4;
  if (components < int(least) || components > int(most) || is_matrix != (least == kMatrix))
    return fail(fmt::format("accessor {} is not of {}", index,
                            least == kMatrix ? "matrices of 4 x 4"
                            : least == most  ? (least == 1 ? "numbers" : fmt::format("vectors of {}", least))
                                             : fmt::format("vectors of {} to {}", least, most)));
  return &accessor;
}

Expected<AccessorValues> finite(AccessorValues values, int index) {
  if (!std::ranges::all_of(values.numbers, [](double x) { return std::isfinite(x); }))
    return fail(fmt::format("accessor {} has numbers that are not finite", index));
  return values;
}

}  // namespace

Expected<AccessorValues> read_accessor(const Asset& asset, int index, std::size_t least, std::size_t most) {
  const auto found = accessor_of(asset, index, least, most);
  if (!found) return std::unexpected(found.error());
  const tinygltf::Accessor& accessor = **found;
  const int components = tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type));
  AccessorValues values;
  values.count = accessor.count;
  values.components = std::size_t(components);
  if (values.count > (accessor.bufferView >= 0 ? kMostElements : kMostWithoutBuffer))
    return fail(fmt::format("accessor {} has {} elements, which is too many", index, values.count));
  if (accessor.bufferView >= 0) {
    const auto& views = asset.model.bufferViews;
    const std::size_t stride = std::size_t(accessor.bufferView) < views.size()
                                   ? views[std::size_t(accessor.bufferView)].byteStride
                                   : 0;
    auto numbers = read_packed(asset, accessor.bufferView, accessor.byteOffset, stride, values.count,
                               values.components, accessor.componentType, accessor.normalized);
    if (!numbers) return fail(fmt::format("accessor {}: {}", index, numbers.error().message));
    values.numbers = std::move(*numbers);
  } else {
    values.numbers.assign(values.count * values.components, 0.0);
  }
  if (accessor.sparse.isSparse) {
    if (const auto done = apply_sparse(asset, accessor, values); !done)
      return fail(fmt::format("accessor {}: {}", index, done.error().message));
  }
  return finite(std::move(values), index);
}

Expected<AccessorValues> decompressed_accessor(const Asset& asset, int index, std::size_t components,
                                               std::vector<double> numbers, std::size_t least,
                                               std::size_t most) {
  const auto found = accessor_of(asset, index, least, most);
  if (!found) return std::unexpected(found.error());
  const tinygltf::Accessor& accessor = **found;
  if (const int wanted = tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type));
      std::size_t(wanted) != components)
    return fail(fmt::format("accessor {} has {} components, where the compressed data have {}", index, wanted,
                            components));
  const double most_stored = accessor.normalized ? largest_of(accessor.componentType) : 0.0;
  if (most_stored > 0.0)
    for (double& number : numbers) number = std::max(number / most_stored, -1.0);
  const std::size_t count = numbers.size() / components;
  return finite({count, components, std::move(numbers)}, index);
}

}  // namespace penumbra::gltf
