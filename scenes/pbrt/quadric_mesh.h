// Spheres, disks and cylinders of pbrt as triangles: parts of them, and what a transform makes an ellipsoid.
#pragma once

#include "scenes/scene_description.h"

namespace penumbra::pbrt {

/// Degrees from the x axis on, about z.
constexpr double kWholeTurn = 360.0;

/// In their own space, smooth, with pbrt's texture coordinates; the front is outside, of the disk towards +z.
Mesh sphere_mesh(double radius, double low, double high, double degrees = kWholeTurn);
Mesh disk_mesh(double radius, double inner_radius, double height, double degrees = kWholeTurn);
Mesh cylinder_mesh(double radius, double low, double high, double degrees = kWholeTurn);

}  // namespace penumbra::pbrt
