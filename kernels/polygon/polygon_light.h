// Closed forms of polygon lights: the unoccluded contribution of a whole light to a diffuse surface and to a
// Phong lobe. They are computed in double, since their errors are a bias that no number of samples averages
// out.
#ifndef PENUMBRA_POLYGON_LIGHT_H
#define PENUMBRA_POLYGON_LIGHT_H
#include "kernels/bsdf/families.h"
#include "kernels/polygon/polygon_edge.h"
#include "kernels/polygon/polygon_lobe_lanes.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

FN vec3d receiver_point(const PRIVATE Receivers* r, int j) {
  return make_vec3d(r->px[j], r->py[j], r->pz[j]);
}
FN vec3d receiver_normal(const PRIVATE Receivers* r, int j) {
  return make_vec3d(r->nx[j], r->ny[j], r->nz[j]);
}
FN vec3d receiver_mirror(const PRIVATE Receivers* r, int j) {
  return make_vec3d(r->wx[j], r->wy[j], r->wz[j]);
}

/// An IrradianceSum for each lane.
typedef struct {
  double sum[LANES], turn_x[LANES], turn_y[LANES];
} IrradianceSums;

FN void add_lane_irradiance(PRIVATE IrradianceSums* sums, int j, VisibleEdge e, double angle, vec3d n) {
  IrradianceSum s;
  s.sum = sums->sum[j];
  s.turn_x = sums->turn_x[j];
  s.turn_y = sums->turn_y[j];
  s = add_irradiance(s, e, angle, n);
  sums->sum[j] = s.sum;
  sums->turn_x[j] = s.turn_x;
  sums->turn_y[j] = s.turn_y;
}

/// Points where edges cross the lanes' horizons.
typedef struct {
  double x[LANES], y[LANES], z[LANES], crossing[LANES];  ///< see VisibleEdge
} Crossings;

/// Adds the arcs of the edge from corner `from` to corner `to` to each lane's sum. Returns whether the edge
/// crosses any lane's horizon, which is rare.
STAGE int add_edge_arcs(vec3d from, vec3d to, const PRIVATE Receivers* RESTRICT r,
                        PRIVATE IrradianceSums* RESTRICT sums, PRIVATE Crossings* RESTRICT crossings) {
  const vec3d d = sub_d(to, from);
  int any = 0;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3d x = receiver_point(r, j), n = receiver_normal(r, j);
      const VisibleEdge e = visible_edge(sub_d(from, x), sub_d(to, x), d, n);
      const vec3d q = crossing_place(e);
      sums->sum[j] += atan2_d(e.sine, e.cosine) * dot3_d(e.normal, n);
      crossings->x[j] = q.x;
      crossings->y[j] = q.y;
      crossings->z[j] = q.z;
      crossings->crossing[j] = e.crossing;
      any |= e.crossing != 0.0 ? 1 : 0;
    }
  return any;
}

STAGE void add_crossings(const PRIVATE Receivers* RESTRICT r, const PRIVATE Crossings* RESTRICT crossings,
                         PRIVATE IrradianceSums* RESTRICT sums) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      IrradianceSum s;
      s.sum = 0.0;
      s.turn_x = sums->turn_x[j];
      s.turn_y = sums->turn_y[j];
      s = add_crossing(s, crossings->crossing[j],
                       make_vec3d(crossings->x[j], crossings->y[j], crossings->z[j]), receiver_normal(r, j));
      sums->turn_x[j] = s.turn_x;
      sums->turn_y[j] = s.turn_y;
    }
}

FN void add_edge_irradiances(vec3d from, vec3d to, const PRIVATE Receivers* r, PRIVATE IrradianceSums* sums) {
  Crossings crossings;
  if (add_edge_arcs(from, to, r, sums, &crossings) != 0) add_crossings(r, &crossings, sums);
}

