// Blurred images against the mean of stills at stratified times.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "tests/acceptance/motion_pieces.h"

namespace penumbra::motion_blur_test {
namespace {

using namespace motion_pieces;

struct Case {
  std::string name;
  std::function<SceneDescription()> scene;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto add = [&](std::string name, std::function<SceneDescription()> scene) {
    all.push_back({std::move(name), std::move(scene)});
  };
  add("Object", [] {
    SceneDescription scene = scene_of(cube(kGrey));
    Mover move(scene);
    move.last_shape(move.node({1.4, 0.5, 0}, 80));
    return scene;
  });
  add("FarObject", [] {  // crosses more than the picture
    SceneDescription scene = scene_of(cube(kGrey, "<translate x='-12'/>"));
    Mover move(scene);
    move.last_shape(move.node({24, 0, 1}, 300, {0, 0, 1}, {-12, 0, 0}));
    return scene;
  });
  add("Sphere", [] {  // shrinks as it moves
    SceneDescription scene =
        scene_of("<shape type='sphere'><float name='radius' value='0.8'/>" + kGrey + "</shape>");
    Mover move(scene);
    move.last_shape(move.node({0.8, 0.3, 0.4}, 0, {0, 1, 0}, glm::dvec3(0), 0.4));
    return scene;
  });
  add("Deformation", [] {
    SceneDescription scene = scene_of(cube(kGrey));
    Mover move(scene);
    move.deform(scene.shapes.size() - 1,
                [](const glm::dvec3& p) { return glm::dvec3(0.9 * p.y + 0.4, 0.5 * p.x, -0.6 * p.z); });
    return scene;
  });
  add("Camera", [] {
    SceneDescription scene = scene_of(cube(kGrey));
    Mover move(scene);
    move.camera(move.node({0.9, 0.2, 0.8}, 9, {0.1, 1, 0.2}));
    return scene;
  });
  add("CameraWithLens", [] {
    SceneDescription scene = scene_of(cube(kGrey));
    scene.camera.aperture_radius = 0.15;
    scene.camera.focus_distance = 4;
    Mover move(scene);
    MovingCamera& camera = move.camera(move.node({0.5, 0, 0.3}, -6));
    camera.fov = KeyedValue<double>{.times = {0, 1}, .values = {40, 55}};
    return scene;
  });
  add("AreaLight", [] {
    SceneDescription scene = scene_of(cube(kGrey));
    Mover move(scene);
    move.shape(1, move.node({-2.5, 0.8, 0}, 70, {0, 0, 1}, {1, 3, 0}));
    return scene;
  });
  add("RoundLights", [] {
    SceneDescription scene = scene_of(
        "<shape type='sphere'><float name='radius' value='0.3'/><point name='center' x='-1' y='0.4' z='0'/>"
        "<emitter type='area'><rgb name='radiance' value='6 1 1'/></emitter></shape>"
        "<shape type='disk'><transform name='to_world'><scale value='0.4'/><rotate x='1' angle='90'/>"
        "<translate x='1.2' y='0.6'/></transform>"
        "<emitter type='area'><rgb name='radiance' value='1 6 1'/></emitter></shape>"
        "<shape type='cylinder'><float name='radius' value='0.15'/><point name='p0' x='0' y='0' z='0.6'/>"
        "<point name='p1' x='0' y='0.9' z='0.6'/><emitter type='area'><rgb name='radiance' value='1 1 6'/>"
        "</emitter></shape>",
        "<integrator type='path'/>", false);
    Mover move(scene);
    move.shape(1, move.node({1.1, 0.5, 0}, 0, {0, 1, 0}, {-1, 0.4, 0}, 0.6));
    move.shape(2, move.node({-0.5, 0.4, 0.2}, 60, {1, 0, 0}, {1.2, 0.6, 0}));
    move.shape(3, move.node({0.4, 0, -0.5}, 75, {0, 0, 1}, {0, 0, 0.6}));
    return scene;
  });
  const std::string point =
      "<emitter type='point'><point name='position' x='-1.5' y='0.5' z='-1'/>"
      "<rgb name='intensity' value='2 1 1'/></emitter>"
      "<emitter type='spot'><transform name='to_world'><lookat origin='2, 2, -2' target='0, -0.5, 0' "
      "up='0, 1, 0'/></transform><rgb name='intensity' value='3 9 3'/><float name='cutoff_angle' value='25'/>"
      "</emitter>";
  const std::string directional =
      "<emitter type='directional'><vector name='direction' x='0.5' y='-1' z='0.4'/>"
      "<rgb name='irradiance' value='0.2 0.2 1'/></emitter>";
  for (const auto& [name, lights] :
       {std::pair("PointLights", point), std::pair("DirectionalLight", directional),
        std::pair("DeltaLights", point + directional)})
    add(name, [lights] {
      SceneDescription scene = scene_of(cube(kGrey) + lights, "<integrator type='path'/>", false);
      Mover move(scene);
      for (std::size_t i = 0; i < scene.emitters.size(); ++i)
        move.emitter(i, move.node({0.8, 0.3, 0.5}, 25, {0.2, 0.5, 1}));
      return scene;
    });
  add("Instances", [] {
    SceneDescription scene = scene_of(
        "<shape type='shapegroup' id='pair'>" + cube(kGrey, "<scale value='0.4'/><translate x='-0.4'/>") +
        "<shape type='sphere'><float name='radius' value='0.3'/><point name='center' x='0.4' y='0.1' z='0'/>"
        "<bsdf type='diffuse'/></shape></shape>"
        "<shape type='instance'><ref id='pair'/><transform name='to_world'><translate "
        "y='0.6'/></transform></shape>"
        "<shape type='instance'><ref id='pair'/><transform name='to_world'><scale x='1.5' y='0.7'/>"
        "<translate y='-0.5'/></transform></shape>");
    Mover move(scene);
    move.instance(0, move.node({0.7, 0.2, 0}, 110, {0, 0, 1}, {0, 0.6, 0}));
    return scene;
  });
  add("MaskAndBumps", [] {
    SceneDescription scene = scene_of(cube(
        "<bsdf type='mask'><texture name='opacity' type='checkerboard'><float name='color0' value='1'/>"
        "<float name='color1' value='0.2'/><transform name='to_uv'><scale value='2'/></transform></texture>"
        "<bsdf type='roughconductor'><float name='alpha' value='0.3'/></bsdf></bsdf>"));
    Mover move(scene);
    move.last_shape(move.node({0.9, 0.4, 0}, 100, {0.3, 1, 0}));
    return scene;
  });
  add("Medium", [] {
    SceneDescription scene = scene_of(
        "<shape type='cube'><transform name='to_world'><scale value='0.7'/></transform><bsdf type='null'/>"
        "<medium type='homogeneous' name='interior'><rgb name='sigma_t' value='1.5 1 0.7'/>"
        "<rgb name='albedo' value='0.9 0.8 0.7'/></medium></shape>",
        "<integrator type='volpath'/>");
    Mover move(scene);
    move.last_shape(move.node({1.0, 0.3, 0}, 60));
    return scene;
  });
  add("ClosedForms", [] {
    SceneDescription scene =
        scene_of(cube(kGrey), "<integrator type='path'><string name='nee' value='cv'/></integrator>");
    Mover move(scene);
    move.shape(1, move.node({-2.5, 0.8, 0}, 70, {0, 0, 1}, {1, 3, 0}));
    move.last_shape(move.node({0.8, 0.4, 0}, 50));
    return scene;
  });
  add("DirectLight", [] {
    SceneDescription scene = scene_of(
        cube(kGrey),
        "<integrator type='direct'><integer name='emitter_samples' value='2'/><integer name='bsdf_samples' "
        "value='2'/></integrator>");
    Mover move(scene);
    move.shape(1, move.node({-2.5, 0.8, 0}, 70, {0, 0, 1}, {1, 3, 0}));
    move.last_shape(move.node({0.8, 0.4, 0}, 50));
    return scene;
  });
  return all;
}

class MotionBlur : public testing::TestWithParam<Case> {};

TEST_P(MotionBlur, IsTheMeanOfStills) { expect_mean_of_stills(GetParam().scene()); }

INSTANTIATE_TEST_SUITE_P(Scenes, MotionBlur, testing::ValuesIn(cases()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace penumbra::motion_blur_test
