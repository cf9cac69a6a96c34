// Sampling of a triangle by projected solid angle: directions with pdf cos(theta) / A, where theta is the
// angle to the receiver's normal. The direct light of a diffuse receiver from an unoccluded light of constant
// radiance then has no variance.
//
// All computations are in the receiver's frame, whose z axis is the normal. Consider an arc of a great circle
// with unit normal g: the region between the arc and the zenith has projected area g.z / 2 times the arc's
// angle (Lambert 1760). An azimuth range between an outer and an inner arc is sampled by the angle x along
// the outer arc: linearly in x if the zenith is inside the light, else by Newton's method, for which the
// inner arc contributes one arc tangent. Then the squared radius sin(theta)^2 is uniform between the arcs.
// Cf. Peters 2021, BRDF Importance Sampling for Polygonal Lights.
#ifndef PENUMBRA_PROJECTED_TRIANGLE_H
#define PENUMBRA_PROJECTED_TRIANGLE_H
#include "kernels/math/math.h"
#include "kernels/math/vec3.h"

PENUMBRA_NAMESPACE_BEGIN

// The area is a sum of terms of both signs, with an error of 1.5e-7 times the perimeter. A triangle is not
// sampled by projected solid angle if twice its area is below this fraction of the perimeter, so that the
// area's relative error stays below 1e-4.
#define SMALL_PROJECTED_AREA 3e-3f
// Vertices have rounding errors of about 1e-7. An edge that misses the zenith by no more than this is treated
// as passing through it, with no area.
#define ZENITH_TOLERANCE 2.5e-7f
// After these steps, the fraction of the area on either side of the sample's azimuth has an error below 1e-5
// (1 + perimeter / area) for 999 of 1000 random triangles, and never above 1e-3.
#define PROJECTED_NEWTON_STEPS 6

/// An arc of a great circle between two unit vectors.
typedef struct {
  vec3 from, to;
  vec3 g;       ///< unit, from x to normalised; 0 if they coincide
  float arc;    ///< angle
  int winding;  ///< 1: counter-clockwise about the zenith; -1: clockwise; 0: through the zenith
} ProjectedEdge;

/// The part of a triangle above the horizon: a convex polygon of four edges, some of which may be degenerate,
/// counter-clockwise as seen from above the hemisphere.
typedef struct {
  ProjectedEdge e0, e1, e2, e3;
  float area;  ///< projected solid angle, at most pi; 0: none, seen from the back, or too small
} ProjectedPolygon;

FN float cross2(float ax, float ay, float bx, float by) { return ax * by - ay * bx; }

FN ProjectedEdge projected_edge(vec3 from, vec3 to) {
  ProjectedEdge e;
  e.from = from;
  e.to = to;
  const vec3 cross = cross3(from, sub(to, from));
  const float sine = length3(cross);
  e.g = scale(cross, 1.0f / max_f(sine, 1e-30f));
  e.arc = atan2_f(sine, dot3(from, to));
  // Not by g.z, which rounds differently: windings must agree exactly with sorted azimuths.
  const float turn = cross2(from.x, from.y, to.x, to.y);
  const float tolerance = ZENITH_TOLERANCE * (FABS(from.x) + FABS(from.y) + FABS(to.x) + FABS(to.y));
  e.winding = (turn > tolerance ? 1 : 0) - (turn < -tolerance ? 1 : 0);
  return e;
}

/// Where the line from a to b meets the horizon.
FN vec3 horizon_point(vec3 a, vec3 b) {
  const float rise = a.z - b.z;
  const vec3 p = add_scaled(a, a.z / (rise != 0.0f ? rise : 1.0f), sub(b, a));
  return make_vec3(p.x, p.y, 0.0f);
}

FN vec3 unit3(vec3 v) { return scale(v, 1.0f / SQRT(max_f(dot3(v, v), 1e-37f))); }

