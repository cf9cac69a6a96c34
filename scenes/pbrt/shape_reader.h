// Reads the shapes of pbrt.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "scenes/pbrt/bspline_curves.h"
#include "scenes/pbrt/material_reader.h"
#include "scenes/pbrt/medium_reader.h"
#include "scenes/pbrt/mesh_faces.h"

namespace penumbra::pbrt {

class ShapeReader {
 public:
  ShapeReader(Context& context, TextureReader& textures, MaterialReader& materials, MediumReader& media)
      : context_(context), textures_(textures), materials_(materials), media_(media) {}

  /// Reads a Shape directive and adds the shape to the scene, or to the object that is being defined.
  void read(const std::string& type, Parameters& parameters, const GraphicsState& state,
            SourceLocation location);

  /// Begins and ends an object definition. Shapes read in between appear only through instances of the
  /// object.
  void begin_object(const std::string& name, SourceLocation location);
  void end_object();
  [[nodiscard]] bool in_object() const { return object_ >= 0; }
  void place_object(const std::string& name, const TransformPair& to_world, SourceLocation location);

  /// Assigns materials and media to all shapes. Call it when both are known.
  void finish();

 private:
  using Geometry = decltype(Shape::geometry);
  std::optional<Geometry> triangle_mesh(Parameters& parameters, SourceLocation location);
  std::optional<Geometry> bilinear_mesh(Parameters& parameters, SourceLocation location);
  std::optional<Geometry> ply_mesh(Parameters& parameters, SourceLocation location);
  std::optional<Geometry> sphere(Parameters& parameters, SourceLocation location);
  std::optional<Geometry> disk(Parameters& parameters, SourceLocation location);
  std::optional<Geometry> cylinder(Parameters& parameters, SourceLocation location);
  std::optional<Geometry> subdivision(Parameters& parameters, SourceLocation location);
  std::optional<Curves> curves(Parameters& parameters, SourceLocation location);
  std::optional<double> turn(Parameters& parameters, SourceLocation location);
  std::optional<Mesh> vertices(Parameters& parameters, SourceLocation location);
  std::vector<std::uint32_t> indices(Parameters& parameters, const Mesh& mesh, std::size_t corners,
                                     SourceLocation location);

  /// What is a shape of its own in pbrt.
  enum class Faces { kWhole, kTriangles, kPatches };
  /// Properties of a shape that are known only at the end of the file.
  struct Use {
    int material = kDefaultMaterial;
    Faces faces = Faces::kWhole;
    bool is_tube = false;                            ///< of triangles, along curves
    std::optional<Parameters> alpha = std::nullopt;  ///< the directive's parameter `alpha`
    MediumNames media;
    SourceLocation location;
    std::vector<TriangleOrigin> origins = {};  ///< of a mesh without texture coordinates
    Placement placement = {};
  };
  /// Consecutive curves with the same graphics state. They become one mesh when another shape follows.
  struct PendingCurves {
    Curves curves;
    Use use;
    GraphicsState state;
  };
  void add(const std::string& type, Geometry geometry, Use use, const GraphicsState& state);
  void add_lights(Shape shape, const Use& use, const AreaLight& light);
  void add_part(Shape shape, Use use);
  void finish_curves();
  bool place(Shape& shape, const Placement& placement, const TransformPair& keys, bool smooth,
             SourceLocation location);
  void make_emit(Shape& shape, const AreaLight& light, double area);
  void cut_emission(Shape& shape, const Use& use, const TexturedNumber& alpha);
  void set_coordinates(Shape& shape, const Use& use);
  TexturedNumber alpha_of(const Use& use);
  void finish(Shape& shape, Use& use);
  void move(int group, std::size_t index, const Shape& shape, const Use& use);
  void map_textures(Shape& shape, const Use& use);
  std::shared_ptr<const SurfaceMaterial> material_of(const Use& use);
  std::pair<int, int> materials_of(const Use& use, const TexturedNumber& alpha);
  std::vector<Shape>& shapes();
  std::vector<Use>& uses() { return object_ >= 0 ? group_uses_[std::size_t(object_)] : uses_; }

  Context& context_;
  TextureReader& textures_;
  MaterialReader& materials_;
  MediumReader& media_;
  MaterialInstaller installer_;
  std::map<std::tuple<std::shared_ptr<const SurfaceMaterial>, float, int>, SurfaceMaterial> masked_;
  /// Materials of tubes by those of their curves.
  std::map<std::shared_ptr<const SurfaceMaterial>, std::shared_ptr<const SurfaceMaterial>> of_tubes_;
  std::vector<Use> uses_;                     ///< for each of the scene's shapes
  std::vector<std::vector<Use>> group_uses_;  ///< for each of a group's shapes
  PendingCurves pending_;
  std::map<std::string, int> objects_;  ///< groups by name
  int object_ = -1;                     ///< the group that is being read
  std::size_t triangles_ = 0, shape_count_ = 0;
};

}  // namespace penumbra::pbrt
