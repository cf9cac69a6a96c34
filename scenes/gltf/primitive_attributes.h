// What the vertices of a primitive have, and its corners: from accessors, or from what Draco compressed.
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
  /// Errors: no POSITION, compressed data that are damaged, libdraco is not there.
  static Expected<PrimitiveAttributes> open(const Asset& asset, const tinygltf::Primitive& primitive);

  [[nodiscard]] std::size_t vertices() const { return vertices_; }

  /// An attribute of each vertex, of `least` to `most` components; nothing where there is none of that name.
  /// Errors: see read_accessor; of another number of vertices.
  [[nodiscard]] Expected<std::optional<AccessorValues>> read(const std::string& name, std::size_t least,
                                                             std::size_t most) const;

  /// The vertices in the order in which the primitive's mode takes them. Errors: as above; beyond the
  /// vertices.
  [[nodiscard]] Expected<std::vector<std::uint32_t>> corners() const;

  /// Draco's corners are three a triangle, whatever the mode says.
  [[nodiscard]] bool is_compressed() const { return compressed_.has_value(); }

 private:
  PrimitiveAttributes(const Asset& asset, const tinygltf::Primitive& primitive)
      : asset_(&asset), primitive_(&primitive) {}
  Expected<void> decompress(const tinygltf::Value& compression);

  const Asset* asset_;
  const tinygltf::Primitive* primitive_;
  std::size_t vertices_ = 0;
  std::optional<DracoMesh> compressed_{};
  std::map<std::string, int> compressed_ids_{};  ///< those that Draco has, by name
};

}  // namespace penumbra::gltf
