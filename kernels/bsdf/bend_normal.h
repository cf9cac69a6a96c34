// Shading normals bent by normal maps and bump maps: a texture decides their direction in the frame of the
// surface's own shading normal.
//
// The bent normal stays on the side of wo and faces it. If the texture's normal would not, it is tilted the
// other way by the same amount, as in Mitsuba 3 from 3.7 on (Schuessler et al. 2017 discuss why). If it
// points into the surface, the surface's own normal is used.
//
// A coat with a normal of its own has that of the surface, or another texture bends it in the same way.
//
// Then tangents are turned about these normals, by the angle from the tangent to the cross product of the
// front's normal and the tangent, or the other way where the material's `turn` is -1. A texture's value t is
// the direction (2 t.x - 1, 2 t.y - 1) in these axes before the turn.
#ifndef PENUMBRA_BEND_NORMAL_H
#define PENUMBRA_BEND_NORMAL_H
#include "kernels/intersect/surface_uv.h"
#include "kernels/math/frame.h"
#include "kernels/motion/moving_surface.h"
#include "kernels/scene.h"
#include "kernels/texture/texture.h"

PENUMBRA_NAMESPACE_BEGIN

/// A bent shading normal: the direction of along + up n, where n is the surface's shading normal and `along`
/// is tangential.
#define BEND_FIELDS(F, a) \
  F(a, vec3, along)       \
  F(a, float, up)
LANE_RECORD(Bend, Bends, bend, BEND_FIELDS)

// Derivatives of the position by the texture coordinates.
#define DERIVATIVES_FIELDS(F, a) \
  F(a, vec3, du)                 \
  F(a, vec3, dv)
LANE_RECORD(Derivatives, DerivativesLanes, derivatives, DERIVATIVES_FIELDS)

/// Of the triangle p0, p1, p2 with the texture coordinates `at`.
FN Derivatives triangle_derivatives(GLOBAL const VertexUvs* at, vec3 p0, vec3 p1, vec3 p2, vec3 normal) {
  const vec3 e1 = sub(p1, p0), e2 = sub(p2, p0);
  const float u1 = at->u1 - at->u0, v1 = at->v1 - at->v0, u2 = at->u2 - at->u0, v2 = at->v2 - at->v0;
  const float determinant = u1 * v2 - v1 * u2;
  const bool some = determinant != 0.0f;
  const float inverse = 1.0f / (some ? determinant : 1.0f);
  const vec3 axis = tangent_axis(normal, make_vec3(0.0f, 0.0f, 0.0f));
  Derivatives d;
  d.du = select3(some, scale(sub(scale(e1, v2), scale(e2, v1)), inverse), axis);
  d.dv = select3(some, scale(sub(scale(e2, u1), scale(e1, u2)), inverse), cross3(normal, axis));
  return d;
}

/// For the coordinates of sphere_uv, disk_uv and cylinder_uv.
FN Derivatives quadric_derivatives(Quadric q, vec3 p) {
  const int kind = q.kind;
  const float radius = q.radius;
  const vec3 x = q.x_axis, y = q.y_axis, z = q.normal;
  const vec3 c = to_quadric_frame(q, sub(p, q.center));
  const float r = max_f(SQRT(sqr(c.x) + sqr(c.y)), 1e-30f);
  const vec3 around = add_scaled(scale(x, -c.y), c.x, y), outward = add_scaled(scale(x, c.x / r), c.y / r, y);
  Derivatives sphere, disk, d;
  sphere.du = disk.dv = scale(around, 2.0f * PI_F);
  sphere.dv = scale(add_scaled(scale(outward, c.z), -r, z), PI_F);
  disk.du = scale(outward, radius);
  d.du = select3(kind == QUADRIC_DISK, disk.du, sphere.du);
  d.dv = select3(kind == QUADRIC_DISK, disk.dv, sphere.dv);
  if (HAS(CYLINDERS)) d.dv = select3(kind == QUADRIC_CYLINDER, scale(z, q.length), d.dv);
  return d;
}

/// The quadric of a surface whose primitive is one.
FN Quadric quadric_of(const PRIVATE Scene* scene, Surface s) {
  const int quadric = s.primitive - scene->header.tables.triangles.count;
  return load_quadric(scene->quadrics + (quadric >= 0 ? quadric : 0));
}

