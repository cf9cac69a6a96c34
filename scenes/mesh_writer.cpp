#include "scenes/mesh_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <initializer_list>

namespace penumbra {

std::string ply_of(const Mesh& mesh) {
  const bool normals = !mesh.normals.empty(), uvs = !mesh.texcoords.empty();
  const bool colours = !mesh.colours.empty(), faces = !mesh.face_colours.empty();
  const bool tangents = !mesh.tangents.empty();
  std::string out =
      fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.positions.size());
  const auto properties = [&](const char* type, std::initializer_list<const char*> names) {
    for (const char* name : names) out += fmt::format("property {} {}\n", type, name);
  };
  properties("double", {"x", "y", "z"});
  if (normals) properties("float", {"nx", "ny", "nz"});
  if (uvs) properties("float", {"u", "v"});
  if (colours) properties("float", {"r", "g", "b"});
  out += fmt::format("element face {}\nproperty list uchar uint vertex_indices\n", mesh.triangles.size());
  if (faces) properties("float", {"r", "g", "b"});
  if (tangents) properties("list uchar float", {"tangents"});
  out += "end_header\n";
  const auto bytes = [&](const auto& value) {
    auto raw = std::bit_cast<std::array<char, sizeof(value)>>(value);
    if constexpr (std::endian::native == std::endian::big) std::ranges::reverse(raw);
    out.append(raw.data(), raw.size());
  };
  const auto vector = [&](const auto& v) {
    for (int axis = 0; axis < v.length(); ++axis) bytes(v[axis]);
  };
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    vector(mesh.positions[i]);
    if (normals) vector(mesh.normals[i]);
    if (uvs) vector(mesh.texcoords[i]);
    if (colours) vector(mesh.colours[i]);
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    out += char(3);
    vector(mesh.triangles[i]);
    if (faces) vector(mesh.face_colours[i]);
    if (!tangents) continue;
    out += char(12);
    for (const glm::vec4& tangent : mesh.tangents[i]) vector(tangent);
  }
  return out;
}

}  // namespace penumbra
