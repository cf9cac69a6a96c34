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
  if (const std::size_t flat = cleaning->flat_triangles; flat > 0)
    warn(location,
         fmt::format("'{}': left out {} {} without area", name, flat, flat == 1 ? "triangle" : "triangles"));
  if (const std::size_t bad = cleaning->bad_normals; bad > 0)
    warn(location, fmt::format("'{}': {} missing or of no length; computed from the faces", name,
                               bad == 1 ? "1 normal is" : fmt::format("{} normals are", bad)));
  if (!mesh.triangles.empty()) return true;
  warn(location, fmt::format("'{}' has no triangles; it is left out", name));
  return false;
}

}  // namespace penumbra
