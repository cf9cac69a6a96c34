// The textures of lights: what they add to a light's power, and the distributions by which points of it are
// chosen (kernels/light/light_grid.h).
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/device/scene_records.h"
#include "scenes/scene_description.h"

namespace penumbra {

class RecordsView;

/// Indices into SceneDescription::textures of those that lights show, each light's, kNoTexture for none.
std::vector<int> textures_of_lights(const SceneDescription& scene);

/// What a texture means for one light.
struct LightTexture {
  int texture = -1;   ///< index into the table of textures
  double mean = 1.0;  ///< of its channels, over points that are uniform by area; above 0
  int grid = -1;      ///< as of Light
  int grid_side = 0;
};

class LightTextures {
 public:
  /// `places`: of each texture of the scene in the records' table, which is complete, or kNoTexture. Grids
  /// are added to the records.
  LightTextures(const SceneDescription& scene, SceneRecords& records, std::vector<int> places)
      : scene_(&scene), records_(&records), places_(std::move(places)) {}

  /// Of a triangle of the records that shows the scene's texture. It has a grid if that lowers the second
  /// moment of what a sample brings by `gain` at least.
  [[nodiscard]] LightTexture of_triangle(int texture, int triangle, double gain) const;
  /// Likewise of a sphere or a disk.
  [[nodiscard]] LightTexture of_quadric(int texture, const Quadric& quadric, double gain) const;
  /// Of a light that shows the unit square of its texture.
  [[nodiscard]] LightTexture of_image(int texture) const;
  /// Width and height of the image that the texture is; 1 and 1 for others.
  [[nodiscard]] glm::ivec2 size_of(int texture) const;

 private:
  /// Where a texture is evaluated.
  struct Place {
    float u, v;
    vec3 p;
    int primitive;
  };
  using PlaceOf = std::function<Place(double u, double v)>;

  [[nodiscard]] static std::vector<vec3> values(const RecordsView& view, int texture,
                                                const std::vector<Place>& places);
  [[nodiscard]] glm::dvec2 texels_a_unit(int texture) const;
  /// By points for numbers of [0, 1)²; `across`: how many texels they pass at most, one way.
  [[nodiscard]] LightTexture measure(int texture, const PlaceOf& place, double across, double gain) const;
  [[nodiscard]] int add_grid(const std::vector<double>& weights, int side) const;

  const SceneDescription* scene_;
  SceneRecords* records_;
  std::vector<int> places_;
};

}  // namespace penumbra
