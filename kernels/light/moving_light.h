// Lights at the time of a path. Where a light moves, it is between two of its states; its area follows from
// its shape there. Lights of scenes whose lights stay in place are their records.
//
// Only positions and directions move: radiance, choice and textures of a light are the same at all times.
// Rectangles and constant environments never move: a rectangle between two states may be none, so the two
// triangles of a moving one are lights of their own.
#ifndef PENUMBRA_MOVING_LIGHT_H
#define PENUMBRA_MOVING_LIGHT_H
#include "kernels/intersect/surface_uv.h"
#include "kernels/light/light_kinds.h"
#include "kernels/motion/motion.h"

PENUMBRA_NAMESPACE_BEGIN

/// Whether lights are sampled by this strategy; `strategies` is a constant. BY(strategies, MOTION): at the
/// time of the path.
#define BY(strategies, name) (HAS(name) && ((strategies)&FEATURE_##name) != 0)

/// Whether any light of the scene moves. If so, each has its Motion.
FN bool lights_move(const PRIVATE Scene* scene) {
  return NEEDS(scene, MOTION) && scene->header.tables.light_motions.count > 0;
}

/// Whether this one does, in a scene where lights_move.
FN bool light_moves(const PRIVATE Scene* scene, int light) { return scene->light_motions[light].steps > 0; }

// Defines stage(PARAMETERS), which calls the stage <stage>_in_motion if `moving`, else <stage>_still. Both
// are <stage>_lanes with the arguments and `strategies`, FEATURE_MOTION or 0.
#define STILL_OR_IN_MOTION(stage, moving, PARAMETERS, ...)                                                   \
  STAGE void stage##_still PARAMETERS { stage##_lanes(__VA_ARGS__, 0u); }                                    \
  STAGE void stage##_in_motion PARAMETERS { stage##_lanes(__VA_ARGS__, COMPILED_FEATURES& FEATURE_MOTION); } \
  FN void stage PARAMETERS {                                                                                 \
    if (moving)                                                                                              \
      stage##_in_motion(__VA_ARGS__);                                                                        \
    else                                                                                                     \
      stage##_still(__VA_ARGS__);                                                                            \
  }

typedef struct {
  vec3 x, y, z;
} UnitAxes;

/// Orthogonal unit axes near these, which are so at the states but not between them: z keeps its direction, x
/// its side of z, y is perpendicular to both.
FN UnitAxes unit_axes(vec3 x, vec3 y, vec3 z) {
  UnitAxes axes;
  axes.z = normalize3(z);
  axes.x = normalize3(add_scaled(x, -dot3(axes.z, x), axes.z));
  const vec3 across = cross3(axes.z, axes.x);
  axes.y = scale(across, sign_of(dot3(across, y)));
  return axes;
}

/// The area of a light that moves, or `area` where its kind has no surface.
FN float moved_area(int kind, vec3 p0, vec3 p1, vec3 p2, float area) {
  const float radius = p2.x, length = p2.z, disk = PI_F * sqr(radius);
  const float triangle = 0.5f * length3(cross3(sub(p1, p0), sub(p2, p0)));
  const float round = kind == LIGHT_SPHERE ? 4.0f * disk : (kind == LIGHT_DISK ? disk : area);
  const float other = kind == LIGHT_CYLINDER ? 2.0f * PI_F * radius * length : round;
  return kind == LIGHT_TRIANGLE ? triangle : other;
}

/// Light `index` at `time`, 0 to 1, if it is of that kind; else arbitrary.
FN Light light_of_kind_at(const PRIVATE Scene* scene, int index, int kind, float time, ulong strategies) {
  Light light = load_light(scene->lights + index);
  if (BY(strategies, MOTION)) {
    const Motion motion = load_motion(scene->light_motions + index);
    const Between b = between_states(motion, time);
    const bool moves = motion.steps > 0;
    vec3 p0 = STATE_BETWEEN(scene->light_states, p0), p1 = STATE_BETWEEN(scene->light_states, p1),
         p2 = STATE_BETWEEN(scene->light_states, p2);
    const bool pointed = (kind == LIGHT_DISK) | (kind == LIGHT_CYLINDER) | (kind == LIGHT_DIRECTIONAL);
    const bool turns = kind == LIGHT_ENVMAP;
    const UnitAxes axes = unit_axes(p0, p2, p1);
    p0 = select3(turns, axes.x, p0);
    p1 = select3(turns, axes.z, select3(pointed, normalize3(p1), p1));
    p2 = select3(turns, axes.y, p2);
    light.p0 = select3(moves, p0, light.p0);
    light.p1 = select3(moves, p1, light.p1);
    light.p2 = select3(moves, p2, light.p2);
    light.area = moves ? moved_area(kind, p0, p1, p2, light.area) : light.area;
  }
  return light;
}

/// Light `index` at `time`, 0 to 1.
FN Light light_at(const PRIVATE Scene* scene, int index, float time, ulong strategies) {
  const int kind = scene->lights[index].kind;
  return light_of_kind_at(scene, index, kind, time, strategies);
}

/// The beam of light `index`, a spot light or projector, at `time`; of other lights an arbitrary one.
FN Beam beam_at(const PRIVATE Scene* scene, int index, float time, ulong strategies) {
  const int own = scene->lights[index].beam;
  const bool has_beam = (own >= 0) & (own < scene->header.tables.beams.count);
  Beam beam = load_beam(scene->beams + (has_beam ? own : 0));
  if (BY(strategies, MOTION)) {
    const Motion motion = load_motion(scene->light_motions + index);
    const Between b = between_states(motion, time);
    const bool moves = motion.steps > 0;
    const UnitAxes axes =
        unit_axes(STATE_BETWEEN(scene->light_states, x), STATE_BETWEEN(scene->light_states, y),
                  STATE_BETWEEN(scene->light_states, z));
    beam.x = select3(moves, axes.x, beam.x);
    beam.y = select3(moves, axes.y, beam.y);
    beam.z = select3(moves, axes.z, beam.z);
  }
  return beam;
}

/// A vector in the frame of the quadric of light `index`, which is a sphere, disk or cylinder, at `time`.
FN vec3 to_light_frame(const PRIVATE Scene* scene, int index, float time, vec3 v, ulong strategies) {
  vec3 in_frame = to_quadric_frame(quadric_of_light(scene, index), v);
  if (BY(strategies, MOTION)) {
    const bool known = index < scene->header.tables.light_triangles.count;
    const int quadric = scene->light_triangles[known ? index : 0].quadric - scene->shutter->still_quadrics;
    const bool moves = (quadric >= 0) & (quadric < scene->header.tables.quadric_motions.count);
    const Between b = between_states(load_motion(scene->quadric_motions + (moves ? quadric : 0)), time);
    const vec3 x = normalize3(STATE_BETWEEN(scene->quadric_states, x_axis)),
               y = normalize3(STATE_BETWEEN(scene->quadric_states, y_axis)),
               z = normalize3(STATE_BETWEEN(scene->quadric_states, normal));
    in_frame = select3(moves, make_vec3(dot3(v, x), dot3(v, y), dot3(v, z)), in_frame);
  }
  return in_frame;
}

PENUMBRA_NAMESPACE_END
#endif
