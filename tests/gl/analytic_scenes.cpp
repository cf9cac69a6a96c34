#include "tests/gl/analytic_scenes.h"

#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

Mesh quadrilateral(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d) {
  Mesh mesh;
  mesh.positions = {a, b, c, d};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

}  // namespace

glm::dmat4 look_at(glm::dvec3 eye, glm::dvec3 target, glm::dvec3 up) {
  const glm::dvec3 z = glm::normalize(target - eye), x = glm::normalize(glm::cross(up, z)),
                   y = glm::cross(z, x);
  return {glm::dvec4(x, 0), glm::dvec4(y, 0), glm::dvec4(z, 0), glm::dvec4(eye, 1)};
}

SceneDescription round_things() {
  SceneDescription scene;
  scene.bsdfs = {{"grey", DiffuseBsdf{glm::vec3(0.5f, 0.6f, 0.7f)}},
                 {"dull", PhongBsdf{glm::vec3(0.3f), glm::vec3(0.4f, 0.5f, 0.2f), 0.5f}},
                 {"glossy", PhongBsdf{glm::vec3(0.2f), glm::vec3(0.6f, 0.5f, 0.4f), 80}}};
  const auto add = [&scene](auto geometry, int front, int back) -> Shape& {
    Shape shape;
    shape.geometry = std::move(geometry);
    shape.front_bsdf = front;
    shape.back_bsdf = back;
    return scene.shapes.emplace_back(std::move(shape));
  };
  add(quadrilateral({-6, 0, -6}, {-6, 0, 6}, {6, 0, 6}, {6, 0, -6}), 0, 0);
  add(Sphere{{-1.2, 0.8, 0}, 0.8}, 2, kBlackBsdf);
  add(Sphere{{1.3, 0.6, 0.4}, 0.6}, 1, kBlackBsdf);
  add(Sphere{{0, 0, 0}, 30}, 0, 1);  // around everything
  add(Disk{{0, 1.5, -1.5}, glm::normalize(glm::dvec3(0.1, 0.2, 1)), 0.7}, 2, 0);
  Mesh roof = quadrilateral({2, 0.3, -2}, {3.5, 0.3, -1}, {3.2, 2, -1.2}, {2.2, 2, -2.2});
  roof.normals = {glm::normalize(glm::vec3(-0.8f, 0.1f, 0.6f)), glm::normalize(glm::vec3(0.1f, 0.1f, 0.9f)),
                  glm::normalize(glm::vec3(0.2f, 0.7f, 0.5f)), glm::normalize(glm::vec3(-0.5f, 0.6f, 0.5f))};
  add(std::move(roof), 1, 2);
  Shape& light =
      add(quadrilateral({-0.7, 2.6, -0.6}, {0.9, 2.9, -0.5}, {0.8, 2.8, 0.6}, {-0.8, 2.5, 0.5}), 0, 0);
  light.radiance = glm::vec3(5, 4, 3);
  light.two_sided_emission = true;
  Shape& area_light = add(Disk{{-2.5, 1, 1}, glm::normalize(glm::dvec3(1, 0, 0.2)), 0.4}, 0, 0);
  area_light.radiance = glm::vec3(2, 1, 1);
  scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(0.1f, 0.2f, 0.3f)});
  scene.camera.to_world = look_at({0.4, 2.2, 6}, {0.1, 1, 0}, {0, 1, 0});
  scene.camera.fov = 55;
  scene.camera.near_clip = 0.1;
  return scene;
}

SceneDescription round_lobes() {
  SceneDescription scene = round_things();
  RoughConductorBsdf conductor;
  conductor.eta = glm::vec3(0.2f, 0.9f, 1.1f);
  conductor.k = glm::vec3(3.9f, 2.4f, 2.2f);
  conductor.alpha_u = conductor.alpha_v = 0.3f;
  conductor.distribution = DISTRIBUTION_GGX;
  RoughPlasticBsdf plastic;
  plastic.alpha = 0.2f;
  PrincipledBsdf principled;
  principled.base_color = glm::vec3(0.7f, 0.5f, 0.2f);
  principled.metallic = 0.3f;
  scene.bsdfs = {{"conductor", conductor}, {"plastic", plastic}, {"principled", principled}};
  return scene;
}

