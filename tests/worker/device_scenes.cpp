#include "tests/worker/device_scenes.h"

#include <array>
#include <cmath>
#include <memory>

#include "scenes/transform.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/support/every_curve.h"
#include "tests/support/every_emitter.h"
#include "tests/support/every_texture.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

using glm::dvec3;

/// Seen from outside through the missing wall at z = 1.
void add_box(SceneDescription& scene) {
  const int white = add_diffuse(scene, 0.7f), grey = add_diffuse(scene, 0.3f);
  scene.shapes.push_back(parallelogram(dvec3(-1, -1, 1), dvec3(2, 0, 0), dvec3(0, 0, -2), white));  // floor
  scene.shapes.push_back(parallelogram(dvec3(-1, 1, -1), dvec3(2, 0, 0), dvec3(0, 0, 2), white));   // ceiling
  scene.shapes.push_back(parallelogram(dvec3(-1, -1, -1), dvec3(2, 0, 0), dvec3(0, 2, 0), white));  // back
  scene.shapes.push_back(parallelogram(dvec3(-1, -1, 1), dvec3(0, 0, -2), dvec3(0, 2, 0), grey));   // left
  scene.shapes.push_back(parallelogram(dvec3(1, -1, -1), dvec3(0, 0, 2), dvec3(0, 2, 0), grey));    // right
  scene.shapes.push_back(
      parallelogram(dvec3(-0.25, 0.99, -0.25), dvec3(0.5, 0, 0), dvec3(0, 0, 0.5), kBlackBsdf, 10.0f));
}

SceneDescription film_and_camera() {
  SceneDescription scene = empty_scene(24, 18, 8, 1);
  scene.sampler.kind = SamplerKind::kSobol;
  scene.camera = look_at(dvec3(0, 0, 4), dvec3(0, 0, 0), dvec3(0, 1, 0), 40);
  return scene;
}

/// A wavy sheet of 2 cells^2 triangles just above the floor.
Shape bumpy_sheet(int cells, int bsdf, bool with_normals) {
  Mesh mesh;
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; j <= cells; ++j) {
      const double x = -0.9 + 1.8 * i / cells, z = -0.9 + 1.8 * j / cells;
      mesh.positions.emplace_back(x, -0.8 + 0.1 * std::sin(5 * x) * std::cos(4 * z), z);
      if (with_normals) {
        const dvec3 slope(0.5 * std::cos(5 * x) * std::cos(4 * z), 0,
                          -0.4 * std::sin(5 * x) * std::sin(4 * z));
        mesh.normals.emplace_back(glm::normalize(dvec3(0, 1, 0) - slope));
      }
    }
  const auto at = [&](int i, int j) { return unsigned(i * (cells + 1) + j); };
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      mesh.triangles.emplace_back(at(i, j), at(i, j + 1), at(i + 1, j + 1));
      mesh.triangles.emplace_back(at(i, j), at(i + 1, j + 1), at(i + 1, j));
    }
  Shape shape;
  shape.name = "sheet";
  shape.geometry = std::move(mesh);
  shape.front_bsdf = shape.back_bsdf = bsdf;
  return shape;
}

Shape sphere(dvec3 center, double radius, int bsdf, std::optional<float> radiance = std::nullopt) {
  Shape shape;
  shape.name = "sphere";
  shape.geometry = Sphere{center, radius};
  shape.front_bsdf = bsdf;
  if (radiance) shape.radiance = glm::vec3(*radiance);
  return shape;
}

