#include "scenes/face_cutter.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/polygon_triangulation.h"

namespace penumbra {

void note(OddFaces& faces, SourceLocation location, std::string_view name) {
  if (faces.count++ > 0) return;
  faces.first = location;
  faces.first_name = location.file != nullptr ? describe(location) : std::string(name);
}

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

std::string describe_too_short(const FaceFindings& findings) {
  const std::size_t count = findings.too_short.count;
  return count == 1 ? "1 face has fewer than 3 corners; it is left out"
                    : fmt::format("{} faces have fewer than 3 corners; they are left out", count);
}

std::string describe_untextured(const FaceFindings& findings) {
  const std::size_t count = findings.untextured.count;
  return fmt::format("{} {} corners without texture coordinates; (0, 0) stands in for them", count,
                     count == 1 ? "face has" : "faces have");
}

std::vector<std::string> describe(const FaceFindings& findings) {
  std::vector<std::string> texts;
  const auto add = [&](const OddFaces& faces, std::string (*text)(const FaceFindings&)) {
    if (faces.count > 0)
      texts.push_back(fmt::format("{}; the first is {}", text(findings), faces.first_name));
  };
  add(findings.tangled, describe_tangled);
  add(findings.too_short, describe_too_short);
  add(findings.untextured, describe_untextured);
  return texts;
}

Expected<void> cut_face(std::span<const glm::dvec3> outline, std::span<const std::uint32_t> vertices,
                        SourceLocation location, std::string_view name, std::vector<glm::uvec3>& triangles,
                        FaceFindings& findings) {
  if (vertices.size() < 3) {
    note(findings.too_short, location, name);
    return {};
  }
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
