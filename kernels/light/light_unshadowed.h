// Unshadowed light at a shading point: the closed form of polygon lights, and the choice of one light in
// proportion to its unshadowed contribution. LANES points at a time, in double, since errors of a closed form
// are a bias of the image.
#ifndef PENUMBRA_LIGHT_UNSHADOWED_H
#define PENUMBRA_LIGHT_UNSHADOWED_H
#include "kernels/bsdf/control_lobes.h"
#include "kernels/bsdf/phong.h"
#include "kernels/intersect/surface.h"
#include "kernels/light/light_sample.h"
#include "kernels/light/projected_light.h"
#include "kernels/polygon/polygon_light.h"

PENUMBRA_NAMESPACE_BEGIN

/// Shading points and their reflectances, one per lane.
typedef struct {
  Receivers receivers;
  double diffuse[3 * LANES];   ///< channel c of lane j is at c * LANES + j; 0 if there is no reflection
  double specular[3 * LANES];  ///< likewise
  int closed[LANES];           ///< 0: the BSDF has no closed form; its lights are chosen by power
  double polygon[LANES];       ///< the polygon light that the point is on, which adds nothing, or -1
  float time[LANES];           ///< of the receivers, see Surface; with FEATURE_MOTION only
} ShadingPoints;

/// Sets lane j to the surface `s`. The position on a triangle is recomputed in double: far from the scene's
/// centre, the deviation of a rounded position from the surface is larger than the closed forms tolerate.
FN void store_shading_point(const PRIVATE Scene* scene, Surface s, Closure c, PRIVATE ShadingPoints* points,
                            int j, ulong strategies) {
  bool on_triangle = is_hit(s) & (s.primitive < scene->header.tables.triangles.count);
  on_triangle = on_triangle & (!NEEDS(scene, INSTANCES) | (s.instance < 0));
  const vec3 o = s.from, d = negate(s.wo);
  GLOBAL const Triangle* t = scene->triangles + (on_triangle ? s.primitive : 0);
  vec3 p0 = load3(&t->p0), p1 = load3(&t->p1), p2 = load3(&t->p2);
  if (BY(strategies, MOTION)) {
    const bool moves = on_triangle & triangle_moves(scene, s.primitive);
    const TriangleState at =
        triangle_at(scene, moves ? s.primitive : scene->shutter->still_triangles, s.time);
    p0 = select3(moves, at.p0, p0);
    p1 = select3(moves, at.p1, p1);
    p2 = select3(moves, at.p2, p2);
    points->time[j] = s.time;
  }
  const double ax = (double)p1.x - p0.x, ay = (double)p1.y - p0.y, az = (double)p1.z - p0.z;
  const double bx = (double)p2.x - p0.x, by = (double)p2.y - p0.y, bz = (double)p2.z - p0.z;
  const double gx = ay * bz - az * by, gy = az * bx - ax * bz, gz = ax * by - ay * bx;
  const double along = gx * d.x + gy * d.y + gz * d.z;
  const double height = gx * ((double)p0.x - o.x) + gy * ((double)p0.y - o.y) + gz * ((double)p0.z - o.z);
  const double distance = height / (along != 0.0 ? along : 1.0);
  const bool meets = on_triangle & (along != 0.0);
  PRIVATE Receivers* r = &points->receivers;
  r->px[j] = meets ? o.x + distance * d.x : (double)s.p.x;
  r->py[j] = meets ? o.y + distance * d.y : (double)s.p.y;
  r->pz[j] = meets ? o.z + distance * d.z : (double)s.p.z;
  const bool faceted = on_triangle & (t->normals < 0);
  const double side = s.front ? 1.0 : -1.0;
  double nx = faceted ? side * gx : (double)s.shading.x, ny = faceted ? side * gy : (double)s.shading.y;
  double nz = faceted ? side * gz : (double)s.shading.z;
  const double n2 = nx * nx + ny * ny + nz * nz;
  const double to_unit = 1.0 / SQRT_D(n2 > 0.0 ? n2 : 1.0);
  nx *= to_unit;
  ny *= to_unit;
  nz = n2 > 0.0 ? nz * to_unit : 1.0;
  r->nx[j] = nx;
  r->ny[j] = ny;
  r->nz[j] = nz;
  const double cosine = -(nx * d.x + ny * d.y + nz * d.z);
  const double wx = 2.0 * cosine * nx + d.x, wy = 2.0 * cosine * ny + d.y, wz = 2.0 * cosine * nz + d.z;
  const double w2 = wx * wx + wy * wy + wz * wz;
  const double shorten = 1.0 / SQRT_D(w2 > 0.0 ? w2 : 1.0);
  r->wx[j] = wx * shorten;
  r->wy[j] = wy * shorten;
  r->wz[j] = wz * shorten;
  const bool closed = has_closed_form(c), lit = is_hit(s) & closed & (dot3(s.shading, s.wo) > 0.0f);
  points->closed[j] = closed ? 1 : 0;
  r->exponent[j] = (lit & (phong_lobe_share(c) > 0.0f)) ? (double)c.exponent : -1.0;
  points->polygon[j] = (double)own_polygon(scene, s.light);
  points->diffuse[j] = lit ? (double)c.diffuse.x : 0.0;
  points->diffuse[LANES + j] = lit ? (double)c.diffuse.y : 0.0;
  points->diffuse[2 * LANES + j] = lit ? (double)c.diffuse.z : 0.0;
  points->specular[j] = lit ? (double)c.specular.x : 0.0;
  points->specular[LANES + j] = lit ? (double)c.specular.y : 0.0;
  points->specular[2 * LANES + j] = lit ? (double)c.specular.z : 0.0;
}