void add_everything(SceneDescription& scene, int sheet_cells) {
  add_box(scene);
  const int glossy = int(scene.bsdfs.size());
  scene.bsdfs.push_back({"glossy", PhongBsdf{glm::vec3(0.3f), glm::vec3(0.5f), 40}});
  scene.shapes.push_back(bumpy_sheet(sheet_cells, glossy, true));
  scene.shapes.push_back(sphere(dvec3(-0.4, -0.3, 0), 0.3, glossy));
  scene.shapes.push_back(sphere(dvec3(0.6, 0.5, 0.2), 0.1, kBlackBsdf, 5.0f));
  Shape disk;
  disk.name = "disk";
  disk.geometry = Disk{dvec3(0.4, -0.2, -0.3), glm::normalize(dvec3(-1, 0.5, 1)), 0.3};
  disk.front_bsdf = 0;
  disk.back_bsdf = glossy;
  disk.radiance = glm::vec3(0.5f);
  scene.shapes.push_back(disk);
  scene.emitters.emplace_back(PointLight{dvec3(0, 0.5, 0.9), glm::vec3(0.5f)});
  scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(0.2f, 0.3f, 0.4f)});
  scene.film.filter = FilterKind::kMitchell;
  scene.film.filter_radius = 2;
}

/// A ball of glass and one of fog.
SceneDescription photons() {
  SceneDescription scene = film_and_camera();
  add_box(scene);
  scene.bsdfs.push_back({"glass", DielectricBsdf{}});
  scene.bsdfs.push_back({"inside", DielectricBsdf{}.other_side()});
  scene.bsdfs.push_back({"nothing", NullBsdf{}});
  scene.bsdfs.push_back({"glossy", PhongBsdf{glm::vec3(0.3f), glm::vec3(0.5f), 40}});
  const int glossy = int(scene.bsdfs.size()) - 1, nothing = glossy - 1;
  scene.media.push_back({.name = "fog",
                         .extinction = glm::vec3(2, 3, 4),
                         .albedo = glm::vec3(0.8f),
                         .phase = {{PHASE_HG, 0.4f, 1}}});
  const auto add_ball = [&](const dvec3& center, int front, int back) {
    Shape ball;
    ball.name = "ball";
    ball.geometry = Sphere{.center = center, .radius = 0.3};
    ball.front_bsdf = front;
    ball.back_bsdf = back;
    scene.shapes.push_back(ball);
  };
  add_ball(dvec3(-0.4, -0.5, 0), nothing - 2, nothing - 1);
  add_ball(dvec3(0.4, -0.5, 0.2), glossy, glossy);
  add_ball(dvec3(0.3, 0.3, 0), nothing, nothing);
  scene.shapes.back().interior = 0;
  ProgressivePhotonIntegrator ppm;
  ppm.photon_count = 60;
  ppm.initial_radius = 0.3f;
  scene.integrator.method = ppm;
  return scene;
}

}  // namespace

SceneDescription flames() {
  SceneDescription scene = film_and_camera();
  add_box(scene);
  scene.bsdfs.push_back({"nothing", NullBsdf{}});
  auto cells = std::make_shared<VolumeGrid>();
  cells->nx = 3;
  cells->ny = 2;
  cells->nz = 4;
  for (int k = 0; k < 24; ++k) cells->values.push_back(k % 5 == 0 ? 0.0f : 0.3f * float(k));
  const auto from = [&](double x) {
    return GridVolume{.grid = cells, .to_world = translation(dvec3(x, -0.5, -0.3)) * scaling(dvec3(0.5))};
  };
  for (const bool by_density : {false, true}) {
    const double x = by_density ? -0.6 : 0.1;
    ParticipatingMedium medium{.name = "flame",
                               .extinction = glm::vec3(2, 3, 4),
                               .albedo = glm::vec3(0.8f),
                               .phase = {{PHASE_HG, 0.4f, 1}}};
    medium.emission = glm::vec3(3, 2, 1);
    if (!by_density) medium.emission_grid = from(x);
    medium.density = from(x);
    medium.emission_by_density = by_density;
    scene.media.push_back(medium);
    Shape ball;
    ball.name = "ball";
    ball.geometry = Sphere{.center = dvec3(x + 0.25, -0.25, -0.05), .radius = 0.28};
    ball.front_bsdf = ball.back_bsdf = int(scene.bsdfs.size()) - 1;
    ball.interior = int(scene.media.size()) - 1;
    scene.shapes.push_back(ball);
  }
  scene.integrator.method = VolpathIntegrator{};
  return scene;
}

