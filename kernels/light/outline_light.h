// Flat lights of several triangles: points by area. Lines through the corners of the outline, all along x,
// cut it into strips, which follow each other across them; the first number chooses a strip and the line in
// it, the second a place on the line. So numbers that are well spread give points that are: on triangles,
// whose points crowd into a corner each, and which follow each other in any order, they do not. And it is one
// light to choose.
#ifndef PENUMBRA_OUTLINE_LIGHT_H
#define PENUMBRA_OUTLINE_LIGHT_H
#include "kernels/light/flat_light.h"
#include "kernels/light/kind_functions.h"

PENUMBRA_NAMESPACE_BEGIN

/// Of the strips the last that starts at u or before it.
FN int strip_at(GLOBAL const LightStrip* strips, int count, float u) {
  int at = 0;
  UNROLL
  for (int step = MOST_LIGHT_STRIPS / 2; step > 0; step /= 2) {
    const int next = at + step;
    const bool is_there = next < count;
    const float start = strips[is_there ? next : 0].start;
    at = (is_there & (start <= u)) ? next : at;
  }
  return at;
}

LIGHT_SHINES_ALIKE(outline)

FN SampledPoint sample_outline_point(const PRIVATE Scene* scene, int index, LightReceiver r, float u, float v,
                                     uint strategies) {
  GLOBAL const Light* light = scene->lights + index;
  GLOBAL const LightStrip* strips = scene->light_strips + light->strip;
  GLOBAL const LightStrip* s = strips + strip_at(strips, light->strip_count, u);
  // How far up the strip it has that share of its area: width t + growth t^2 / 2 is that of width + growth
  // / 2.
  const float share = clamp_f((u - s->start) * s->inverse_share, 0.0f, 1.0f);
  const float width = s->width, growth = s->growth, twice = share * (2.0f * width + growth);
  const float root = SQRT(max_f(width * width + growth * twice, 0.0f));
  const float t = min_f(twice / max_f(width + root, 1e-30f), 1.0f);
  const float x = s->x + t * s->step_x + v * (width + t * growth), y = s->y + t * s->step_y;
  return flat_light_point(flat_light(light), r.p, (1.0f - x) - y, x, y);
}

SAMPLE_LIGHT_BY_POINT(outline)
FIND_LIGHT_BY_AREA(outline)

PENUMBRA_NAMESPACE_END
#endif
