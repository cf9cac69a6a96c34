// Lights at the time of a path. Where a light moves, it is between two of its states; its area follows from
// its shape there. Lights of scenes whose lights stay in place are their records.
//
// Stages that are fast because a scene needs little read those records. All others read the places of LANES
// lights, which place_lights computes for the lanes' times.
//
// Only positions and directions move: radiance, choice and textures of a light are the same at all times.
// Rectangles and constant environments never move: a rectangle between two states may be none, so the two
// triangles of a moving one are lights of their own.
#ifndef PENUMBRA_MOVING_LIGHT_H
#define PENUMBRA_MOVING_LIGHT_H
#include "kernels/intersect/surface_uv.h"
#include "kernels/light/light_kinds.h"
#include "kernels/math/lane_record.h"
#include "kernels/motion/motion.h"

PENUMBRA_NAMESPACE_BEGIN

/// Whether lights are sampled by this strategy; `strategies` is a constant.
#define BY(strategies, name) (HAS(name) && ((strategies)&FEATURE_##name) != 0)

/// Whether any light of the scene moves. If so, each has its Motion.
FN bool lights_move(const PRIVATE Scene* scene) {
  return NEEDS_MOTION(scene) && scene->header.tables.light_motions.count > 0;
}

/// Whether this one does, in a scene where lights_move.
FN bool light_moves(const PRIVATE Scene* scene, int light) { return scene->light_motions[light].steps > 0; }

// What changes of a light that moves, see Light; and the axes of its beam, or of its sphere, disk or
// cylinder.
#define LIGHT_PLACE_FIELDS(F, a) \
  F(a, vec3, p0)                 \
  F(a, vec3, p1)                 \
  F(a, vec3, p2)                 \
  F(a, float, area)
LANE_RECORD(LightPlace, LightPlaces, light_place, LIGHT_PLACE_FIELDS)
#define LIGHT_AXES_FIELDS(F, a) \
  F(a, vec3, x)                 \
  F(a, vec3, y)                 \
  F(a, vec3, z)
LANE_RECORD(LightAxes, LightAxesLanes, light_axes, LIGHT_AXES_FIELDS)

FN LightAxes make_light_axes(vec3 x, vec3 y, vec3 z) {
  LightAxes axes;
  axes.x = x;
  axes.y = y;
  axes.z = z;
  return axes;
}

