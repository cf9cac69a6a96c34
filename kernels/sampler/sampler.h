// Samplers: a number in [0, 1) is a pure function of (seed, pixel, sample index, dimension). Dimensions come
// in pairs. All pairs that a path may need have fixed numbers, so that a scene that does not use some of them
// leaves the numbers of the others unchanged.
#ifndef PENUMBRA_SAMPLER_H
#define PENUMBRA_SAMPLER_H
#include "kernels/block/path_state.h"
#include "kernels/math/math.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

// Pairs of the camera ray.
#define PAIR_FILM 0u              // position on the film
#define PAIR_LENS 0xffffffffu     // position on the lens
#define PAIR_CHANNEL 0xfffffffeu  // colour channel (hero) of media
#define PAIR_TIME 0xfffffffbu     // time while the shutter is open
// Pairs of a photon's first ray, with those above: PAIR_FILM is the light and a point on it.
#define PAIR_EMISSION 0xfffffffdu  // the direction
#define PAIR_EMITTER 0xfffffffcu   // digits below those of PAIR_FILM; the channel

// Pairs of each depth: for the surface, or the point in a medium, that scatters a path. See step_point.
enum {
  PAIR_LIGHT,   ///< a light and a point on it
  PAIR_BSDF,    ///< a direction by the BSDF or the phase function
  PAIR_CHOICE,  ///< digits below those of PAIR_LIGHT; choice of a lobe
  PAIR_END,     ///< Russian roulette; free flight to the surface
  STEP_PAIRS
};

// The numbers of one step by their purpose, in the order of these pairs.
enum {
  DIM_LIGHT_U,
  DIM_LIGHT_V,
  DIM_BSDF_U,
  DIM_BSDF_V,
  DIM_LIGHT_FINE,  ///< digits below those of DIM_LIGHT_U, see choose_light
  DIM_LOBE_CHOICE,
  DIM_ROULETTE,
  DIM_FREE_FLIGHT,
  DIM_UNUSED,  ///< for halves of pairs that are not needed
  STEP_DIMENSIONS
};

/// PCG output permutation as a hash (O'Neill 2014; Jarzynski and Olano 2020).
FN uint hash_uint(uint v) {
  uint s = v * 747796405u + 2891336453u;
  uint w = ((s >> ((s >> 28) + 4u)) ^ s) * 277803737u;
  return (w >> 22) ^ w;
}

/// The seed of a unit's random sequence; 0 is that of the scene's seed.
FN uint sequence_seed(uint seed, uint sequence) {
  return sequence != 0u ? hash_uint(seed ^ hash_uint(sequence)) : seed;
}

FN uint pixel_hash(uint seed, uint x, uint y) { return hash_uint(x + hash_uint(y + hash_uint(seed))); }

// Sobol: the pixels of a square of 2^TILE_LEVELS pixels a side share a sequence.
#define TILE_LEVELS 4
#define TILE_PLACE ((1u << 2 * TILE_LEVELS) - 1u)

/// Interleaves the bits of x (even positions) and y (odd positions): neighbours on the film share their high
/// bits. x, y < 2^8.
FN uint morton_index(uint x, uint y) {
  uint v = x | (y << 16);
  v = (v | (v << 4)) & 0x0f0f0f0fu;
  v = (v | (v << 2)) & 0x33333333u;
  v = (v | (v << 1)) & 0x55555555u;
  return (v | (v >> 15)) & 0xffffu;
}

/// The part of a pixel's numbers that does not depend on the sample. For most samplers it is a hash of the
/// pixel. For Sobol it is a hash of its tile, except for the lowest bits, which are the pixel's position
/// along the tile's Z curve.
FN uint pixel_sequence(int sampler, uint seed, uint x, uint y) {
  const uint of_tile = pixel_hash(seed, x >> TILE_LEVELS, y >> TILE_LEVELS) & ~TILE_PLACE;
  const uint mask = (1u << TILE_LEVELS) - 1u;
  return sampler == SAMPLER_SOBOL ? of_tile | morton_index(x & mask, y & mask) : pixel_hash(seed, x, y);
}

/// The top 24 bits as a float in [0, 1 - 2^-24].
FN float unit_float(uint bits) { return (float)(bits >> 8) * (1.0f / 16777216.0f); }

FN uint reverse_bits(uint v) {
#ifdef BIT_REVERSE
  return BIT_REVERSE(v);
#else
  v = (v >> 16) | (v << 16);
  v = ((v & 0xff00ff00u) >> 8) | ((v & 0x00ff00ffu) << 8);
  v = ((v & 0xf0f0f0f0u) >> 4) | ((v & 0x0f0f0f0fu) << 4);
  v = ((v & 0xccccccccu) >> 2) | ((v & 0x33333333u) << 2);
  return ((v & 0xaaaaaaaau) >> 1) | ((v & 0x55555555u) << 1);
#endif
}

