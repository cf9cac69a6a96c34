// The implementation of the module in meshopt_module.h.
#include "scenes/gltf/meshopt_module.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <new>

#include "scenes/gltf/meshopt_attributes.h"

namespace penumbra::gltf {
namespace {

constexpr std::size_t kMostBytes = std::size_t{4} << 30;
// A byte becomes so many at most: in the version 1 of attributes, of up to 256 equal elements four bytes each
// take one of control (meshoptimizer's vertexcodec.cpp). A damaged count would make room for nothing.
constexpr std::size_t kMostExpansion = 1024;

Expected<void> unfilter(const MeshoptPacking& packing, char* elements) {
  const auto [count, stride, mode, filter] = packing;
  if (filter.empty() || filter == "NONE") return {};
  if (mode != "ATTRIBUTES") return fail(fmt::format("meshopt: the mode {} has no filters", mode));
  if (filter == "OCTAHEDRAL" && (stride == 4 || stride == 8)) {
    meshopt_decodeFilterOct(elements, count, stride);
  } else if (filter == "COLOR" && (stride == 4 || stride == 8)) {
    unfilter_colours({elements, count * stride}, stride);
  } else if (filter == "QUATERNION" && stride == 8) {
    meshopt_decodeFilterQuat(elements, count, stride);
  } else if (filter == "EXPONENTIAL" && stride % 4 == 0) {
    meshopt_decodeFilterExp(elements, count, stride);
  } else {
    return fail(fmt::format("meshopt: there is no filter '{}' of {} bytes", filter, stride));
  }
  return {};
}

Expected<std::string> read(std::string_view bytes, const MeshoptPacking& packing) {
  const auto& [count, stride, mode, filter] = packing;
  if (stride == 0 || stride > 256 || count > kMostBytes / stride)
    return fail(fmt::format("meshopt: {} elements of {} bytes", count, stride));
  if (count * stride > kMostExpansion * bytes.size())
    return fail(fmt::format("meshopt: {} elements of {} bytes are more than {} compressed bytes can be",
                            count, stride, bytes.size()));
  try {
    if (mode == "ATTRIBUTES" && stride % 4 == 0 && is_attributes_1(bytes)) {
      auto elements = read_attributes_1(bytes, count, stride);
      if (!elements) return elements;
      if (const auto done = unfilter(packing, elements->data()); !done) return std::unexpected(done.error());
      return elements;
    }
    std::string elements(count * stride, '\0');
    const auto* from = reinterpret_cast<const unsigned char*>(bytes.data());
    int problem = 0;
    if (mode == "ATTRIBUTES" && stride % 4 == 0) {
      problem = meshopt_decodeVertexBuffer(elements.data(), count, stride, from, bytes.size());
    } else if (mode == "TRIANGLES" && (stride == 2 || stride == 4) && count % 3 == 0) {
      problem = meshopt_decodeIndexBuffer(elements.data(), count, stride, from, bytes.size());
    } else if (mode == "INDICES" && (stride == 2 || stride == 4)) {
      problem = meshopt_decodeIndexSequence(elements.data(), count, stride, from, bytes.size());
    } else {
      return fail(
          fmt::format("meshopt: there is no mode '{}' of {} elements of {} bytes", mode, count, stride));
    }
    if (problem != 0) return fail("meshopt: the compressed data are damaged, or of a later version");
    if (const auto done = unfilter(packing, elements.data()); !done) return std::unexpected(done.error());
    return elements;
  } catch (const std::bad_alloc&) {
    return fail(fmt::format("meshopt: {} elements are more than there is memory for", count));
  }
}

}  // namespace
}  // namespace penumbra::gltf

/// Looked up by name, see asset.cpp.
extern "C" const penumbra::gltf::MeshoptReader penumbra_meshopt_reader{penumbra::gltf::read};
