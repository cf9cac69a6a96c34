// Small scenes for tests of devices and of the device scene. Each takes another path through the kernels.
#pragma once

#include <cstdint>
#include <cstring>
#include <ostream>
#include <string>
#include <vector>

#include "kernels/host/device_scene.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// A box of diffuse parallelograms with an area light, 24 x 18 pixels, path tracing: the features of most
/// scenes.
SceneDescription diffuse_box();

/// The box with a bumpy floor of many triangles, so that it needs a hierarchy.
SceneDescription many_triangles();
/// So many that devices choose whether to test all or to build on a hierarchy.
SceneDescription some_triangles();

/// Spheres, disks, Phong, vertex normals, point light, environment and a Mitchell filter, direct light by
/// solid angle.
SceneDescription everything();

/// The same with so many spheres that it needs a hierarchy, by path tracing, projected
/// solid angle and Halton points.
SceneDescription everything_in_a_hierarchy();

/// A concave two-sided light, a triangle and the box's square, sampled in different ways, a sphere light and
/// a glossy floor: path tracing with control variates, lights chosen by their contribution.
SceneDescription polygon_lights();

/// A group of smooth and glossy shapes, some of them seen through, placed turned, mirrored and stretched, by
/// path tracing.
SceneDescription instances();
/// A sky and more lights than the cut of their hierarchy has nodes, path tracing.
SceneDescription lights_in_a_hierarchy();

/// No shape at all, only a constant environment, and a material that nothing uses.
SceneDescription environment_alone();

/// The box with lights of all kinds, those of shapes with textures.
SceneDescription emitters();
/// Two media that are lights, one by its density, by path tracing.
SceneDescription flames();

/// The box with curves of all forms, and instances of them.
SceneDescription curves();

struct NamedScene {
  std::string name;
  SceneDescription (*make)();
};
void PrintTo(const NamedScene& scene, std::ostream* out);
const std::vector<NamedScene>& device_scenes();

/// Changes a record of one of the scene's tables.
template <typename Record, typename Change>
DeviceScene with_record(DeviceScene scene, TableSpan span, std::size_t index, Change change) {
  Record record;
  std::uint32_t* at = scene.words.data() + span.offset + index * (sizeof(Record) / 4);
  std::memcpy(&record, at, sizeof record);
  change(record);
  std::memcpy(at, &record, sizeof record);
  return scene;
}

}  // namespace penumbra