namespace {

SceneDescription photons_of_one_map() {
  SceneDescription scene = photons();
  PhotonMapIntegrator maps;
  maps.global_photons = 60;
  maps.caustic_photons = maps.volume_photons = 40;
  maps.photon_radius = 0.4f;
  maps.lookup_size = 5;
  maps.final_gather = true;
  scene.integrator.method = maps;
  return scene;
}

}  // namespace

SceneDescription diffuse_box() {
  SceneDescription scene = film_and_camera();
  add_box(scene);
  return scene;
}

SceneDescription many_triangles() {
  SceneDescription scene = diffuse_box();
  scene.shapes.push_back(bumpy_sheet(12, 0, false));
  return scene;
}

SceneDescription some_triangles() {
  SceneDescription scene = diffuse_box();
  scene.shapes.push_back(bumpy_sheet(6, 0, false));
  return scene;
}

SceneDescription everything() {
  SceneDescription scene = film_and_camera();
  add_everything(scene, 4);
  scene.integrator = direct_integrator(2, 1);
  param::emitter_sampling(scene.integrator) = EmitterSampling::kSolidAngle;
  return scene;
}

SceneDescription everything_in_a_hierarchy() {
  SceneDescription scene = film_and_camera();
  add_everything(scene, 8);
  for (int i = 0; i < 30; ++i)
    scene.shapes.push_back(sphere(dvec3(-0.8 + 0.06 * i, 0.6 - 0.01 * i * (i % 3), -0.5), 0.05, i % 2));
  scene.integrator = path_integrator(DirectSampling::kMis);
  param::emitter_sampling(scene.integrator) = EmitterSampling::kProjected;
  scene.sampler.kind = SamplerKind::kHalton;
  return scene;
}

SceneDescription polygon_lights() {
  SceneDescription scene = diffuse_box();
  scene.bsdfs.push_back({"glossy", PhongBsdf{glm::vec3(0.3f), glm::vec3(0.5f), 40}});
  scene.shapes[0].front_bsdf = int(scene.bsdfs.size()) - 1;
  const dvec3 ell[] = {{-0.8, -0.5, -0.6}, {-0.8, 0.5, -0.6}, {-0.6, 0.5, -0.6},
                       {-0.6, 0.1, -0.6},  {-0.2, 0.1, -0.6}, {-0.2, -0.5, -0.6}};
  std::vector<dvec3> corners;
  for (int k = 1; k < 5; ++k)  // a fan about the reflex corner
    for (const int i : {3, (3 + k) % 6, (4 + k) % 6}) corners.push_back(ell[i]);
  Shape concave = triangles(corners, kBlackBsdf, 2.0f);
  concave.two_sided_emission = true;
  concave.sampling = EmitterSampling::kArea;
  scene.shapes.push_back(concave);
  Shape triangle = triangles(std::array{dvec3(0.9, 0, 0), dvec3(0.9, 0.5, -0.25), dvec3(0.8, -0.25, -0.75)},
                             kBlackBsdf, 1.0f);
  triangle.radiance = glm::vec3(1, 3, 2);
  triangle.sampling = EmitterSampling::kSolidAngle;
  scene.shapes.push_back(triangle);
  scene.shapes.push_back(sphere(dvec3(0.3, -0.4, 0.2), 0.1, kBlackBsdf, 2.0f));
  scene.integrator = path_integrator(DirectSampling::kEmitterOnly);
  param::emitter_sampling(scene.integrator) = EmitterSampling::kProjected;
  param::next_event(scene.integrator) = NextEvent::kCv;
  param::alpha(scene.integrator) = 0.75f;  // a fitted one would depend on the range of samples
  return scene;
}

