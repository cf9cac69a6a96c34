// Meshes of a few polygons, and their files.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "tests/differential/random.h"

namespace penumbra::differential {

/// Inside the unit sphere.
struct Polyhedron {
  std::vector<glm::dvec3> positions;
  std::vector<glm::dvec3> normals;          ///< one for each position, or empty
  std::vector<std::vector<int>> faces;      ///< polygons, counterclockwise as seen from outside
  std::vector<std::vector<int>> triangles;  ///< the same surface
};

Polyhedron tetrahedron();
/// With unit normals, `rows` by `columns` quadrilaterals as triangles; `part` below 1 leaves out the lower
/// part.
Polyhedron ball(int rows, int columns, double part);
/// A ring with normals.
Polyhedron ring(int rows, int columns);
/// The same surfaces without normals, in quadrilaterals.
Polyhedron faceted(Polyhedron smooth);
/// A flat regular polygon in the plane z = 0, in one face.
Polyhedron plate(int corners);
/// A flat concave polygon in the plane z = 0, in one face: a star with so many points.
Polyhedron star(int points);
/// Both a star's faces, and walls between them.
Polyhedron star_prism(int points);

struct MeshFile {
  std::string name, text;
};

/// As OBJ; `from_end`: indices are negative ones.
std::string obj_text(const Polyhedron& mesh, bool triangles, bool from_end = false, bool texcoords = false);
/// As PLY in one of its three formats, with extra properties or without.
std::string ply_text(const Polyhedron& mesh, bool triangles, Random& random);

}  // namespace penumbra::differential