/// Adjusts lane j, set by store_shading_point, if its closure has control lobes.
FN void store_control_point(Surface s, Closure c, ControlLobes control, PRIVATE ShadingPoints* points,
                            int j) {
  const bool has = has_ltc_form(c), lit = is_hit(s) & has & (dot3(s.shading, s.wo) > 0.0f);
  const bool leans = lit & (control.width_x > 0.0f);
  PRIVATE Receivers* r = &points->receivers;
  // The tangent is the mirror direction's component perpendicular to the normal. If that is 0, the lobe is
  // round.
  const double nx = r->nx[j], ny = r->ny[j], nz = r->nz[j];
  const double height = r->wx[j] * nx + r->wy[j] * ny + r->wz[j] * nz;
  const double x = r->wx[j] - height * nx, y = r->wy[j] - height * ny, z = r->wz[j] - height * nz;
  const double t2 = x * x + y * y + z * z;
  const bool across = t2 > 1e-28;
  const double shorten = 1.0 / SQRT_D(across ? t2 : 1.0);
  const vec3 axis = from_frame(s.shading, 1.0f, 0.0f, 0.0f);
  r->tx[j] = across ? x * shorten : (double)axis.x;
  r->ty[j] = across ? y * shorten : (double)axis.y;
  r->tz[j] = across ? z * shorten : (double)axis.z;
  r->inverse_x[j] = leans ? 1.0 / (double)(leans ? control.width_x : 1.0f) : 0.0;
  r->inverse_y[j] = leans ? 1.0 / (double)(leans ? control.width_y : 1.0f) : 0.0;
  r->shift[j] = (double)control.shift;
  r->exponent[j] = has ? -1.0 : r->exponent[j];
  points->closed[j] = has ? 1 : points->closed[j];
  const vec3 diffuse = control.diffuse, specular = control.specular;
  points->diffuse[j] = has ? (lit ? (double)diffuse.x : 0.0) : points->diffuse[j];
  points->diffuse[LANES + j] = has ? (lit ? (double)diffuse.y : 0.0) : points->diffuse[LANES + j];
  points->diffuse[2 * LANES + j] = has ? (lit ? (double)diffuse.z : 0.0) : points->diffuse[2 * LANES + j];
  points->specular[j] = has ? (lit ? (double)specular.x : 0.0) : points->specular[j];
  points->specular[LANES + j] = has ? (lit ? (double)specular.y : 0.0) : points->specular[LANES + j];
  points->specular[2 * LANES + j] = has ? (lit ? (double)specular.z : 0.0) : points->specular[2 * LANES + j];
}

/// A weighted reservoir of one item per lane: of a stream of items it keeps each with a probability
/// proportional to its weight. One random number is used for all decisions. After each it is stretched to [0,
/// 1) again, so that stratified numbers make stratified choices and the remainder can sample a point.
typedef struct {
  double u[LANES];       ///< the random number, or its remainder
  double total[LANES];   ///< sum of all weights
  double weight[LANES];  ///< of the chosen item
  int chosen[LANES];     ///< index of the chosen item, or -1
} Reservoir;

FN void start_reservoir(PRIVATE Reservoir* reservoir, int j, double u) {
  reservoir->u[j] = u;
  reservoir->total[j] = reservoir->weight[j] = 0.0;
  reservoir->chosen[j] = -1;
}

