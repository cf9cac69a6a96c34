#include "scenes/mitsuba/deforming_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "scenes/mesh_tools.h"
#include "scenes/transform.h"

namespace penumbra::mitsuba {

bool DeformingMesh::changes() const {
  return std::ranges::any_of(deformation->targets, [](const MorphTarget& target) {
    return !target.positions.empty() || !target.normals.empty();
  });
}

std::shared_ptr<const DeformingMesh> deforming_mesh(std::vector<Mesh> meshes, std::span<const TextKey> files,
                                                    const glm::dmat4& to_world, Diagnostics& diagnostics) {
  const Mesh& first = meshes.front();
  std::vector<double> times;
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    const Mesh& mesh = meshes[k];
    times.push_back(files[k].time);
    const bool fits =
        mesh.positions.size() == first.positions.size() && mesh.triangles.size() == first.triangles.size();
    if (fits && mesh.normals.empty() == first.normals.empty()) continue;
    const auto numbers = [&](const Mesh& of) {
      return fmt::format("{} vertices, {} triangles, {}", of.positions.size(), of.triangles.size(),
                         of.normals.empty() ? "no normals" : "normals");
    };
    diagnostics.error(
        files[k].location,
        fmt::format("'{}' has {}; '{}' at {} s has {}. The files of a mesh over time differ in "
                    "positions and in the values of normals alone",
                    files[k].text, numbers(mesh), files.front().text, files.front().time, numbers(first)));
    return nullptr;
  }
  auto deformation = std::make_shared<const MeshDeformation>(deformation_between(meshes, times));
  Mesh& rest = meshes.front();
  // A place that mirrors reverses the winding of a mesh without normals, which here stays that of the file.
  if (rest.normals.empty() && is_mirror(to_world))
    for (std::size_t i = 0; i < rest.triangles.size(); ++i) turn_over(rest, i);
  return std::make_shared<const DeformingMesh>(std::move(rest), std::move(deformation), to_world);
}

}  // namespace penumbra::mitsuba
