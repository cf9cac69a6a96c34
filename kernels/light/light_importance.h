// The importance of a node of the light hierarchy: a bound of the irradiance from it (Conty Estevez and Kulla
// 2018). Lights are chosen by it, see light_tree.h.
#ifndef PENUMBRA_LIGHT_IMPORTANCE_H
#define PENUMBRA_LIGHT_IMPORTANCE_H
#include "kernels/math/lane_record.h"
#include "kernels/math/math.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

// Error of bounds of cosines in single precision, where the sine of an angle near 180 degrees matters.
#define LIGHT_COSINE_SLACK 5e-4f
#define LEAST_IMPORTANCE 1e-30f

// The shading point, as far as the choice of lights depends on it.
#define LIT_PLACE_FIELDS(F, a) \
  F(a, vec3, p)                \
  F(a, vec3, facing) /* unit shading normal; 0: light arrives from all directions */
LANE_RECORD(LitPlace, LitPlaces, lit_place, LIT_PLACE_FIELDS)

#define READ_float(place) (place)
#define READ_int(place) (place)
#define READ_vec3(place) load3(&(place))
#define READ_FIELD(type, name) record.name = READ_##type(node->name);
/// Copies a node, once for all lanes if all need the same one.
FN LightNode read_light_node(GLOBAL const LightNode* node) {
  LightNode record;
  LIGHT_NODE_FIELDS(READ_FIELD)
  return record;
}
#undef READ_FIELD

// What is known of a node at compile time.
enum { NODE_ANY, NODE_INFINITE, NODE_ISOTROPIC /* has a position and emits equally in all directions */ };

// cos(max(a - b, 0)) and sin(max(a - b, 0)), for two angles in [0, pi] given by their cosines and sines.
FN float cos_of_excess(float cos_a, float sin_a, float cos_b, float sin_b) {
  return cos_a >= cos_b ? 1.0f : cos_a * cos_b + sin_a * sin_b;
}
FN float sin_of_excess(float cos_a, float sin_a, float cos_b, float sin_b) {
  return cos_a >= cos_b ? 0.0f : max_f(sin_a * cos_b - cos_a * sin_b, 0.0f);
}

/// An upper bound, in units that all nodes share, of the irradiance at a place from all lights of a node. It
/// bounds intensity, cosines and distance; the lights are taken as at least as far away as the size of their
/// box. It is 0 only if no light arrives on the side that the place faces.
///
/// `known` is a constant: what is known of the node, or NODE_ANY.
FN float light_importance_by(LightNode node, LitPlace place, int known) {
  const vec3 axis = node.axis, half_size = node.half_size;
  const int flags = node.flags;
  const bool infinite = known == NODE_INFINITE || (known == NODE_ANY && (flags & LIGHTS_INFINITE) != 0);
  const bool two_sided = (flags & LIGHTS_TWO_SIDED) != 0;
  const float cos_o = node.cos_o, sin_o = node.sin_o, cos_e = node.cos_e, radius = node.radius;
  const bool all_around = dot3(place.facing, place.facing) == 0.0f;
  const vec3 way = sub(place.p, node.center);
  float inverse = 1.0f, ball_cos = 1.0f, ball_sin = 0.0f;
  if (known != NODE_INFINITE) {
    inverse = 1.0f / SQRT(max_f(dot3(way, way), 1e-30f));
    // Half the angle that the bounding sphere subtends; from inside it is everything.
    const float sine = radius * inverse;
    const bool outside = sine < 1.0f;
    ball_sin = outside ? sine : 0.0f;
    ball_cos = outside ? SQRT(1.0f - sqr(ball_sin)) : -1.0f;
  }

  // At the lights: the least angle between a direction to the place and an axis, beyond the cone of axes.
  bool shines = true;
  float emitted = 1.0f;
  if (known == NODE_ANY) {
    const float along = dot3(way, axis), cos_along = clamp_f(along * inverse, -1.0f, 1.0f);
    const float cos_w = two_sided ? FABS(cos_along) : cos_along, sin_w = SQRT(1.0f - sqr(cos_w));
    const float cos_x = cos_of_excess(cos_w, sin_w, cos_o, sin_o);
    const float sin_x = sin_of_excess(cos_w, sin_w, cos_o, sin_o);
    const float cos_emitted = cos_of_excess(cos_x, sin_x, ball_cos, ball_sin);
    // Lights with the same normal emit nothing behind the plane of the last of them.
    const bool flat = (cos_o == 1.0f) & !two_sided & (cos_e >= 0.0f);
    const bool behind = flat & !(along + dot3(abs3(axis), half_size) > 0.0f);
    shines = infinite | ((cos_emitted > cos_e - LIGHT_COSINE_SLACK) & !behind);
    emitted = max_f(cos_emitted, LIGHT_COSINE_SLACK);
  }

  // At the place: the least angle between its normal and a direction to the lights.
  const float height = -dot3(way, place.facing);
  const float cos_i = clamp_f(infinite ? -dot3(axis, place.facing) : height * inverse, -1.0f, 1.0f);
  const float around_cos = infinite ? cos_o : ball_cos, around_sin = infinite ? sin_o : ball_sin;
  const float cos_received = cos_of_excess(cos_i, SQRT(1.0f - sqr(cos_i)), around_cos, around_sin);
  const float slack = around_sin > 0.0f ? LIGHT_COSINE_SLACK : 0.0f;
  const bool above = infinite | (height + dot3(abs3(place.facing), half_size) > 0.0f);
  const bool reaches = all_around | (above & (cos_received > -slack));

  const float received = all_around ? 1.0f : max_f(cos_received, slack);
  const float falls = emitted * sqr(min_f(inverse, node.inverse_radius));
  const float bound = node.intensity * received * (infinite ? 1.0f : falls);
  // If light may arrive, the probability is never 0.
  return (shines & reaches) ? clamp_f(bound, LEAST_IMPORTANCE, 1.0f / LEAST_IMPORTANCE) : 0.0f;
}
FN float light_importance(GLOBAL const LightNode* node, LitPlace place) {
  return light_importance_by(read_light_node(node), place, NODE_ANY);
}

PENUMBRA_NAMESPACE_END
#endif
