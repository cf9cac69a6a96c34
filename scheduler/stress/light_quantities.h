// Quantities of lights: closed forms of polygons, sampling and densities. See quantities.h.
#ifndef PENUMBRA_STRESS_LIGHT_QUANTITIES_H
#define PENUMBRA_STRESS_LIGHT_QUANTITIES_H
#include "kernels/light/light.h"
#include "kernels/light/mis.h"
#include "kernels/light/projected_triangle.h"
#include "kernels/polygon/polygon_light.h"
#include "scheduler/stress/quantity_numbers.h"

PENUMBRA_NAMESPACE_BEGIN

/// In: position, normal, mirror direction, exponent (negative: no lobe), two-sided; number of corners, then
/// for each x, y, z and whether it starts a loop. Out: irradiance, lobe; then the largest difference of any
/// lane from lane 0, which has the same inputs.
STAGE void polygon_quantity(GLOBAL const double* in, GLOBAL double* out, GLOBAL uint* scratch) {
  const Scene scene = scratch_scene(scratch);
  GLOBAL Polygon* polygon = (GLOBAL Polygon*)(scratch + 320);
  GLOBAL PolygonCorner* corners = (GLOBAL PolygonCorner*)(scratch + 384);
  polygon->two_sided = (int)in[10];
  polygon->corner_count = (int)in[11];
  for (int i = 0; i < polygon->corner_count; i++) {
    set_v(&corners[i].p, in_v(in, 12 + 4 * i));
    corners[i].starts = (int)in[15 + 4 * i];
  }
  Receivers r;
  for (int j = 0; j < LANES; j++) {
    r.px[j] = in[0];
    r.py[j] = in[1];
    r.pz[j] = in[2];
    r.nx[j] = in[3];
    r.ny[j] = in[4];
    r.nz[j] = in[5];
    r.wx[j] = in[6];
    r.wy[j] = in[7];
    r.wz[j] = in[8];
    r.exponent[j] = in[9];
    r.tx[j] = r.ty[j] = r.tz[j] = 0.0;
    r.inverse_x[j] = r.inverse_y[j] = r.shift[j] = 0.0;
  }
  double irradiance[LANES], lobe[LANES];
  polygon_terms(&scene, &r, 0, irradiance, lobe);
  out[0] = irradiance[0];
  out[1] = lobe[0];
  out[2] = 0.0;
  for (int j = 1; j < LANES; j++)
    out[2] = max_d(out[2], FABS_D(irradiance[j] - irradiance[0]) + FABS_D(lobe[j] - lobe[0]));
}

/// In: three vertices relative to the shading point, u, v. Out: direction, solid angle.
STAGE void spherical_triangle_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const SphericalTriangle t = spherical_triangle(in_v(in, 0), in_v(in, 3), in_v(in, 6));
  out_v(out, 0, sample_spherical_triangle(t, in_f(in, 9), in_f(in, 10)));
  out[3] = t.solid_angle;
}

/// In: corner, next, previous, u, v. Out: direction, solid angle.
STAGE void spherical_rectangle_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const SphericalRectangle r = spherical_rectangle(in_v(in, 0), in_v(in, 3), in_v(in, 6));
  out_v(out, 0, sample_spherical_rectangle(r, in_f(in, 9), in_f(in, 10)));
  out[3] = r.solid_angle;
}

/// In: three vertices in the receiver's frame, u, v; an axis w, size N of a grid. Out: direction, projected
/// solid angle (0: not sampled); mean of w.u over N x N samples at the centres of the cells of (u, v); the
/// number of samples that are not unit vectors above the horizon.
STAGE void projected_triangle_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const ProjectedPolygon p = project_triangle(in_v(in, 0), in_v(in, 3), in_v(in, 6));
  out_v(out, 0, sample_projected_polygon(p, in_f(in, 9), in_f(in, 10)));
  out[3] = p.area;
  const vec3 w = in_v(in, 11);
  const int size = (int)in[14];
  double sum = 0.0, bad = 0.0;
  for (int i = 0; i < size; i++) {
    for (int k = 0; k < size; k++) {
      const vec3 d =
          sample_projected_polygon(p, ((float)i + 0.5f) / (float)size, ((float)k + 0.5f) / (float)size);
      sum += dot3(w, d);
      bad += ((FABS(dot3(d, d) - 1.0f) < 1e-5f) & (d.z >= 0.0f)) ? 0.0 : 1.0;
    }
  }
  out[4] = sum / max_d((double)size * (double)size, 1.0);
  out[5] = bad;
}

/// In: HEURISTIC_*, density of the sampled strategy, density of the other. Out: MIS weight.
STAGE void mis_quantity(GLOBAL const double* in, GLOBAL double* out) {
  out[0] = mis_weight((int)in[0], in_f(in, 1), in_f(in, 2));
}

/// In: centre and radius of a sphere light, shading point, its normal, u, v. Out: direction, density,
/// sphere_light_pdf of that direction, length of the shadow ray or a negative number.
STAGE void sphere_light_quantity(GLOBAL const double* in, GLOBAL double* out, GLOBAL uint* scratch) {
  const Scene scene = scratch_scene(scratch);
  GLOBAL Light* light = (GLOBAL Light*)(scratch + 256);
  const float radius = in_f(in, 3);
  set_v(&light->radiance, make_vec3(1.0f, 1.0f, 1.0f));
  set_v(&light->p0, in_v(in, 0));
  set_v(&light->p2, make_vec3(radius, 1.0f, 0.0f));
  light->area = 4.0f * PI_F * radius * radius;
  light->sampling = EMITTER_SOLID_ANGLE;
  light->polygon = -1;
  light->pmf = 1.0f;
  light->kind = LIGHT_SPHERE;
  Surface s = surface_in_medium(in_v(in, 4));
  s.geometric = s.shading = in_v(in, 7);
  s.error = POSITION_ERROR * dot3(abs3(s.geometric), abs3(s.p));
  const LightReceiver r = receiver_of(s);
  const LightSample sample =
      sample_sphere_light(&scene, 0, load_light(light), still_axes(&scene, 0, LIGHT_SPHERE), r, in_f(in, 10),
                          in_f(in, 11), no_light_sampling(), 0u);
  out_v(out, 0, sample.wi);
  out[3] = sample.pdf;
  FoundLight found;
  found.from = r.p;
  found.wi = sample.wi;
  found.distance = sample.tmax;
  found.cosine = 1.0f;  // not used for a cone
  out[4] = sphere_light_pdf(&scene, load_light(light), found, 0u);
  out[5] = sample.tmax;
}

PENUMBRA_NAMESPACE_END
#endif