/// Clips the triangle to the upper hemisphere. Its vertices are relative to the receiver and in the
/// receiver's frame. Its front is where p0, p1, p2 appear counter-clockwise, as everywhere.
FN ProjectedPolygon project_triangle(vec3 p0, vec3 p1, vec3 p2) {
  // The receiver sees the triangle from below, the horizon's plane is seen from above: hence p0, p2, p1.
  const bool up0 = p0.z > 0.0f, up1 = p2.z > 0.0f, up2 = p1.z > 0.0f;
  const bool any = up0 | up1 | up2, all = up0 & up1 & up2;
  // The vertices are rotated so that `a` is alone on its side of the horizon, if any vertex is.
  const bool odd1 = (up1 != up0) & (up1 != up2), odd2 = (up2 != up0) & (up2 != up1);
  const vec3 a = select3(odd1, p2, select3(odd2, p1, p0));
  const vec3 b = select3(odd1, p1, select3(odd2, p0, p2));
  const vec3 c = select3(odd1, p0, select3(odd2, p2, p1));
  const bool one = !all & (a.z > 0.0f);
  const vec3 ab = horizon_point(a, b), ac = horizon_point(a, c);
  const vec3 v0 = unit3(select3(all | one, a, ab)), v1 = unit3(select3(one, ab, b));
  const vec3 v2 = unit3(select3(one, ac, c)), v3 = unit3(select3(all, c, ac));
  ProjectedPolygon polygon;
  polygon.e0 = projected_edge(v0, v1);
  polygon.e1 = projected_edge(v1, v2);
  polygon.e2 = projected_edge(v2, v3);
  polygon.e3 = projected_edge(v3, v0);
  const float twice = (polygon.e0.arc * polygon.e0.g.z + polygon.e1.arc * polygon.e1.g.z) +
                      (polygon.e2.arc * polygon.e2.g.z + polygon.e3.arc * polygon.e3.g.z);
  const float perimeter = (polygon.e0.arc + polygon.e1.arc) + (polygon.e2.arc + polygon.e3.arc);
  polygon.area = (any & (twice > SMALL_PROJECTED_AREA * perimeter)) ? min_f(0.5f * twice, PI_F) : 0.0f;
  return polygon;
}

/// The angle along the great circle with unit normal g between the azimuths of (ax, ay) and (bx, by): vectors
/// of any length, less than half a turn apart.
FN float arc_between(vec3 g, float ax, float ay, float bx, float by) {
  return atan2_f(g.z * cross2(ax, ay, bx, by),
                 g.z * g.z * (ax * bx + ay * by) + (g.x * ax + g.y * ay) * (g.x * bx + g.y * by));
}

/// The part of the polygon within an azimuth range, between two arcs.
typedef struct {
  float from_x, from_y;  ///< the smaller azimuth
  float to_x, to_y;      ///< the larger azimuth
  vec3 outer, inner;     ///< normals of the arcs' great circles, z >= 0; 0: no arc
  float outer_arc;
  float area;  ///< twice the area
} ProjectedSector;

/// Sets the edge as an arc of the sector if it covers the sector's azimuths.
FN void cover_sector(PRIVATE ProjectedSector* s, ProjectedEdge e) {
  const bool clockwise = e.winding < 0;
  const float low_x = clockwise ? e.to.x : e.from.x, low_y = clockwise ? e.to.y : e.from.y;
  const float high_x = clockwise ? e.from.x : e.to.x, high_y = clockwise ? e.from.y : e.to.y;
  const bool covers = (e.winding != 0) & (cross2(low_x, low_y, s->from_x, s->from_y) >= 0.0f) &
                      (cross2(s->to_x, s->to_y, high_x, high_y) >= 0.0f);
  s->outer = select3(covers & !clockwise, make_vec3(e.g.x, e.g.y, FABS(e.g.z)), s->outer);
  s->inner = select3(covers & clockwise, make_vec3(-e.g.x, -e.g.y, FABS(e.g.z)), s->inner);
}

/// If the zenith is inside (`central`): the region between the zenith and edge `own`. Else the region between
/// these azimuths.
FN ProjectedSector projected_sector(ProjectedPolygon p, bool central, ProjectedEdge own, float from_x,
                                    float from_y, float to_x, float to_y) {
  ProjectedSector s;
  s.from_x = central ? own.from.x : from_x;
  s.from_y = central ? own.from.y : from_y;
  s.to_x = central ? own.to.x : to_x;
  s.to_y = central ? own.to.y : to_y;
  s.outer = s.inner = make_vec3(0.0f, 0.0f, 0.0f);
  cover_sector(&s, p.e0);
  cover_sector(&s, p.e1);
  cover_sector(&s, p.e2);
  cover_sector(&s, p.e3);
  const bool sweeps = central ? own.winding > 0 : (s.outer.z > 0.0f) & (s.inner.z > 0.0f);
  s.outer = select3(central, make_vec3(own.g.x, own.g.y, FABS(own.g.z)), s.outer);
  s.inner = select3(central, make_vec3(0.0f, 0.0f, 0.0f), s.inner);
  s.outer_arc = max_f(arc_between(s.outer, s.from_x, s.from_y, s.to_x, s.to_y), 0.0f);
  const float inner_arc = max_f(arc_between(s.inner, s.from_x, s.from_y, s.to_x, s.to_y), 0.0f);
  s.area = sweeps ? max_f(s.outer.z * s.outer_arc - s.inner.z * inner_arc, 0.0f) : 0.0f;
  return s;
}

