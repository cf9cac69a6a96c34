// Cuts the faces of mesh files into triangles, the same way for every format, and counts the faces that need
// a warning.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/diagnostic.h"

namespace penumbra {

/// Tolerance for planar faces, relative to the face's extent. Exporters write six decimals, and a face may be
/// as small as a thousandth of the scene's unit.
constexpr double kFlatFace = 1e-3;

/// Faces with the same defect.
struct OddFaces {
  std::size_t count = 0;
  SourceLocation first;    ///< without a file if the first such face has no line, as in a PLY file
  std::string first_name;  ///< "m.obj:6:1", "face 3"
};

struct FaceFindings {
  OddFaces warped;  ///< not planar: a corner is farther from the face's plane than kFlatFace times its extent
  double deviation = 0.0;  ///< the largest such distance, relative to the face's extent
  OddFaces tangled;        ///< the outline crosses itself (see Triangulation)
  OddFaces too_short;      ///< fewer than three corners; the face is left out
  OddFaces untextured;     ///< some corners lack texture coordinates although others of the mesh have them
};

/// "2 faces are not flat (by up to 0.1 of its extent); cut into flat triangles".
std::string describe_warped(const FaceFindings& findings);
/// "1 face folds over or back on itself; cut into fans of triangles that overlap".
std::string describe_tangled(const FaceFindings& findings);
/// "2 faces have fewer than 3 corners; they are left out".
std::string describe_too_short(const FaceFindings& findings);
/// "1 face has corners without texture coordinates; (0, 0) stands in for them".
std::string describe_untextured(const FaceFindings& findings);

/// The warnings common to all formats, each with the first face concerned. Faces that are not planar are not
/// included.
std::vector<std::string> describe(const FaceFindings& findings);

/// Counts one more such face. It is at `location`, or, without a file, it is called `name`.
void note(OddFaces& faces, SourceLocation location, std::string_view name);

/// Cuts one face into triangles (see triangulate) and appends them. `outline` holds the positions of its
/// corners and `vertices` their vertex indices. A face of fewer than three corners yields no triangle. The
/// face is at `location`, or, without a file, it is called `name`.
Expected<void> cut_face(std::span<const glm::dvec3> outline, std::span<const std::uint32_t> vertices,
                        SourceLocation location, std::string_view name, std::vector<glm::uvec3>& triangles,
                        FaceFindings& findings);

}  // namespace penumbra
