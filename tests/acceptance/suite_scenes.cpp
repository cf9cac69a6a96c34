#include "tests/acceptance/suite_scenes.h"
#include "tests/support/oracles.h"

#include <gtest/gtest.h>

#include <ostream>
#include <tuple>

#include "tests/support/every_curve.h"
#include "tests/support/every_emitter.h"
#include "tests/support/every_texture.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/measured_writer.h"

namespace penumbra {
namespace {

void by_projection(SceneDescription& scene) {
  param::emitter_sampling(scene.integrator) = EmitterSampling::kProjected;
}

void by_solid_angle(SceneDescription& scene) {
  param::emitter_sampling(scene.integrator) = EmitterSampling::kSolidAngle;
}

void look_through(SceneDescription& scene) {
  scene.integrator.hide_emitters = true;
  scene.integrator.hidden_emitters = HiddenEmitters::kLookedThrough;
}

void look_through_directly(SceneDescription& scene) {
  look_through(scene);
  use(scene.integrator, IntegratorKind::kDirect);
}

void direct(SceneDescription& scene) { use(scene.integrator, IntegratorKind::kDirect); }

void closed_form(SceneDescription& scene) { use(scene.integrator, IntegratorKind::kPolygonAnalytic); }

void control_variate(SceneDescription& scene) {
  use(scene.integrator, IntegratorKind::kPolygonCv);
  param::emitter_sampling(scene.integrator) = EmitterSampling::kArea;
  param::vis_samples(scene.integrator) = 3;
}

void path_with_control_variate(SceneDescription& scene) {
  use(scene.integrator, IntegratorKind::kPath);
  param::next_event(scene.integrator) = NextEvent::kCv;
  param::max_depth(scene.integrator) = 5;
}

/// One of them, in a scene that mixes techniques.
void part_of_paths(SceneDescription& scene) {
  PathIntegrator part;
  part.only_bounces = 2;
  part.only_technique = PathTechnique::kEmitter;
  scene.integrator.method = part;
}

void progressive_photons(SceneDescription& scene) {
  ProgressivePhotonIntegrator ppm;
  ppm.photon_count = 3000;
  scene.integrator.method = ppm;
}

void photons_with_final_gathering(SceneDescription& scene) {
  PhotonMapIntegrator maps;
  maps.global_photons = 5000;
  maps.caustic_photons = maps.volume_photons = 3000;
  maps.lookup_size = 40;
  maps.final_gather = true;
  scene.integrator.method = maps;
}

void whitted(SceneDescription& scene) {
  use(scene.integrator, IntegratorKind::kWhitted);
  param::max_depth(scene.integrator) = 5;
  param::branch_depth(scene.integrator) = 3;
  param::indirect_samples(scene.integrator) = 2;
}

void whitted_with_control_variate(SceneDescription& scene) {
  whitted(scene);
  param::next_event(scene.integrator) = NextEvent::kCv;
  param::indirect_sampling(scene.integrator) = IndirectSampling::kUniform;
}

/// Returns the index.
int add_bsdf(SceneDescription& scene, const BsdfModel& model) {
  scene.bsdfs.push_back({"added", model});
  return int(scene.bsdfs.size()) - 1;
}

void add_sphere(SceneDescription& scene, glm::dvec3 center, double radius, int front, int back) {
  Shape sphere;
  sphere.name = "added";
  sphere.geometry = Sphere{.center = center, .radius = radius};
  sphere.front_bsdf = front;
  sphere.back_bsdf = back;
  scene.shapes.push_back(sphere);
}

/// For the Cornell box of 556 units.
void whitted_through_glass(SceneDescription& scene) {
  const DielectricBsdf glass;
  const int mirror = add_bsdf(scene, ConductorBsdf{}), pane = add_bsdf(scene, ThinDielectricBsdf{});
  const int outside = add_bsdf(scene, glass), inside = add_bsdf(scene, glass.other_side());
  add_sphere(scene, {200, 120, 150}, 90, outside, inside);
  add_sphere(scene, {400, 350, 200}, 80, pane, pane);
  add_sphere(scene, {150, 400, 250}, 70, mirror, mirror);
  whitted(scene);
  param::max_depth(scene.integrator) = 9;
  param::branch_depth(scene.integrator) = 6;
  param::indirect_samples(scene.integrator) = 1;
}

void photons_through_glass(SceneDescription& scene) {
  whitted_through_glass(scene);
  progressive_photons(scene);
}

/// Walls of several measured materials among others.
void measured(SceneDescription& scene) {
  const MeasuredFormula formulas[] = {isotropic_formula(), anisotropic_formula(), strange_formula()};
  for (std::size_t i = 0; i < scene.bsdfs.size(); ++i) {
    if (i % 4 == 3) continue;
    const auto brdf = read_measured_file("formula", measured_fields(formulas[i % 4]).file());
    scene.bsdfs[i].model = MeasuredBsdf{"formula", std::make_shared<const MeasuredBrdf>(brdf.value())};
  }
}

void ambient_occlusion(SceneDescription& scene) {
  use(scene.integrator, IntegratorKind::kAmbientOcclusion);
  param::vis_samples(scene.integrator) = 3;
}

void reflection_occlusion(SceneDescription& scene) {
  use(scene.integrator, IntegratorKind::kReflectionOcclusion);
  param::exponent(scene.integrator) = 777.25f;
}

/// Lobes of low and high, whole and broken exponents.
void make_glossy(SceneDescription& scene) {
  const float exponents[] = {0, 1, 8.5f, 30, 777.25f, 1e4f};
  for (std::size_t i = 0; i < scene.bsdfs.size(); ++i)
    scene.bsdfs[i].model = PhongBsdf{glm::vec3(0.3f), glm::vec3(0.2f, 0.4f, 0.5f), exponents[i % 6]};
}

void glossy_closed_form(SceneDescription& scene) {
  make_glossy(scene);
  closed_form(scene);
}

void glossy_path_with_control_variate(SceneDescription& scene) {
  make_glossy(scene);
  path_with_control_variate(scene);
  param::alpha(scene.integrator) = 0.75f;
  param::emitter_sampling(scene.integrator) = EmitterSampling::kSolidAngle;
}

void glossy_choice(SceneDescription& scene) {
  make_glossy(scene);
  use(scene.integrator, IntegratorKind::kDirect);
  param::bsdf_samples(scene.integrator) = 0;
  param::light_choice(scene.integrator) = LightChoice::kAnalytic;
}

constexpr int kEdgePixels = 30;

/// A rough height field seen from in front, its vertices in the middle of pixels, where nearly all of every
/// pixel's rays go: they meet vertices and edges within rounding.
void rays_on_edges(SceneDescription& scene) {
  Mesh field;
  for (int j = 0; j <= kEdgePixels; ++j)
    for (int i = 0; i <= kEdgePixels; ++i) {
      const double z = 1 + 0.02 * ((i * 7 + j * 11) % 5);
      const double x = (i + 0.5) / (kEdgePixels / 2) - 1, y = (j + 0.5) / (kEdgePixels / 2) - 1;
      field.positions.push_back({x * z, y * z, z});
    }
  const auto vertex = [](int i, int j) { return glm::uint(j * (kEdgePixels + 1) + i); };
  for (int j = 0; j < kEdgePixels; ++j)
    for (int i = 0; i < kEdgePixels; ++i) {
      field.triangles.push_back({vertex(i, j), vertex(i, j + 1), vertex(i + 1, j)});
      field.triangles.push_back({vertex(i + 1, j), vertex(i, j + 1), vertex(i + 1, j + 1)});
    }
  Shape shape;
  shape.name = "field";
  shape.geometry = std::move(field);
  shape.front_bsdf = shape.back_bsdf = 0;
  scene.shapes = {std::move(shape)};
  scene.bsdfs = {Bsdf{"grey", DiffuseBsdf{}}};
  scene.emitters = {PointLight{.position = {0.3, 0.4, 0.2}, .intensity = glm::vec3(1)},
                    ConstantEnvironment{}};
  scene.camera = {};
  scene.camera.fov = 90;
  resize_film(scene, kEdgePixels, kEdgePixels);
  scene.film.filter = FilterKind::kBox;
  scene.film.filter_radius = 1e-6f;
  direct(scene);
}

/// Red patches in the planes of the walls.
void coincident_walls(SceneDescription& scene) {
  const int other = int(scene.bsdfs.size());
  scene.bsdfs.push_back({"red", DiffuseBsdf{glm::vec3(0.8f, 0.1f, 0.1f)}});
  const std::size_t count = scene.shapes.size();
  for (std::size_t i = 0; i < count && i < 5; ++i) {
    Shape copy = scene.shapes[i];
    if (copy.radiance) continue;
    copy.front_bsdf = copy.back_bsdf = other;
    auto* mesh = std::get_if<Mesh>(&copy.geometry);
    if (mesh == nullptr) continue;
    // Other vertices in the same plane: ties but for rounding.
    glm::dvec3 center(0);
    for (const glm::dvec3& p : mesh->positions) center += p / double(mesh->positions.size());
    for (glm::dvec3& p : mesh->positions) p = center + 0.7 * (p - center);
    scene.shapes.push_back(std::move(copy));
  }
}

/// Masks with a texture, one in a blend, null surfaces of which one shines, and bent normals.
void nest(SceneDescription& scene) {
  CheckerboardTexture board, leaning;
  board.color0 = glm::vec3(0.2f, 0.9f, 0.4f);
  board.color1 = glm::vec3(1.4f);
  leaning.color0 = glm::vec3(0.7f, 0.45f, 0.9f);
  leaning.color1 = glm::vec3(0.2f, 0.6f, 0.8f);
  const int first = int(scene.textures.size());
  scene.textures.push_back({"board", board, glm::dmat3(3)});
  scene.textures.push_back({"leaning", leaning, glm::dmat3(5)});
  const auto add = [&](BsdfModel model, SurfaceBend bend = {}) {
    scene.bsdfs.push_back({"nested", std::move(model), bend});
    return int(scene.bsdfs.size()) - 1;
  };
  const int bumpy = add(DiffuseBsdf{glm::vec3(0.6f)}, {BendKind::kNormalMap, first + 1});
  const int glossy =
      add(PhongBsdf{glm::vec3(0.3f), glm::vec3(0.4f), 20.0f}, {BendKind::kBumpMap, first, 0.01f});
  MaskBsdf holes{1.0f, glossy};
  holes.opacity.texture = first;
  BlendBsdf both{1.0f, add(MaskBsdf{0.3f, bumpy}), add(holes)};
  both.weight.texture = first + 1;
  const int blend = add(both), nothing = add(NullBsdf{}), mask = add(MaskBsdf{0.5f, bumpy});
  for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
    Shape& shape = scene.shapes[i];
    if (shape.radiance) continue;
    const int bsdfs[] = {blend, bumpy, mask, shape.front_bsdf};
    shape.front_bsdf = bsdfs[i % 4];
    shape.back_bsdf = bsdfs[(i + 1) % 4];
  }
  glm::dvec3 low(1e30), high(-1e30);
  for (const Shape& shape : scene.shapes)
    if (const auto* mesh = std::get_if<Mesh>(&shape.geometry))
      for (const glm::dvec3& p : mesh->positions) low = glm::min(low, p), high = glm::max(high, p);
  // Off the floor: of masks in one place either may be passed as both.
  for (Shape& shape : scene.shapes)
    if (auto* mesh = std::get_if<Mesh>(&shape.geometry); mesh != nullptr && mesh->triangles.size() == 12)
      for (glm::dvec3& p : mesh->positions) p.y += 0.01 * (high.y - low.y);
  for (const double share : {0.3, 0.6}) {
    Shape ball;
    ball.name = "ball";
    ball.geometry = Sphere{low + share * (high - low), 0.12 * glm::length(high - low)};
    ball.front_bsdf = ball.back_bsdf = share < 0.5 ? nothing : blend;
    if (share < 0.5) ball.radiance = glm::vec3(0.5f, 0.2f, 0.1f);
    scene.shapes.push_back(ball);
  }
}

/// Coats with normals of their own: smooth, with a normal map and with bumps, over bases with others.
void coat(SceneDescription& scene) {
  CheckerboardTexture leaning, heights;
  leaning.color0 = glm::vec3(0.7f, 0.45f, 0.9f), leaning.color1 = glm::vec3(0.2f, 0.6f, 0.8f);
  heights.color0 = glm::vec3(0.0f), heights.color1 = glm::vec3(1.0f);
  const int first = int(scene.textures.size());
  scene.textures.push_back({"leaning", leaning, glm::dmat3(5)});
  scene.textures.push_back({"heights", heights, glm::dmat3(3)});
  const SurfaceBend map{BendKind::kNormalMap, first}, bumps{BendKind::kBumpMap, first + 1, 0.01f};
  OpenPbrBsdf surface;
  surface.base_color = TexturedColour(glm::vec3(0.6f, 0.3f, 0.2f)), surface.base_metalness = 0.5f;
  surface.coat_weight = 0.8f, surface.coat_roughness = 0.3f;
  OpenPbrBsdf filmed = surface;
  filmed.film_weight = 1.0f, filmed.specular_anisotropy = 0.5f;
  const int start = int(scene.bsdfs.size());
  scene.bsdfs.push_back({"smooth", surface, map, {}, SurfaceBend{}});
  scene.bsdfs.push_back({"bumpy", filmed, map, {.angle = 0.5f}, bumps});
  scene.bsdfs.push_back({"mapped", surface, {}, {}, map});
  for (std::size_t i = 0; i < scene.shapes.size(); ++i)
    if (Shape& shape = scene.shapes[i]; !shape.radiance)
      shape.front_bsdf = shape.back_bsdf = start + int(i % 3);
}

void coat_directly(SceneDescription& scene) {
  coat(scene);
  use(scene.integrator, IntegratorKind::kDirect);
  param::emitter_samples(scene.integrator) = 2;
  param::bsdf_samples(scene.integrator) = 3;
}

void whitted_nested(SceneDescription& scene) {
  nest(scene);
  whitted(scene);
}

void nest_directly(SceneDescription& scene) {
  nest(scene);
  use(scene.integrator, IntegratorKind::kDirect);
  param::emitter_samples(scene.integrator) = 2;
  param::bsdf_samples(scene.integrator) = 3;
}

void nest_with_control_variate(SceneDescription& scene) {
  nest(scene);
  path_with_control_variate(scene);
}

void nest_hidden(SceneDescription& scene) {
  nest(scene);
  look_through(scene);
  param::emitter_sampling(scene.integrator) = EmitterSampling::kProjected;
}

void nest_with_photons(SceneDescription& scene) {
  nest(scene);
  photons_with_final_gathering(scene);
}

void textured(SceneDescription& scene) { add_every_texture(scene); }

void every_emitter(SceneDescription& scene) { add_every_emitter(scene, {278, 274, 280}, 500); }

/// Not their instances, of which what explains Embree's differences knows nothing.
void every_curve(SceneDescription& scene) {
  add_every_curve(scene, {278, 274, 280}, 400);
  scene.instances.clear();
  scene.groups.clear();
}

void every_curve_directly(SceneDescription& scene) {
  every_curve(scene);
  direct(scene);
}

/// Beside polygons in closed form.
void every_emitter_controlled(SceneDescription& scene) {
  every_emitter(scene);
  scene.shapes.front().radiance_texture = kNoTexture;
  path_with_control_variate(scene);
}

void every_emitter_by_photons(SceneDescription& scene) {
  every_emitter(scene);
  photons_with_final_gathering(scene);
}

void textured_directly(SceneDescription& scene) {
  add_every_texture(scene);
  direct(scene);
}

void through_a_lens(SceneDescription& scene) {
  scene.camera.aperture_radius = 20;
  scene.camera.focus_distance = 1000;
  scene.camera.blades = 7;
  scene.camera.blade_rotation = 20;
  scene.camera.distortion_k1 = -0.2;
  scene.camera.distortion_k2 = 0.3;
  scene.camera.principal_point_offset_x = 0.1;
  scene.camera.magnify_red = 0.02;
  scene.camera.magnify_blue = -0.03;
  scene.camera.refocus_red = 0.1;
}

void through_a_lens_with_control_variate(SceneDescription& scene) {
  path_with_control_variate(scene);
  through_a_lens(scene);
}

void in_parallel(SceneDescription& scene) {
  direct(scene);
  scene.camera.projection = Projection::kOrthographic;
  scene.camera.scale_x = 5;
  scene.camera.scale_y = 7;
  scene.camera.aperture_radius = 0.5;
  scene.camera.focus_distance = 10;
}

}  // namespace