/// `d`: the derivatives as if the primitive were not instanced; `at`: its instance, if it is.
FN Derivatives instance_derivatives(const PRIVATE Scene* scene, Surface s, Instance at, Derivatives d) {
  const int triangles = scene->header.tables.triangles.count;
  const bool is_quadric = s.primitive >= triangles;
  Derivatives own = d;
  if (HAS(QUADRICS)) {
    const Derivatives q = quadric_derivatives(quadric_of(scene, s), to_group_point(at, s.p));
    own.du = select3(is_quadric, q.du, own.du);
    own.dv = select3(is_quadric, q.dv, own.dv);
  }
  const bool moves = s.instance >= 0;
  Derivatives there;
  there.du = select3(moves, from_group_vector(at, own.du), d.du);
  there.dv = select3(moves, from_group_vector(at, own.dv), d.dv);
  return there;
}

FN Derivatives surface_derivatives(const PRIVATE Scene* scene, Surface s, vec3 front) {
  const int triangles = scene->header.tables.triangles.count;
  const bool is_triangle = (s.primitive >= 0) & (s.primitive < triangles);
  const int index = is_triangle ? s.primitive : 0;
  GLOBAL const Triangle* triangle = scene->triangles + index;
  Derivatives d = triangle_derivatives(uvs_of(scene, index), load3(&triangle->p0), load3(&triangle->p1),
                                       load3(&triangle->p2), front);
  if (HAS(QUADRICS)) {
    const bool is_quadric = s.primitive >= triangles;
    const Derivatives q = quadric_derivatives(quadric_of(scene, s), s.p);
    d.du = select3(is_quadric, q.du, d.du);
    d.dv = select3(is_quadric, q.dv, d.dv);
  }
  return d;
}

/// What bends normals: textures, or -1, and the fields of materials for them.
typedef struct {
  int textures[LANES];
  float scales[LANES], steps[LANES];
} BendLanes;

/// Of the materials that bend normals in this way (BEND_*); `coat`: those of their coats. Returns whether
/// there are any.
STAGE bool note_bends(const PRIVATE Scene* scene, int way, bool coat,
                      const PRIVATE Surfaces* RESTRICT surfaces, PRIVATE BendLanes* RESTRICT by) {
  int any = 0;
  for (int j = 0; j < LANES; j++) {
    GLOBAL const Material* m = scene->materials + surfaces->material[j];
    const int texture = coat ? m->coat_bend_texture : m->bend_texture;
    by->textures[j] = (coat ? m->coat_bend : m->bend) == way ? texture : -1;
    by->scales[j] = coat ? m->coat_bend_scale : m->bend_scale;
    by->steps[j] = coat ? m->coat_bend_step : m->bend_step;
    any |= by->textures[j] >= 0 ? 1 : 0;
  }
  return any != 0;
}

/// A normal map's value t is the vector 2 t - 1 in a frame of three axes: the tangent, the cross product of
/// the front's normal and the tangent times the surface's hand, and the normal of the visible side. From
/// behind, the same bumps appear mirrored.
STAGE void bends_of_normals(const PRIVATE Surfaces* RESTRICT surfaces, const PRIVATE BendLanes* RESTRICT by,
                            const PRIVATE TextureLanes* RESTRICT found, PRIVATE Bends* RESTRICT bends) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      const vec3 value = LOAD_LANE_vec3(found->value, j);
      const float lean = by->scales[j];
      const vec3 x = tangent_axis(s.shading, s.tangent);
      const vec3 y = scale(cross3(s.shading, x), s.front ? s.hand : -s.hand);
      Bend bend;
      bend.along = add(scale(x, lean * (2.0f * value.x - 1.0f)), scale(y, lean * (2.0f * value.y - 1.0f)));
      bend.up = 2.0f * value.z - 1.0f;
      store_bend(bends, j, bend);
    }
}

/// Moves the texture coordinates by `u_steps` and `v_steps` times the materials' steps.
STAGE void move_coordinates(const PRIVATE BendLanes* RESTRICT by, float u_steps, float v_steps,
                            PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      surfaces->u[j] += u_steps * by->steps[j];
      surfaces->v[j] += v_steps * by->steps[j];
    }
}

