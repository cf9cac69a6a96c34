// Light tables that arrive over the network: a worker refuses invalid data for choosing lights, and invalid
// edges.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "kernels/host/device_scene.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra::light_tables_check_test {
namespace {

/// A light of several triangles that the camera sees, and another one above it.
DeviceScene scene_of_area_lights() {
  SceneDescription scene = read_or_throw(project_file("scenes/star-light/star-light.xml"));
  use(scene.integrator, IntegratorKind::kDirect);
  Shape& area_light =
      *std::ranges::find_if(scene.shapes, [](const Shape& s) { return s.radiance.has_value(); });
  area_light.sampling = EmitterSampling::kArea;
  Shape above = area_light;
  for (auto& p : std::get<Mesh>(above.geometry).positions) p.y += 3;
  scene.shapes.push_back(std::move(above));
  return build_or_throw(scene);
}

template <typename Record>
std::span<Record> records(DeviceScene& scene, TableSpan span) {
  return {reinterpret_cast<Record*>(scene.words.data() + span.offset), std::size_t(span.count)};
}

struct Broken {
  const char* what;  ///< in the error
  std::function<void(DeviceScene&)> change;
};

TEST(LightTablesCheck, TablesAsTheyAreBuiltAreAccepted) {
  const DeviceScene scene = scene_of_area_lights();
  ASSERT_GT(scene.header.tables.lights.count, 1);
  ASSERT_GT(scene.header.tables.light_edge_pixels.count, 0);
  const auto checked = check_device_scene(scene);
  EXPECT_TRUE(checked) << checked.error().message;
}

TEST(LightTablesCheck, TablesThatLeadElsewhereAreRefused) {
  const auto cells = [](DeviceScene& s) { return records<int>(s, s.header.tables.light_cells); };
  const auto rows = [](DeviceScene& s) { return records<int>(s, s.header.tables.light_edge_rows); };
  const auto pixels = [](DeviceScene& s) {
    return records<LightEdgePixel>(s, s.header.tables.light_edge_pixels);
  };
  const std::vector<Broken> broken = {
      {"no power of two", [](DeviceScene& s) { --s.header.tables.light_cells.count; }},
      {"no cells to choose lights by", [](DeviceScene& s) { s.header.tables.light_cells.count = 0; }},
      {"names one that is not there",
       [&](DeviceScene& s) { cells(s).back() = s.header.tables.lights.count; }},
      {"names one that is not there", [&](DeviceScene& s) { cells(s).front() = -1; }},
      {"do not match the film", [](DeviceScene& s) { --s.header.tables.light_edge_rows.count; }},
      {"do not match the film", [](DeviceScene& s) { ++s.header.film.height; }},
      {"not in order", [&](DeviceScene& s) { rows(s).front() = 1; }},
      {"not in order", [&](DeviceScene& s) { ++rows(s).back(); }},
      {"not in order", [&](DeviceScene& s) { rows(s)[1] = s.header.tables.light_edge_pixels.count + 1; }},
      {"edges of lights that are not there", [&](DeviceScene& s) { pixels(s)[0].first_edge = -1; }},
      {"edges of lights that are not there", [&](DeviceScene& s) { pixels(s)[0].edge_count = 0x7fffffff; }},
      {"edges of lights that are not there",
       [&](DeviceScene& s) { pixels(s).back().first_edge = s.header.tables.light_edges.count; }},
      {"a polygon that is not there", [](DeviceScene& s) {
         s.header.features |= FEATURE_POLYGONS;
         records<Light>(s, s.header.tables.lights)[0].polygon = 1 << 20;
       }}};
  for (const Broken& one : broken) {
    DeviceScene scene = scene_of_area_lights();
    one.change(scene);
    const auto checked = check_device_scene(scene);
    ASSERT_FALSE(checked) << one.what;
    EXPECT_NE(checked.error().message.find(one.what), std::string::npos) << checked.error().message;
  }
}

}  // namespace
}  // namespace penumbra::light_tables_check_test
