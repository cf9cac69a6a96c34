// Triangle meshes of pbrt's spheres, disks and cylinders, which may be partial, or deformed by a transform.
#pragma once

#include "scenes/scene_description.h"

namespace penumbra::pbrt {

/// A full turn about z in degrees, measured from the x axis.
constexpr double kWholeTurn = 360.0;

/// Smooth meshes in the quadric's own space, with pbrt's texture coordinates. The front is the outside; for
/// the disk it faces +z.
Mesh sphere_mesh(double radius, double low, double high, double degrees = kWholeTurn);
Mesh disk_mesh(double radius, double inner_radius, double height, double degrees = kWholeTurn);
Mesh cylinder_mesh(double radius, double low, double high, double degrees = kWholeTurn);

}  // namespace penumbra::pbrt