/// Points where outlines cross the horizon. Along it, arcs lead from where an outline sets to where it rises.
/// All crossings are within half a turn, so it does not matter which ones are joined. On each loop, rising
/// and setting alternate, and every second crossing is joined to the one before it.
typedef struct {
  double x[LANES], y[LANES], z[LANES], crossing[LANES];  ///< of the current edge, see VisibleEdge
  double ax[LANES], ay[LANES], az[LANES];
  double bx[LANES], by[LANES], bz[LANES];
  double open[LANES];  ///< not 0: `a` is waiting for `b`
  double pair[LANES];  ///< 1: the arc is from a to b; -1: from b to a; 0: not yet
  double sum[LANES];   ///< over the horizon's arcs only, so that its order does not depend on other lanes
} Horizon;

/// Adds the edge from `from` to `to` = from + d to lane j's irradiance; also computes its arc and crossing.
FN void add_lane_edge(vec3d from, vec3d to, vec3d d, int j, const PRIVATE Receivers* r,
                      PRIVATE IrradianceSums* sums, const PRIVATE Lobes* lobes, PRIVATE LobeArcs* arcs,
                      PRIVATE Horizon* horizon) {
  const vec3d x = receiver_point(r, j), n = receiver_normal(r, j), w = receiver_mirror(r, j);
  const VisibleEdge e = visible_edge(sub_d(from, x), sub_d(to, x), d, n);
  const double angle = atan2_d(e.sine, e.cosine);
  add_lane_irradiance(sums, j, e, angle, n);
  const double visible = angle > 0.0 ? 1.0 : 0.0;
  store_lobe_arc(arcs, j, lobes, e.from, e.normal, e.sine, e.cosine, angle, n, w, visible);
  const vec3d q = crossing_place(e);
  horizon->x[j] = q.x;
  horizon->y[j] = q.y;
  horizon->z[j] = q.z;
  horizon->crossing[j] = e.crossing;
}

/// Like add_edge_irradiances, by add_lane_edge.
STAGE void add_edges(vec3d from, vec3d to, const PRIVATE Receivers* RESTRICT r,
                     PRIVATE IrradianceSums* RESTRICT sums, const PRIVATE Lobes* RESTRICT lobes,
                     PRIVATE LobeArcs* RESTRICT arcs, PRIVATE Horizon* RESTRICT horizon) {
  const vec3d d = sub_d(to, from);
  LANE_LOOP
    for (int j = 0; j < LANES; j++) add_lane_edge(from, to, d, j, r, sums, lobes, arcs, horizon);
}

/// Adds the arcs between pairs of crossings.
STAGE void add_horizon_arcs(const PRIVATE Receivers* RESTRICT r, const PRIVATE Lobes* RESTRICT lobes,
                            PRIVATE Horizon* RESTRICT horizon) {
  LobeArcs arcs;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3d n = receiver_normal(r, j), w = receiver_mirror(r, j);
      const vec3d a = make_vec3d(horizon->ax[j], horizon->ay[j], horizon->az[j]);
      const vec3d b = make_vec3d(horizon->bx[j], horizon->by[j], horizon->bz[j]);
      const double turn = dot3_d(n, cross3_d(a, b)), cosine = dot3_d(a, b);
      const vec3d g = scale_d(n, turn < 0.0 ? -1.0 : 1.0);
      const double sine = FABS_D(turn);
      store_lobe_arc(&arcs, j, lobes, a, g, sine, cosine, atan2_d(sine, cosine), n, w, horizon->pair[j]);
      horizon->pair[j] = 0.0;
    }
  add_lobe_arcs(lobes, &arcs, horizon->sum);
}