/// Moves on to sector s if `target` is beyond the area of the sectors before, the last of which is `chosen`.
FN void pass_sector(PRIVATE ProjectedSector* chosen, PRIVATE float* target, ProjectedSector s) {
  const bool beyond = (*target >= chosen->area) & (s.area > 0.0f);
  *target = beyond ? *target - chosen->area : *target;
  chosen->from_x = beyond ? s.from_x : chosen->from_x;
  chosen->from_y = beyond ? s.from_y : chosen->from_y;
  chosen->outer = select3(beyond, s.outer, chosen->outer);
  chosen->inner = select3(beyond, s.inner, chosen->inner);
  chosen->outer_arc = beyond ? s.outer_arc : chosen->outer_arc;
  chosen->area = beyond ? s.area : chosen->area;
}

/// The fraction of the outer squared radius that the inner arc cuts off, at a point of the outer arc.
FN float inner_share(vec3 inner, vec3 at) {
  const float height = inner.x * at.x + inner.y * at.y;
  const float across = inner.z * inner.z;
  const float d = across * (at.x * at.x + at.y * at.y) + height * height;
  return d > 0.0f ? min_f(across / d, 1.0f) : 0.0f;
}

/// For a linear density on [0, 1] from `density0` to `density1`: the point below which lies the fraction y of
/// its integral. Also returns the density there.
FN float along_linear_density(float density0, float density1, float y, PRIVATE float* density) {
  *density = SQRT(sqr(density0) * (1.0f - y) + sqr(density1) * y);
  const float sum = density0 + *density;
  return sum > 0.0f ? min_f(y * (density0 + density1) / sum, 1.0f) : y;
}

/// Twice the area of the sector up to point `at` of the outer arc, which is the fraction x of the arc.
FN float sector_area(ProjectedSector s, float x, vec3 at) {
  return s.outer.z * s.outer_arc * x - s.inner.z * arc_between(s.inner, s.from_x, s.from_y, at.x, at.y);
}

