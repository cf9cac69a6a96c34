#include "scenes/gltf/primitive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/gltf/accessor.h"

namespace penumbra::gltf {
namespace {

/// An attribute of each vertex; nothing where there is none of that name.
Expected<std::optional<AccessorValues>> attribute(const Asset& asset, const tinygltf::Primitive& primitive,
                                                  const std::string& name, std::size_t least,
                                                  std::size_t most, std::size_t vertices) {
  const auto found = primitive.attributes.find(name);
  if (found == primitive.attributes.end()) return std::optional<AccessorValues>();
  auto values = read_accessor(asset, found->second, least, most);
  if (!values) return fail(fmt::format("{}: {}", name, values.error().message));
  if (values->count != vertices)
    return fail(fmt::format("{} of {} vertices, where there are {}", name, values->count, vertices));
  return std::optional<AccessorValues>(std::move(*values));
}

Expected<std::vector<std::uint32_t>> corners(const Asset& asset, const tinygltf::Primitive& primitive,
                                             std::size_t vertices) {
  std::vector<std::uint32_t> result;
  if (primitive.indices < 0) {
    for (std::size_t i = 0; i < vertices; ++i) result.push_back(std::uint32_t(i));
    return result;
  }
  const auto indices = read_accessor(asset, primitive.indices, 1, 1);
  if (!indices) return fail(fmt::format("indices: {}", indices.error().message));
  result.reserve(indices->count);
  for (const double index : indices->numbers) {
    if (!(index >= 0 && index < double(vertices) && index == std::floor(index)))
      return fail(fmt::format("an index {}, where there are {} vertices", index, vertices));
    result.push_back(std::uint32_t(index));
  }
  return result;
}

}  // namespace

bool is_surface(const tinygltf::Primitive& primitive) {
  return primitive.mode < 0 || primitive.mode == TINYGLTF_MODE_TRIANGLES ||
         primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP || primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

Expected<Mesh> read_primitive(const Asset& asset, const tinygltf::Primitive& primitive, int texcoord) {
  const auto position = primitive.attributes.find("POSITION");
  if (position == primitive.attributes.end()) return fail("a primitive without POSITION");
  const auto positions = read_accessor(asset, position->second, 3, 3);
  if (!positions) return fail(fmt::format("POSITION: {}", positions.error().message));
  const std::size_t count = positions->count;
  const auto normals = attribute(asset, primitive, "NORMAL", 3, 3, count);
  if (!normals) return std::unexpected(normals.error());
  const auto texcoords =
      attribute(asset, primitive, fmt::format("TEXCOORD_{}", std::max(texcoord, 0)), 2, 2, count);
  if (!texcoords) return std::unexpected(texcoords.error());
  const auto colours = attribute(asset, primitive, "COLOR_0", 3, 4, count);
  if (!colours) return std::unexpected(colours.error());
  const auto order = corners(asset, primitive, count);
  if (!order) return std::unexpected(order.error());

  Mesh mesh;
  for (std::size_t i = 0; i < count; ++i) {
    mesh.positions.emplace_back(positions->at(i, 0), positions->at(i, 1), positions->at(i, 2));
    if (*normals) mesh.normals.emplace_back((*normals)->at(i, 0), (*normals)->at(i, 1), (*normals)->at(i, 2));
    if (*texcoords) mesh.texcoords.emplace_back((*texcoords)->at(i, 0), (*texcoords)->at(i, 1));
    if (*colours)
      mesh.colours.push_back(glm::clamp(
          glm::vec3((*colours)->at(i, 0), (*colours)->at(i, 1), (*colours)->at(i, 2)), 0.0f, 1.0f));
  }
  const std::vector<std::uint32_t>& c = *order;
  const std::size_t n = c.size();
  if (primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
    for (std::size_t i = 0; i + 2 < n; ++i)
      mesh.triangles.emplace_back(c[i], c[i + 1 + i % 2], c[i + 2 - i % 2]);
  } else if (primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN) {
    for (std::size_t i = 1; i + 1 < n; ++i) mesh.triangles.emplace_back(c[i], c[i + 1], c[0]);
  } else {
    for (std::size_t i = 0; i + 2 < n; i += 3) mesh.triangles.emplace_back(c[i], c[i + 1], c[i + 2]);
  }
  return mesh;
}

}  // namespace penumbra::gltf