STAGE void note_heights(const PRIVATE TextureLanes* RESTRICT found, PRIVATE float* RESTRICT heights) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) heights[j] = luminance(LOAD_LANE_vec3(found->value, j));
}

STAGE void find_derivatives(const PRIVATE Scene* scene, const PRIVATE Surfaces* RESTRICT surfaces,
                            PRIVATE DerivativesLanes* RESTRICT derivatives) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      store_derivatives(derivatives, j,
                        surface_derivatives(scene, s, scale(s.shading, s.front ? 1.0f : -1.0f)));
    }
}

STAGE void find_instance_derivatives(const PRIVATE Scene* scene, const PRIVATE Surfaces* RESTRICT surfaces,
                                     PRIVATE DerivativesLanes* RESTRICT derivatives) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      const Instance at = load_instance(scene->instances + (s.instance >= 0 ? s.instance : 0));
      store_derivatives(derivatives, j, instance_derivatives(scene, s, at, load_derivatives(derivatives, j)));
    }
}

/// Of surfaces that move, at their times.
FN void find_moving_derivatives(const PRIVATE Scene* scene, const PRIVATE Surfaces* surfaces,
                                PRIVATE DerivativesLanes* derivatives) {
  for (int j = 0; j < LANES; j++) {
    Surface s = load_surface(surfaces, j);
    if (!NEEDS(scene, INSTANCES)) s.instance = -1;
    const vec3 front = scale(s.shading, s.front ? 1.0f : -1.0f);
    if (HAS(INSTANCES) && is_moving_instance(scene, s.instance)) {
      const Instance at = instance_at(scene, s.instance, s.time);
      store_derivatives(derivatives, j,
                        instance_derivatives(scene, s, at, surface_derivatives(scene, s, front)));
    } else if (is_moving_triangle(scene, s.primitive, s.instance)) {
      const TriangleState at = triangle_at(scene, s.primitive, s.time);
      store_derivatives(derivatives, j,
                        triangle_derivatives(uvs_of(scene, s.primitive), at.p0, at.p1, at.p2, front));
    } else if (HAS(QUADRICS) && is_moving_quadric(scene, s.primitive, s.instance)) {
      const int quadric = s.primitive - scene->header.tables.triangles.count;
      store_derivatives(derivatives, j, quadric_derivatives(quadric_at(scene, quadric, s.time), s.p));
    }
  }
}

/// Of curves.
FN void find_curve_derivatives(const PRIVATE Scene* scene, const PRIVATE Surfaces* surfaces,
                               PRIVATE DerivativesLanes* derivatives) {
  for (int j = 0; j < LANES; j++) {
    const Surface s = load_surface(surfaces, j);
    const int curve = curve_of(scene, s.primitive);
    if (curve < 0) continue;
    const Quadric q = load_quadric(scene->quadrics + curve);
    const vec3 front = scale(s.shading, s.front ? 1.0f : -1.0f);
    Derivatives d;
    if (HAS(INSTANCES) && NEEDS(scene, INSTANCES) && s.instance >= 0) {
      const Instance at = instance_of(scene, s.instance, NEEDS_MOTION(scene) ? s.time : 0.0f);
      const vec3 there = make_vec3(dot3(at.x, front), dot3(at.y, front), dot3(at.z, front));
      curve_derivatives(q, s.u, s.v, normalize_any(there), &d.du, &d.dv);
      d.du = from_group_vector(at, d.du);
      d.dv = from_group_vector(at, d.dv);
    } else
      curve_derivatives(q, s.u, s.v, front, &d.du, &d.dv);
    store_derivatives(derivatives, j, d);
  }
}