/// Samples a direction in the sector: the fraction `u` of the area is at smaller azimuths, and the fraction
/// `v` of the squared radius range is inside.
FN vec3 sample_sector(ProjectedSector s, float u, float v) {
  const float height = -(s.outer.x * s.from_x + s.outer.y * s.from_y);
  const vec3 on_arc = make_vec3(s.outer.z * s.from_x, s.outer.z * s.from_y, height);
  const vec3 start = scale(on_arc, 1.0f / SQRT(max_f(dot3(on_arc, on_arc), 1e-37f)));
  const vec3 side = cross3(s.outer, start);
  const float turns = s.outer_arc * (0.5f * INV_PI_F);
  float sine, cosine, density;
  sincos_2pi(turns, &sine, &cosine);
  const float density0 = 1.0f - inner_share(s.inner, start);
  const float density1 = 1.0f - inner_share(s.inner, add(scale(start, cosine), scale(side, sine)));
  // First guess: the linear density with the same area in each half.
  sincos_2pi(0.5f * turns, &sine, &cosine);
  const float middle = sector_area(s, 0.5f, add(scale(start, cosine), scale(side, sine)));
  const float guess0 = clamp_f(4.0f * middle / max_f(s.area, 1e-30f) - 1.0f, 0.0f, 2.0f);
  const float part = clamp_f(u, 0.0f, 1.0f);
  float x = along_linear_density(guess0, 2.0f - guess0, part, &density);
  // Newton's method does not solve for x but for the area under a linear density between the true ends: its
  // slope stays of order 1 where the arcs meet in a vertex and the density is 0.
  const float densities = max_f(density0 + density1, 1e-30f);
  float y = clamp_f(x * (2.0f * density0 + (density1 - density0) * x) / densities, 0.0f, 1.0f);
  float low = 0.0f, high = 1.0f;
  UNROLL
  for (int k = 0; k < PROJECTED_NEWTON_STEPS; k++) {
    x = along_linear_density(density0, density1, y, &density);
    sincos_2pi(turns * x, &sine, &cosine);
    const vec3 on = add(scale(start, cosine), scale(side, sine));
    const float excess = sector_area(s, x, on) - part * s.area;
    const float slope = s.outer.z * s.outer_arc * (1.0f - inner_share(s.inner, on)) * densities;
    low = excess < 0.0f ? y : low;
    high = excess < 0.0f ? high : y;
    const float next = y - 2.0f * excess * density / max_f(slope, 1e-30f);
    y = ((next >= low) & (next <= high)) ? next : 0.5f * (low + high);
  }
  x = along_linear_density(density0, density1, y, &density);
  sincos_2pi(turns * x, &sine, &cosine);
  const vec3 at = add(scale(start, cosine), scale(side, sine));
  // Squared sine and cosine of theta, interpolated between the two arcs without cancellation near the
  // horizon.
  const float outer_r2 = at.x * at.x + at.y * at.y;
  const float inner_height = s.inner.x * at.x + s.inner.y * at.y;
  const float inner_low = sqr(s.inner.z) * outer_r2, inner_high = sqr(inner_height);
  const float d = inner_low + inner_high;
  const float inner_r2 = d > 0.0f ? inner_low / d : 0.0f, inner_z2 = d > 0.0f ? inner_high / d : 1.0f;
  const float r2 = (1.0f - v) * inner_r2 + v * outer_r2;
  const float z2 = (1.0f - v) * inner_z2 + v * sqr(at.z);
  const float r = SQRT(r2 / max_f(outer_r2, 1e-37f));
  return make_vec3(r * at.x, r * at.y, SQRT(z2));
}

/// Orders two vectors in the plane by azimuth.
FN void order_azimuths(PRIVATE float* ax, PRIVATE float* ay, PRIVATE float* bx, PRIVATE float* by) {
  const float x0 = *ax, y0 = *ay, x1 = *bx, y1 = *by;
  const bool swap = cross2(x0, y0, x1, y1) < 0.0f;
  *ax = swap ? x1 : x0;
  *ay = swap ? y1 : y0;
  *bx = swap ? x0 : x1;
  *by = swap ? y0 : y1;
}

/// Samples a unit direction of the polygon with pdf z / area, for an area above 0.
FN vec3 sample_projected_polygon(ProjectedPolygon p, float u, float v) {
  // If the zenith is inside, every edge is an outer arc.
  const bool central = (p.e0.winding >= 0) & (p.e1.winding >= 0) & (p.e2.winding >= 0) & (p.e3.winding >= 0);
  // Otherwise all azimuths are within half a turn and can be sorted.
  float x0 = p.e0.from.x, x1 = p.e1.from.x, x2 = p.e2.from.x, x3 = p.e3.from.x;
  float y0 = p.e0.from.y, y1 = p.e1.from.y, y2 = p.e2.from.y, y3 = p.e3.from.y;
  order_azimuths(&x0, &y0, &x1, &y1);
  order_azimuths(&x2, &y2, &x3, &y3);
  order_azimuths(&x0, &y0, &x2, &y2);
  order_azimuths(&x1, &y1, &x3, &y3);
  order_azimuths(&x1, &y1, &x2, &y2);
  ProjectedSector chosen = projected_sector(p, central, p.e0, x0, y0, x1, y1);
  const ProjectedSector s1 = projected_sector(p, central, p.e1, x1, y1, x2, y2);
  const ProjectedSector s2 = projected_sector(p, central, p.e2, x2, y2, x3, y3);
  const ProjectedSector s3 = projected_sector(p, central, p.e3, x3, y3, x3, y3);
  float target = u * ((chosen.area + s1.area) + (s2.area + s3.area));
  pass_sector(&chosen, &target, s1);
  pass_sector(&chosen, &target, s2);
  pass_sector(&chosen, &target, s3);
  return sample_sector(chosen, target / max_f(chosen.area, 1e-30f), v);
}

PENUMBRA_NAMESPACE_END
#endif
