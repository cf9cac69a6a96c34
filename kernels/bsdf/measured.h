// Measured BRDFs (Dupuy and Jakob 2018, "An Adaptive Parameterization for Efficient Material Acquisition and
// Rendering"), as in Mitsuba 3 and pbrt-v4. A file has grids over the unit square for each of some directions
// of wo: `vndf`, a density of half vectors; and over the square that this density warps to them, `luminance`,
// a density, and the colours. All are bilinear, and linear between the neighbouring directions of wo. A
// sample goes through both warps, of marginal and conditional sums. f cos is the colour times ndf / (4
// sigma).
//
// A half vector of angles theta and phi is at (sqrt(2 theta / pi), (phi + pi) / (2 pi)) of the square. Where
// the material is isotropic, phi is relative to wo.
//
// `specular` is the albedo, over which the colours of the table are. `anisotropic` is 0 where the frame has
// any axis. At `curve` begin, in this order: MEASURED_HEADER numbers (those of azimuths and polar angles, the
// columns and rows of `ndf`, `sigma`, `vndf` and `luminance`, `by_facets`, and the symmetry); the azimuths
// and the polar angles of wo; the grids of `ndf` and `sigma`; for each azimuth and polar angle the grid of
// `vndf`, its sums along each row, and those of rows; the same of `luminance`; and the colours.
#ifndef PENUMBRA_MEASURED_H
#define PENUMBRA_MEASURED_H
#include "kernels/bsdf/families.h"
#include "kernels/bsdf/microfacet.h"
#include "kernels/math/math.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

// Steps of searches: see MEASURED_NODES and MEASURED_SIDE.
#define MEASURED_NODE_STEPS 7
#define MEASURED_STEPS 9

typedef struct {
  int start;          ///< index in the table of curves of the first slice
  int columns, rows;  ///< at least 2
} MeasuredGrid;

/// What a table's header says.
typedef struct {
  int phi, phis, theta, thetas;  ///< starts and numbers of the azimuths and polar angles
  MeasuredGrid ndf, sigma, vndf, luminance, colours;
  bool by_facets;  ///< f cos has the factor ndf / (4 sigma)
  int symmetry;    ///< MEASURED_*
} MeasuredTable;

FN int measured_slice(MeasuredGrid grid) { return (2 * grid.columns + 1) * grid.rows; }

FN MeasuredGrid measured_grid(int start, int columns, int rows) {
  MeasuredGrid grid;
  grid.start = start;
  grid.columns = columns;
  grid.rows = rows;
  return grid;
}

/// A count of the header.
FN int measured_count(const PRIVATE Scene* scene, Closure c, int at) {
  return (int)scene->curves[c.curve + at];
}

FN MeasuredTable measured_table(const PRIVATE Scene* scene, Closure c) {
  MeasuredTable t;
  const int azimuths = measured_count(scene, c, 0);
  t.phis = c.anisotropic != 0.0f ? azimuths : 1;
  t.thetas = measured_count(scene, c, 1);
  t.by_facets = measured_count(scene, c, 10) != 0;
  t.symmetry = measured_count(scene, c, 11);
  t.phi = c.curve + MEASURED_HEADER;
  t.theta = t.phi + azimuths;
  t.ndf = measured_grid(t.theta + t.thetas, measured_count(scene, c, 2), measured_count(scene, c, 3));
  t.sigma = measured_grid(t.ndf.start + t.ndf.columns * t.ndf.rows, measured_count(scene, c, 4),
                          measured_count(scene, c, 5));
  t.vndf = measured_grid(t.sigma.start + t.sigma.columns * t.sigma.rows, measured_count(scene, c, 6),
                         measured_count(scene, c, 7));
  const int slices = azimuths * t.thetas;
  t.luminance = measured_grid(t.vndf.start + slices * measured_slice(t.vndf), measured_count(scene, c, 8),
                              measured_count(scene, c, 9));
  t.colours = measured_grid(t.luminance.start + slices * measured_slice(t.luminance), t.luminance.columns,
                            t.luminance.rows);
  return t;
}

/// A place between neighbouring angles.
typedef struct {
  int first, second;
  float w;
} MeasuredNodes;

