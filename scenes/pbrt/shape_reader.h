// Shapes of pbrt.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "scenes/pbrt/texture_reader.h"

namespace penumbra::pbrt {

/// A shape as it was met, in its own space: an object holds such, which each of its instances puts in place.
struct ReadShape {
  std::string name;
  decltype(Shape::geometry) geometry;
  glm::dmat4 ctm{1.0};
  bool reverse_orientation = false;
  std::shared_ptr<const SurfaceMaterial> material;
  std::string material_name;
  std::shared_ptr<const AreaLight> area_light;
  TexturedNumber alpha{1.0f};
  SourceLocation location;
};

class ShapeReader {
 public:
  ShapeReader(Context& context, TextureReader& textures) : context_(context), textures_(textures) {}

  /// Of a directive Shape; none, and an error, where it cannot be read.
  std::optional<ReadShape> read(const std::string& type, Parameters& parameters, const GraphicsState& state,
                                SourceLocation location);

  /// Puts it in place, after its own transform.
  void place(const ReadShape& shape, const glm::dmat4& instance);

 private:
  using Geometry = decltype(Shape::geometry);
  std::optional<Geometry> triangle_mesh(Parameters& parameters, SourceLocation location);
  std::optional<Geometry> bilinear_mesh(Parameters& parameters, SourceLocation location);
  std::optional<Geometry> ply_mesh(Parameters& parameters, SourceLocation location);
  std::optional<Geometry> sphere(Parameters& parameters, SourceLocation location);
  std::optional<Geometry> disk(Parameters& parameters, SourceLocation location);
  std::optional<Mesh> vertices(Parameters& parameters, SourceLocation location);
  std::vector<std::uint32_t> indices(Parameters& parameters, const Mesh& mesh, std::size_t corners,
                                     SourceLocation location);
  std::pair<int, int> materials_of(const ReadShape& shape);

  Context& context_;
  TextureReader& textures_;
  MaterialInstaller installer_;
  std::map<std::tuple<std::shared_ptr<const SurfaceMaterial>, float, int>, SurfaceMaterial> masked_;
  std::size_t triangles_ = 0;
};

}  // namespace penumbra::pbrt
