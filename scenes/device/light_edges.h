// Edges of lights that the camera sees, found once while the scene is built: see
// kernels/camera/light_edges.h. Lights are projected onto the film. Edges that two triangles of a light share
// cancel. The others are cut at each pixel's filter, whose integral over the light is a sum over the pieces
// (Green's theorem). Two rays beside each piece tell whether the edge is visible. Disks and spheres are
// polygons within 1/500 of a pixel. Not covered, and sampled as before: lights with textures or masks,
// cylinders, edges before an environment map, lenses, media, images with alpha, and scenes of more than a
// million triangles that Embree traces.
#pragma once

#include "kernels/host/error.h"
#include "scenes/device/intersector.h"
#include "scenes/device/scene_records.h"

namespace penumbra {

/// Finds the visible edges of triangles, disks and spheres that have uniform emission and are opaque. Fills
/// in their tables and the header's fields, and sets the feature bit if there are any edges. The rest of the
/// scene must be complete. A scene of more than a million triangles without a hierarchy of the portable
/// intersector gets no edges. Errors: those of add_hierarchy.
Expected<void> add_light_edges(SceneHeader& header, SceneRecords& records, TemporaryHierarchy& hierarchy);

}  // namespace penumbra