/// Between angles that ascend.
FN MeasuredNodes measured_nodes(const PRIVATE Scene* scene, int start, int count, float x) {
  int at = 0;
  for (int k = 0; k < MEASURED_NODE_STEPS; k++) {
    const int next = at + (1 << (MEASURED_NODE_STEPS - 1 - k));
    const bool below = (next <= count - 2) & (scene->curves[start + min_i(next, count - 1)] <= x);
    at = below ? next : at;
  }
  MeasuredNodes nodes;
  nodes.first = at;
  nodes.second = min_i(at + 1, count - 1);
  const float low = scene->curves[start + nodes.first], high = scene->curves[start + nodes.second];
  nodes.w = clamp_f((x - low) / max_f(high - low, 1e-20f), 0.0f, 1.0f);
  return nodes;
}

/// wo, in the frame of the table: about the normal, turned by an angle, then mirrored.
typedef struct {
  float cosine, sine, flip_x, flip_y;
  MeasuredNodes phi, theta;
  float u, v;  ///< of wo
} MeasuredIncidence;

FN float measured_u(vec3 w) { return SQRT(atan2_f(SQRT(w.x * w.x + w.y * w.y), w.z) * (2.0f * INV_PI_F)); }

FN MeasuredIncidence measured_incidence(const PRIVATE Scene* scene, MeasuredTable t, vec3 wo) {
  const float across = SQRT(wo.x * wo.x + wo.y * wo.y);
  const bool relative = t.symmetry == MEASURED_ISOTROPIC, turns = relative & (across > 0.0f);
  const float inverse = 1.0f / (turns ? across : 1.0f);
  MeasuredIncidence i;
  i.cosine = turns ? wo.x * inverse : 1.0f;
  i.sine = turns ? wo.y * inverse : 0.0f;
  const float back_y = wo.y < 0.0f ? 1.0f : -1.0f, back_x = wo.x < 0.0f ? 1.0f : -1.0f;
  const bool folds = t.symmetry >= MEASURED_HALF;
  i.flip_y = folds ? back_y : 1.0f;
  i.flip_x = t.symmetry == MEASURED_QUARTER ? back_x : i.flip_y;
  // Folded azimuths are in [-pi, 0]. One azimuth is the same as any other.
  const float folded = -atan2_f(FABS(wo.y), i.flip_x * wo.x);
  const float phi = folds ? folded : atan2_f(wo.y, wo.x);
  i.phi = measured_nodes(scene, t.phi, t.phis, phi);
  i.theta = measured_nodes(scene, t.theta, t.thetas, atan2_f(across, wo.z));
  i.u = measured_u(wo);
  i.v = t.phis > 1 ? 0.5f + phi * (0.5f * INV_PI_F) : 0.5f;
  return i;
}

FN vec3 to_measured(MeasuredIncidence i, vec3 v) {
  return make_vec3(i.flip_x * (i.cosine * v.x + i.sine * v.y), i.flip_y * (i.cosine * v.y - i.sine * v.x),
                   v.z);
}
FN vec3 from_measured(MeasuredIncidence i, vec3 v) {
  const float x = i.flip_x * v.x, y = i.flip_y * v.y;
  return make_vec3(i.cosine * x - i.sine * y, i.sine * x + i.cosine * y, v.z);
}

/// The four slices of a grid around wo, and their weights.
typedef struct {
  int low_low, high_low, low_high, high_high;  ///< azimuth, then polar angle
  float phi, theta;
} MeasuredSlices;

FN MeasuredSlices measured_slices(MeasuredTable t, MeasuredIncidence i, MeasuredGrid grid, int size) {
  const int low = grid.start + i.phi.first * t.thetas * size,
            high = grid.start + i.phi.second * t.thetas * size;
  MeasuredSlices s;
  s.low_low = low + i.theta.first * size;
  s.high_low = high + i.theta.first * size;
  s.low_high = low + i.theta.second * size;
  s.high_high = high + i.theta.second * size;
  s.phi = i.phi.w;
  s.theta = i.theta.w;
  return s;
}
FN MeasuredSlices measured_slice_at(int start) {
  MeasuredSlices s;
  s.low_low = s.high_low = s.low_high = s.high_high = start;
  s.phi = s.theta = 0.0f;
  return s;
}

FN float measured_number(const PRIVATE Scene* scene, MeasuredSlices s, int at) {
  return mix_f(mix_f(scene->curves[s.low_low + at], scene->curves[s.high_low + at], s.phi),
               mix_f(scene->curves[s.low_high + at], scene->curves[s.high_high + at], s.phi), s.theta);
}

/// A place within a cell of a grid.
typedef struct {
  int column, row;
  float x, y;
} MeasuredCell;

