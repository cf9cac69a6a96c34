// The structs of photon maps that host and device share (see scene_types.h), and the list of maps.
#ifndef PENUMBRA_PHOTON_FIELDS_H
#define PENUMBRA_PHOTON_FIELDS_H

// The maps of a scene. A photon belongs to one of the first three.
#define PHOTON_MAP_SURFACE 0  // indirect light on surfaces; PHOTONS_FIXED: without caustics
#define PHOTON_MAP_CAUSTIC 1  // light that only surfaces without a diffuse part scattered; PHOTONS_FIXED only
#define PHOTON_MAP_VOLUME 2   // indirect light in media
#define PHOTON_MAP_IRRADIANCE 3  // final gathering: the irradiance at some photons of the first two maps
#define PHOTON_MAPS 4

// A photon where it arrived. Its power is that of its path if that were the only one: estimates divide by the
// number of paths. In media the power is over the scattering coefficient.
#define PHOTON_FIELDS(F)                                                    \
  F(vec3, p)                                                                \
  F(vec3, wi)     /* unit, back along its path */                           \
  F(vec3, normal) /* unit geometric normal on the side of wi; 0 in media */ \
  F(vec3, power)  /* see above */                                           \
  F(int, map)     /* PHOTON_MAP_* */                                        \
  F(int, path)    /* index of its path */                                   \
  F(int, edges)   /* number of edges from the light to here; 2 or more: indirect */

// One map in the array of words that holds all. Its photons are sorted by bucket, path and edges. Arrays, one
// after the other from `offset` on: x, y, z of the positions, then of wi, normals and powers; edges; and the
// first photon of each bucket, with the end.
#define PHOTON_MAP_FIELDS(F)                                                 \
  F(int, count)                                                              \
  F(int, buckets)       /* a power of two */                                 \
  F(float, radius)      /* of density estimates */                           \
  F(float, beam_radius) /* of estimates along beams, in media */             \
  F(vec3, low)          /* bounds of the photons, for beams */               \
  F(vec3, high)                                                              \
  F(float, cells) /* 1 / the side of a cell, which is longer than 2 radii */ \
  F(float, share) /* 1 / the number of paths of photons */                   \
  F(uint, offset) /* in words from the start of the array */

#endif