FN void add_to_reservoir(PRIVATE Reservoir* reservoir, int j, int number, double weight) {
  const double total = reservoir->total[j] + weight;
  const double share = weight / (total > 0.0 ? total : 1.0), u = reservoir->u[j];
  const bool taken = (weight > 0.0) & (u < share);
  const double scale = taken ? share : 1.0 - share;
  reservoir->u[j] = (taken ? u : u - share) / (scale > 0.0 ? scale : 1.0);
  reservoir->total[j] = total;
  reservoir->weight[j] = taken ? weight : reservoir->weight[j];
  reservoir->chosen[j] = taken ? number : reservoir->chosen[j];
}

/// Probability of the chosen item.
FN double reservoir_probability(const PRIVATE Reservoir* reservoir, int j) {
  const double total = reservoir->total[j];
  return reservoir->weight[j] / (total > 0.0 ? total : 1.0);
}

/// Whether polygon light `polygon` has a k-th part. part_of: the index of that part among the lights;
/// arbitrary if there is none.
FN bool is_part(const PRIVATE Scene* scene, int polygon, int k) {
  const bool is_polygon = (polygon >= 0) & (polygon < scene->header.tables.polygons.count);
  const int count = scene->polygons[is_polygon ? polygon : 0].light_count;
  return is_polygon & (k < count);
}
FN int part_of(const PRIVATE Scene* scene, int polygon, int k) {
  const bool is_polygon = (polygon >= 0) & (polygon < scene->header.tables.polygons.count);
  GLOBAL const Polygon* p = scene->polygons + (is_polygon ? polygon : 0);
  const int first = p->first_light, count = p->light_count;
  return first + (k < count ? k : 0);
}

/// A rough upper bound of the irradiance from a light without a closed form, averaged over channels. It is
/// good enough for choosing a light. `is_sky`: the light surrounds the scene.
FN double rough_irradiance(GLOBAL const Light* light, bool is_sky, double x, double y, double z) {
  const vec3 p = load3(&light->p0), radiance = load3(&light->radiance);
  const double dx = p.x - x, dy = p.y - y, dz = p.z - z;
  const double d2 = dx * dx + dy * dy + dz * dz;
  const double mean = ((double)radiance.x + radiance.y + radiance.z) / 3.0;
  const double section = light->kind == LIGHT_SPHERE ? 0.25 * light->area : (double)light->area;
  const double pi = 3.14159265358979323846;
  const bool of_point = is_point_of_light(light->kind), across = is_infinite_light(light->kind);
  const bool bounded = !of_point;
  const double solid = of_point ? 1.0 : section;
  const double seen = solid / (d2 > 0.0 ? d2 : 1.0);
  const double limited = ((bounded & (seen > pi)) | (d2 == 0.0)) ? pi : seen;
  const double of_sun = light->kind == LIGHT_SUN ? 2.0 * pi * section : 1.0;
  return mean * (is_sky ? pi : across ? of_sun : limited);
}

/// Lights that lanes sample or have hit, and their places.
typedef struct {
  int lights[LANES];
  LightPlaces places;
} PlacedParts;

FN Light placed_part(const PRIVATE Scene* scene, const PRIVATE PlacedParts* parts, int j) {
  return placed_light(load_light(scene->lights + parts->lights[j]), load_light_place(&parts->places, j));
}

// Projected solid angles of triangle lights at the points; 0 of other kinds. `of_lane` is the lane's light.
#define PART_IRRADIANCES(stage, of_lane)                                                                     \
  STAGE void stage(const PRIVATE Scene* scene, const PRIVATE Receivers* RESTRICT r,                          \
                   const PRIVATE PlacedParts* RESTRICT parts, PRIVATE double* RESTRICT irradiance) {         \
    LANE_LOOP                                                                                                \
      for (int j = 0; j < LANES; j++) {                                                                      \
        const Light light = of_lane;                                                                         \
        irradiance[j] = light_irradiance(light, r->px[j], r->py[j], r->pz[j], r->nx[j], r->ny[j], r->nz[j]); \
      }                                                                                                      \
  }
PART_IRRADIANCES(part_irradiances, placed_part(scene, parts, j))
PART_IRRADIANCES(still_part_irradiances, load_light(scene->lights + parts->lights[j]))
#undef PART_IRRADIANCES

/// Integrals of linearly transformed cosines' densities over triangle lights, times pi; arbitrary in lanes
/// without such a lobe.
STAGE void part_ltcs(const PRIVATE Scene* scene, const PRIVATE Receivers* RESTRICT r,
                     const PRIVATE PlacedParts* RESTRICT parts, PRIVATE double* RESTRICT lobe) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int two_sided = scene->lights[parts->lights[j]].two_sided;
      const LightPlace place = load_light_place(&parts->places, j);
      const vec3d x = receiver_point(r, j);
      const vec3d a = lane_to_cosine_space(r, j, sub_d(widen3(place.p0), x));
      const vec3d b = lane_to_cosine_space(r, j, sub_d(widen3(place.p1), x));
      const vec3d c = lane_to_cosine_space(r, j, sub_d(widen3(place.p2), x));
      lobe[j] = corners_irradiance(a, b, c, sub_d(b, a), sub_d(c, b), sub_d(a, c), make_vec3d(0.0, 0.0, 1.0),
                                   two_sided != 0);
    }
}