/// Joins the current edges' crossings to pairs.
STAGE void join_crossings(const PRIVATE Receivers* RESTRICT r, const PRIVATE Lobes* RESTRICT lobes,
                          PRIVATE Horizon* RESTRICT horizon) {
  double crossings = 0.0, full = 0.0;
  for (int j = 0; j < LANES; j++) {
    const double crosses = FABS_D(horizon->crossing[j]);
    crossings += crosses;
    full += crosses * FABS_D(horizon->pair[j]);
  }
  if (full > 0.0) add_horizon_arcs(r, lobes, horizon);
  if (crossings == 0.0) return;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const double crossing = horizon->crossing[j], open = horizon->open[j];
      const bool opens = (crossing != 0.0) & (open == 0.0), closes = (crossing != 0.0) & (open != 0.0);
      horizon->ax[j] = opens ? horizon->x[j] : horizon->ax[j];
      horizon->ay[j] = opens ? horizon->y[j] : horizon->ay[j];
      horizon->az[j] = opens ? horizon->z[j] : horizon->az[j];
      horizon->bx[j] = closes ? horizon->x[j] : horizon->bx[j];
      horizon->by[j] = closes ? horizon->y[j] : horizon->by[j];
      horizon->bz[j] = closes ? horizon->z[j] : horizon->bz[j];
      horizon->pair[j] = closes ? crossing : horizon->pair[j];
      horizon->open[j] = opens ? crossing : (closes ? 0.0 : open);
    }
}

/// Before the first edge.
FN void start_horizon(PRIVATE Horizon* horizon, PRIVATE double* sum) {
  for (int j = 0; j < LANES; j++) {
    sum[j] = horizon->sum[j] = horizon->open[j] = horizon->pair[j] = 0.0;
    horizon->ax[j] = horizon->ay[j] = horizon->az[j] = 0.0;
    horizon->bx[j] = horizon->by[j] = horizon->bz[j] = 0.0;
  }
}

/// After each edge, and after the last one.
FN void add_arcs_of_edge(const PRIVATE Receivers* r, const PRIVATE Lobes* lobes, const PRIVATE LobeArcs* arcs,
                         PRIVATE Horizon* horizon, PRIVATE double* sum) {
  add_lobe_arcs(lobes, arcs, sum);
  join_crossings(r, lobes, horizon);
}
FN void add_last_horizon(const PRIVATE Receivers* r, const PRIVATE Lobes* lobes, PRIVATE Horizon* horizon,
                         PRIVATE double* sum) {
  double pairs = 0.0;
  for (int j = 0; j < LANES; j++) pairs += FABS_D(horizon->pair[j]);
  if (pairs > 0.0) add_horizon_arcs(r, lobes, horizon);
  for (int j = 0; j < LANES; j++) sum[j] += horizon->sum[j];
}

/// Irradiance and lobe together. `sum` is (e + 2) times the lobe's integral, with the sign of the light's
/// orientation.
STAGE void add_polygon_with_lobes(GLOBAL const PolygonCorner* corners, int count,
                                  const PRIVATE Receivers* RESTRICT r, const PRIVATE Lobes* RESTRICT lobes,
                                  PRIVATE IrradianceSums* RESTRICT sums, PRIVATE double* RESTRICT sum) {
  LobeArcs arcs;
  Horizon horizon;
  start_horizon(&horizon, sum);
  for (int i = 1; i < count; i++) {
    if (corners[i].starts != 0) continue;
    add_edges(widen3(load3(&corners[i - 1].p)), widen3(load3(&corners[i].p)), r, sums, lobes, &arcs,
              &horizon);
    add_arcs_of_edge(r, lobes, &arcs, &horizon, sum);
  }
  add_last_horizon(r, lobes, &horizon, sum);
}

/// Lane j's Phong lobe from the sum over a polygon's edges, see add_polygon_with_lobes.
FN double total_lobe(const PRIVATE Receivers* r, int j, double sum, bool two_sided) {
  const double total = -0.5 / PI_D * sum;
  return r->exponent[j] >= 0.0 ? max_d(two_sided ? FABS_D(total) : total, 0.0) : 0.0;
}

