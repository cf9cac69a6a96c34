// Builds the kernels' tables of lights.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/device/emitter_sampling.h"
#include "scenes/device/light_bounds.h"
#include "scenes/device/light_textures.h"
#include "scenes/device/polygon_outline.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// Collects the lights of a scene in the order in which they are added.
class LightBuilder {
 public:
  /// `by_default`: the sampling of shapes that do not specify it. `polygons`: whether the closed form of
  /// polygon lights is needed.
  LightBuilder(EmitterSampling by_default, bool polygons)
      : by_default_(by_default), polygons_wanted_(polygons) {}

  void set_default_sampling(EmitterSampling by_default) { by_default_ = by_default; }

  /// Sets points that receive light, in the lights' coordinates. A light without a sampling setting gets the
  /// method that pays at these points for the integrator (emitter_sampling.h). Without receivers it is
  /// sampled by area.
  void set_receivers(std::vector<Receiver> receivers, const IntegratorSettings& integrator) {
    receivers_ = std::move(receivers);
    integrator_ = integrator;
  }

  /// Must be called before shapes with textured radiance are added.
  void set_textures(const LightTextures& textures) { textures_ = &textures; }

  /// Adds the triangles of an emitting shape, which start at `first` in the table of triangles. Returns the
  /// index of each triangle's light. A triangle that duplicates another shares its light; otherwise it would
  /// shine twice.
  /// `moves`: while the shutter is open, so each triangle is a light and an outline of its own.
  std::vector<int> add_triangles(std::span<const LightTriangle> triangles, const Shape& shape, int first = 0,
                                 bool moves = false);

  /// Adds a sphere or a disk. `light` is complete except for its radiance and sampling. `quadric` is needed
  /// for a texture.
  int add_quadric(Light light, const Shape& shape, double area, const Quadric& quadric = {});

  /// Adds an emitter, which must not be black.
  int add_emitter(const Emitter& emitter, const EmitterPlace& place);

  int add(const EmitterLight& made);

  /// Extends the bounds of a light to all places between these states, which it takes one after the other.
  void cover(int light, std::span<const LightState> states);

  /// Sets the probability of choosing each light by its power.
  void finish();

  [[nodiscard]] const std::vector<Light>& lights() const { return lights_; }
  [[nodiscard]] const std::vector<LightBounds>& bounds() const { return bounds_; }  ///< one entry per light
  /// The table of set_light_probabilities; empty before finish().
  [[nodiscard]] const std::vector<int>& cells() const { return cells_; }
  [[nodiscard]] const std::vector<Polygon>& polygons() const { return polygons_; }
  [[nodiscard]] const std::vector<PolygonCorner>& corners() const { return corners_; }
  [[nodiscard]] int duplicates() const { return duplicates_; }

  /// The FEATURE_* bits that sampling the lights requires.
  [[nodiscard]] std::uint64_t features() const;
  /// The kinds of lights in the scene, as bits 1 << LIGHT_*.
  [[nodiscard]] std::uint32_t kinds() const;
  [[nodiscard]] bool only_polygons() const;
  /// Whether samples of the unshadowed light on a diffuse surface all have the same value: every light is a
  /// polygon sampled by projected solid angle, and all have the same colour.
  [[nodiscard]] bool constant_if_projected() const;

 private:
  /// Powers of lights of different classes are not comparable. So half of all samples are distributed by
  /// power over all lights, and the other half equally over the classes present. Within a class, lights are
  /// chosen by power.
  enum Class { kShapes, kPoints, kSkies, kClasses };  ///< a directional light belongs to the class of skies

  int add(Light light, const glm::vec3& radiance, double area, double power);
  void add_polygon(const Outline& outline, const Shape& shape, int first_light, int light_count);

  [[nodiscard]] bool is_textured(const Shape& shape) const;
  [[nodiscard]] double least_gain(const Shape& shape, double gain) const;
  static double show(const LightTexture& texture, Light& light);
  [[nodiscard]] int triangle_sampling(std::span<const LightTriangle> triangles, const Shape& shape) const;

  IntegratorSettings integrator_;  ///< for which the receivers decide
  EmitterSampling by_default_;
  bool polygons_wanted_;
  const LightTextures* textures_ = nullptr;
  std::vector<Receiver> receivers_;
  std::vector<Light> lights_;
  std::vector<double> power_;
  std::vector<LightBounds> bounds_;
  std::vector<int> cells_;
  std::vector<Polygon> polygons_;
  std::vector<PolygonCorner> corners_;
  int duplicates_ = 0;
};

}  // namespace penumbra
