// How readers of other programs' formats report what they cannot represent exactly, beside plain errors.
#pragma once

#include <string>
#include <string_view>

#include "scenes/diagnostic.h"
#include "scenes/scene_description.h"

namespace penumbra {

class ReaderReport {
 public:
  ReaderReport(Diagnostics& diagnostics, bool lenient) : diagnostics_(diagnostics), lenient_(lenient) {}

  void error(SourceLocation location, std::string_view message) { diagnostics_.error(location, message); }
  void warn(SourceLocation location, std::string_view message) { diagnostics_.warn(location, message); }

  /// See Diagnostics::warn_counted.
  void warn_counted(SourceLocation location, std::string_view message) {
    diagnostics_.warn_counted(location, message);
  }

  /// Reports a feature that is not supported: an error, or in lenient mode a warning that ends in `instead`,
  /// "it is left out" for example.
  void unsupported(SourceLocation location, std::string_view message, std::string_view instead);

  /// Calls place_mesh and reports its errors and warnings. Returns whether the mesh can be rendered; a mesh
  /// without triangles cannot.
  bool place(Mesh& mesh, const glm::dmat4& to_world, bool face_normals, const std::string& name,
             SourceLocation location);

  [[nodiscard]] bool full() const { return diagnostics_.full(); }
  [[nodiscard]] bool lenient() const { return lenient_; }

 private:
  Diagnostics& diagnostics_;
  bool lenient_;
};

/// The placeholder colour of a material or texture that could not be read. It is deliberately unnatural.
constexpr glm::vec3 kUnreadColour(0.8f, 0.2f, 0.8f);

}  // namespace penumbra
