#include "scenes/reader_report.h"

#include <fmt/format.h>

#include "scenes/mesh_tools.h"

namespace penumbra {

void ReaderReport::unsupported(SourceLocation location, std::string_view message, std::string_view instead) {
  if (lenient_)
    warn(location, fmt::format("{}; {}", message, instead));
  else
    error(location, message);
}

bool ReaderReport::place(Mesh& mesh, const glm::dmat4& to_world, bool face_normals, const std::string& name,
                         SourceLocation location) {
  const auto cleaning = place_mesh(mesh, to_world, face_normals);
  if (!cleaning) {
    error(location, fmt::format("'{}': {}", name, cleaning.error().message));
    return false;
  }
  for (const std::string& text : describe(*cleaning)) warn(location, fmt::format("'{}': {}", name, text));
  if (!mesh.triangles.empty()) return true;
  warn(location, fmt::format("'{}' has no triangles; it is left out", name));
  return false;
}

}  // namespace penumbra
