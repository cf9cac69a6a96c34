// Noise-free edges of lights that the camera sees. A camera ray that hits a light brings its radiance L, and
// a ray beside it almost nothing: in a pixel that contains the light's edge, this is most of the noise. But
// the fraction (share) of the pixel that the light covers has a closed form. So every sample gets the control
// variate
//   L (share - inside), with inside = 1 if its film position is within the light's outline, else 0.
// Its mean is 0. Where nothing occludes the light, the sum of light and control variate is L share, without
// noise. Where the light is occluded the mean is still right, but the control variate only adds noise. So L
// is 0 where rays to the edge are occluded (scenes/device/light_edges.h).
#ifndef PENUMBRA_LIGHT_EDGES_H
#define PENUMBRA_LIGHT_EDGES_H
#include "kernels/sampler/filter.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// The first pixel with edges of a row that is not left of x; `first` and `end` bound the row's pixels.
FN int find_edge_pixel(const PRIVATE Scene* scene, int first, int end, int x) {
  while (first < end) {
    const int middle = (first + end) / 2;
    const bool left = scene->light_edge_pixels[middle].x < x;
    first = left ? middle + 1 : first;
    end = left ? end : middle;
  }
  return first;
}

/// Adds the edges of a light in pixel (pixel.x, y) to those of LANES paths that belong to this pixel.
STAGE void add_edges_in_pixel(const PRIVATE Scene* scene, LightEdgePixel pixel, int y,
                              const PRIVATE PathState* paths, int i, const PRIVATE float* RESTRICT u,
                              const PRIVATE float* RESTRICT v) {
  const int filter = scene->header.film.filter;
  const PathState fields = *paths;  // see step.h
  // The winding number of the light's outline about each film position: 1 inside, 0 outside.
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

/// Adds the edges of lights to LANES paths that have just started, at the film positions of (u, v).
FN void add_light_edges(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                        const PRIVATE float* u, const PRIVATE float* v) {
  int last_x = -1, last_y = -1;
  for (int j = 0; j < LANES; j++) {
    const int x = get_film_x(paths, i + j), y = get_film_y(paths, i + j);
    if ((x == last_x) & (y == last_y)) continue;
    const bool on_film = (y >= 0) & (y < scene->header.film.height);  // units may be outside of the film
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
