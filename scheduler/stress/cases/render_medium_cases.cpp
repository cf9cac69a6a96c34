// Whole renders of participating media: from nearly nothing to what no light gets through.
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "scenes/mesh_tools.h"
#include "scenes/transform.h"
#include "scheduler/stress/cases/cases.h"
#include "scheduler/stress/cases/inputs.h"
#include "scheduler/stress/cases/scene_pieces.h"
#include "scheduler/stress/truth/quadrature.h"

namespace penumbra::stress {
namespace render_medium_cases {
namespace {

IntegratorSettings volpath(DirectSampling sampling) {
  return {.method = VolpathIntegrator{.rr_depth = 1'000'000, .direct_sampling = sampling}};
}

int add_medium(SceneDescription& scene, const glm::vec3& extinction, float albedo, float g = 0) {
  scene.media.push_back(
      {.name = "medium", .extinction = extinction, .albedo = glm::vec3(albedo), .phase = {{PHASE_HG, g, 1}}});
  return int(scene.media.size()) - 1;
}

/// The shape with a boundary in the place of a surface.
void bound(SceneDescription& scene, Geometry geometry, int interior) {
  if (scene.bsdfs.empty() || !std::holds_alternative<NullBsdf>(scene.bsdfs.back().model))
    scene.bsdfs.push_back({"nothing", NullBsdf{}});
  Shape shape;
  shape.name = "boundary";
  shape.geometry = std::move(geometry);
  shape.front_bsdf = shape.back_bsdf = int(scene.bsdfs.size()) - 1;
  shape.interior = interior;
  scene.shapes.push_back(std::move(shape));
}

Mesh box(const glm::dvec3& low, const glm::dvec3& high) {
  return make_cube(translation(0.5 * (low + high)) * scaling(0.5 * (high - low)));
}

/// A pixel that looks along z from the origin, at what a sky of 1 shines on.
SceneDescription under_sky(std::uint32_t spp, const IntegratorSettings& integrator) {
  SceneDescription scene = empty_scene(1, 1, spp, {}, {0, 0, 1}, 1e-3);
  scene.emitters.emplace_back(ConstantEnvironment{});
  scene.integrator = integrator;
  return scene;
}

// --- What shadow rays are dimmed by: one sample, no chance.

constexpr Point kAreaLight{1.5, 0, .5}, kLit{0, 0, 4};
const double kSlope = std::hypot(kLit.x - kAreaLight.x, kLit.z - kAreaLight.z) / (kLit.z - kAreaLight.z);

/// A grey wall that a point light shines on, and beside the camera's way, across that of the light, `slabs`
/// of a medium from z = 1 on, each as thick as the space behind it.
SceneDescription lit_wall(double extinction, int slabs, double thickness) {
  SceneDescription scene = empty_scene(1, 1, 1, {}, {0, 0, 1}, 1e-9);
  scene.shapes.push_back(quad_shape({2, -2, 4}, {-4, 0, 0}, {0, 4, 0}, add_diffuse(scene, .5f), {}));
  PointLight light;
  light.position = {kAreaLight.x, kAreaLight.y, kAreaLight.z};
  scene.emitters.emplace_back(light);
  const int medium = add_medium(scene, glm::vec3(float(extinction)), .5f);
  for (int i = 0; i < slabs; ++i) {
    const double z = 1 + 2 * i * thickness;
    bound(scene, box({.05, -1, z}, {1.4, 1, z + thickness}), medium);
  }
  scene.integrator = volpath(DirectSampling::kMis);
  std::get<VolpathIntegrator>(scene.integrator.method).max_depth = 2;
  return scene;
}

void add_dimmed(std::vector<Case>& cases) {
  struct Entry {
    const char *name, *stiff;
    double extinction;
    int slabs;
    double thickness;
  };
  const Entry entries[] = {
      {"optical-depth-1e-8", "a medium of optical depth 1e-8", 1e-8, 1, 1},
      {"optical-depth-1", "a medium of optical depth 1", 1, 1, 1},
      {"optical-depth-60", "a transmittance of 1e-28", 60, 1, 1},
      {"transmittance-underflow", "a transmittance below the smallest number", 120, 1, 1},
      {"optical-depth-1e8", "a medium of optical depth 1e8", 1e8, 1, 1},
      {"thin-slab", "a medium 16 times as thick as where it is may be off", 1024, 1, 1. / 32768},
      {"crossings-1e4", "10000 boundaries on the way", 1, 5000, 1. / 8192}};
  for (const Entry& e : entries) {
    const double depth = rounded(e.extinction) * e.slabs * e.thickness * kSlope;
    // Of a way of some 4 either end of a slab is off by 16 roundings of 2, and lengths round likewise.
    const double lengths = rounded(e.extinction) * e.slabs * kSlope * 2 * 16 * 2 * kUlp;
    cases.push_back(
        {fmt::format("media/{}", e.name),
         e.stiff,
         "radiance of a wall that is lit through it",
         RenderMeasurement{[e] { return lit_wall(e.extinction, e.slabs, e.thickness); }, first_pixel},
         {[depth] {
            const Quad x = Quad(kLit.x) - kAreaLight.x, z = Quad(kLit.z) - kAreaLight.z,
                       square = x * x + z * z;
            return Quads{exp_q(-Quad(depth)) * z / sqrt_q(square) / square / (2 * kQuadPi)};
          },
          "closed form"},
         {1.2e-38,
          std::expm1(std::min(lengths, 1.) + 32 * kUlp),
          "places of boundaries, 16 roundings each; 32 more; below the smallest float 0",
          {}}});
  }
}

// --- Light from everywhere.

/// What half a space of isotropic scattering gives back of it straight up (Chandrasekhar 1960, sections 25,
/// 39): 1 - H(1) sqrt(1 - a), H(1) = exp(-1/pi int_0^(pi/2) log(1 - a t / tan t) dt).
Quad half_space(Quad albedo) {
  const auto f = [albedo](Quad t) {
    return t > 0 ? log_q(1 - albedo * t * cos_q(t) / sin_q(t)) : log_q(1 - albedo);
  };
  return 1 - exp_q(-tanh_sinh(f, 0, kQuadPi / 2) / kQuadPi) * sqrt_q(1 - albedo);
}

void add_dense(std::vector<Case>& cases) {
  constexpr std::uint32_t kSamples = 1 << 15;
  for (const auto& [name, extinction] :
       {std::pair("1e2", 1e2f), std::pair("1e5", 1e5f), std::pair("1e8", 1e8f)}) {
    const float sigma = extinction;
    cases.push_back(
        {fmt::format("media/dense-{}", name),
         fmt::format("scattering every 1/{} below a boundary 1 away and 100 wide", name),
         "share of the light from everywhere that is given back",
         RenderMeasurement{
             [sigma] {
               SceneDescription scene = under_sky(kSamples, volpath(DirectSampling::kBsdfOnly));
               bound(scene, box({-50, -50, 1}, {50, 50, 2}), add_medium(scene, glm::vec3(sigma), .9f));
               return scene;
             },
             first_pixel},
         {[] { return Quads{half_space(.9f)}; }, "Chandrasekhar's H function by tanh-sinh quadrature"},
         absolute(5 * .5 / std::sqrt(double(kSamples)), "5 deviations of samples in [0, 1]")});
  }
}

void add_ball(SceneDescription& scene, const glm::vec3& extinction, float g = 0) {
  bound(scene, Sphere{.center = {0, 0, 3}, .radius = 1}, add_medium(scene, extinction, 1, g));
}

void add_furnaces(std::vector<Case>& cases) {
  struct Entry {
    const char *name, *stiff;
    std::function<void(SceneDescription&)> fill;
  };
  const Entry entries[] = {
      {"albedo-1", "some hundred collisions of albedo 1",
       [](SceneDescription& s) { add_ball(s, glm::vec3(15)); }},
      {"hg-forward-.9999", "collisions by g = .9999",
       [](SceneDescription& s) { add_ball(s, glm::vec3(300), .9999f); }},
      {"hg-backward-.9999", "collisions by g = -.9999",
       [](SceneDescription& s) { add_ball(s, glm::vec3(15), -.9999f); }},
      {"thinner-than-offset", "a medium as thick as two floats are apart", [](SceneDescription& s) {
         bound(s, box({-1, -1, 1}, {1, 1, 1 + 4 * kUlp}), add_medium(s, glm::vec3(1e7f), 1));
       }}};
  for (const Entry& e : entries) {
    const auto fill = e.fill;
    cases.push_back({fmt::format("media/furnace-{}", e.name), e.stiff, "radiance of it in a sky of 1",
                     RenderMeasurement{[fill] {
                                         SceneDescription scene =
                                             under_sky(64, volpath(DirectSampling::kBsdfOnly));
                                         fill(scene);
                                         return scene;
                                       },
                                       first_pixel},
                     known(1, "furnace"), relative(4 * kUlp, "weights of exactly 1")});
  }
  constexpr std::uint32_t kSamples = 1 << 14;
  cases.push_back({"media/furnace-channels",
                   "channels whose mean free paths are 6 orders apart",
                   "radiance of the two thinner channels in a sky of 1",
                   RenderMeasurement{[] {
                                       SceneDescription scene =
                                           under_sky(kSamples, volpath(DirectSampling::kBsdfOnly));
                                       add_ball(scene, {1e-3f, 1, 1e3f});
                                       std::get<VolpathIntegrator>(scene.integrator.method).max_depth = 200;
                                       return scene;
                                     },
                                     [](const FilmAccumulator& film) {
                                       const PixelStatistics& pixel = film.at(0, 0);
                                       return Numbers{pixel.mean[0], pixel.mean[1]};
                                     }},
                   {[] {
                      return Quads{1, 1};
                    },
                    "furnace"},
                   absolute(5 * 2 * std::sqrt(2.) / std::sqrt(double(kSamples)),
                            "5 deviations of samples in [0, 3] of mean 1, of two channels")});
}

// Flights go by where lights are, so weights are not 1.
void add_area_lights(std::vector<Case>& cases) {
  constexpr std::uint32_t kSamples = 1 << 12;
  const auto add = [&](const std::string& name, const char* stiff, double truth,
                       std::function<SceneDescription()> scene) {
    cases.push_back({"media/furnace-" + name, stiff, "standard errors that its radiance is off by",
                     RenderMeasurement{std::move(scene), errors_from(truth)}, known(0, "furnace"),
                     absolute(5, "5 standard errors")});
  };
  for (const DirectSampling sampling : {DirectSampling::kBsdfOnly, DirectSampling::kMis})
    add(sampling == DirectSampling::kMis ? "area-light-inside-light-samples" : "area-light-inside",
        "an area light in the middle of a dense medium", 1, [sampling] {
          SceneDescription scene = under_sky(kSamples, volpath(sampling));
          add_ball(scene, glm::vec3(15));
          Shape area_light;
          area_light.name = "area_light";
          area_light.geometry = Sphere{.center = {0, 0, 3}, .radius = .1};
          area_light.radiance = glm::vec3(1);
          scene.shapes.push_back(area_light);
          return scene;
        });
  add("walls", "a boundary in the place of walls that shine, of albedo .5", 2, [] {
    SceneDescription scene = empty_scene(1, 1, kSamples, {}, {.3, .2, 1}, 1e-3);
    scene.integrator = volpath(DirectSampling::kBsdfOnly);
    Shape walls;
    walls.name = "walls";
    walls.geometry = box(glm::dvec3(-1), glm::dvec3(1));
    walls.front_bsdf = add_diffuse(scene, .5f);
    walls.flip_normals = true;
    walls.radiance = glm::vec3(1);
    scene.shapes.push_back(walls);
    scene.camera_medium = add_medium(scene, glm::vec3(1), 1);
    bound(scene, box(glm::dvec3(-1), glm::dvec3(1)), scene.camera_medium);
    // Of so many collisions some 24 are with walls at least.
    std::get<VolpathIntegrator>(scene.integrator.method).max_depth = 256;
    return scene;
  });
}

// --- Grids.

void add_grids(std::vector<Case>& cases) {
  constexpr std::uint32_t kSamples = 1 << 16;
  constexpr int kCells = 64;
  cases.push_back(
      {"media/grid-spike-1e6",
       "one of 64 layers 1e6 times as dense as the others",
       "share of the light that gets through",
       RenderMeasurement{[] {
                           SceneDescription scene = under_sky(kSamples, volpath(DirectSampling::kBsdfOnly));
                           const int medium = add_medium(scene, glm::vec3(kCells), 0);
                           auto layers = std::make_shared<VolumeGrid>();
                           layers->nx = layers->ny = 1;
                           layers->nz = kCells;
                           layers->values.assign(kCells, 1e-6f);
                           layers->values[20] = 1;
                           scene.media[std::size_t(medium)].density = GridVolume{
                               .grid = layers,
                               .to_world = translation(glm::dvec3(-1, -1, 1)) * scaling(glm::dvec3(2, 2, 1)),
                               .nearest = true};
                           bound(scene, box({-1, -1, 1}, {1, 1, 2}), medium);
                           return scene;
                         },
                         first_pixel},
       {[] { return Quads{exp_q(-(1 + Quad(1e-6f) * (kCells - 1)))}; }, "closed form"},
       absolute(5 * .4823 / std::sqrt(double(kSamples)), "5 deviations of samples of 0 and 1")});
}

}  // namespace

void add(std::vector<Case>& cases) {
  add_dimmed(cases);
  add_dense(cases);
  add_furnaces(cases);
  add_area_lights(cases);
  add_grids(cases);
}

}  // namespace render_medium_cases

void add_render_medium_cases(std::vector<Case>& cases) { render_medium_cases::add(cases); }

}  // namespace penumbra::stress
