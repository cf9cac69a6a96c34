#include "scenes/face_cutter.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/polygon_triangulation.h"

namespace penumbra {
namespace {

void note(OddFaces& faces, SourceLocation location, std::string_view name) {
  if (faces.count++ > 0) return;
  faces.first = location;
  faces.first_name = location.file != nullptr ? describe(location) : std::string(name);
}

}  // namespace

std::string describe_warped(const FaceFindings& findings) {
  const std::size_t count = findings.warped.count;
  return fmt::format("{} {} not flat (by up to {:.2g} of its extent); cut into flat triangles", count,
                     count == 1 ? "face is" : "faces are", findings.deviation);
}

std::string describe_tangled(const FaceFindings& findings) {
  const std::size_t count = findings.tangled.count;
  return fmt::format("{}; cut into fans of triangles that overlap",
                     count == 1 ? "1 face folds over or back on itself"
                                : fmt::format("{} faces fold over or back on themselves", count));
}

Expected<void> cut_face(std::span<const glm::dvec3> outline, std::span<const std::uint32_t> vertices,
                        SourceLocation location, std::string_view name, std::vector<glm::uvec3>& triangles,
                        FaceFindings& findings) {
  if (vertices.size() == 3) {  // most faces are
    triangles.emplace_back(vertices[0], vertices[1], vertices[2]);
    return {};
  }
  const auto cut = triangulate(outline);
  if (!cut) return std::unexpected(cut.error());
  for (const glm::uvec3& t : cut->triangles)
    triangles.emplace_back(vertices[t.x], vertices[t.y], vertices[t.z]);
  if (cut->deviation > kFlatFace) note(findings.warped, location, name);
  findings.deviation = std::max(findings.deviation, cut->deviation);
  if (cut->tangled) note(findings.tangled, location, name);
  return {};
}

}  // namespace penumbra
