// The parameters of shapes, one table row for each (see bsdfs.h).
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <variant>

#include "scenes/plugin_values.h"

namespace penumbra::mitsuba {

/// The parameters that all shapes have.
struct PlacedShape {
  glm::dmat4 to_world{1.0};
  bool flip_normals = false;

  template <typename Shape, typename Row>
  static void placement(const Row& row) {
    row("to_world", &Shape::to_world, AnyTransform{}, "where it is");
    row("flip_normals", &Shape::flip_normals, TrueOrFalse{}, "whether its front is the other side");
  }
};

/// The tangents of meshes that files describe, for normal maps and anisotropy.
struct MeshTangents {
  bool mikktspace = false;
  bool mirrored_maps = false;

  template <typename Shape, typename Row>
  static void tangents(const Row& row) {
    row("tangents", &Shape::mikktspace, OneOf<bool>{{{"triangle", false}, {"mikktspace", true}}},
        "directions of u for normal maps and anisotropy, unless the file has some: of each triangle, or "
        "MikkTSpace's");
    row("mirrored_maps", &Shape::mirrored_maps, TrueOrFalse{},
        "whether normal maps are mirrored where the texture is, as in most programs, but not in Mitsuba; "
        "needs tangents");
  }
};

template <typename Shape>
struct MeshFileShape : PlacedShape, MeshTangents {
  std::string filename;
  bool face_normals = false;
  bool flip_tex_coords = Shape::kFlips;
  double max_smooth_angle = 0;  ///< degrees; 0: vertex normals are those of the file, or smooth

  template <typename Row>
  static void parameters(const Row& row) {
    placement<Shape>(row);
    row("filename", &Shape::filename, FileName{}, "the mesh");
    row("face_normals", &Shape::face_normals, TrueOrFalse{}, "whether vertex normals are ignored");
    row("flip_tex_coords", &Shape::flip_tex_coords, TrueOrFalse{}, "whether v counts from the top");
    max_smooth_angle_row(row);
    tangents<Shape>(row);
  }
  template <typename Row>
  static void max_smooth_angle_row(const Row& row) {
    row("max_smooth_angle", &Shape::max_smooth_angle, AnyNumber{"number in (0, 180]"},
        "normals are computed: faces that meet at more than this, in degrees, have an edge between them");
  }
  void complete(Findings& findings) const {
    if (!(max_smooth_angle >= 0 && max_smooth_angle <= 180))
      findings.push_back({"max_smooth_angle", "max_smooth_angle must be a number in (0, 180]"});
    if (max_smooth_angle > 0 && face_normals)
      findings.push_back({"max_smooth_angle", "either max_smooth_angle or face_normals, not both"});
  }
};
struct ObjShape : MeshFileShape<ObjShape> {
  static constexpr bool kFlips = true;
  static constexpr const char* kPlugin = "obj";
  static constexpr const char* kText = "Wavefront OBJ file";
};
struct PlyShape : MeshFileShape<PlyShape> {
  static constexpr bool kFlips = false;
  static constexpr const char* kPlugin = "ply";
  static constexpr const char* kText = "PLY file, text or binary";
};

struct SerializedShape : MeshFileShape<SerializedShape> {
  static constexpr bool kFlips = false;
  static constexpr const char* kPlugin = "serialized";
  static constexpr const char* kText = "Mitsuba's compressed mesh file";
  std::int64_t shape_index = 0;

  template <typename Row>
  static void parameters(const Row& row) {
    placement<SerializedShape>(row);
    row("filename", &SerializedShape::filename, FileName{}, "the file");
    row("shape_index", &SerializedShape::shape_index, WholeNumber{0, std::numeric_limits<int>::max()},
        "which of its meshes, from 0 on");
    row("face_normals", &SerializedShape::face_normals, TrueOrFalse{}, "whether vertex normals are ignored");
    max_smooth_angle_row(row);
    tangents<SerializedShape>(row);
  }
};

struct SphereShape : PlacedShape {
  static constexpr const char* kPlugin = "sphere";
  static constexpr const char* kText = "sphere; its transform scales all directions alike";
  glm::dvec3 center{0.0};
  double radius = 1.0;

  template <typename Row>
  static void parameters(const Row& row) {
    placement<SphereShape>(row);
    row("center", &SphereShape::center, AnyPoint{}, "its centre");
    row("radius", &SphereShape::radius, AnyNumber{"number above 0"}, "its radius");
  }
};

struct CylinderShape : PlacedShape {
  static constexpr const char* kPlugin = "cylinder";
  static constexpr const char* kText =
      "cylinder without caps; its transform scales all directions across the axis alike";
  glm::dvec3 p0{0.0}, p1{0.0, 0.0, 1.0};
  double radius = 1.0;