FN MeasuredCell measured_cell(MeasuredGrid grid, float u, float v) {
  const float x = clamp_f(u, 0.0f, 1.0f) * (float)(grid.columns - 1),
              y = clamp_f(v, 0.0f, 1.0f) * (float)(grid.rows - 1);
  MeasuredCell cell;
  cell.column = min_i((int)x, grid.columns - 2);
  cell.row = min_i((int)y, grid.rows - 2);
  cell.x = x - (float)cell.column;
  cell.y = y - (float)cell.row;
  return cell;
}

/// A grid whose knots have `size` numbers each.
FN float measured_bilinear(const PRIVATE Scene* scene, MeasuredSlices s, MeasuredGrid grid, MeasuredCell cell,
                           int size, int channel) {
  const int at = (cell.row * grid.columns + cell.column) * size + channel, down = grid.columns * size;
  return mix_f(
      mix_f(measured_number(scene, s, at), measured_number(scene, s, at + size), cell.x),
      mix_f(measured_number(scene, s, at + down), measured_number(scene, s, at + down + size), cell.x),
      cell.y);
}
FN float measured_plain(const PRIVATE Scene* scene, MeasuredGrid grid, float u, float v) {
  return measured_bilinear(scene, measured_slice_at(grid.start), grid, measured_cell(grid, u, v), 1, 0);
}

/// A point of the unit square, and the density with which a warp gets there.
typedef struct {
  float u, v, density;
} MeasuredPoint;

/// The density of a grid of area 1 whose cells have area 1.
FN float measured_area(MeasuredGrid grid) { return (float)((grid.columns - 1) * (grid.rows - 1)); }

/// Where the warp of a density has this point from, which it would go to.
FN MeasuredPoint measured_unwarp(const PRIVATE Scene* scene, MeasuredSlices s, MeasuredGrid grid, float u,
                                 float v) {
  const MeasuredCell cell = measured_cell(grid, u, v);
  const int at = cell.row * grid.columns + cell.column, sums = grid.rows * grid.columns,
            end = sums + (cell.row + 1) * grid.columns - 1;
  const float left =
      mix_f(measured_number(scene, s, at), measured_number(scene, s, at + grid.columns), cell.y);
  const float right =
      mix_f(measured_number(scene, s, at + 1), measured_number(scene, s, at + grid.columns + 1), cell.y);
  const float before = mix_f(measured_number(scene, s, sums + at),
                             measured_number(scene, s, sums + at + grid.columns), cell.y);
  const float first = measured_number(scene, s, end), second = measured_number(scene, s, end + grid.columns);
  const float whole = mix_f(first, second, cell.y);
  const float along = before + cell.x * (left + 0.5f * cell.x * (right - left));
  const float down = cell.y * (first + 0.5f * cell.y * (second - first));
  MeasuredPoint p;
  p.u = whole > 0.0f ? clamp_f(along / whole, 0.0f, 1.0f) : 0.0f;
  p.v = clamp_f(measured_number(scene, s, 2 * sums + cell.row) + down, 0.0f, 1.0f);
  p.density = mix_f(left, right, cell.x) * measured_area(grid);
  return p;
}

/// The t in [0, 1] at which the integral from 0 of what goes from a to b is `rest`: (b - a) t^2 / 2 + a t =
/// rest, in the form that loses no digits.
FN float measured_part(float a, float b, float rest) {
  const float root = SQRT(max_f(a * a + 2.0f * rest * (b - a), 0.0f));
  return clamp_f(2.0f * rest / max_f(a + root, 1e-30f), 0.0f, 1.0f);
}