/// If a surface is displaced along its normal n by h(u, v), its new normal is that of du + h_u n and dv + h_v
/// n (Blinn 1978). The change of n itself is neglected, as in Mitsuba 3.
STAGE void bends_of_heights(const PRIVATE Surfaces* RESTRICT surfaces, const PRIVATE BendLanes* RESTRICT by,
                            const PRIVATE DerivativesLanes* RESTRICT derivatives,
                            const PRIVATE float* RESTRICT heights, PRIVATE Bends* RESTRICT bends) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      const float bump = by->scales[j], step = by->steps[j];
      const float per_step = bump / (2.0f * (step > 0.0f ? step : 1.0f));
      const float h_u = per_step * (heights[j] - heights[LANES + j]);
      const float h_v = per_step * (heights[2 * LANES + j] - heights[3 * LANES + j]);
      const vec3 front = scale(s.shading, s.front ? 1.0f : -1.0f);
      const Derivatives d = load_derivatives(derivatives, j);
      const vec3 du = add_scaled(d.du, -dot3(front, d.du), front);
      const vec3 dv = add_scaled(d.dv, -dot3(front, d.dv), front);
      const float area = dot3(cross3(du, dv), front);
      const vec3 lean = add(scale(cross3(du, front), h_v), scale(cross3(front, dv), h_u));
      Bend bend;
      bend.along = scale(lean, area < 0.0f ? -1.0f : 1.0f);
      bend.up = FABS(area);
      store_bend(bends, j, bend);
    }
}

/// The bent normal of a surface, on the side of wo and facing it.
FN vec3 bent_normal(Surface s, Bend bend) {
  const vec3 up = scale(s.shading, bend.up);
  const vec3 there = add(bend.along, up), mirrored = sub(up, bend.along);
  const vec3 n = select3(dot3(there, s.wo) > 0.0f, there, mirrored);
  const float length2 = dot3(n, n);
  const bool good = (bend.up > 0.0f) & (length2 > 1e-30f) & (length2 < 1e30f) & (dot3(n, s.wo) > 0.0f) &
                    (dot3(n, s.geometric) > 0.0f);
  return select3(good, scale(n, 1.0f / SQRT(good ? length2 : 1.0f)), s.shading);
}

/// The squared roughness of bumps with this bent normal: an eighth of the squared tangent of its angle
/// (Estevez, Lecocq and Stein 2019).
FN float bump_roughness(vec3 smooth, vec3 bent) {
  const float cosine2 = sqr(dot3(smooth, bent));
  return min_f(0.125f * max_f(1.0f - cosine2, 0.0f) / max_f(cosine2, 1e-12f), 1.0f);
}

STAGE void apply_bends(const PRIVATE Scene* scene, const PRIVATE BendLanes* RESTRICT by,
                       const PRIVATE Bends* RESTRICT bends, PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      const vec3 n = bent_normal(s, load_bend(bends, j));
      const bool bends_it = (by->textures[j] >= 0) & is_hit(s);
      const int shadows = scene->materials[s.material].bend_shadows;
      surfaces->bumps[j] = (bends_it & (shadows != 0)) ? bump_roughness(s.shading, n) : s.bumps;
      STORE_LANE_vec3(surfaces->shading, j, select3(bends_it, n, s.shading));
    }
}

/// The same of coats, before the surfaces' own normals are bent.
STAGE void apply_coat_bends(const PRIVATE BendLanes* RESTRICT by, const PRIVATE Bends* RESTRICT bends,
                            PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      const vec3 n = bent_normal(s, load_bend(bends, j));
      STORE_LANE_vec3(surfaces->coat, j, select3((by->textures[j] >= 0) & is_hit(s), n, s.coat));
    }
}
STAGE void start_coats(PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 n = LOAD_LANE_vec3(surfaces->shading, j);
      STORE_LANE_vec3(surfaces->coat, j, n);
    }
}

/// The textures of the materials that turn tangents, or -1. Returns whether any material does.
STAGE bool note_turn_textures(const PRIVATE Scene* scene, const PRIVATE Surfaces* RESTRICT surfaces,
                              PRIVATE int* RESTRICT textures) {
  int any = 0;
  for (int j = 0; j < LANES; j++) {
    GLOBAL const Material* m = scene->materials + surfaces->material[j];
    textures[j] = m->turn_texture;
    any |= m->turn;
  }
  return any != 0;
}

