// The parameters of shapes, a row for every one (see bsdfs.h).
#pragma once

#include <string>
#include <variant>

#include "scenes/plugin_values.h"

namespace penumbra::mitsuba {

/// What all shapes have.
struct PlacedShape {
  glm::dmat4 to_world{1.0};
  bool flip_normals = false;

  template <typename Shape, typename Row>
  static void placement(const Row& row) {
    row("to_world", &Shape::to_world, AnyTransform{}, "where it is");
    row("flip_normals", &Shape::flip_normals, TrueOrFalse{}, "whether its front is the other side");
  }
};

template <typename Shape>
struct MeshFileShape : PlacedShape {
  std::string filename;
  bool face_normals = false;
  bool flip_tex_coords = Shape::kFlips;

  template <typename Row>
  static void parameters(const Row& row) {
    placement<Shape>(row);
    row("filename", &Shape::filename, FileName{}, "the mesh");
    row("face_normals", &Shape::face_normals, TrueOrFalse{}, "whether vertex normals are ignored");
    row("flip_tex_coords", &Shape::flip_tex_coords, TrueOrFalse{}, "whether v counts from the top");
  }
};
struct ObjShape : MeshFileShape<ObjShape> {
  static constexpr bool kFlips = true;
  static constexpr const char* kPlugin = "obj";
  static constexpr const char* kText = "triangles and polygons of a Wavefront file";
};
struct PlyShape : MeshFileShape<PlyShape> {
  static constexpr bool kFlips = false;
  static constexpr const char* kPlugin = "ply";
  static constexpr const char* kText = "triangles and polygons of a PLY file, text or binary";
};

struct SphereShape : PlacedShape {
  static constexpr const char* kPlugin = "sphere";
  static constexpr const char* kText = "a sphere; its transform scales all directions alike";
  glm::dvec3 center{0.0};
  double radius = 1.0;

  template <typename Row>
  static void parameters(const Row& row) {
    placement<SphereShape>(row);
    row("center", &SphereShape::center, AnyPoint{}, "its centre");
    row("radius", &SphereShape::radius, AnyNumber{"number above 0"}, "its radius");
  }
};

/// One that has no parameters of its own.
template <typename Shape>
struct PlainShape : PlacedShape {
  template <typename Row>
  static void parameters(const Row& row) {
    placement<Shape>(row);
  }
};
struct DiskShape : PlainShape<DiskShape> {
  static constexpr const char* kPlugin = "disk";
  static constexpr const char* kText = "the unit disk, which faces z";
};
struct RectangleShape : PlainShape<RectangleShape> {
  static constexpr const char* kPlugin = "rectangle";
  static constexpr const char* kText = "the square from (-1, -1, 0) to (1, 1, 0), which faces z";
};
struct CubeShape : PlainShape<CubeShape> {
  static constexpr const char* kPlugin = "cube";
  static constexpr const char* kText = "the cube from (-1, -1, -1) to (1, 1, 1), which faces outwards";
};

using ShapeParameters = std::variant<ObjShape, PlyShape, SphereShape, DiskShape, RectangleShape, CubeShape>;

}  // namespace penumbra::mitsuba
