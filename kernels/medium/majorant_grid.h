// The coarse grid over a volume, of whose cells each knows the largest number within.
#ifndef PENUMBRA_MAJORANT_GRID_H
#define PENUMBRA_MAJORANT_GRID_H
#include "kernels/scene_types.h"

PENUMBRA_NAMESPACE_BEGIN

#define MAJORANT_CELLS 8  // of a volume, along each axis, that share a majorant

/// Cells of the coarse grid along an axis along which the volume has so many.
FN int majorant_cells(int cells) { return (cells + (MAJORANT_CELLS - 1)) / MAJORANT_CELLS; }

PENUMBRA_NAMESPACE_END
#endif