void PrintTo(const SuiteScene& scene, std::ostream* out) { *out << scene.name; }

const std::vector<SuiteScene>& suite_scenes() {
  static const std::vector<SuiteScene> scenes{
      {"Cornell", "cornell/cornell.xml"},
      {"CornellSmall", "cornell-small/cornell-small.xml"},
      {"VeachMis", "veach-mis/veach-mis.xml"},
      {"Furnace", "furnace/furnace.xml"},
      {"Smoke", "smoke/smoke.xml"},
      {"Textures", "veach-mis/veach-mis.xml", false, textured},
      {"TexturesDirect", "cornell-small/cornell-small.xml", false, textured_directly},
      {"Emitters", "cornell/cornell.xml", false, every_emitter},
      {"EmittersControlVariate", "cornell/cornell.xml", false, every_emitter_controlled},
      {"UnitSphere", "furnace/unit-sphere.xml"},
      {"PolygonLights", "polygon-lights/polygon-lights.xml"},
      {"CornellDirect", "cornell/cornell.xml", false, direct},
      {"CornellProjected", "cornell/cornell.xml", false, by_projection},
      {"PolygonLightsProjected", "polygon-lights/polygon-lights.xml", false, by_projection},
      {"CornellSolidAngle", "cornell/cornell.xml", false, by_solid_angle},
      {"CornellAnalytic", "cornell/cornell.xml", false, closed_form},
      {"CornellControlVariate", "cornell/cornell.xml", false, control_variate},
      {"CornellPathControlVariate", "cornell/cornell.xml", false, path_with_control_variate},
      {"Materials", "materials/materials.xml"},
      {"MaterialsControlVariate", "materials/materials.xml", false, path_with_control_variate},
      {"VeachMisPart", "veach-mis/veach-mis.xml", false, part_of_paths},
      {"CornellGlossyAnalytic", "cornell/cornell.xml", false, glossy_closed_form},
      {"CornellGlossyPathControlVariate", "cornell/cornell.xml", false, glossy_path_with_control_variate},
      {"CornellGlossyChoice", "cornell/cornell.xml", false, glossy_choice},
      {"VeachMisLookedThrough", "veach-mis/veach-mis.xml", false, look_through},
      {"CornellLookedThrough", "cornell/cornell.xml", false, look_through_directly},
      {"Nested", "cornell-small/cornell-small.xml", false, nest},
      {"NestedCornell", "cornell/cornell.xml", false, nest},
      {"NestedDirect", "cornell-small/cornell-small.xml", false, nest_directly},
      {"NestedControlVariate", "cornell-small/cornell-small.xml", false, nest_with_control_variate},
      {"NestedLookedThrough", "cornell/cornell.xml", false, nest_hidden},
      {"Coats", "cornell/cornell.xml", false, coat},
      {"CoatsDirect", "cornell-small/cornell-small.xml", false, coat_directly},
      {"CornellWhitted", "cornell/cornell.xml", false, whitted},
      {"CornellWhittedNested", "cornell/cornell.xml", false, whitted_nested},
      {"CornellWhittedGlass", "cornell/cornell.xml", false, whitted_through_glass},
      {"VeachMisWhitted", "veach-mis/veach-mis.xml", false, whitted_with_control_variate},
      {"CornellPhotonsGlass", "cornell/cornell.xml", false, photons_through_glass},
      {"NestedPhotons", "cornell/cornell.xml", false, nest_with_photons},
      {"EmittersPhotons", "cornell/cornell.xml", false, every_emitter_by_photons},
      {"SmokePhotons", "smoke/smoke.xml", false, progressive_photons},
      {"CornellAmbientOcclusion", "cornell/cornell.xml", false, ambient_occlusion},
      {"VeachMisReflectionOcclusion", "veach-mis/veach-mis.xml", false, reflection_occlusion},
      {"CornellMeasured", "cornell/cornell.xml", false, measured},
      {"CornellLens", "cornell/cornell.xml", false, through_a_lens},
      {"CornellLensControlVariate", "cornell/cornell.xml", false, through_a_lens_with_control_variate},
      {"VeachMisParallel", "veach-mis/veach-mis.xml", false, in_parallel},
      {"CurvesDirect", "cornell/cornell.xml", false, every_curve_directly},
      {"RaysOnEdges", "cornell-small/cornell-small.xml", false, rays_on_edges, true},
      {"CoincidentWalls", "cornell-small/cornell-small.xml", false, coincident_walls, true},
      {"BitterliCornellBox", "bitterli/cornell-box/scene.xml", true},
      {"MitsubaCbox", "mitsuba/scenes/cbox/cbox-rgb.xml", true},
      {"Grid", "tinyrender-a4/grid/tinyrender/grid_cv.toml", true},
  };
  return scenes;
}

SceneDescription small_scene(const SuiteScene& scene) {
  const auto file = scene.is_oracle ? *find_oracle("") / scene.file : project_file("scenes/" + scene.file);
  SceneDescription description = read_or_throw(file);
  resize_film(description, 40, 30);  // no multiple of a block, a vector or a tile
  description.sampler.spp = 6;
  if (scene.change != nullptr) scene.change(description);
  return description;
}

std::string first_difference(const FilmAccumulator& a, const FilmAccumulator& b) {
  if (a.width() != b.width() || a.height() != b.height() || a.layers().planes() != b.layers().planes())
    return "in size";
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      const PixelStatistics &p = a.at(x, y), &q = b.at(x, y);
      for (int c = 0; c < 3; ++c) {
        if (p.mean[c] != q.mean[c] || p.m2[c] != q.m2[c])
          return "at (x, y, channel, mean, mean): " +
                 testing::PrintToString(std::tuple(x, y, c, p.mean[c], q.mean[c]));
      }
    }
  }
  return "only in layers or counts";
}

}  // namespace penumbra
