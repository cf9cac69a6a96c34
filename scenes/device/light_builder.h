// The lights of a scene as the kernels' tables.
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

/// Collects lights in the order in which they come.
class LightBuilder {
 public:
  /// `by_default`: for shapes that do not say how they are sampled. `polygons`: whether the closed form of
  /// polygon lights is wanted.
  LightBuilder(EmitterSampling by_default, bool polygons)
      : by_default_(by_default), polygons_wanted_(polygons) {}

  void set_default_sampling(EmitterSampling by_default) { by_default_ = by_default; }

  /// Points that receive light, in the lights' coordinates. A light without a sampling setting gets the
  /// sampling that pays at these points for the integrator (emitter_sampling.h). Without receivers: by area.
  void set_receivers(std::vector<Receiver> receivers, const IntegratorSettings& integrator) {
    receivers_ = std::move(receivers);
    integrator_ = integrator;
  }

  /// For shapes whose radiance has a texture.
  void set_textures(const LightTextures& textures) { textures_ = &textures; }

  /// The triangles of an emitting shape, in the table of triangles from `first` on; returns the index of the
  /// light of each. One that repeats another is the same light, or it would shine twice.
  std::vector<int> add_triangles(std::span<const LightTriangle> triangles, const Shape& shape, int first = 0);

  /// A sphere or a disk, all but its radiance and sampling filled in; the quadric for its texture.
  int add_quadric(Light light, const Shape& shape, double area, const Quadric& quadric = {});

  /// One that is not black.
  int add_emitter(const Emitter& emitter, const EmitterPlace& place);

  /// Sets the probabilities of choosing each light by power.
  void finish();

  [[nodiscard]] const std::vector<Light>& lights() const { return lights_; }
  [[nodiscard]] const std::vector<LightBounds>& bounds() const { return bounds_; }  ///< of each light
  /// See set_light_probabilities; none before finish().
  [[nodiscard]] const std::vector<int>& cells() const { return cells_; }
  [[nodiscard]] const std::vector<Polygon>& polygons() const { return polygons_; }
  [[nodiscard]] const std::vector<PolygonCorner>& corners() const { return corners_; }
  [[nodiscard]] int duplicates() const { return duplicates_; }

  /// FEATURE_* bits that the sampling of the lights needs.
  [[nodiscard]] std::uint64_t features() const;
  /// Bits 1 << LIGHT_* of the lights there are.
  [[nodiscard]] std::uint32_t kinds() const;
  [[nodiscard]] bool only_polygons() const;
  /// Whether samples of a diffuse surface's light are constant without shadows: every light is a polygon that
  /// is sampled by projected solid angle, and all have one colour.
  [[nodiscard]] bool constant_if_projected() const;

 private:
  /// Powers of different classes do not compare: half of all samples go by power, half to each class that is
  /// there alike; within a class all go by power.
  enum Class { kShapes, kPoints, kSkies, kClasses };  ///< a directional light is a part of the sky

  int add(Light light, const glm::vec3& radiance, double area, double power);
  int add(const EmitterLight& made);
  void add_polygon(const Outline& outline, const Shape& shape, int first_light, int light_count);

  [[nodiscard]] bool is_textured(const Shape& shape) const;
  [[nodiscard]] double least_gain(const Shape& shape, double gain) const;
  static double show(const LightTexture& texture, Light& light);
  [[nodiscard]] int triangle_sampling(std::span<const LightTriangle> triangles, const Shape& shape) const;

  IntegratorSettings integrator_;  ///< of the receivers
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
