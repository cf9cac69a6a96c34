// Shared by the tests against TinyRender's reference images: its scenes, its image encodings, and a test that
// two images are samples of one estimator.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "scenes/scene_description.h"
#include "scheduler/plan/film_accumulator.h"
#include "tests/support/image_test.h"

namespace penumbra {

/// The first three channels of a reference, as stored; throws std::runtime_error.
statistics::Image read_reference(const std::filesystem::path& file);

/// All samples of a pixel go through its centre, as TinyRender's do where there is one of them.
void sample_pixel_centres(SceneDescription& scene);

/// TinyRender's direct light takes an emitter for the sphere about it: it chooses one with equal chances and
/// a direction uniformly within its cone. So each emitter becomes a sphere of the mesh's surface, which is as
/// large from everywhere, on average, as the convex mesh is (Cauchy). Green and blue change so that a choice
/// in proportion to power, the mean of the channels times the area, is one of equal chances: the red channel
/// of the image is then what the grey scene has.
void make_emitters_spheres_chosen_alike(SceneDescription& scene);

/// The camera ray through a pixel's centre, worked out in double from eye, target and vertical field of view
/// in degrees, up being +y; where it meets the plane y = 0.
struct PinholeCamera {
  glm::dvec3 eye, target;
  double fov;
  int width, height;
  [[nodiscard]] glm::dvec3 floor_point(int x, int y) const;
};

/// What the closed form says that a diffuse point of normal (0, 1, 0) reflects of a scene's one light, a mesh
/// above the horizon: positive in front of it, negative behind. One channel.
double unshadowed_radiance(const Shape& light, double albedo, const glm::dvec3& point, int channel);

/// The sum over the edges of a light, a quadrilateral of two triangles, of |n . normalize(v_i x v_i+1)| times
/// the error that the angle between v_i and v_i+1 may have: the radiance may be off by L albedo / 2 pi times
/// as much.
double edge_error(const Shape& light, const glm::dvec3& point,
                  const std::function<double(double)>& error_of_angle);

/// The nearest half float, ties to even, as a reference is stored.
double to_half(double value);
/// Distance of neighbouring half floats about a value.
double half_spacing(double value);
/// 255 times the sRGB encoding of a value, clamped to 0...255, not rounded.
double srgb_code(double value);

/// One for each pixel, row by row.
using Mask = std::vector<char>;

/// Pixels about which, in the 3 x 3 neighbourhood, one thing only is seen: albedo and normal are everywhere
/// the same (to 1e-3), and so is whether anything is hit and whether it shines.
Mask smooth_pixels(const FilmAccumulator& film, const Mask& shines);
/// Pixels that see an emitter: they have depth and no albedo.
Mask emitter_pixels(const FilmAccumulator& film);

/// Are two images independent draws of one estimator, pixel by pixel? Then the difference of a pixel has a
/// distribution that is symmetric about 0, whatever its tails: given their sizes, the signs of all
/// differences are independent fair coins. So z = sum d / sqrt(sum d^2) over any set of pixels has mean 0,
/// mean square 1 exactly, variance of z^2 at most 2, and P(|z| > t) <= 2 exp(-t^2 / 2) (Hoeffding's
/// inequality), without a word about variances or normal distributions. The same holds for the signs of d in
/// place of d, which see a shift that outliers hide.
struct SymmetryTest {
  struct Part {
    std::size_t blocks = 0;  ///< with any difference
    double mean_square = 0;  ///< of z over the blocks
    double worst = 0;        ///< z farthest from 0 of a block ...
    int worst_x = 0, worst_y = 0;
    double whole = 0;  ///< z of all pixels together
  };
  Part values, signs;
  double relative = 0;        ///< sum d / sum of the reference
  double relative_error = 0;  ///< its standard deviation
  std::size_t pixels = 0;     ///< with a difference

  /// Empty if nothing is more improbable than `significance`: the worst block, the mean square, the whole.
  [[nodiscard]] std::string failure(double significance, bool with_signs) const;
  [[nodiscard]] std::string summary() const;
};

/// Blocks of `block` x `block` pixels; of the pixels those in `mask`. Pixels that differ by no more than
/// `ignored` at (x, y) count as equal.
SymmetryTest symmetry_test(
    const statistics::Image& reference, const statistics::Image& ours, int channel, const Mask& mask,
    int block, const std::function<double(int, int)>& ignored = [](int, int) { return 0.0; });

}  // namespace penumbra
