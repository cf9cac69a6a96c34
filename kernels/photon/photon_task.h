// The photon paths of one map, and where the photons are stored.
#ifndef PENUMBRA_PHOTON_TASK_H
#define PENUMBRA_PHOTON_TASK_H
#include "kernels/scene_types.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  uint map;       ///< number of the map: 0, or PHOTONS_PROGRESSIVE 0, 1, ...
  uint sequence;  ///< random sequence, see Unit
  int paths;      ///< number of paths of photons
} PhotonTask;

/// Where photons are stored. `count` goes on past the capacity, so that the caller knows how many there are.
typedef struct {
  GLOBAL Photon* photons;
  GLOBAL int* count;
  int capacity;
} PhotonStore;

PENUMBRA_NAMESPACE_END
#endif