STAGE void turn_tangents(const PRIVATE Scene* scene, const PRIVATE int* RESTRICT textures,
                         const PRIVATE TextureLanes* RESTRICT found, PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      GLOBAL const Material* m = scene->materials + s.material;
      const vec3 value = LOAD_LANE_vec3(found->value, j);
      const int turn = m->turn;
      const bool mapped = textures[j] >= 0;
      const float u = mapped ? 2.0f * value.x - 1.0f : 1.0f, v = mapped ? 2.0f * value.y - 1.0f : 0.0f;
      const float cosine = m->turn_cosine, sine = m->turn_sine;
      const float side = s.front ? (float)turn : -(float)turn;
      const vec3 x = tangent_axis(s.shading, s.tangent);
      const vec3 turned =
          add(scale(x, cosine * u - sine * v), scale(cross3(s.shading, x), side * (sine * u + cosine * v)));
      STORE_LANE_vec3(surfaces->tangent, j, select3((turn != 0) & is_hit(s), turned, s.tangent));
    }
}

/// How materials bend normals, as for note_bends. Returns whether any does.
FN bool find_bends(const PRIVATE Scene* scene, int way, bool coat, PRIVATE Surfaces* surfaces,
                   PRIVATE BendLanes* by, PRIVATE Bends* bends) {
  TextureLanes found;
  if (!note_bends(scene, way, coat, surfaces, by)) return false;
  if (way == BEND_NORMAL_MAP) {
    eval_textures(scene, surfaces, by->textures, &found);
    bends_of_normals(surfaces, by, &found, bends);
    return true;
  }
  float heights[4 * LANES], u[LANES], v[LANES];
  for (int j = 0; j < LANES; j++) {
    u[j] = surfaces->u[j];
    v[j] = surfaces->v[j];
  }
  for (int k = 0; k < 4; k++) {
    move_coordinates(by, k == 0 ? 1.0f : (k == 1 ? -1.0f : 0.0f), k == 2 ? 1.0f : (k == 3 ? -1.0f : 0.0f),
                     surfaces);
    eval_textures(scene, surfaces, by->textures, &found);
    note_heights(&found, heights + k * LANES);
    for (int j = 0; j < LANES; j++) {
      surfaces->u[j] = u[j];
      surfaces->v[j] = v[j];
    }
  }
  DerivativesLanes derivatives;
  find_derivatives(scene, surfaces, &derivatives);
  if (NEEDS(scene, INSTANCES)) find_instance_derivatives(scene, surfaces, &derivatives);
  if (HAS(MOTION) && has_moving_surfaces(scene)) find_moving_derivatives(scene, surfaces, &derivatives);
  if (HAS(CURVES) && NEEDS(scene, CURVES)) find_curve_derivatives(scene, surfaces, &derivatives);
  bends_of_heights(surfaces, by, &derivatives, heights, bends);
  return true;
}

/// Bends the shading normals of the surfaces and of their coats, and turns their tangents. Their materials
/// must be leaves.
FN void bend_normals(const PRIVATE Scene* scene, PRIVATE Surfaces* surfaces) {
  BendLanes by;
  Bends bends;
  const bool coats = NEEDS(scene, COAT_NORMALS);
  if (coats) start_coats(surfaces);
  for (int layer = coats ? 0 : 1; layer < 2; layer++)
    for (int way = BEND_NORMAL_MAP; way <= BEND_BUMP_MAP; way++) {
      const bool coat = HAS(COAT_NORMALS) && layer == 0;
      if (!find_bends(scene, way, coat, surfaces, &by, &bends)) continue;
      if (coat)
        apply_coat_bends(&by, &bends, surfaces);
      else
        apply_bends(scene, &by, &bends, surfaces);
    }
  int textures[LANES];
  TextureLanes found;
  if (note_turn_textures(scene, surfaces, textures)) {
    eval_textures(scene, surfaces, textures, &found);
    turn_tangents(scene, textures, &found, surfaces);
  }
}

/// The fraction of light from or towards w that bumps do not shadow: GGX masking about the smooth normal
/// (Estevez, Lecocq and Stein 2019). 1 if the normal is not bent.
FN float bump_shadow(Surface s, vec3 w) {
  const float cosine2 = sqr(dot3(s.smooth, w));
  const float tangent2 = max_f(1.0f - cosine2, 0.0f) / max_f(cosine2, 1e-12f);
  return 2.0f / (1.0f + SQRT(1.0f + s.bumps * tangent2));
}

PENUMBRA_NAMESPACE_END
#endif
