// Closed forms of polygon lights: what a whole light without anything in its way adds to a diffuse surface
// and to a Phong lobe. In double, since their errors are a bias that no number of samples averages out.
#ifndef PENUMBRA_POLYGON_LIGHT_H
#define PENUMBRA_POLYGON_LIGHT_H
#include "kernels/polygon_edge.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// LANES shading points.
typedef struct {
  double px[LANES], py[LANES], pz[LANES];  ///< position, relative to the scene's centre
  double nx[LANES], ny[LANES], nz[LANES];  ///< unit shading normal on the viewer's side
  double wx[LANES], wy[LANES], wz[LANES];  ///< unit mirror direction of wo about the normal, at most rounding
                                           ///< below the horizon
  double exponent[LANES];  ///< of the Phong lobe, any real number from 0; negative: no lobe is wanted
} Receivers;

/// Adds the edge from corner `from` to corner `to` to each lane's sum.
STAGE void add_polygon_edge(vec3d from, vec3d to, const PRIVATE Receivers* RESTRICT r,
                            PRIVATE double* RESTRICT sum, PRIVATE double* RESTRICT turn_x,
                            PRIVATE double* RESTRICT turn_y) {
  const vec3d d = sub_d(to, from);
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3d x = make_vec3d(r->px[j], r->py[j], r->pz[j]);
      const vec3d n = make_vec3d(r->nx[j], r->ny[j], r->nz[j]);
      IrradianceSum s;
      s.sum = sum[j];
      s.turn_x = turn_x[j];
      s.turn_y = turn_y[j];
      s = add_edge_irradiance(s, sub_d(from, x), sub_d(to, x), d, n);
      sum[j] = s.sum;
      turn_x[j] = s.turn_x;
      turn_y[j] = s.turn_y;
    }
}

/// For polygon `index` of the scene and per unit of its radiance: `irradiance` is the integral of max(0, n.u)
/// over the directions u of its visible part, 0 to pi; `lobe`, where the scene has Phong lobes,
/// (e + 2) / (2 pi) times that of max(0, w.u)^e max(0, n.u), which times specular reflectance and radiance is
/// the reflected radiance. Both LANES long and always written; 0 for a one-sided light seen from behind.
STAGE void polygon_terms(const PRIVATE Scene* scene, const PRIVATE Receivers* r, int index,
                         PRIVATE double* RESTRICT irradiance, PRIVATE double* RESTRICT lobe) {
  GLOBAL const Polygon* polygon = scene->polygons + index;
  GLOBAL const PolygonCorner* corners = scene->polygon_corners + polygon->first_corner;
  const bool two_sided = polygon->two_sided != 0;
  double sum[LANES], turn_x[LANES], turn_y[LANES];
  for (int j = 0; j < LANES; j++) {
    sum[j] = turn_y[j] = 0.0;
    turn_x[j] = 1.0;
  }
  for (int i = 1; i < polygon->corner_count; i++) {
    if (corners[i].starts != 0) continue;
    add_polygon_edge(widen3(load3(&corners[i - 1].p)), widen3(load3(&corners[i].p)), r, sum, turn_x, turn_y);
  }
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      IrradianceSum s;
      s.sum = sum[j];
      s.turn_x = turn_x[j];
      s.turn_y = turn_y[j];
      irradiance[j] = total_irradiance(s, two_sided);
      lobe[j] = 0.0;
    }
}

PENUMBRA_NAMESPACE_END
#endif
