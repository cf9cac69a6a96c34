#include "gl/tile_outlines.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace penumbra {
namespace {

struct Bounds {
  int left, top, right, bottom;
  [[nodiscard]] bool empty() const { return left >= right || top >= bottom; }
  [[nodiscard]] Bounds inner(int margin) const {
    return {left + margin, top + margin, right - margin, bottom - margin};
  }
};

void add_rectangle(std::vector<OutlineVertex>& vertices, const Bounds& box,
                   const std::array<float, 3>& color) {
  if (box.empty()) return;
  const std::array<std::array<int, 2>, 6> corners{{{box.left, box.top},
                                                   {box.right, box.top},
                                                   {box.left, box.bottom},
                                                   {box.left, box.bottom},
                                                   {box.right, box.top},
                                                   {box.right, box.bottom}}};
  for (const auto& corner : corners)
    vertices.push_back({float(corner[0]), float(corner[1]), color[0], color[1], color[2]});
}

/// Adds the part of `box` that is outside of `box.inner(thickness)`.
void add_frame(std::vector<OutlineVertex>& vertices, const Bounds& box, int thickness,
               const std::array<float, 3>& color) {
  if (box.empty()) return;
  const Bounds hole = box.inner(thickness);
  if (hole.empty()) return add_rectangle(vertices, box, color);
  add_rectangle(vertices, {box.left, box.top, box.right, hole.top}, color);
  add_rectangle(vertices, {box.left, hole.bottom, box.right, box.bottom}, color);
  add_rectangle(vertices, {box.left, hole.top, hole.left, hole.bottom}, color);
  add_rectangle(vertices, {hole.right, hole.top, box.right, hole.bottom}, color);
}

/// The edge between screen pixels that is nearest to an edge of a film pixel.
int screen_edge(int film, int film_size, int origin, int size) {
  return origin + int(std::lround(double(film) * size / film_size));
}

}  // namespace

std::vector<OutlineVertex> outline_triangles(std::span<const WorkerView> workers,
                                             const PixelRectangle& picture, int film_width, int film_height,
                                             int thickness) {
  std::vector<OutlineVertex> vertices;
  if (film_width < 1 || film_height < 1) return vertices;
  for (const WorkerView& worker : workers) {
    if (worker.width < 1 || worker.height < 1 || worker.x < 0 || worker.y < 0) continue;
    if (worker.width > film_width - worker.x || worker.height > film_height - worker.y) continue;
    Bounds box{screen_edge(worker.x, film_width, picture.x, picture.width),
               screen_edge(worker.y, film_height, picture.y, picture.height),
               screen_edge(worker.x + worker.width, film_width, picture.x, picture.width),
               screen_edge(worker.y + worker.height, film_height, picture.y, picture.height)};
    // Even a tile smaller than a pixel must be visible.
    box.right = std::max(box.right, box.left + 1);
    box.bottom = std::max(box.bottom, box.top + 1);
    const std::array<float, 3> color = worker_color(worker.number);
    const Bounds dark = box.inner(thickness);
    // If there is no room for the dark line and some of the picture, only the colour is drawn.
    if (!dark.inner(2).empty())
      add_frame(vertices, dark, 1, {0.1f * color[0], 0.1f * color[1], 0.1f * color[2]});
    add_frame(vertices, box, thickness, color);
  }
  return vertices;
}

}  // namespace penumbra
