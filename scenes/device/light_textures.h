// The textures of lights: their effect on a light's power, and the distributions by which textured points are
// sampled (kernels/light/light_grid.h).
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

/// The effect of a texture on one light.
struct LightTexture {
  int texture = -1;   ///< index into the table of textures
  double mean = 1.0;  ///< mean over the light's area of the average of the channels; above 0
  int grid = -1;      ///< as in Light
  int grid_side = 0;
};

class LightTextures {
 public:
  /// `places`: for each texture of the scene its index in the records' table of textures, or kNoTexture. That
  /// table must be complete. Grids are appended to the records.
  LightTextures(const SceneDescription& scene, SceneRecords& records, std::vector<int> places)
      : scene_(&scene), records_(&records), places_(std::move(places)) {}

  /// For a triangle of the records. It gets a sampling grid if that reduces the second moment of a sample by
  /// at least `gain`.
  [[nodiscard]] LightTexture of_triangle(int texture, int triangle, double gain) const;
  /// The same for a sphere or a disk.
  [[nodiscard]] LightTexture of_quadric(int texture, const Quadric& quadric, double gain) const;
  /// For a light that shows the unit square of its texture.
  [[nodiscard]] LightTexture of_image(int texture) const;
  /// Width and height of the texture's image; (1, 1) if it is not an image.
  [[nodiscard]] glm::ivec2 size_of(int texture) const;

 private:
  /// The arguments with which a texture is evaluated.
  struct Place {
    float u, v;
    vec3 p;
    int primitive;
  };
  using PlaceOf = std::function<Place(double u, double v)>;

  [[nodiscard]] static std::vector<vec3> values(const RecordsView& view, int texture,
                                                const std::vector<Place>& places);
  [[nodiscard]] glm::dvec2 texels_a_unit(int texture) const;
  /// Measures the texture at points given by parameters in [0, 1)². `across` is the largest number of texels
  /// that these points cross in one direction.
  [[nodiscard]] LightTexture measure(int texture, const PlaceOf& place, double across, double gain) const;
  [[nodiscard]] int add_grid(const std::vector<double>& weights, int side) const;

  const SceneDescription* scene_;
  SceneRecords* records_;
  std::vector<int> places_;
};

}  // namespace penumbra
