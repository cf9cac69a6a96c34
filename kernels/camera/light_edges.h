// Edges of lights that the camera sees, without noise. A camera ray that ends on a light brings its radiance
// L, the next one beside it next to nothing: in a pixel with the light's edge that is most of the noise. How
// much of the pixel the light takes up is known in closed form, though, so every sample gets
//   L (share - inside), inside = 1 where its film position is within the light's outline, else 0,
// whose mean is 0: where nothing is in front of the light, light and share add up to the share without
// noise. Where something is, the mean stays right, but there is noise for nothing, so L is 0 where rays to
// the edge say so (scenes/device/light_edges.h).
#ifndef PENUMBRA_LIGHT_EDGES_H
#define PENUMBRA_LIGHT_EDGES_H
#include "kernels/sampler/filter.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// The first of a row's pixels with edges that is not left of x.
FN int find_edge_pixel(const PRIVATE Scene* scene, int first, int end, int x) {
  while (first < end) {
    const int middle = (first + end) / 2;
    const bool left = scene->light_edge_pixels[middle].x < x;
    first = left ? middle + 1 : first;
    end = left ? end : middle;
  }
  return first;
}

/// Adds the edges of a light in pixel (pixel.x, y) to the paths among LANES that are the pixel's.
STAGE void add_edges_in_pixel(const PRIVATE Scene* scene, LightEdgePixel pixel, int y,
                              const PRIVATE PathState* paths, int i, const PRIVATE float* RESTRICT u,
                              const PRIVATE float* RESTRICT v) {
  const int filter = scene->header.film.filter;
  const PathState fields = *paths;  // see step.h
  // How many times the light's outline winds about film positions: 1 within it, 0 outside.
  float film_x[LANES], film_y[LANES], windings[LANES];
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      film_x[j] = sample_filter(filter, scene->filter_table, u[j]).x;
      film_y[j] = sample_filter(filter, scene->filter_table, v[j]).x;
      windings[j] = 0.0f;
    }
  for (int k = pixel.first_edge; k < pixel.first_edge + pixel.edge_count; k++) {
    const LightEdge e = scene->light_edges[k];
    LANE_LOOP
      for (int j = 0; j < LANES; j++) {
        const bool below_start = e.y0 <= film_y[j], below_end = e.y1 <= film_y[j];
        const bool crossed = (below_start != below_end) & (film_x[j] < e.x0 + e.slope * (film_y[j] - e.y0));
        windings[j] += crossed ? (below_start ? 1.0f : -1.0f) : 0.0f;
      }
  }
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const bool own = (get_film_x(&fields, i + j) == pixel.x) & (get_film_y(&fields, i + j) == y);
      const float more = own ? pixel.share - windings[j] : 0.0f;
      set_radiance(&fields, i + j, add_scaled(get_radiance(&fields, i + j), more, pixel.radiance));
    }
}

/// Adds the edges of lights to LANES paths that have just started, at film positions chosen by (u, v).
FN void add_light_edges(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                        const PRIVATE float* u, const PRIVATE float* v) {
  int last_x = -1, last_y = -1;
  for (int j = 0; j < LANES; j++) {
    const int x = get_film_x(paths, i + j), y = get_film_y(paths, i + j);
    if ((x == last_x) & (y == last_y)) continue;
    const bool on_film = (y >= 0) & (y < scene->header.film.height);  // a unit may come from anywhere
    const int first = on_film ? scene->light_edge_rows[y] : 0,
              end = on_film ? scene->light_edge_rows[y + 1] : 0;
    int k = find_edge_pixel(scene, first, end, x);
    for (; k < end && scene->light_edge_pixels[k].x == x; k++)
      add_edges_in_pixel(scene, scene->light_edge_pixels[k], y, paths, i, u, v);
    last_x = x;
    last_y = y;
  }
}

PENUMBRA_NAMESPACE_END
#endif
