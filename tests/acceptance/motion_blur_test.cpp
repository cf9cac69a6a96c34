// Blurred images against the mean of stills at stratified times.
#include <gtest/gtest.h>

#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "scenes/motion/scene_motion.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/support/render_scene.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::motion_blur_test {
namespace {

constexpr int kSide = 24;  ///< of the film
constexpr int kStills = 64;
constexpr int kBatches = 10;
constexpr int kBlock = 3;
constexpr double kSignificance = 1e-3;  ///< of each scene; the seeds are fixed

/// A floor and a lamp above it. `rest` comes after them, `integrator` is the plugin's name and parameters.
SceneDescription scene_of(const std::string& rest,
                          const std::string& integrator = "<integrator type='path'/>", bool lamp = true) {
  const std::string light =
      "<shape type='rectangle'><transform name='to_world'><scale value='1.2'/><rotate x='1' angle='90'/>"
      "<translate y='3' x='1'/></transform><emitter type='area'><rgb name='radiance' value='9 8 "
      "7'/></emitter>"
      "</shape>";
  const std::string text =
      "<scene version='3.0.0'>" + integrator +
      "<sensor type='perspective'><float name='fov' value='40'/><transform name='to_world'>"
      "<lookat origin='0.3, 1.2, -5' target='0, 0, 0' up='0, 1, 0'/></transform>"
      "<film type='hdrfilm'><integer name='width' value='24'/><integer name='height' value='24'/>"
      "<rfilter type='box'/></film><sampler type='independent'/></sensor>"
      "<shape type='rectangle'><transform name='to_world'><scale value='6'/><rotate x='1' angle='-90'/>"
      "<translate y='-1'/></transform><bsdf type='diffuse'/></shape>" +
      (lamp ? light : "") + rest + "</scene>";
  const TemporaryFolder folder;
  write_text(folder.path() / "scene.xml", text);
  SceneDescription scene = read_or_throw(folder.path() / "scene.xml");
  scene.camera.shutter = 1.0f;
  scene.frame_duration = 1.0;
  return scene;
}

/// Builds the motion of a scene whose shutter is open from 0 to 1.
class Mover {
 public:
  explicit Mover(SceneDescription& scene) : scene_(scene) {}
  ~Mover() { scene_.motion = std::make_shared<const SceneMotion>(std::move(motion_)); }
  Mover(const Mover&) = delete;
  Mover& operator=(const Mover&) = delete;

  /// A node that turns about an axis through `center`, by `degrees`, and then moves by `way`.
  int node(const glm::dvec3& way, double degrees = 0, const glm::dvec3& axis = {0, 1, 0},
           const glm::dvec3& center = glm::dvec3(0), double size = 1) {
    std::vector<TransformKey> keys;
    constexpr int kKeys = 8;  // a turn between two of them is less than half a turn
    for (int k = 0; k <= kKeys; ++k) {
      const double t = double(k) / kKeys;
      glm::dmat4 m = glm::translate(glm::dmat4(1), center + t * way);
      m = glm::rotate(m, glm::radians(t * degrees), axis);
      m = glm::scale(m, glm::dvec3(1 + t * (size - 1)));
      keys.push_back({t, glm::translate(m, -center)});
    }
    motion_.nodes.push_back({.keys = keyed_transform(keys).value()});
    return int(motion_.nodes.size()) - 1;
  }
  void shape(std::size_t index, int node) {
    motion_.shapes.push_back({.shape = index, .rest = scene_.shapes.at(index).geometry, .place = {node}});
  }
  void last_shape(int node) { shape(scene_.shapes.size() - 1, node); }
  void instance(std::size_t index, int node) {
    motion_.instances.push_back({index, {node, scene_.instances.at(index).to_world}});
  }
  void emitter(std::size_t index, int node) {
    motion_.emitters.push_back({.emitter = index, .rest = scene_.emitters.at(index), .place = {node}});
  }
  MovingCamera& camera(int node) {
    motion_.camera = MovingCamera{.place = {node, scene_.camera.to_world}};
    return *motion_.camera;
  }
  /// The mesh's positions grow by `change` from the beginning to the end.
  void deform(std::size_t index, const std::function<glm::dvec3(const glm::dvec3&)>& change) {
    auto deformation = std::make_shared<MeshDeformation>();
    MorphTarget target;
    for (const glm::dvec3& p : std::get<Mesh>(scene_.shapes.at(index).geometry).positions)
      target.positions.push_back(change(p));
    deformation->targets.push_back(std::move(target));
    deformation->weights = {.times = {0, 1}, .values = {{0}, {1}}};
    motion_.shapes.push_back(
        {.shape = index, .rest = scene_.shapes.at(index).geometry, .deformation = std::move(deformation)});
  }