/// Transforms a world-space vector to the space where lane j's lobe is a cosine about the z axis.
FN vec3d lane_to_cosine_space(const PRIVATE Receivers* r, int j, vec3d v) {
  const vec3d n = receiver_normal(r, j), t = make_vec3d(r->tx[j], r->ty[j], r->tz[j]);
  const double z = dot3_d(n, v);
  return make_vec3d((dot3_d(t, v) - r->shift[j] * z) * r->inverse_x[j],
                    dot3_d(cross3_d(n, t), v) * r->inverse_y[j], z);
}

/// Like add_edge_irradiances, in the spaces of the lanes' cosines.
STAGE void add_ltc_edges(vec3d from, vec3d to, const PRIVATE Receivers* RESTRICT r,
                         PRIVATE IrradianceSums* RESTRICT sums) {
  const vec3d d = sub_d(to, from);
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3d x = receiver_point(r, j), up = make_vec3d(0.0, 0.0, 1.0);
      const vec3d a = lane_to_cosine_space(r, j, sub_d(from, x));
      const vec3d b = lane_to_cosine_space(r, j, sub_d(to, x));
      const VisibleEdge e = visible_edge(a, b, lane_to_cosine_space(r, j, d), up);
      add_lane_irradiance(sums, j, e, atan2_d(e.sine, e.cosine), up);
    }
}

FN void start_irradiances(PRIVATE IrradianceSums* sums) {
  for (int j = 0; j < LANES; j++) {
    sums->sum[j] = sums->turn_y[j] = 0.0;
    sums->turn_x[j] = 1.0;
  }
}

STAGE void total_irradiances(const PRIVATE IrradianceSums* RESTRICT sums, bool two_sided,
                             PRIVATE double* RESTRICT irradiance) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      IrradianceSum s;
      s.sum = sums->sum[j];
      s.turn_x = sums->turn_x[j];
      s.turn_y = sums->turn_y[j];
      irradiance[j] = total_irradiance(s, two_sided);
    }
}

/// For lanes that want a linearly transformed cosine: sets the lobe to the integral of its density over the
/// light, which is the irradiance in the cosine's space, over pi.
STAGE void add_ltc_lobes(GLOBAL const PolygonCorner* corners, int count, bool two_sided,
                         const PRIVATE Receivers* RESTRICT r, PRIVATE double* RESTRICT lobe) {
  IrradianceSums sums;
  double irradiance[LANES];
  start_irradiances(&sums);
  for (int i = 1; i < count; i++) {
    if (corners[i].starts == 0)
      add_ltc_edges(widen3(load3(&corners[i - 1].p)), widen3(load3(&corners[i].p)), r, &sums);
  }
  total_irradiances(&sums, two_sided, irradiance);
  for (int j = 0; j < LANES; j++) lobe[j] = r->inverse_x[j] > 0.0 ? irradiance[j] * (1.0 / PI_D) : lobe[j];
}

FN bool any_wants_ltc(const PRIVATE Receivers* r) {
  bool any = false;
  for (int j = 0; j < LANES; j++) any |= r->inverse_x[j] > 0.0;
  return any;
}