/// Flips each bit by a hash of the bits below it: an Owen scramble of bit-reversed numbers. Laine and Karras
/// 2011, with Vegdahl's constants of 2021.
FN uint scramble_reversed(uint v, uint seed) {
  v ^= v * 0x3d20adeau;
  v += seed;
  v *= (seed >> 16) | 1u;
  v ^= v * 0x05526c56u;
  v ^= v * 0x53a22864u;
  return v;
}

/// The second Sobol dimension of index i, bit-reversed: Pascal's matrix modulo 2, in one step for each bit of
/// a bit's position.
FN uint sobol_second_reversed(uint i) {
  i ^= (i >> 1) & 0x55555555u;
  i ^= (i >> 2) & 0x33333333u;
  i ^= (i >> 4) & 0x0f0f0f0fu;
  i ^= (i >> 8) & 0x00ff00ffu;
  i ^= i >> 16;
  return i;
}

FN uint pair_seed(uint pixel, uint pair) { return hash_uint(pixel + pair * 0x9e3779b9u); }

/// A 2D Owen-scrambled Sobol point, padded over pairs by an Owen-shuffled index (Burley 2020).
FN void sobol_pair(uint pixel, uint index, uint pair, PRIVATE float* u, PRIVATE float* v) {
  uint seed = pair_seed(pixel, pair);
  uint shuffled = reverse_bits(scramble_reversed(reverse_bits(index), seed));
  *u = unit_float(reverse_bits(scramble_reversed(shuffled, hash_uint(seed ^ 0x68bc21ebu))));
  *v = unit_float(
      reverse_bits(scramble_reversed(sobol_second_reversed(shuffled), hash_uint(seed ^ 0x02e5be93u))));
}

/// Digits for a pixel's points in its tile's sequence: the smallest number with 2^bits >= points, at most 32.
FN uint point_bits(uint points) {
  uint bits = 0u;
  while (bits < 32u && ((points - 1u) >> bits) != 0u) bits++;
  return bits;
}

/// Point `index` of the 2^bits points of a pixel, given by its pixel_sequence. The points of all pixels of a
/// tile are one Owen-scrambled sequence along the Z curve. So not only the points of each pixel are a net,
/// but also those of every aligned square of 2 x 2, 4 x 4 ... pixels: the remaining errors of neighbouring
/// pixels have opposite signs, and averages of pixels cancel most of them. The index is shuffled differently
/// for each pair; the shuffle keeps aligned blocks together, so pixels swap positions within their tile and
/// nets stay nets. After Ahmed and Wonka 2020, "Screen-space blue-noise diffusion of Monte Carlo sampling
/// error via hierarchical ordering of pixels". If 32 bits cannot number all points, each pixel has its own
/// sequence.
FN void tile_pair(uint pixel, uint index, uint bits, uint pair, PRIVATE float* u, PRIVATE float* v) {
  const bool together = bits + 2u * TILE_LEVELS <= 32u;
  const uint place = pixel & TILE_PLACE;
  const uint sequence = together ? pixel & ~TILE_PLACE : pixel;
  sobol_pair(sequence, index | (together ? place << (bits & 31u) : 0u), pair, u, v);
}

FN void independent_pair(uint pixel, uint index, uint pair, PRIVATE float* u, PRIVATE float* v) {
  uint a = hash_uint(pair_seed(pixel, pair) + index * 0x85ebca6bu);
  *u = unit_float(a);
  *v = unit_float(hash_uint(a ^ 0x2c1b3c6du));
}

/// The i-th element of a random permutation of 0..n-1, by cycle walking (Kensler 2013).
FN uint permute(uint i, uint n, uint seed) {
  uint mask = n - 1u;
  mask |= mask >> 1;
  mask |= mask >> 2;
  mask |= mask >> 4;
  mask |= mask >> 8;
  mask |= mask >> 16;
  do {
    i ^= seed;
    i *= 0xe170893du;
    i ^= seed >> 16;
    i ^= (i & mask) >> 4;
    i ^= seed >> 8;
    i *= 0x0929eb3fu;
    i ^= seed >> 23;
    i ^= (i & mask) >> 1;
    i *= 1u | seed >> 27;
    i *= 0x6935fa69u;
    i ^= (i & mask) >> 11;
    i *= 0x74dcb303u;
    i ^= (i & mask) >> 2;
    i *= 0x9e501cc3u;
    i ^= (i & mask) >> 2;
    i *= 0xc860a3dfu;
    i &= mask;
    i ^= i >> 5;
  } while (i >= n);
  const uint shift = seed % n;  // i + seed could wrap around, which would not be a permutation
  return i < n - shift ? i + shift : i - (n - shift);
}

