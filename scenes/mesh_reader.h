// Reads triangle meshes from Wavefront OBJ, Stanford PLY and Mitsuba's serialized files.
#pragma once

#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/diagnostic.h"
#include "scenes/face_cutter.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// The names of the vertex attribute and of the face attribute that become a mesh's colours.
struct MeshAttributeNames {
  std::string vertex = "color", face = "color";
};

/// The mesh of a whole file.
struct MeshFile {
  Mesh mesh;
  FaceFindings faces;
  bool face_normals = false;  ///< the file asks for face normals instead of vertex normals
  std::vector<std::string> warnings = {};
};

/// The mesh of an OBJ file in the file's own space: positions, faces (see triangulate), texture coordinates
/// and normals. Corners with the same position, texture and normal index share a vertex. If only some corners
/// have a normal or texture coordinates, those of the others are zero; place_mesh then computes their
/// normals. Faces of fewer than three corners are left out. Groups, materials, lines and points are ignored.
/// Errors, with line and column: unknown statements, malformed or non-finite numbers, indices out of range,
/// faces that cannot be cut into triangles.
Expected<MeshFile> read_obj(const SourceFile& file);

/// A name and where it was read.
struct ObjName {
  std::string name;
  SourceLocation location;
};

/// All faces of one object (or group) and one material. They need not be adjacent in the file.
struct ObjGroup {
  std::string object;       ///< from the last `o` or `g`; empty: none
  ObjName material;         ///< from `usemtl`; an empty name: none
  SourceLocation location;  ///< of the first face
  Mesh mesh;
  FaceFindings faces;
};

struct ObjModel {
  std::vector<ObjName> libraries;  ///< from `mtllib`; each is the rest of a line
  std::vector<ObjGroup> groups;    ///< in the order of their first faces
};

/// Like read_obj, but with one mesh per object and material.
Expected<ObjModel> read_obj_groups(const SourceFile& file);

/// The mesh of a PLY file, ascii or binary, little- or big-endian. It uses the properties x y z, nx ny nz,
/// and u v (or s t, texture_u texture_v) of `vertex`, and vertex_indices (or vertex_index) of `face`, in any
/// order and of any type. Other elements and properties are ignored. Errors: those of read_obj (for binary
/// files with the number of the vertex or face); a file that ends early. Colours are the attributes of the
/// given names, as in Mitsuba 3: the attribute NAME consists of the properties NAME_0, NAME_1, NAME_2 (or
/// with other suffixes; a single property is grey). P_color consists of P_r, P_g, P_b, and `color` also of
/// red, green, blue (or r, g, b).
Expected<MeshFile> read_ply(const SourceFile& file, const MeshAttributeNames& attributes = {});

/// The mesh number `index`, counted from 0, of a serialized file of Mitsuba (version 3 or 4). Numbers may be
/// in single or double precision; normals, texture coordinates and colours are optional. Errors: another
/// format or version, no mesh of that index, data that are damaged or end early, numbers that are not finite,
/// indices out of range.
Expected<MeshFile> read_serialized(const SourceFile& file, std::int64_t index);

}  // namespace penumbra
