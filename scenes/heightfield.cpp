#include "scenes/heightfield.h"

#include <fmt/format.h>

#include <cmath>

#include "kernels/math/vec3.h"
#include "scenes/image/bitmap_values.h"

namespace penumbra {
namespace {

class Grid {
 public:
  Grid(const Bitmap& bitmap, float gamma, double scale)
      : width(std::size_t(bitmap.width)), height(std::size_t(bitmap.height)) {
    const auto channels = std::size_t(bitmap.channels);
    const BitmapValues values(bitmap, gamma);
    heights_.reserve(width * height);
    for (std::size_t i = 0; i < width * height; ++i) {
      const std::size_t k = i * channels;
      const float grey =
          channels == 1 ? values[k] : luminance(make_vec3(values[k], values[k + 1], values[k + 2]));
      heights_.push_back(scale * double(grey));
    }
  }

  [[nodiscard]] double at(std::size_t x, std::size_t y) const { return heights_[y * width + x]; }

  /// The unnormalised normal, in grid steps, of a bilinear patch at its corner (x, y). The patch extends
  /// towards (x + dx, y + dy), where each step is 1 or -1.
  [[nodiscard]] glm::dvec3 patch_normal(std::size_t x, std::size_t y, int dx, int dy) const {
    const double here = at(x, y);
    return {dx * (here - at(x + std::size_t(dx), y)), dy * (here - at(x, y + std::size_t(dy))), 1.0};
  }

  const std::size_t width, height;

 private:
  std::vector<double> heights_;
};

/// The unit normal at a vertex. `step` is the size of a grid step.
glm::vec3 smooth_normal(const Grid& grid, std::size_t x, std::size_t y, const glm::dvec2& step) {
  glm::dvec3 sum(0.0);
  for (const int dx : {-1, 1})
    for (const int dy : {-1, 1}) {
      const bool inside = (dx < 0 ? x > 0 : x + 1 < grid.width) && (dy < 0 ? y > 0 : y + 1 < grid.height);
      if (inside) sum += glm::normalize(grid.patch_normal(x, y, dx, dy));
    }
  return glm::vec3(glm::normalize(glm::dvec3(sum.x / step.x, sum.y / step.y, sum.z)));
}

}  // namespace

Expected<Mesh> make_heightfield(const Bitmap& heights, float gamma, double scale, bool smooth) {
  if (heights.width < 2 || heights.height < 2)
    return fail(
        fmt::format("a height field has at least 2 x 2 texels, not {} x {}", heights.width, heights.height));
  const std::size_t count = std::size_t(heights.width) * std::size_t(heights.height);
  if (count > kMostHeights)
    return fail(fmt::format("a height field has at most {} texels, not {} x {}", kMostHeights, heights.width,
                            heights.height));
  const Grid grid(heights, gamma, scale);
  const glm::dvec2 cells(double(grid.width - 1), double(grid.height - 1)), step = 2.0 / cells;
  Mesh mesh;
  mesh.positions.reserve(count);
  mesh.texcoords.reserve(count);
  mesh.triangles.reserve(2 * (grid.width - 1) * (grid.height - 1));
  if (smooth) mesh.normals.reserve(count);
  for (std::size_t y = 0; y < grid.height; ++y)
    for (std::size_t x = 0; x < grid.width; ++x) {
      const glm::dvec2 uv = glm::dvec2(double(x), double(y)) / cells;
      mesh.positions.emplace_back(2.0 * uv - 1.0, grid.at(x, y));
      mesh.texcoords.emplace_back(uv);
      if (smooth) mesh.normals.push_back(smooth_normal(grid, x, y, step));
    }
  const auto row = std::uint32_t(grid.width);
  for (std::uint32_t y = 0; y + 1 < std::uint32_t(grid.height); ++y)
    for (std::uint32_t x = 0; x + 1 < row; ++x) {
      const std::uint32_t i = y * row + x;
      mesh.triangles.emplace_back(i, i + 1, i + row + 1);
      mesh.triangles.emplace_back(i, i + row + 1, i + row);
    }
  return mesh;
}

}  // namespace penumbra