SceneDescription instances() {
  SceneDescription scene = film_and_camera();
  add_box(scene);
  const int glossy = int(scene.bsdfs.size());
  scene.bsdfs.push_back({"glossy", PhongBsdf{glm::vec3(0.3f), glm::vec3(0.5f), 40}});
  scene.bsdfs.push_back({"half there", MaskBsdf{0.5f, glossy}});
  ShapeGroup group{"group", {}, {}}, outer{"outer", {}, {}};
  group.shapes.push_back(bumpy_sheet(4, glossy, true));
  group.shapes.push_back(bumpy_sheet(2, glossy + 1, false));
  group.shapes.push_back(sphere(dvec3(0.3, 0, 0.2), 0.4, 0));
  Shape disk;
  disk.name = "disk";
  disk.geometry = Disk{dvec3(-0.5, 0.2, 0), glm::normalize(dvec3(-1, 0.5, 1)), 0.5};
  disk.front_bsdf = 0;
  disk.back_bsdf = glossy;
  group.shapes.push_back(disk);
  Shape tube;
  tube.name = "cylinder";
  tube.geometry =
      Cylinder{dvec3(0.2, -0.3, -0.4), dvec3(0, 0.6, 0.8), 0.2, 0.7, dvec3(1, 0, 0), dvec3(0, 0.8, -0.6)};
  tube.front_bsdf = tube.back_bsdf = glossy;
  group.shapes.push_back(tube);
  tube.radiance = glm::vec3(0.5f);
  scene.shapes.push_back(tube);
  outer.instances.push_back({"twice", 0, glm::dmat4(1.0)});
  outer.instances.push_back({"twice", 0, translation({0, 0.9, 0}) * scaling({-0.7, 0.7, 1.2})});
  scene.groups = {std::move(group), std::move(outer)};
  for (int i = 0; i < 6; ++i)
    scene.instances.push_back({"placed", 1,
                               translation({-0.7 + 0.28 * i, -0.6 + 0.2 * (i % 3), 0.4 - 0.2 * (i % 2)}) *
                                   rotation({0.2 * i, 1, 0.3}, 50.0 * i) * scaling(glm::dvec3(0.35))});
  scene.integrator = path_integrator(DirectSampling::kMis);
  return scene;
}

SceneDescription environment_alone() {
  SceneDescription scene = film_and_camera();
  add_diffuse(scene, 0.5f);
  scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(0.25f, 0.5f, 0.75f)});
  return scene;
}

SceneDescription lights_in_a_hierarchy() {
  SceneDescription scene = many_triangles();
  for (int k = 0; k < 30; ++k)
    scene.emitters.emplace_back(
        PointLight{dvec3(-0.8 + 0.3 * (k % 6), -0.5 + 0.25 * (k / 6), 0.1 * (k % 4)), glm::vec3(0.05f)});
  scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(0.3f)});
  scene.integrator = path_integrator(DirectSampling::kMis);
  return scene;
}

SceneDescription textured() {
  SceneDescription scene = everything();
  add_every_texture(scene);
  return scene;
}

SceneDescription emitters() {
  SceneDescription scene = diffuse_box();
  add_every_emitter(scene, dvec3(0), 1.5);
  return scene;
}

SceneDescription curves() {
  SceneDescription scene = diffuse_box();
  add_every_curve(scene, dvec3(0), 1.5);
  return scene;
}

void PrintTo(const NamedScene& scene, std::ostream* out) { *out << scene.name; }

const std::vector<NamedScene>& device_scenes() {
  static const std::vector<NamedScene> scenes{{"DiffuseBox", diffuse_box},
                                              {"ManyTriangles", many_triangles},
                                              {"Everything", everything},
                                              {"EverythingInAHierarchy", everything_in_a_hierarchy},
                                              {"PolygonLights", polygon_lights},
                                              {"Textures", textured},
                                              {"Instances", instances},
                                              {"LightsInAHierarchy", lights_in_a_hierarchy},
                                              {"Emitters", emitters},
                                              {"Curves", curves},
                                              {"EnvironmentAlone", environment_alone},
                                              {"Photons", photons},
                                              {"PhotonsOfOneMap", photons_of_one_map},
                                              {"Flames", flames}};
  return scenes;
}

}  // namespace penumbra
