// The records of spheres, disks and cylinders, and of the lights that they are.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <optional>

#include "kernels/scene_types.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// The record of a sphere, disk or cylinder, without materials and light; nothing for a mesh. `local(p,
/// reach)`: a position in the record's coordinates, and how far the shape reaches from there.
std::optional<Quadric> quadric_record(const Shape& shape,
                                      const std::function<vec3(const glm::dvec3& p, double reach)>& local);

/// The kind and the place of the light that the quadric is.
Light light_of_quadric(const Quadric& quadric);

/// In the description's units.
double quadric_area(const Geometry& geometry);

}  // namespace penumbra