/// Columns of the most nearly square grid with n strata: the largest divisor of n that is at most sqrt(n).
FN uint strata_columns(uint n) {
  uint columns = (uint)SQRT((float)n);
  while (columns > 1u && n % columns != 0u) columns--;
  return columns;
}

/// Position `jitter`, in [0, 1), in stratum `cell` of `count`. Rounding must not move it to the next stratum.
FN float in_stratum(uint cell, float jitter, uint count) {
  const float below_next = BITS_FLOAT(FLOAT_BITS((float)(cell + 1u)) - 1u);
  return min_f(min_f((float)cell + jitter, below_next) / (float)count, ONE_MINUS_EPSILON);
}

/// Jittered strata, in an order that is a random permutation for each pixel and pair.
FN void stratified_pair(uint pixel, uint index, uint pair, uint spp, PRIVATE float* u, PRIVATE float* v) {
  uint seed = pair_seed(pixel, pair);
  uint columns = strata_columns(spp);
  uint rows = spp / columns;
  uint cell = permute(index % spp, spp, seed);
  float ju, jv;
  independent_pair(pixel, index, pair, &ju, &jv);
  *u = in_stratum(cell % columns, ju, columns);
  *v = in_stratum(cell / columns, jv, rows);
}

/// The radical inverse of the index in a prime base.
FN float radical_inverse(uint index, uint base) {
  float inverse = 1.0f / (float)base, digit_weight = inverse, sum = 0.0f;
  while (index > 0u) {
    uint next = index / base;
    sum += (float)(index - next * base) * digit_weight;
    digit_weight *= inverse;
    index = next;
  }
  return sum;
}

// Two bases for each of the pairs with Halton points; the last pair is that of the time.
#define HALTON_PAIRS 33
CONSTANT_TABLE uint halton_bases[2 * HALTON_PAIRS] = {
    2,   3,   5,   7,   11,  13,  17,  19,  23,  29,  31,  37,  41,  43,  47,  53,   // film, first depth ...
    59,  61,  67,  71,  73,  79,  83,  89,  97,  101, 103, 107, 109, 113, 127, 131,  //
    137, 139, 149, 151, 157, 163, 167, 173, 179, 181, 191, 193, 197, 199, 211, 223,  //
    227, 229, 233, 239, 241, 251, 257, 263, 269, 271, 277, 281, 283, 293, 307, 311,  //
    313, 317};
// Up to this place, points of two bases are almost uncorrelated without digit permutations.
#define PLAIN_HALTON_PAIRS 8u

/// The index of a pair's bases: film and first depth, then lens and channel, then the other depths.
FN uint halton_place(uint pair) {
  if (pair == PAIR_LENS) return STEP_PAIRS + 1u;
  if (pair == PAIR_CHANNEL) return STEP_PAIRS + 2u;
  if (pair == PAIR_TIME) return HALTON_PAIRS - 1u;
  if (pair + 2u == HALTON_PAIRS - 1u) return HALTON_PAIRS;
  return pair <= STEP_PAIRS ? pair : pair + 2u;
}

/// The radical inverse with permuted digits, a different permutation for each digit (Matousek 1998), to 24
/// bits.
FN float permuted_inverse(uint index, uint base, uint seed) {
  float inverse = 1.0f / (float)base, digit_weight = inverse, sum = 0.0f;
  for (uint place = seed; digit_weight > 2.9802322e-8f; place = hash_uint(place)) {
    const uint next = index / base;
    sum += (float)permute(index - next * base, base, place) * digit_weight;
    digit_weight *= inverse;
    index = next;
  }
  return min_f(sum, ONE_MINUS_EPSILON);
}

/// Halton points. Those of small bases are rotated by a random offset for each pixel (Cranley and Patterson
/// 1976). Those of larger bases, which are strongly correlated, have randomly permuted digits. Higher
/// dimensions are independent.
FN void halton_pair(uint pixel, uint index, uint pair, PRIVATE float* u, PRIVATE float* v) {
  const uint place = halton_place(pair);
  if (place >= HALTON_PAIRS) {
    independent_pair(pixel, index, pair, u, v);
    return;
  }
  const uint base_u = halton_bases[2u * place], base_v = halton_bases[2u * place + 1u];
  if (place >= PLAIN_HALTON_PAIRS) {
    const uint seed = pair_seed(pixel, pair);
    *u = permuted_inverse(index, base_u, seed);
    *v = permuted_inverse(index, base_v, hash_uint(seed ^ 0x02e5be93u));
    return;
  }
  float ru, rv;
  independent_pair(pixel, 0u, pair, &ru, &rv);
  const float a = radical_inverse(index, base_u) + ru, b = radical_inverse(index, base_v) + rv;
  *u = min_f(a >= 1.0f ? a - 1.0f : a, ONE_MINUS_EPSILON);
  *v = min_f(b >= 1.0f ? b - 1.0f : b, ONE_MINUS_EPSILON);
}

