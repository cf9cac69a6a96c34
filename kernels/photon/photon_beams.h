// Beam estimates: the light that the photons of a homogeneous medium scatter towards the camera along whole
// segments of rays, where a density estimate has that of one point only (Jarosz, Zwicker and Jensen 2008; its
// progressive form: Jarosz et al. 2011). A photon counts with the transmittance from the start of the segment
// to the photon, in a disk of constant weight across the ray. Segments of thin media are beams at random.
//
// The map's cells are visited in slabs across the ray's main axis, and each slab in the order of its cells.
#ifndef PENUMBRA_PHOTON_BEAMS_H
#define PENUMBRA_PHOTON_BEAMS_H
#include "kernels/block/block_media.h"
#include "kernels/bsdf/bsdf.h"
#include "kernels/photon/photon_gather.h"

PENUMBRA_NAMESPACE_BEGIN

// Beams for each path that scatters.
#define BEAMS_PER_SCATTERING 2.0f

/// A part of a ray in one medium.
typedef struct {
  vec3 origin, direction;  ///< unit
  float first, last;       ///< distances from the origin; empty unless first <= last
  vec3 extinction;
  int most_edges;  ///< of photons
} PhotonBeam;

/// A box of cells that holds what is within the radius of a piece of a beam.
typedef struct {
  PhotonCell low, high;
  vec3 start;  ///< of the piece
} BeamSlab;

/// Shortens the beam to where it may meet photons.
FN PhotonBeam clip_beam(const PRIVATE PhotonMap* map, PhotonBeam beam) {
  const float reach = 2.0f * map->beam_radius;
  for (int axis = 0; axis < 3; axis++) {
    const float o = channel_of(beam.origin, axis), d = channel_of(beam.direction, axis);
    const float low = channel_of(map->low, axis) - reach - o, high = channel_of(map->high, axis) + reach - o;
    const float inverse = 1.0f / d, a = low * inverse, b = high * inverse;
    const bool parallel = FABS(d) < 1e-12f;
    const float nearer = min_f(a, b), farther = max_f(a, b);
    beam.first = parallel ? beam.first : max_f(beam.first, nearer);
    const bool beside = parallel & ((low > 0.0f) | (high < 0.0f));
    beam.last = beside ? -1.0f : (parallel ? beam.last : min_f(beam.last, farther));
  }
  return beam;
}

FN int main_axis(vec3 d) {
  const vec3 a = abs3(d);
  return a.x >= a.y ? (a.x >= a.z ? 0 : 2) : (a.y >= a.z ? 1 : 2);
}

FN int cell_along(PhotonCell cell, int axis) { return axis == 0 ? cell.x : (axis == 1 ? cell.y : cell.z); }

FN PhotonCell with_cell_along(PhotonCell cell, int axis, int k) {
  cell.x = axis == 0 ? k : cell.x;
  cell.y = axis == 1 ? k : cell.y;
  cell.z = axis == 2 ? k : cell.z;
  return cell;
}

/// The cells that may hold photons within the radius of the beam between two distances.
FN BeamSlab beam_cells(const PRIVATE PhotonMap* map, PhotonBeam beam, float from, float to) {
  // A part of a cell more, because photons and beams are rounded.
  const float pad = map->beam_radius + 0.01f / map->cells;
  const vec3 reach = make_vec3(pad, pad, pad);
  const vec3 a = add_scaled(beam.origin, from, beam.direction),
             b = add_scaled(beam.origin, to, beam.direction);
  BeamSlab slab;
  slab.low = photon_cell(sub(min3(a, b), reach), map->cells);
  slab.high = photon_cell(add(max3(a, b), reach), map->cells);
  slab.start = a;
  return slab;
}

/// The piece of the beam in the `k`-th slab of cells across an axis.
FN BeamSlab beam_slab(const PRIVATE PhotonMap* map, PhotonBeam beam, int axis, int k) {
  const float side = 1.0f / map->cells, pad = map->beam_radius + 0.01f * side;
  const float o = channel_of(beam.origin, axis), inverse = 1.0f / channel_of(beam.direction, axis);
  const float a = ((float)k * side - pad - o) * inverse, b = ((float)(k + 1) * side + pad - o) * inverse;
  const float from = clamp_f(min_f(a, b), beam.first, beam.last),
              to = clamp_f(max_f(a, b), beam.first, beam.last);
  BeamSlab slab = beam_cells(map, beam, from, to);
  slab.low = with_cell_along(slab.low, axis, k);
  slab.high = with_cell_along(slab.high, axis, k);
  return slab;
}

