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

/// Positions, faces (see triangulate), texture coordinates and normals as the file has them, in the file's
/// own space. Corners with the same position, texture and normal index share a vertex. Where some corners
/// lack a normal or texture coordinates that others have, theirs are zero: place_mesh computes such normals.
/// Faces of fewer than three corners are left out. Groups, materials, lines and points are passed over.
/// Warnings: unknown statements, indices of normals and texture coordinates that the file does not have.
/// Errors, with line and column: malformed or non-finite numbers, other indices out of range, faces that
/// cannot be cut into triangles, a file of nothing but unknown statements.
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
  std::vector<std::string> warnings;
};

/// Like read_obj, but with one mesh per object and material.
Expected<ObjModel> read_obj_groups(const SourceFile& file);

/// The same of a PLY file, ascii or binary of either byte order, whatever the order and types of its
/// properties: x y z, nx ny nz, and u v (or s t, texture_u texture_v) of `vertex`, vertex_indices (or
/// vertex_index) of `face`, those of `tristrips`, whose strips end at -1. Other elements and properties are
/// passed over; a file of points alone has no triangles, and a warning. Lines of the header end as its first
/// one does, with LF, CR LF or CR. Errors: as of read_obj (binary: with the vertex's or face's number), a
/// file that ends early.
/// Colours of vertices and faces are the attributes of these names, as Mitsuba 3 has them: NAME is made of
/// the properties NAME_0, NAME_1, NAME_2 (or of other endings; a single one is grey), of P_r, P_g, P_b where
/// NAME is P_color, and `color` of red, green, blue (or r, g, b), too.
Expected<MeshFile> read_ply(const SourceFile& file, const MeshAttributeNames& attributes = {});

/// The mesh number `index`, counted from 0, of a serialized file of Mitsuba (version 3 or 4). Numbers may be
/// in single or double precision; normals, texture coordinates and colours are optional. Errors: another
/// format or version, no mesh of that index, data that are damaged or end early, numbers that are not finite,
/// indices out of range.
Expected<MeshFile> read_serialized(const SourceFile& file, std::int64_t index);

}  // namespace penumbra