/// The closed forms of polygon light `k` at the points' times, see polygon_terms. One that moves is one
/// triangle.
FN void polygon_terms_in_time(const PRIVATE Scene* scene, const PRIVATE ShadingPoints* points, int k,
                              PRIVATE double* irradiance, PRIVATE double* lobe) {
  GLOBAL const Polygon* polygon = scene->polygons + k;
  const PRIVATE Receivers* r = &points->receivers;
  if (!(lights_move(scene) && light_moves(scene, polygon->first_light))) {
    polygon_terms(scene, r, k, irradiance, lobe);
    return;
  }
  PlacedParts only;
  for (int j = 0; j < LANES; j++) only.lights[j] = polygon->first_light;
  place_lights(scene, only.lights, points->time, &only.places);
  part_irradiances(scene, r, &only, irradiance);
  LaneTriangles triangles;
  triangles.p0 = only.places.p0;
  triangles.p1 = only.places.p1;
  triangles.p2 = only.places.p2;
  lane_triangle_lobes(r, triangles, polygon->two_sided != 0, lobe);
  if (!NEEDS_LTC(scene) || !any_wants_ltc(r)) return;
  double ltc[LANES];
  part_ltcs(scene, r, &only, ltc);
  for (int j = 0; j < LANES; j++) lobe[j] = r->inverse_x[j] > 0.0 ? ltc[j] * (1.0 / PI_D) : lobe[j];
}

/// Sums the closed forms of all polygon lights except the point's own: unshadowed reflected radiance towards
/// wo, channel c of lane j at `analytic[c * LANES + j]`. With `choose`, also adds all lights to the
/// reservoir: polygon k as item k, and light k that is not part of a polygon as item polygon_count + k.
STAGE void unshadowed_lights(const PRIVATE Scene* scene, const PRIVATE ShadingPoints* points, bool choose,
                             PRIVATE Reservoir* RESTRICT reservoir, PRIVATE double* RESTRICT analytic) {
  for (int j = 0; j < 3 * LANES; j++) analytic[j] = 0.0;
  for (int k = 0; k < scene->header.tables.polygons.count; k++) {
    double irradiance[LANES], lobe[LANES];
    polygon_terms_in_time(scene, points, k, irradiance, lobe);
    GLOBAL const Polygon* polygon = scene->polygons + k;
    const vec3 radiance = load3(&polygon->radiance);
    LANE_LOOP
      for (int j = 0; j < LANES; j++) {
        const bool own = points->polygon[j] == (double)k;
        const double e = own ? 0.0 : irradiance[j] * (1.0 / 3.14159265358979323846);
        const double l = own ? 0.0 : lobe[j];
        const double r = radiance.x * (points->diffuse[j] * e + points->specular[j] * l);
        const double g = radiance.y * (points->diffuse[LANES + j] * e + points->specular[LANES + j] * l);
        const double b =
            radiance.z * (points->diffuse[2 * LANES + j] * e + points->specular[2 * LANES + j] * l);
        analytic[j] += r;
        analytic[LANES + j] += g;
        analytic[2 * LANES + j] += b;
        if (choose) add_to_reservoir(reservoir, j, k, r + g + b);
      }
  }
  for (int k = 0; choose && k < scene->header.tables.lights.count; k++) {
    GLOBAL const Light* light = scene->lights + k;
    const bool is_sky = k == scene->header.environment;
    if (light->polygon >= 0) continue;
    LANE_LOOP
      for (int j = 0; j < LANES; j++) {
        const PRIVATE Receivers* r = &points->receivers;
        const double reflectance = points->diffuse[j] + points->diffuse[LANES + j] +
                                   points->diffuse[2 * LANES + j] + points->specular[j] +
                                   points->specular[LANES + j] + points->specular[2 * LANES + j];
        const double most = rough_irradiance(light, is_sky, r->px[j], r->py[j], r->pz[j]);
        add_to_reservoir(reservoir, j, scene->header.tables.polygons.count + k, reflectance * most);
      }
  }
}

FN double sum_of_channels(const PRIVATE double* values, int j) {
  return values[j] + values[LANES + j] + values[2 * LANES + j];
}

