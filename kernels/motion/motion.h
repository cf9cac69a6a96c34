// What moves, at a time while the shutter is open. These functions are the only ones that interpolate, so
// traversal, surfaces, lights, media and layers agree to the bit.
//
// Time goes from 0, when the shutter opens, to 1, when it is closed. BEFORE_FRAME and AFTER_FRAME stand for
// the middles of the frame before and of the next one, which only the layer of motion asks for.
#ifndef PENUMBRA_MOTION_H
#define PENUMBRA_MOTION_H
#include "kernels/intersect/instance.h"
#include "kernels/math/math.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

#define BEFORE_FRAME -1.0f
#define AFTER_FRAME 2.0f

/// The position between two states.
typedef struct {
  int from, to;  ///< indices of states
  float f;       ///< 0: at `from`, 1: at `to`
} Between;

FN Between between_states(Motion m, float time) {
  const float at = clamp_f(time, 0.0f, 1.0f) * (float)m.steps;
  const int step = min_i((int)at, max_i(m.steps - 1, 0));
  const int other = time < 0.0f ? m.steps + 1 : m.steps + 2;
  const bool within = (time >= 0.0f) & (time <= 1.0f);
  Between b;
  b.from = m.first + (within ? step : other) * m.stride;
  b.to = within ? b.from + m.stride : b.from;
  b.f = within ? at - (float)step : 0.0f;
  return b;
}

/// Of a thing whose states are consecutive, from the first of a table on.
FN Motion consecutive_states(int steps) {
  Motion m;
  m.first = 0;
  m.stride = 1;
  m.steps = steps;
  return m;
}

/// Exactly `a` where both are equal: what does not move keeps its bits.
FN float float_between(float a, float b, float f) { return a + f * (b - a); }
FN vec3 vec3_between(vec3 a, vec3 b, float f) { return add_scaled(a, f, sub(b, a)); }
#define STATE_BETWEEN(states, member) \
  vec3_between(load3(&(states)[b.from].member), load3(&(states)[b.to].member), b.f)

/// Whether anything moves besides camera and lights without a surface.
FN bool has_moving_surfaces(const PRIVATE Scene* scene) {
  return NEEDS_MOTION(scene) && scene->header.tables.motion_nodes.count > 0;
}

FN bool triangle_moves(const PRIVATE Scene* scene, int triangle) {
  return triangle >= scene->shutter->still_triangles;
}
FN bool quadric_moves(const PRIVATE Scene* scene, int quadric) {
  return quadric >= scene->shutter->still_quadrics;
}
FN bool instance_moves(const PRIVATE Scene* scene, int instance) {
  return instance >= scene->shutter->still_instances;
}

/// Whether the hierarchy of what is still has instances.
FN bool has_still_instances(const PRIVATE Scene* scene) {
  return NEEDS(scene, INSTANCES) && (!NEEDS_MOTION(scene) || scene->shutter->still_instances > 0);
}

/// The state of a triangle that moves.
FN TriangleState triangle_at(const PRIVATE Scene* scene, int triangle, float time) {
  const Between b = between_states(
      load_motion(scene->triangle_motions + (triangle - scene->shutter->still_triangles)), time);
  TriangleState s;
  s.p0 = STATE_BETWEEN(scene->triangle_states, p0);
  s.p1 = STATE_BETWEEN(scene->triangle_states, p1);
  s.p2 = STATE_BETWEEN(scene->triangle_states, p2);
  s.n0 = STATE_BETWEEN(scene->triangle_states, n0);
  s.n1 = STATE_BETWEEN(scene->triangle_states, n1);
  s.n2 = STATE_BETWEEN(scene->triangle_states, n2);
  return s;
}

/// A quadric that moves. Its axes are unit vectors again.
FN Quadric quadric_at(const PRIVATE Scene* scene, int quadric, float time) {
  const Between b =
      between_states(load_motion(scene->quadric_motions + (quadric - scene->shutter->still_quadrics)), time);
  Quadric q = load_quadric(scene->quadrics + quadric);
  q.center = STATE_BETWEEN(scene->quadric_states, center);
  q.normal = normalize3(STATE_BETWEEN(scene->quadric_states, normal));
  q.x_axis = normalize3(STATE_BETWEEN(scene->quadric_states, x_axis));
  q.y_axis = normalize3(STATE_BETWEEN(scene->quadric_states, y_axis));
  q.radius = float_between(scene->quadric_states[b.from].radius, scene->quadric_states[b.to].radius, b.f);
  q.length = float_between(scene->quadric_states[b.from].length, scene->quadric_states[b.to].length, b.f);
  return q;
}

/// An instance that moves. The inverse is that of the matrix between the states.
FN Instance instance_at(const PRIVATE Scene* scene, int instance, float time) {
  const Between b = between_states(
      load_motion(scene->instance_motions + (instance - scene->shutter->still_instances)), time);
  Instance i = load_instance(scene->instances + instance);
  i.x = STATE_BETWEEN(scene->instance_states, x);
  i.y = STATE_BETWEEN(scene->instance_states, y);
  i.z = STATE_BETWEEN(scene->instance_states, z);
  i.at = STATE_BETWEEN(scene->instance_states, at);
  const vec3 yz = cross3(i.y, i.z), zx = cross3(i.z, i.x), xy = cross3(i.x, i.y);
  const float inverse = 1.0f / dot3(i.x, yz);
  i.row_x = scale(yz, inverse);
  i.row_y = scale(zx, inverse);
  i.row_z = scale(xy, inverse);
  return i;
}

/// An instance at the time, whether it moves or not.
FN Instance instance_of(const PRIVATE Scene* scene, int instance, float time) {
  return NEEDS_MOTION(scene) && instance_moves(scene, instance) ? instance_at(scene, instance, time)
                                                                : load_instance(scene->instances + instance);
}

FN bool camera_moves(const PRIVATE Scene* scene) {
  return NEEDS_MOTION(scene) && scene->header.camera_moves != 0;
}

/// `camera` at the time, if it moves.
FN Camera camera_at(const PRIVATE Scene* scene, Camera camera, float time) {
  const Between b = between_states(consecutive_states(scene->shutter->camera_steps), time);
  GLOBAL const Camera* from = scene->camera_states + b.from;
  GLOBAL const Camera* to = scene->camera_states + b.to;
  camera.origin = vec3_between(load3(&from->origin), load3(&to->origin), b.f);
  camera.x = vec3_between(load3(&from->x), load3(&to->x), b.f);
  camera.y = vec3_between(load3(&from->y), load3(&to->y), b.f);
  camera.z = normalize3(vec3_between(load3(&from->z), load3(&to->z), b.f));
  camera.focus = vec3_between(load3(&from->focus), load3(&to->focus), b.f);
  camera.lens_radius = float_between(from->lens_radius, to->lens_radius, b.f);
  return camera;
}

PENUMBRA_NAMESPACE_END
#endif