/// Of the photons k ... k + 7, before `end`, those of these cells that the beam meets: bit j of the result.
FN uint beam_photons(const PRIVATE PhotonTable* table, const PRIVATE PhotonBeam* of,
                     const PRIVATE BeamSlab* in, PhotonCell row, int k, int end) {
  int near[8];
  const int n = table->map.count;
  const float cells = table->map.cells, radius2 = sqr(table->map.beam_radius);
  const PhotonBeam beam = *of;
  const BeamSlab slab = *in;
  const float start = dot3(sub(slab.start, beam.origin), beam.direction);
  GLOBAL const float* p = table->p + k;
  GLOBAL const int* edges = table->edges + k;
  // Reads beyond the range, and beyond an array, stay within the map.
  REGISTER_LOOP(8)
  for (int j = 0; j < 8; j++) {
    const vec3 at = make_vec3(p[j], p[n + j], p[2 * n + j]), d = sub(at, slab.start);
    const float along = dot3(d, beam.direction);
    const vec3 off = add_scaled(d, -along, beam.direction);
    const PhotonCell own = photon_cell(at, cells);
    const bool in_row = (own.y == row.y) & (own.z == row.z) & (own.x >= slab.low.x) & (own.x <= slab.high.x);
    const bool within = (start + along >= beam.first) & (start + along <= beam.last);
    const bool taken =
        (k + j < end) & in_row & within & (dot3(off, off) <= radius2) & (edges[j] <= beam.most_edges);
    near[j] = taken ? 1 : 0;
  }
  return mask_of_8(near);
}

// The photons that lanes gather along beams.
typedef struct {
  const PRIVATE Surfaces* surfaces;  ///< scattering points of the lanes' media
  const PRIVATE Closures* closures;
  ulong families;
  PRIVATE PhotonPairs* pairs;
  PRIVATE float* sums;
} BeamSums;

/// Adds the photons of one row of a slab's cells: neighbours in x, whose buckets may wrap around the table.
FN void gather_row(const PRIVATE Scene* scene, const PRIVATE PhotonTable* table,
                   const PRIVATE PhotonBeam* beam, const PRIVATE BeamSlab* slab, PhotonCell row, int j,
                   const PRIVATE BeamSums* into) {
  const int first = photon_bucket(row, table->map.buckets), end = first + (slab->high.x - slab->low.x) + 1;
  for (int part = 0; part < 2; part++) {
    const int from = part == 0 ? first : 0;
    const int to = part == 0 ? min_i(end, table->map.buckets) : max_i(end - table->map.buckets, 0);
    const int last = table->starts[to];
    for (int k = table->starts[from]; k < last; k += 8)
      for (uint near = beam_photons(table, beam, slab, row, k, last); near != 0u; near &= near - 1u) {
        const int i = k + LOWEST_BIT(near);
        const float way = dot3(sub(photon_vector(table, table->p, i), beam->origin), beam->direction);
        const vec3 passes = exp3(scale(beam->extinction, -max_f(way, 0.0f)));
        add_pair(scene, into->families, into->surfaces, into->closures, j, photon_vector(table, table->wi, i),
                 mul(photon_vector(table, table->powers, i), passes), into->pairs, into->sums);
      }
  }
}

/// Adds the photons along the beam of lane j.
FN void gather_along(const PRIVATE Scene* scene, const PRIVATE PhotonTable* table, PhotonBeam beam, int j,
                     const PRIVATE BeamSums* into) {
  if (!(beam.first <= beam.last)) return;
  const int axis = main_axis(beam.direction);
  const BeamSlab whole = beam_cells(&table->map, beam, beam.first, beam.last);
  const int last = cell_along(whole.high, axis);
  for (int k = cell_along(whole.low, axis); k <= last; k++) {
    const BeamSlab slab = beam_slab(&table->map, beam, axis, k);
    PhotonCell row = slab.low;
    for (row.z = slab.low.z; row.z <= slab.high.z; row.z++)
      for (row.y = slab.low.y; row.y <= slab.high.y; row.y++)
        gather_row(scene, table, &beam, &slab, row, j, into);
  }
}

