#include "scenes/gltf/primitive.h"

#include <fmt/format.h>

#include <algorithm>

namespace penumbra::gltf {

bool is_surface(const tinygltf::Primitive& primitive) {
  return primitive.mode < 0 || primitive.mode == TINYGLTF_MODE_TRIANGLES ||
         primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP || primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

void warn_of_opacity(const Asset& asset, const tinygltf::Primitive& primitive, SourceLocation location,
                     ReaderReport& report) {
  const auto colours = primitive.attributes.find("COLOR_0");
  if (colours == primitive.attributes.end() || primitive.material < 0 ||
      asset.model.materials[std::size_t(primitive.material)].alphaMode == "OPAQUE")
    return;
  const auto attributes = PrimitiveAttributes::open(asset, primitive);
  const auto values = attributes ? attributes->read("COLOR_0", 4, 4) : std::unexpected(attributes.error());
  if (!values || !*values) return;
  for (std::size_t i = 0; i < (*values)->count; ++i)
    if ((*values)->at(i, 3) < 1.0)
      return report.warn_counted(location, "the opacity of vertices (the alpha of COLOR_0) is ignored");
}

Expected<Mesh> read_primitive(const PrimitiveAttributes& attributes, int mode, int texcoord) {
  const std::size_t count = attributes.vertices();
  const auto positions = attributes.read("POSITION", 3, 3);
  if (!positions) return std::unexpected(positions.error());
  const auto normals = attributes.read("NORMAL", 3, 3);
  if (!normals) return std::unexpected(normals.error());
  const auto texcoords = attributes.read(fmt::format("TEXCOORD_{}", std::max(texcoord, 0)), 2, 2);
  if (!texcoords) return std::unexpected(texcoords.error());
  const auto colours = attributes.read("COLOR_0", 3, 4);
  if (!colours) return std::unexpected(colours.error());
  const auto order = attributes.corners();
  if (!order) return std::unexpected(order.error());

  Mesh mesh;
  for (std::size_t i = 0; i < count; ++i) {
    mesh.positions.emplace_back((*positions)->at(i, 0), (*positions)->at(i, 1), (*positions)->at(i, 2));
    if (*normals) mesh.normals.emplace_back((*normals)->at(i, 0), (*normals)->at(i, 1), (*normals)->at(i, 2));
    if (*texcoords) mesh.texcoords.emplace_back((*texcoords)->at(i, 0), (*texcoords)->at(i, 1));
    if (*colours)
      mesh.colours.push_back(glm::clamp(
          glm::vec3((*colours)->at(i, 0), (*colours)->at(i, 1), (*colours)->at(i, 2)), 0.0f, 1.0f));
  }
  const std::vector<std::uint32_t>& c = *order;
  const std::size_t n = c.size();
  if (attributes.is_compressed()) mode = TINYGLTF_MODE_TRIANGLES;
  if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
    for (std::size_t i = 0; i + 2 < n; ++i)
      mesh.triangles.emplace_back(c[i], c[i + 1 + i % 2], c[i + 2 - i % 2]);
  } else if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
    for (std::size_t i = 1; i + 1 < n; ++i) mesh.triangles.emplace_back(c[i], c[i + 1], c[0]);
  } else {
    for (std::size_t i = 0; i + 2 < n; i += 3) mesh.triangles.emplace_back(c[i], c[i + 1], c[i + 2]);
  }
  return mesh;
}

}  // namespace penumbra::gltf