/// The nth of the `times` points that each sample of a pixel takes from a dimension pair. All points of the
/// pair form one sequence, so they are as well distributed as `times` as many samples.
typedef struct {
  uint pair;       ///< pair number at depth 0
  uint per_depth;  ///< increment for each surface that scattered the path
  uint times, nth;
} PairPoint;

FN PairPoint one_point(uint pair) {
  PairPoint point;
  point.pair = pair;
  point.per_depth = 0u;
  point.times = 1u;
  point.nth = 0u;
  return point;
}

// Pairs for surfaces that a ray meets and may pass through: one for each surface along the ray, separate from
// all others, so that the numbers of scenes without such surfaces do not change. A ray passes at most
// MOST_PASSED surfaces.
#define MOST_PASSED 4096
#define MOST_CROSSED 65536  // including boundaries of media, which need no numbers
#define PAIR_RAY_SURFACES 0x80000000u

/// The point for the k-th surface that a ray meets after it left a surface of the path's depth.
FN PairPoint met_point(int k) {
  PairPoint point = one_point(PAIR_RAY_SURFACES + (uint)k);
  point.per_depth = MOST_PASSED;
  return point;
}

/// The point for one of STEP_PAIRS, at each path's own depth.
FN PairPoint step_point(uint pair) {
  PairPoint point = one_point(1u + pair);
  point.per_depth = STEP_PAIRS;
  return point;
}

FN PairPoint nth_point(PairPoint point, int times, int nth) {
  point.times = (uint)times;
  point.nth = (uint)nth;
  return point;
}

FN uint pair_of_path(PairPoint point, const PRIVATE PathState* paths, int i) {
  return point.pair + point.per_depth * (uint)get_depth(paths, i);
}
FN uint index_of_path(PairPoint point, const PRIVATE PathState* paths, int i) {
  return (uint)get_sample_index(paths, i) * point.times + point.nth;
}

/// One pair of numbers for each of the LANES paths from lane `first` on.
JIT_CALLED_FN void sample_pair(int sampler, uint spp, PairPoint point, const PRIVATE PathState* paths,
                               int first, PRIVATE float* RESTRICT u, PRIVATE float* RESTRICT v) {
  const uint points = spp > 0xffffffffu / point.times ? 0xffffffffu : spp * point.times;
  if (HAS(SAMPLERS)) {
    if (sampler == SAMPLER_STRATIFIED) {
      for (int j = 0; j < LANES; j++)
        stratified_pair((uint)get_pixel_hash(paths, first + j), index_of_path(point, paths, first + j),
                        pair_of_path(point, paths, first + j), points, &u[j], &v[j]);
      return;
    }
    if (sampler == SAMPLER_HALTON) {
      for (int j = 0; j < LANES; j++)
        halton_pair((uint)get_pixel_hash(paths, first + j), index_of_path(point, paths, first + j),
                    pair_of_path(point, paths, first + j), &u[j], &v[j]);
      return;
    }
    if (sampler == SAMPLER_INDEPENDENT) {
      LANE_LOOP
        for (int j = 0; j < LANES; j++) {
          float a, b;
          independent_pair((uint)get_pixel_hash(paths, first + j), index_of_path(point, paths, first + j),
                           pair_of_path(point, paths, first + j), &a, &b);
          u[j] = a;
          v[j] = b;
        }
      return;
    }
  }
  const uint bits = point_bits(points);
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      float a, b;
      tile_pair((uint)get_pixel_hash(paths, first + j), index_of_path(point, paths, first + j), bits,
                pair_of_path(point, paths, first + j), &a, &b);
      u[j] = a;
      v[j] = b;
    }
}

/// Whether a pixel's samples of even and of odd index form two independent sequences, so that alpha for one
/// half is estimated from the other.
FN bool in_halves(const PRIVATE SceneHeader* h) {
  return HAS(POLYGONS) && h->integrator.estimator == ESTIMATOR_AUTO;
}

/// The number of samples of a pixel in one sequence.
FN uint sequence_length(const PRIVATE SceneHeader* h) {
  return in_halves(h) ? h->sampler.spp / 2u + h->sampler.spp % 2u : h->sampler.spp;
}

PENUMBRA_NAMESPACE_END
#endif
