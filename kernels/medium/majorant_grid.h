// The coarse majorant grid of a volume: each of its cells stores the maximum of the volume's numbers inside.
#ifndef PENUMBRA_MAJORANT_GRID_H
#define PENUMBRA_MAJORANT_GRID_H
#include "kernels/scene_types.h"

PENUMBRA_NAMESPACE_BEGIN

#define MAJORANT_CELLS 8  // cells of the volume along each axis that share a majorant

/// Cells of the majorant grid along an axis that has `cells` cells in the volume.
FN int majorant_cells(int cells) { return (cells + (MAJORANT_CELLS - 1)) / MAJORANT_CELLS; }

PENUMBRA_NAMESPACE_END
#endif