/// Orthogonal unit axes near these, which are so at the states but not between them: z keeps its direction, x
/// its side of z, y is perpendicular to both.
FN LightAxes unit_axes(vec3 x, vec3 y, vec3 z) {
  LightAxes axes;
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

/// Light `index` at `time`, 0 to 1, in a scene where lights_move.
FN Light moved_light(const PRIVATE Scene* scene, int index, float time) {
  Light light = load_light(scene->lights + index);
  const int kind = light.kind;
  const Motion motion = load_motion(scene->light_motions + index);
  const Between b = between_states(motion, time);
  const bool moves = motion.steps > 0;
  vec3 p0 = STATE_BETWEEN(scene->light_states, p0), p1 = STATE_BETWEEN(scene->light_states, p1),
       p2 = STATE_BETWEEN(scene->light_states, p2);
  const bool pointed =
      (kind == LIGHT_DISK) | (kind == LIGHT_CYLINDER) | (kind == LIGHT_DIRECTIONAL) | (kind == LIGHT_SUN);
  const bool turns = kind == LIGHT_ENVMAP;
  const LightAxes axes = unit_axes(p0, p2, p1);
  p0 = select3(turns, axes.x, p0);
  p1 = select3(turns, axes.z, select3(pointed, normalize3(p1), p1));
  p2 = select3(turns, axes.y, p2);
  light.p0 = select3(moves, p0, light.p0);
  light.p1 = select3(moves, p1, light.p1);
  light.p2 = select3(moves, p2, light.p2);
  light.area = moves ? moved_area(kind, p0, p1, p2, light.area) : light.area;
  return light;
}

/// Light `index` at `time`, 0 to 1; `strategies` is a constant: without FEATURE_MOTION, the light's record.
FN Light light_at(const PRIVATE Scene* scene, int index, float time, ulong strategies) {
  if (BY(strategies, MOTION)) return moved_light(scene, index, time);
  return load_light(scene->lights + index);
}

/// The beam of a spot light or projector; of other lights an arbitrary one.
FN GLOBAL const Beam* beam_of(const PRIVATE Scene* scene, int index) {
  const int beam = scene->lights[index].beam;
  const bool known = (beam >= 0) & (beam < scene->header.tables.beams.count);
  return scene->beams + (known ? beam : 0);
}

/// The axes of light `index`, which is of that kind and does not move; arbitrary if it has none.
FN LightAxes still_axes(const PRIVATE Scene* scene, int index, int kind) {
  if (is_beam_light(kind)) {
    GLOBAL const Beam* beam = beam_of(scene, index);
    return make_light_axes(load3(&beam->x), load3(&beam->y), load3(&beam->z));
  }
  const Quadric q = quadric_of_light(scene, index);
  return make_light_axes(q.x_axis, q.y_axis, q.normal);
}

/// The axes of light `index` at `time`; arbitrary if it has none.
FN LightAxes light_axes_at(const PRIVATE Scene* scene, int index, float time, ulong strategies) {
  const bool beams = is_beam_light(scene->lights[index].kind);
  LightAxes axes =
      select_light_axes(beams, still_axes(scene, index, LIGHT_SPOT), still_axes(scene, index, LIGHT_SPHERE));
  if (BY(strategies, MOTION)) {
    const Motion motion = load_motion(scene->light_motions + index);
    Between b = between_states(motion, time);
    const LightAxes of_beam =
        unit_axes(STATE_BETWEEN(scene->light_states, x), STATE_BETWEEN(scene->light_states, y),
                  STATE_BETWEEN(scene->light_states, z));
    // As quadric_at has them.
    const bool known = index < scene->header.tables.light_triangles.count;
    const int quadric = scene->light_triangles[known ? index : 0].quadric - scene->shutter->still_quadrics;
    const bool turns = (quadric >= 0) & (quadric < scene->header.tables.quadric_motions.count);
    b = between_states(load_motion(scene->quadric_motions + (turns ? quadric : 0)), time);
    const LightAxes of_quadric = make_light_axes(normalize3(STATE_BETWEEN(scene->quadric_states, x_axis)),
                                                 normalize3(STATE_BETWEEN(scene->quadric_states, y_axis)),
                                                 normalize3(STATE_BETWEEN(scene->quadric_states, normal)));
    axes = select_light_axes(beams & (motion.steps > 0), of_beam,
                             select_light_axes(!beams & turns, of_quadric, axes));
  }
  return axes;
}

/// A vector in the frame of axes.
FN vec3 to_light_axes(LightAxes axes, vec3 v) {
  return make_vec3(dot3(v, axes.x), dot3(v, axes.y), dot3(v, axes.z));
}

/// The light at that place.
FN Light placed_light(Light light, LightPlace place) {
  light.p0 = place.p0;
  light.p1 = place.p1;
  light.p2 = place.p2;
  light.area = place.area;
  return light;
}

// Places and axes of `lights`, of which negative ones are none, at `times`.
#define PLACE_LANES(stage_of_places, stage_of_axes, strategies)                                           \
  STAGE void stage_of_places(const PRIVATE Scene* scene, const PRIVATE int* RESTRICT lights,              \
                             const PRIVATE float* RESTRICT times, PRIVATE LightPlaces* RESTRICT places) { \
    LANE_LOOP                                                                                             \
      for (int j = 0; j < LANES; j++) {                                                                   \
        const Light light = light_at(scene, lights[j] >= 0 ? lights[j] : 0, times[j], strategies);        \
        LightPlace place;                                                                                 \
        place.p0 = light.p0;                                                                              \
        place.p1 = light.p1;                                                                              \
        place.p2 = light.p2;                                                                              \
        place.area = light.area;                                                                          \
        store_light_place(places, j, place);                                                              \
      }                                                                                                   \
  }                                                                                                       \
  STAGE void stage_of_axes(const PRIVATE Scene* scene, const PRIVATE int* RESTRICT lights,                \
                           const PRIVATE float* RESTRICT times, PRIVATE LightAxesLanes* RESTRICT axes) {  \
    LANE_LOOP                                                                                             \
      for (int j = 0; j < LANES; j++)                                                                     \
        store_light_axes(axes, j,                                                                         \
                         light_axes_at(scene, lights[j] >= 0 ? lights[j] : 0, times[j], strategies));     \
  }
PLACE_LANES(place_still_lights, place_still_axes, 0u)
PLACE_LANES(place_moving_lights, place_moving_axes, FEATURE_MOTION)
#undef PLACE_LANES

/// Places of LANES lights, of which negative ones are none, at `times`, which only scenes with FEATURE_MOTION
/// have.
FN void place_lights(const PRIVATE Scene* scene, const PRIVATE int* lights, const PRIVATE float* times,
                     PRIVATE LightPlaces* places) {
  if (lights_move(scene))
    place_moving_lights(scene, lights, times, places);
  else
    place_still_lights(scene, lights, times, places);
}

/// Whether the scene has lights whose samples need axes.
FN bool needs_light_axes(const PRIVATE Scene* scene) {
  const bool round = NEEDS_LIGHT(scene, SPHERE) || NEEDS_LIGHT(scene, DISK) || NEEDS_LIGHT(scene, CYLINDER);
  return (NEEDS(scene, UV) && round) || NEEDS_LIGHT(scene, SPOT) || NEEDS_LIGHT(scene, PROJECTOR) ||
         NEEDS_LIGHT(scene, ROUND_SPOT);
}

/// Their axes, if the scene needs them.
FN void place_light_axes(const PRIVATE Scene* scene, const PRIVATE int* lights, const PRIVATE float* times,
                         PRIVATE LightAxesLanes* axes) {
  if (!needs_light_axes(scene)) return;
  if (lights_move(scene))
    place_moving_axes(scene, lights, times, axes);
  else
    place_still_axes(scene, lights, times, axes);
}

PENUMBRA_NAMESPACE_END
#endif
