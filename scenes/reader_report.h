// What readers of other programs' formats say of what they cannot read as it is, beside plain errors.
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

  /// What there is no counterpart for: an error, or with leniency a warning that ends in `instead`, "it is
  /// left out" for example.
  void unsupported(SourceLocation location, std::string_view message, std::string_view instead);

  /// place_mesh, with an error or warnings for what it finds. Whether the mesh is fit to render, which one
  /// without triangles is not.
  bool place(Mesh& mesh, const glm::dmat4& to_world, bool face_normals, const std::string& name,
             SourceLocation location);

  [[nodiscard]] bool full() const { return diagnostics_.full(); }
  [[nodiscard]] bool lenient() const { return lenient_; }

 private:
  Diagnostics& diagnostics_;
  bool lenient_;
};

/// What stands in for a material or a texture that is not read: nothing in nature has this colour.
constexpr glm::vec3 kUnreadColour(0.8f, 0.2f, 0.8f);

}  // namespace penumbra