/// The closed forms of polygon `index` of the scene, per unit of its radiance. `irradiance` is the integral
/// of max(0, n.u) over the directions u of its visible part, 0 to pi. `lobe` is, for a Phong lobe, (e + 2) /
/// (2 pi) times the integral of max(0, w.u)^e max(0, n.u): times specular reflectance and radiance it is the
/// reflected radiance. For a linearly transformed cosine it is the integral of its density. Both arrays are
/// LANES long and always written; they are 0 for a one-sided light seen from behind.
///
/// Absolute errors are below 1.4e-14 and 2e-10. Relative errors for a light of small angular size are below
/// 3e-15 / size, for the lobe up to a size of 0.3 / sqrt(max(e, 1)). In the light's plane the result is the
/// limit from either side; on its outline, an arbitrary finite number of the range. A lane's results do not
/// depend on the other lanes.
STAGE void polygon_terms(const PRIVATE Scene* scene, const PRIVATE Receivers* r, int index,
                         PRIVATE double* RESTRICT irradiance, PRIVATE double* RESTRICT lobe) {
  GLOBAL const Polygon* polygon = scene->polygons + index;
  GLOBAL const PolygonCorner* corners = scene->polygon_corners + polygon->first_corner;
  const int count = polygon->corner_count;
  const bool two_sided = polygon->two_sided != 0;
  IrradianceSums sums;
  start_irradiances(&sums);
  for (int j = 0; j < LANES; j++) lobe[j] = 0.0;
  Lobes lobes;
  const bool with_lobes = HAS_FAMILY(PHONG) && start_lobes(r, &lobes);
  if (with_lobes) {
    double lobe_sum[LANES];
    add_polygon_with_lobes(corners, count, r, &lobes, &sums, lobe_sum);
    for (int j = 0; j < LANES; j++) lobe[j] = total_lobe(r, j, lobe_sum[j], two_sided);
  }
  for (int i = 1; i < count; i++) {
    if (!with_lobes & (corners[i].starts == 0))
      add_edge_irradiances(widen3(load3(&corners[i - 1].p)), widen3(load3(&corners[i].p)), r, &sums);
  }
  total_irradiances(&sums, two_sided, irradiance);
  if (NEEDS_LTC(scene) && any_wants_ltc(r)) add_ltc_lobes(corners, count, two_sided, r, lobe);
}

/// The corners of a triangle for each lane, such as a light that moves has at the lanes' times; vec3 lanes.
typedef struct {
  const PRIVATE float* p0;
  const PRIVATE float* p1;
  const PRIVATE float* p2;
} LaneTriangles;

FN vec3d lane_corner(const PRIVATE float* p, int j) { return widen3(LOAD_LANE_vec3(p, j)); }

/// Like add_edges, between corners of each lane's own triangle.
STAGE void add_lane_edges(const PRIVATE float* RESTRICT from, const PRIVATE float* RESTRICT to,
                          const PRIVATE Receivers* RESTRICT r, PRIVATE IrradianceSums* RESTRICT sums,
                          const PRIVATE Lobes* RESTRICT lobes, PRIVATE LobeArcs* RESTRICT arcs,
                          PRIVATE Horizon* RESTRICT horizon) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3d a = lane_corner(from, j), b = lane_corner(to, j);
      add_lane_edge(a, b, sub_d(b, a), j, r, sums, lobes, arcs, horizon);
    }
}

/// The lobes of polygon_terms for a triangle of each lane's own, in lanes with a Phong lobe; 0 in others.
FN void lane_triangle_lobes(const PRIVATE Receivers* r, LaneTriangles triangles, bool two_sided,
                            PRIVATE double* lobe) {
  Lobes lobes;
  for (int j = 0; j < LANES; j++) lobe[j] = 0.0;
  if (!HAS_FAMILY(PHONG) || !start_lobes(r, &lobes)) return;
  IrradianceSums sums;
  LobeArcs arcs;
  Horizon horizon;
  double sum[LANES];
  start_irradiances(&sums);
  start_horizon(&horizon, sum);
  for (int k = 0; k < 3; k++) {
    const PRIVATE float* from = k == 0 ? triangles.p0 : (k == 1 ? triangles.p1 : triangles.p2);
    const PRIVATE float* to = k == 0 ? triangles.p1 : (k == 1 ? triangles.p2 : triangles.p0);
    add_lane_edges(from, to, r, &sums, &lobes, &arcs, &horizon);
    add_arcs_of_edge(r, &lobes, &arcs, &horizon, sum);
  }
  add_last_horizon(r, &lobes, &horizon, sum);
  for (int j = 0; j < LANES; j++) lobe[j] = total_lobe(r, j, sum[j], two_sided);
}

PENUMBRA_NAMESPACE_END
#endif