/// The k-th parts of the chosen polygons: their lights, whether they exist, whether they are sampled by
/// projected solid angle, and their areas as weights.
STAGE void find_parts(const PRIVATE Scene* scene, const PRIVATE Reservoir* RESTRICT reservoir, int k,
                      PRIVATE int* RESTRICT lights, PRIVATE int* RESTRICT exist,
                      PRIVATE int* RESTRICT projected, PRIVATE double* RESTRICT weights) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int light = part_of(scene, reservoir->chosen[j], k);
      lights[j] = light;
      exist[j] = is_part(scene, reservoir->chosen[j], k) ? 1 : 0;
      projected[j] = scene->lights[light].sampling == EMITTER_PROJECTED ? 1 : 0;
      weights[j] = scene->lights[light].area;
    }
}

/// Of parts that are sampled by projected solid angle: sets the weights to it; with `leans`, to what both
/// control lobes receive.
FN void weigh_projected_parts(const PRIVATE Scene* scene, const PRIVATE ShadingPoints* points, bool leans,
                              const PRIVATE int* projected, PRIVATE PlacedParts* parts,
                              PRIVATE double* weights) {
  const PRIVATE Receivers* r = &points->receivers;
  double irradiance[LANES], lobe[LANES];
  const bool moves = lights_move(scene);
  if (moves | leans) place_lights(scene, parts->lights, points->time, &parts->places);
  if (moves) {
    part_irradiances(scene, r, parts, irradiance);
  } else {
    still_part_irradiances(scene, r, parts, irradiance);
  }
  LANE_LOOP
    for (int j = 0; j < LANES; j++) weights[j] = projected[j] != 0 ? irradiance[j] : weights[j];
  if (!HAS(LTC) || !leans) return;
  part_ltcs(scene, r, parts, lobe);
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const double sum =
          sum_of_channels(points->diffuse, j) * weights[j] + sum_of_channels(points->specular, j) * lobe[j];
      weights[j] = ((projected[j] != 0) & (r->inverse_x[j] > 0.0)) ? sum : weights[j];
    }
}

/// Chooses one part of the chosen polygon, in proportion to projected solid angle if the light is sampled by
/// it, else to area. Sets the light and its probability in the samplings, its projected solid angle in
/// `projected`, and the remainder of the random number in `u`.
STAGE void choose_part(const PRIVATE Scene* scene, const PRIVATE ShadingPoints* points, bool by_projection,
                       const PRIVATE Reservoir* RESTRICT reservoir,
                       PRIVATE LightSamplings* RESTRICT samplings, PRIVATE double* RESTRICT projected,
                       PRIVATE float* RESTRICT u) {
  const int polygons = scene->header.tables.polygons.count;
  int parts = 0;
  Reservoir part;
  for (int j = 0; j < LANES; j++) {
    start_reservoir(&part, j, reservoir->u[j]);
    const int chosen = reservoir->chosen[j];
    const int count = ((chosen >= 0) & (chosen < polygons)) ? scene->polygons[chosen].light_count : 0;
    parts = count > parts ? count : parts;
  }
  const bool leans = NEEDS_LTC(scene) && by_projection && any_wants_ltc(&points->receivers);
  for (int k = 0; k < parts; k++) {
    double weights[LANES];
    int exist[LANES], by_angle[LANES];
    PlacedParts these;
    find_parts(scene, reservoir, k, these.lights, exist, by_angle, weights);
    if (HAS(PROJECTED) && by_projection) {
      weigh_projected_parts(scene, points, leans, by_angle, &these, weights);
    }
    LANE_LOOP
      for (int j = 0; j < LANES; j++)
        add_to_reservoir(&part, j, these.lights[j], exist[j] != 0 ? weights[j] : 0.0);
  }
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int chosen = reservoir->chosen[j], chosen_part = part.chosen[j];
      const bool is_polygon = (chosen >= 0) & (chosen < polygons);
      const int other = chosen >= polygons ? chosen - polygons : 0;
      const double share =
          reservoir_probability(reservoir, j) * (is_polygon ? reservoir_probability(&part, j) : 1.0);
      const int light = is_polygon ? (chosen_part >= 0 ? chosen_part : 0) : other;
      samplings->light[j] = points->closed[j] != 0 ? light : -1;
      samplings->pmf[j] = chosen >= 0 ? (float)share : 0.0f;
      projected[j] = is_polygon ? part.weight[j] : 0.0;
      const float left = (float)(is_polygon ? part.u[j] : reservoir->u[j]);
      u[j] = min_f(left, ONE_MINUS_EPSILON);
    }
}

PENUMBRA_NAMESPACE_END
#endif