SceneDescription coarse_rims() {
  SceneDescription scene;
  scene.bsdfs = {{"outside", PhongBsdf{glm::vec3(0.4f, 0.3f, 0.2f), glm::vec3(0.4f), 8}},
                 {"inside", DiffuseBsdf{glm::vec3(0.9f, 0, 0)}}};
  Mesh octahedron;
  octahedron.positions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  octahedron.triangles = {{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2},
                          {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}};
  for (const glm::dvec3& p : octahedron.positions) octahedron.normals.emplace_back(p);
  Shape& body = scene.shapes.emplace_back();
  body.geometry = std::move(octahedron);
  body.front_bsdf = 0;
  body.back_bsdf = 1;
  Shape& light = scene.shapes.emplace_back();
  light.geometry = quadrilateral({-0.7, 2.6, -0.6}, {0.9, 2.9, 0.5}, {0.8, 2.8, 1.6}, {-0.8, 2.5, 1.5});
  light.radiance = glm::vec3(5, 4, 3);
  light.two_sided_emission = true;
  scene.camera.to_world = look_at({0.5, 0.7, 4}, {0.05, 0.1, 0}, {0, 1, 0});
  scene.camera.fov = 35;
  return scene;
}

SceneDescription scaled(SceneDescription scene, double factor) {
  for (Shape& shape : scene.shapes) {
    if (auto* mesh = std::get_if<Mesh>(&shape.geometry))
      for (glm::dvec3& p : mesh->positions) p *= factor;
    if (auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
      sphere->center *= factor;
      sphere->radius *= factor;
    }
    if (auto* disk = std::get_if<Disk>(&shape.geometry)) {
      disk->center *= factor;
      disk->radius *= factor;
    }
  }
  for (int k = 0; k < 3; ++k) scene.camera.to_world[3][k] *= factor;
  scene.camera.near_clip *= factor;
  scene.camera.far_clip *= factor;
  return scene;
}

SceneDescription glossy_box() {
  SceneDescription scene = read_or_throw(project_file("scenes/cornell/cornell.xml"));
  const float exponents[] = {0, 1, 8.5f, 30, 777.25f, 1e4f};
  for (std::size_t i = 0; i < scene.bsdfs.size(); ++i)
    scene.bsdfs[i].model = PhongBsdf{glm::vec3(0.3f), glm::vec3(0.2f, 0.4f, 0.5f), exponents[i % 6]};
  return scene;
}

SceneDescription strips() {
  SceneDescription scene;
  const float exponents[] = {0, 0.25f, 1, 2.5f, 4, 5.99f, 6, 7.9f, 8, 12.5f, 40, 300, 2500, 1e4f};
  double x = -3.5;
  for (const float exponent : exponents) {
    Shape strip;
    strip.geometry = quadrilateral({x, 0, -2}, {x, 0, 2}, {x + 0.5, 0, 2}, {x + 0.5, 0, -2});
    strip.front_bsdf = int(scene.bsdfs.size());
    strip.name = "strip";
    scene.shapes.push_back(std::move(strip));
    scene.bsdfs.push_back({"lobe", PhongBsdf{glm::vec3(0.1f), glm::vec3(0.7f, 0.5f, 0.3f), exponent}});
    x += 0.5;
  }
  Shape upright;
  upright.geometry = quadrilateral({-3, 0.8, -2.4}, {-2.8, -0.5, -2.4}, {2.5, -0.3, -2.5}, {3, 1.1, -2.5});
  upright.radiance = glm::vec3(3, 2, 1);
  Shape slanted;
  slanted.geometry = quadrilateral({-2, -0.4, 0.5}, {-2.2, 1.2, -0.7}, {1.9, 1, -0.6}, {2.4, -0.2, 0.6});
  slanted.radiance = glm::vec3(1, 2, 2);
  slanted.two_sided_emission = true;
  scene.shapes.push_back(std::move(upright));
  scene.shapes.push_back(std::move(slanted));
  scene.camera.to_world = look_at({0.3, 2.5, 5}, {0, 0, -0.1}, {0, 1, 0});
  scene.camera.fov = 70;
  return scene;
}

SceneDescription on_a_plain() {
  SceneDescription scene = round_things();
  scene.shapes[0].geometry = quadrilateral({-3e5, 0, -3e5}, {-3e5, 0, 3e5}, {3e5, 0, 3e5}, {3e5, 0, -3e5});
  scene.shapes.erase(scene.shapes.begin() + 3);  // the sphere around everything
  scene.camera.near_clip = 1e-2;
  return scene;
}

}  // namespace penumbra