/// Warps a point of the unit square to the density. Where that is 0 no point goes to, but for rounding.
FN MeasuredPoint measured_warp(const PRIVATE Scene* scene, MeasuredSlices s, MeasuredGrid grid, float u,
                               float v) {
  const int sums = grid.rows * grid.columns;
  int row = 0, column = 0;
  for (int k = 0; k < MEASURED_STEPS; k++) {
    const int next = row + (1 << (MEASURED_STEPS - 1 - k));
    const bool below =
        (next <= grid.rows - 2) & (measured_number(scene, s, 2 * sums + min_i(next, grid.rows - 1)) <= v);
    row = below ? next : row;
  }
  const int above = sums + row * grid.columns, end = above + grid.columns - 1;
  const float first = measured_number(scene, s, end), second = measured_number(scene, s, end + grid.columns);
  const float y = measured_part(first, second, max_f(v - measured_number(scene, s, 2 * sums + row), 0.0f));
  const float target = u * mix_f(first, second, y);
  for (int k = 0; k < MEASURED_STEPS; k++) {
    const int next = column + (1 << (MEASURED_STEPS - 1 - k)), at = above + min_i(next, grid.columns - 1);
    const bool below =
        (next <= grid.columns - 2) &
        (mix_f(measured_number(scene, s, at), measured_number(scene, s, at + grid.columns), y) <= target);
    column = below ? next : column;
  }
  const int at = above + column, knot = at - sums;
  const float before = mix_f(measured_number(scene, s, at), measured_number(scene, s, at + grid.columns), y);
  const float left =
      mix_f(measured_number(scene, s, knot), measured_number(scene, s, knot + grid.columns), y);
  const float right =
      mix_f(measured_number(scene, s, knot + 1), measured_number(scene, s, knot + grid.columns + 1), y);
  const float x = measured_part(left, right, max_f(target - before, 0.0f));
  MeasuredPoint p;
  p.u = ((float)column + x) / (float)(grid.columns - 1);
  p.v = ((float)row + y) / (float)(grid.rows - 1);
  p.density = mix_f(left, right, x) * measured_area(grid);
  return p;
}

CALLED_FN BsdfValue measured_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  if (c.family != FAMILY_MEASURED || wo.z <= 0.0f || wi.z <= 0.0f) return no_bsdf_value();
  const MeasuredTable t = measured_table(scene, c);
  const MeasuredIncidence i = measured_incidence(scene, t, wo);
  const vec3 sum = to_measured(i, add(wo, wi));
  const float length = max_f(length3(sum), 1e-20f);  // twice the cosine between wo and the half vector
  const vec3 h = scale(sum, 1.0f / length);
  const float u = measured_u(h), v = 0.5f + atan2_f(h.y, h.x) * (0.5f * INV_PI_F);
  const MeasuredSlices of_vndf = measured_slices(t, i, t.vndf, measured_slice(t.vndf)),
                       of_luminance = measured_slices(t, i, t.luminance, measured_slice(t.luminance)),
                       of_colours = measured_slices(t, i, t.colours, 3 * t.colours.columns * t.colours.rows);
  const MeasuredPoint p = measured_unwarp(scene, of_vndf, t.vndf, u, v);
  const MeasuredCell cell = measured_cell(t.luminance, p.u, p.v);
  const float luminance =
      measured_bilinear(scene, of_luminance, t.luminance, cell, 1, 0) * measured_area(t.luminance);
  const vec3 colour = make_vec3(measured_bilinear(scene, of_colours, t.colours, cell, 3, 0),
                                measured_bilinear(scene, of_colours, t.colours, cell, 3, 1),
                                measured_bilinear(scene, of_colours, t.colours, cell, 3, 2));
  const float projected = measured_plain(scene, t.sigma, i.u, i.v);
  const float facets = projected > 0.0f ? 0.25f * measured_plain(scene, t.ndf, u, v) / projected : 0.0f;
  // Solid angle of half vectors by area of the square, and of wi by that of half vectors. The bound is for
  // the pole, where floats hold no half vectors nearer than 1e-7.
  const float solid_angle =
      max_f(2.0f * PI_F * PI_F * u * SQRT(h.x * h.x + h.y * h.y), 1e-12f) * (2.0f * length);
  BsdfValue value;
  value.f_cos = scale(mul(c.specular, colour), t.by_facets ? facets : 1.0f);
  value.pdf = p.density * luminance / solid_angle;
  return value;
}

CALLED_FN BsdfSample measured_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v,
                                     float choice) {
  if (c.family != FAMILY_MEASURED) return no_bsdf_sample();
  const MeasuredTable t = measured_table(scene, c);
  const MeasuredIncidence i = measured_incidence(scene, t, wo);
  const MeasuredPoint p = measured_warp(
      scene, measured_slices(t, i, t.luminance, measured_slice(t.luminance)), t.luminance, u, v);
  const MeasuredPoint q =
      measured_warp(scene, measured_slices(t, i, t.vndf, measured_slice(t.vndf)), t.vndf, p.u, p.v);
  float sine, cosine, along_y, along_x;
  sincos_2pi(0.25f * q.u * q.u, &sine, &cosine);
  sincos_2pi(q.v - 0.5f, &along_y, &along_x);
  const vec3 h = from_measured(i, make_vec3(sine * along_x, sine * along_y, cosine));
  const vec3 wi = mirror_about(wo, h);
  return sample_of_value(wi, measured_eval(scene, c, wo, wi));
}

PENUMBRA_NAMESPACE_END
#endif