/// Whether the path's photons in its medium come from beams: of progressive maps, in homogeneous media.
FN bool has_beam(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i) {
  GLOBAL const Medium* medium = scene->media + innermost(get_media(paths, i));
  return scene->header.integrator.photons == PHOTONS_PROGRESSIVE && !is_grid(medium);
}

/// The probability with which a segment of that length is a beam: thin media, in which few paths scatter, are
/// not worth a beam for each path.
FN float beam_probability(GLOBAL const Medium* medium, float length) {
  const vec3 extinction = load3(&medium->extinction);
  if (only_absorbs(load3(&medium->albedo))) return 0.0f;
  return min_f(BEAMS_PER_SCATTERING * -expm1_f(-max_component(extinction) * length), 1.0f);
}

/// Sets the points that scatter along the beams of LANES paths under way, over `lengths`, and with which
/// chances they have beams; 0: they have none. Returns whether any has one.
FN bool find_scattering_points(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                               const PRIVATE float* lengths, PRIVATE Surfaces* surfaces,
                               PRIVATE float* chances) {
  int any = 0;
  for (int j = 0; j < LANES; j++) {
    const int medium = innermost(get_media(paths, i + j));
    const vec3 direction = get_ray_direction(paths, i + j);
    Surface s =
        surface_in_medium(add_scaled(get_kept_origin(paths, i + j), get_way(paths, i + j), direction));
    const float chance = beam_probability(scene->media + medium, lengths[j]);
    const bool wanted = (medium != 0) & (ray_number(paths, i + j, 0x9b05688cu) < chance) &
                        (get_ray_tmax(paths, i + j) > 0.0f) & has_beam(scene, paths, i + j) &
                        (most_photon_edges(&scene->header, paths, i + j) > 0) &
                        (get_chain(paths, i + j) < CHAIN_LAST);
    s.wo = negate(direction);
    s.material = wanted ? scene->media[medium].material : 0;
    chances[j] = wanted ? chance : 0.0f;
    any |= wanted ? 1 : 0;
    store_surface(surfaces, j, s);
  }
  return any != 0;
}

/// Adds the light of photons along LANES rays, from their last boundaries over `lengths`.
CALLED_FN void add_beams(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                         const PRIVATE float* lengths) {
  if (is_empty_map(scene->photons, PHOTON_MAP_VOLUME)) return;
  const PhotonTable table = photon_table(scene->photons, PHOTON_MAP_VOLUME);
  Surfaces surfaces;
  Closures closures;
  PhotonPairs pairs;
  float chances[LANES], sums[3 * LANES];
  if (!find_scattering_points(scene, paths, i, lengths, &surfaces, chances)) return;
  for (int j = 0; j < LANES; j++) {
    store_closure(&closures, j, black_closure());
    STORE_LANE_vec3(sums, j, make_vec3(0.0f, 0.0f, 0.0f));
  }
  resolve_closures(scene, &surfaces, &closures);
  start_pairs(&pairs);
  const BeamSums into = {&surfaces, &closures, families_among(&closures), &pairs, sums};
  for (int j = 0; j < LANES; j++) {
    if (chances[j] == 0.0f) continue;
    PhotonBeam beam;
    beam.origin = LOAD_LANE_vec3(surfaces.p, j);
    beam.direction = get_ray_direction(paths, i + j);
    beam.first = 0.0f;
    beam.last = lengths[j];
    beam.extinction = load3(&scene->media[innermost(get_media(paths, i + j))].extinction);
    beam.most_edges = most_photon_edges(&scene->header, paths, i + j);
    gather_along(scene, &table, clip_beam(&table.map, beam), j, &into);
  }
  finish_pairs(scene, into.families, &pairs, sums);
  const float weight = table.map.share * inverse_extent(false, sqr(table.map.beam_radius));
  for (int j = 0; j < LANES; j++) {
    if (chances[j] == 0.0f) continue;
    GLOBAL const Medium* medium = scene->media + innermost(get_media(paths, i + j));
    const vec3 scattering =
        scale(mul(load3(&medium->extinction), load3(&medium->albedo)), weight / chances[j]);
    const vec3 light = mul(get_throughput(paths, i + j), mul(scattering, LOAD_LANE_vec3(sums, j)));
    set_radiance(paths, i + j, add(get_radiance(paths, i + j), light));
  }
}

PENUMBRA_NAMESPACE_END
#endif
