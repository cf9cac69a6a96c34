// Small scenes for tests of devices and of the device scene, one for each way through the kernels.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "scenes/scene_description.h"

namespace penumbra {

/// A box of diffuse parallelograms with an area light, 24 x 18 pixels, path tracing: the features of most
/// scenes.
SceneDescription diffuse_box();

/// The box with a bumpy floor of many triangles, so that it needs a hierarchy.
SceneDescription many_triangles();

/// Spheres, disks, Phong, vertex normals, point light, environment and a Mitchell filter, direct light by
/// solid angle.
SceneDescription everything();

/// The same with so many spheres that it needs a hierarchy, by path tracing, projected
/// solid angle and Halton points.
SceneDescription everything_in_a_hierarchy();

/// A concave two-sided light, a triangle and the box's square, sampled in different ways, a sphere light and
/// a glossy floor: path tracing with control variates, lights chosen by their contribution.
SceneDescription polygon_lights();

/// No shape at all, only a constant environment, and a material that nothing uses.
SceneDescription environment_alone();

struct NamedScene {
  std::string name;
  SceneDescription (*make)();
};
void PrintTo(const NamedScene& scene, std::ostream* out);
const std::vector<NamedScene>& device_scenes();

}  // namespace penumbra
