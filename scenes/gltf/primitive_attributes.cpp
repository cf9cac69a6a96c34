#include "scenes/gltf/primitive_attributes.h"

#include <fmt/format.h>

#include <cmath>

#include "kernels/host/module.h"

namespace penumbra::gltf {

Expected<PrimitiveAttributes> PrimitiveAttributes::open(const Asset& asset,
                                                        const tinygltf::Primitive& primitive) {
  const auto position = primitive.attributes.find("POSITION");
  if (position == primitive.attributes.end()) return fail("a primitive without POSITION");
  PrimitiveAttributes result(asset, primitive);
  const auto compression = primitive.extensions.find("KHR_draco_mesh_compression");
  if (compression != primitive.extensions.end()) {
    if (const auto done = result.decompress(compression->second); !done)
      return fail(fmt::format("KHR_draco_mesh_compression: {}", done.error().message));
    return result;
  }
  const auto& accessors = asset.model.accessors;
  if (position->second < 0 || std::size_t(position->second) >= accessors.size())
    return fail(fmt::format("POSITION: there is no accessor {}", position->second));
  result.vertices_ = accessors[std::size_t(position->second)].count;
  return result;
}

Expected<void> PrimitiveAttributes::decompress(const tinygltf::Value& compression) {
  static const Expected<const void*> module =
      load_module("libpenumbra_draco_reader.so", "penumbra_draco_reader");
  if (!module)
    return fail(
        fmt::format("such meshes need a part of the program that is built where libdraco (Debian: "
                    "libdraco-dev) is: {}",
                    module.error().message));
  if (!compression.Has("bufferView") || !compression.Get("bufferView").IsInt() ||
      !compression.Has("attributes") || !compression.Get("attributes").IsObject())
    return fail("it has a 'bufferView' and 'attributes'");
  const auto bytes = asset_->view(compression.Get("bufferView").GetNumberAsInt());
  if (!bytes) return std::unexpected(bytes.error());
  const tinygltf::Value& attributes = compression.Get("attributes");
  std::vector<int> ids;
  for (const std::string& name : attributes.Keys()) {
    if (!attributes.Get(name).IsInt()) return fail(fmt::format("'{}' has no whole number", name));
    ids.push_back(compressed_ids_[name] = attributes.Get(name).GetNumberAsInt());
  }
  auto mesh = static_cast<const DracoReader*>(*module)->read(*bytes, ids);
  if (!mesh) return std::unexpected(mesh.error());
  vertices_ = mesh->vertices;
  compressed_ = std::move(*mesh);
  return {};
}

Expected<std::optional<AccessorValues>> PrimitiveAttributes::read(const std::string& name, std::size_t least,
                                                                  std::size_t most) const {
  const auto found = primitive_->attributes.find(name);
  if (found == primitive_->attributes.end()) return std::optional<AccessorValues>();
  const auto id = compressed_ids_.find(name);
  Expected<AccessorValues> values;
  if (compressed_ && id != compressed_ids_.end()) {
    const DracoAttribute& attribute = compressed_->attributes.at(id->second);
    values =
        decompressed_accessor(*asset_, found->second, attribute.components, attribute.numbers, least, most);
  } else {
    values = read_accessor(*asset_, found->second, least, most);
  }
  if (!values) return fail(fmt::format("{}: {}", name, values.error().message));
  if (values->count != vertices_)
    return fail(fmt::format("{} of {} vertices, where there are {}", name, values->count, vertices_));
  return std::optional<AccessorValues>(std::move(*values));
}

Expected<std::vector<std::uint32_t>> PrimitiveAttributes::corners() const {
  std::vector<std::uint32_t> result;
  if (compressed_) {
    for (const std::uint32_t corner : compressed_->corners)
      if (corner >= vertices_)
        return fail(fmt::format("an index {}, where there are {} vertices", corner, vertices_));
    return compressed_->corners;
  }
  if (primitive_->indices < 0) {
    for (std::size_t i = 0; i < vertices_; ++i) result.push_back(std::uint32_t(i));
    return result;
  }
  const auto indices = read_accessor(*asset_, primitive_->indices, 1, 1);
  if (!indices) return fail(fmt::format("indices: {}", indices.error().message));
  result.reserve(indices->count);
  for (const double index : indices->numbers) {
    if (!(index >= 0 && index < double(vertices_) && index == std::floor(index)))
      return fail(fmt::format("an index {}, where there are {} vertices", index, vertices_));
    result.push_back(std::uint32_t(index));
  }
  return result;
}

}  // namespace penumbra::gltf