 private:
  SceneDescription& scene_;
  SceneMotion motion_;
};

struct Case {
  std::string name;
  std::function<SceneDescription()> scene;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

std::string cube(const std::string& bsdf, const std::string& place = "") {
  return "<shape type='cube'><transform name='to_world'><scale value='0.6'/>" + place + "</transform>" +
         bsdf + "</shape>";
}
const std::string kGrey = "<bsdf type='diffuse'><rgb name='reflectance' value='0.7 0.4 0.2'/></bsdf>";

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
  add("DeltaLights", [] {
    SceneDescription scene = scene_of(
        cube(kGrey) +
            "<emitter type='point'><point name='position' x='-1.5' y='0.5' z='-1'/>"
            "<rgb name='intensity' value='2 1 1'/></emitter>"
            "<emitter type='spot'><transform name='to_world'><lookat origin='2, 2, -2' target='0, -0.5, 0' "
            "up='0, 1, 0'/></transform><rgb name='intensity' value='3 9 3'/><float name='cutoff_angle' "
            "value='25'/></emitter>"
            "<emitter type='directional'><vector name='direction' x='0.5' y='-1' z='0.4'/>"
            "<rgb name='irradiance' value='0.2 0.2 1'/></emitter>",
        "<integrator type='path'/>", false);
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

/// Means of batches of stills, one at a random time in each of kStills equal parts of the exposure.
statistics::Estimate of_stills(SceneDescription scene) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> within(0, 1);
  scene.camera.shutter = 0.0f;
  scene.sampler.spp = 1;
  std::vector<statistics::Image> batches;
  for (int b = 0; b < kBatches; ++b) {
    statistics::Image sum(kSide, kSide, 3);
    for (int k = 0; k < kStills; ++k) {
      if (auto done = set_time(scene, (k + within(random)) / kStills); !done)
        throw std::runtime_error(done.error().message);
      scene.sampler.seed = std::uint32_t(1000 + b * kStills + k);
      const statistics::Image still = mean_image(render_or_throw(scene));
      for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += still.values[i] / kStills;
    }
    batches.push_back(statistics::block_average(sum, kBlock));
  }
  return statistics::estimate_from_batches(batches);
}

class MotionBlur : public testing::TestWithParam<Case> {};

TEST_P(MotionBlur, IsTheMeanOfStills) {
  SceneDescription scene = GetParam().scene();
  ASSERT_TRUE(set_time(scene, 0));
  ASSERT_NE(build_or_throw(scene).header.features & FEATURE_MOTION, 0u);
  const statistics::Estimate stills = of_stills(scene);
  scene.sampler.spp = kStills;
  const statistics::Estimate blurred = block_estimate(scene, kBatches, 1, kBlock);
  const auto result = statistics::z_test(blurred, stills, {.significance = kSignificance});
  EXPECT_TRUE(result.passed) << result.summary();
  RecordProperty("z", result.summary());
}

INSTANTIATE_TEST_SUITE_P(Scenes, MotionBlur, testing::ValuesIn(cases()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace penumbra::motion_blur_test
