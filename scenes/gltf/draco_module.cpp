// The implementation of the module in draco_module.h.
#include "scenes/gltf/draco_module.h"

#include <draco/compression/decode.h>
#include <fmt/format.h>

#include <exception>

namespace penumbra::gltf {
namespace {

/// Reads all values of one attribute, one per vertex, through a type that holds them exactly.
template <typename Number>
bool read_values(const draco::Mesh& mesh, const draco::PointAttribute& from, DracoAttribute& to) {
  std::vector<Number> values(to.components);
  for (draco::PointIndex i(0); i < mesh.num_points(); ++i) {
    if (!from.ConvertValue<Number>(from.mapped_index(i), std::int8_t(to.components), values.data()))
      return false;
    to.numbers.insert(to.numbers.end(), values.begin(), values.end());
  }
  return true;
}

Expected<DracoMesh> read(std::string_view bytes, std::span<const int> attributes) {
  try {
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) return fail(fmt::format("Draco: {}", decoded.status().error_msg()));
    const draco::Mesh& mesh = *decoded.value();
    DracoMesh result;
    result.vertices = mesh.num_points();
    result.corners.reserve(3 * std::size_t(mesh.num_faces()));
    for (draco::FaceIndex i(0); i < mesh.num_faces(); ++i)
      for (const draco::PointIndex& corner : mesh.face(i)) result.corners.push_back(corner.value());
    for (const int id : attributes) {
      const draco::PointAttribute* from = id < 0 ? nullptr : mesh.GetAttributeByUniqueId(std::uint32_t(id));
      if (from == nullptr) return fail(fmt::format("Draco: there is no attribute {}", id));
      DracoAttribute& to = result.attributes[id];
      to = {.components = std::size_t(from->num_components()), .numbers = {}};
      to.numbers.reserve(result.vertices * to.components);
      const bool is_float = from->data_type() == draco::DT_FLOAT32 || from->data_type() == draco::DT_FLOAT64;
      if (!(is_float ? read_values<float>(mesh, *from, to) : read_values<std::int64_t>(mesh, *from, to)))
        return fail(fmt::format("Draco: the attribute {} cannot be read", id));
    }
    return result;
  } catch (const std::exception& problem) {
    return fail(fmt::format("Draco: {}", problem.what()));
  }
}

}  // namespace
}  // namespace penumbra::gltf

/// Looked up by name, see primitive_attributes.cpp.
extern "C" const penumbra::gltf::DracoReader penumbra_draco_reader{penumbra::gltf::read};
