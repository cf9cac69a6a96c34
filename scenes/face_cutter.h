// Faces of mesh files as triangles, the same way for every format, with account of the odd ones.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/diagnostic.h"

namespace penumbra {

/// Six decimals, as exporters write them, on a face of a thousandth of the scene's unit.
constexpr double kFlatFace = 1e-3;

/// Faces with something odd about them.
struct OddFaces {
  std::size_t count = 0;
  SourceLocation first;    ///< no file where the first has no line: in a PLY file
  std::string first_name;  ///< "m.obj:6:1", "face 3"
};

struct FaceFindings {
  OddFaces warped;  ///< not flat: a corner is further off the face's plane than kFlatFace of its extent
  double deviation = 0.0;  ///< the most that one is off, of its extent
  OddFaces tangled;        ///< they cross themselves (see Triangulation)
  OddFaces too_short;      ///< of fewer than three corners, which are left out
  OddFaces untextured;     ///< a corner lacks the texture coordinates that others of the mesh have
};

/// "2 faces are not flat (by up to 0.1 of its extent); cut into flat triangles".
std::string describe_warped(const FaceFindings& findings);
/// "1 face folds over or back on itself; cut into fans of triangles that overlap".
std::string describe_tangled(const FaceFindings& findings);
/// "2 faces have fewer than 3 corners; they are left out".
std::string describe_too_short(const FaceFindings& findings);
/// "1 face has corners without texture coordinates; (0, 0) stands in for them".
std::string describe_untextured(const FaceFindings& findings);

/// What all formats warn of, each with the first face that it is about: all but that faces are warped.
std::vector<std::string> describe(const FaceFindings& findings);

/// One more face of that kind: at `location`, or without a file called `name`.
void note(OddFaces& faces, SourceLocation location, std::string_view name);

/// Cuts the face whose corners lie at `outline` (see triangulate) and adds its triangles, over the vertices
/// of the same numbers; none where there are fewer than three. It is at `location`, or without a file the one
/// called `name`.
Expected<void> cut_face(std::span<const glm::dvec3> outline, std::span<const std::uint32_t> vertices,
                        SourceLocation location, std::string_view name, std::vector<glm::uvec3>& triangles,
                        FaceFindings& findings);

}  // namespace penumbra
