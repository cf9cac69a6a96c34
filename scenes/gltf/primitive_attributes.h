// The vertex attributes and the indices of a primitive, from accessors or from Draco-compressed data.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scenes/gltf/accessor.h"
#include "scenes/gltf/draco_module.h"

namespace penumbra::gltf {

class PrimitiveAttributes {
 public:
  /// Errors: no POSITION, damaged compressed data, libdraco not available.
  static Expected<PrimitiveAttributes> open(const Asset& asset, const tinygltf::Primitive& primitive);

  [[nodiscard]] std::size_t vertices() const { return vertices_; }

  /// A vertex attribute of `least` to `most` components. Nothing if there is none of that name. Errors: those
  /// of read_accessor; another number of vertices.
  [[nodiscard]] Expected<std::optional<AccessorValues>> read(const std::string& name, std::size_t least,
                                                             std::size_t most) const;

  /// The vertex indices in the order of the primitive's mode. Errors: those of read(); indices beyond the
  /// vertices.
  [[nodiscard]] Expected<std::vector<std::uint32_t>> corners() const;

  /// Draco stores three corners per triangle, whatever the mode says.
  [[nodiscard]] bool is_compressed() const { return compressed_.has_value(); }

 private:
  PrimitiveAttributes(const Asset& asset, const tinygltf::Primitive& primitive)
      : asset_(&asset), primitive_(&primitive) {}
  Expected<void> decompress(const tinygltf::Value& compression);

  const Asset* asset_;
  const tinygltf::Primitive* primitive_;
  std::size_t vertices_ = 0;
  std::optional<DracoMesh> compressed_{};
  std::map<std::string, int> compressed_ids_{};  ///< attributes in the compressed data, by name
};

}  // namespace penumbra::gltf