  template <typename Row>
  static void parameters(const Row& row) {
    placement<CylinderShape>(row);
    row("p0", &CylinderShape::p0, AnyPoint{}, "centre of one end");
    row("p1", &CylinderShape::p1, AnyPoint{}, "centre of the other");
    row("radius", &CylinderShape::radius, AnyNumber{"number above 0"}, "its radius");
  }
};

/// The heightfield of Mitsuba 0.6.
struct HeightfieldShape : PlacedShape {
  static constexpr const char* kPlugin = "heightfield";
  static constexpr const char* kText =
      "square with the heights of an image; from (-1, -1) to (1, 1), by `filename` or a nested texture";
  std::string filename;
  double scale = 1.0;
  bool shading_normals = true;

  template <typename Row>
  static void parameters(const Row& row) {
    placement<HeightfieldShape>(row);
    row("filename", &HeightfieldShape::filename, FileName{}, "the image");
    row("scale", &HeightfieldShape::scale, AnyNumber{"finite number"}, "the height of white");
    row("shading_normals", &HeightfieldShape::shading_normals, TrueOrFalse{},
        "whether it is smooth; else it is faceted");
  }
  void complete(Findings& findings) const {
    if (!std::isfinite(scale)) findings.push_back({"scale", "scale must be a finite number"});
  }
};

/// Curves from a text file. `to_world` does not scale their thickness.
template <typename Shape>
struct CurvesShape : PlacedShape {
  std::string filename;

  template <typename Row>
  static void parameters(const Row& row) {
    placement<Shape>(row);
    row("filename", &Shape::filename, FileName{},
        "the file: a line \"x y z radius\" a point, an empty one a curve");
  }
};
struct BsplineCurveShape : CurvesShape<BsplineCurveShape> {
  static constexpr const char* kPlugin = "bsplinecurve";
  static constexpr const char* kText = "hair and tubes along cubic B-splines";
  CurveForm form = CurveForm::kRound;

  template <typename Row>
  static void parameters(const Row& row) {
    CurvesShape<BsplineCurveShape>::parameters(row);
    row("form", &BsplineCurveShape::form,
        OneOf<CurveForm>{
            {{"round", CurveForm::kRound}, {"flat", CurveForm::kFlat}, {"cylinder", CurveForm::kCylinder}}},
        "tubes, or as in pbrt ribbons that face each ray, flat or with the normals of tubes. Not in Mitsuba");
  }
};
struct LinearCurveShape : CurvesShape<LinearCurveShape> {
  static constexpr const char* kPlugin = "linearcurve";
  static constexpr const char* kText = "hair and tubes along straight segments";
};

struct SdfGridShape : PlacedShape {
  static constexpr const char* kPlugin = "sdfgrid";
  static constexpr const char* kText = "surface where the signed distances of a grid are 0, as triangles";
  std::string filename;
  bool analytic = false;

  template <typename Row>
  static void parameters(const Row& row) {
    placement<SdfGridShape>(row);
    row("filename", &SdfGridShape::filename, FileName{}, "the volume file");
    row("normals", &SdfGridShape::analytic, OneOf<bool>{{{"smooth", false}, {"analytic", true}}},
        "smooth whatever this says");
  }
};

/// A shape without parameters of its own.
template <typename Shape>
struct PlainShape : PlacedShape {
  template <typename Row>
  static void parameters(const Row& row) {
    placement<Shape>(row);
  }
};
struct DiskShape : PlainShape<DiskShape> {
  static constexpr const char* kPlugin = "disk";
  static constexpr const char* kText =
      "unit disk that faces z; one that its transform makes elliptic is a polygon of 512 sides";
};
struct RectangleShape : PlainShape<RectangleShape> {
  static constexpr const char* kPlugin = "rectangle";
  static constexpr const char* kText = "square from (-1, -1, 0) to (1, 1, 0) that faces z";
};
struct CubeShape : PlainShape<CubeShape> {
  static constexpr const char* kPlugin = "cube";
  static constexpr const char* kText = "cube from (-1, -1, -1) to (1, 1, 1)";
};

/// A shape without any parameters.
struct BareShape {
  template <typename Row>
  static void parameters(const Row&) {}
};
struct ShapeGroupShape : BareShape {
  static constexpr const char* kPlugin = "shapegroup";
  static constexpr const char* kText =
      "shapes that instances place, stored once; it may hold instances of other groups";
};
struct MergeShape : BareShape {
  static constexpr const char* kPlugin = "merge";
  static constexpr const char* kText = "several shapes as one, each with its own material";
};
struct InstanceShape {
  static constexpr const char* kPlugin = "instance";
  static constexpr const char* kText = "a `shapegroup` in a place; it holds the group, or refers to it";
  glm::dmat4 to_world{1.0};

  template <typename Row>
  static void parameters(const Row& row) {
    row("to_world", &InstanceShape::to_world, AnyTransform{}, "where it is");
  }
};

using ShapeParameters =
    std::variant<ObjShape, PlyShape, SerializedShape, SphereShape, CylinderShape, DiskShape, RectangleShape,
                 CubeShape, HeightfieldShape, BsplineCurveShape, LinearCurveShape, SdfGridShape,
                 ShapeGroupShape, InstanceShape, MergeShape>;

}  // namespace penumbra::mitsuba
