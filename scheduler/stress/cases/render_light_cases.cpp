// Whole renders of a floor under a light: scales, shifts, radiances, samples.
#include <fmt/format.h>

#include "scheduler/stress/cases/cases.h"
#include "scheduler/stress/cases/inputs.h"
#include "scheduler/stress/cases/scene_pieces.h"
#include "scheduler/stress/truth/polygon.h"
#include "scheduler/stress/truth/quadrature.h"

namespace penumbra::stress {
namespace render_light_cases {
namespace {

constexpr float kAlbedo = .5f;
constexpr std::uint32_t kSamples = 1 << 16;
// A few dozen roundings of coordinates that are a few times the distance of the light.
const Allowed kRounding = relative(64 * kUlp, "64 roundings of coordinates and colours");
// Of samples in [low, high] the deviation is at most half the range (Popoviciu 1935).
Allowed sampled(double low, double high, double count) {
  return {5 * (high - low) / 2 / std::sqrt(count),
          64 * kUlp,
          fmt::format("5 deviations of {:.0f} samples in a range, and rounding", count),
          {}};
}

/// A unit square at height 1 that faces down, as the truth has it.
Loop square_loop() { return {{-.5, -.5, 1}, {-.5, .5, 1}, {.5, .5, 1}, {.5, -.5, 1}}; }
Quad square_irradiance() { return irradiance({square_loop()}, {}, {0, 0, 1}); }
/// What a sample by area of it contributes, over albedo and radiance: cos^2 / d^2 / pi.
Quad area_sample(Quad x, Quad y) {
  const Quad d2 = 1 + x * x + y * y;
  return 1 / (kQuadPi * d2 * d2);
}
const double kLowest = double(area_sample(.5, .5)), kHighest = double(area_sample(0, 0));

/// The floor's point (0, 0, 0) under the square.
SceneDescription lit_floor(const IntegratorSettings& integrator, float radiance, const Placement& place,
                           std::uint32_t spp) {
  SceneDescription scene = empty_scene(1, 1, spp, {.9, .2, .8}, {0, 0, 0}, 1e-6, place);
  const int grey = add_diffuse(scene, kAlbedo);
  scene.shapes.push_back(quad_shape({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, grey, {}, place));
  scene.shapes.push_back(quad_shape({-.5, -.5, 1}, {0, 1, 0}, {1, 0, 0}, kBlackBsdf, radiance, place));
  scene.integrator = integrator;
  return scene;
}

struct Method {
  const char *name, *text;
  IntegratorSettings integrator;
  std::uint32_t spp;
};
const Method kMethods[] = {
    {"analytic", "closed form", analytic(), 4},
    {"projected", "samples by projected solid angle", emitter_samples(EmitterSampling::kProjected), 256},
    {"area", "samples by area", emitter_samples(EmitterSampling::kArea), kSamples}};

Allowed allowed_of(const Method& m, double scale) {
  if (m.spp == kSamples) return sampled(scale * kLowest, scale * kHighest, kSamples);
  if (std::string(m.name) == "projected")
    return relative(1e-5, "the documented error of projected solid angles");
  return kRounding;
}

void add_floor(std::vector<Case>& cases, const std::string& name, const std::string& stiff,
               const Method& method, float radiance, const Placement& place) {
  const double scale = double(kAlbedo) * double(radiance);
  cases.push_back(
      {fmt::format("render/{}-{}", name, method.name),
       fmt::format("{}, {}", stiff, method.text),
       "radiance of a floor under a square light",
       RenderMeasurement{[=] { return lit_floor(method.integrator, radiance, place, method.spp); },
                         first_pixel},
       {[scale] { return Quads{scale * square_irradiance() / kQuadPi}; }, "Lambert's sum in 113 bits"},
       allowed_of(method, scale)});
}

void add_placements(std::vector<Case>& cases) {
  struct Entry {
    const char *name, *stiff;
    Placement place;
  };
  const Entry entries[] = {{"scale-1", "nothing", {}},
                           {"scale-1e-4", "a scene of 1e-4 units", {1e-4}},
                           {"scale-1e5", "a scene of 1e5 units", {1e5}},
                           {"shift-1e3", "a scene 1e3 from the origin", {1, {1e3, -1e3, 1e3}}},
                           {"shift-1e5", "a scene 1e5 from the origin", {1, {1e5, -1e5, 1e5}}},
                           {"shift-1e7", "a scene 1e7 from the origin", {1, {1e7, -1e7, 1e7}}}};
  for (const Entry& e : entries) {
    for (const Method& m : kMethods) add_floor(cases, e.name, e.stiff, m, 3, e.place);
  }
}

void add_radiances(std::vector<Case>& cases) {
  for (const auto& [name, radiance] :
       {std::pair("1e-20", 1e-20f), std::pair("1e20", 1e20f), std::pair("3e37", 3e37f)}) {
    const float l = radiance;
    for (const Method& m : kMethods)
      add_floor(cases, fmt::format("radiance-{}", name), fmt::format("a light of radiance {}", name), m, l,
                {});
    cases.push_back(
        {fmt::format("render/radiance-{}-deviation", name),
         fmt::format("squares of deviations of {}", name),
         "standard deviation of samples by area over their mean",
         RenderMeasurement{[l] { return lit_floor(kMethods[2].integrator, l, {}, kSamples); },
                           first_pixel_deviation},
         {[] {
            const auto moment = [](int power) {
              return tanh_sinh(
                  [power](Quad y) {
                    return tanh_sinh(
                        [power, y](Quad x) {
                          const Quad v = area_sample(x, y);
                          return power == 1 ? v : v * v;
                        },
                        Quad(-.5), Quad(.5));
                  },
                  Quad(-.5), Quad(.5));
            };
            const Quad mean = moment(1);
            return Quads{sqrt_q(moment(2) / (mean * mean) - 1)};
          },
          "tanh-sinh quadrature in 113 bits"},
         relative(5 / std::sqrt(2.0 * kSamples), "5 deviations of a deviation of 65536 samples")});
  }
}

void add_seeds(std::vector<Case>& cases) {
  for (const auto& [name, seed] : {std::pair("0", 0u), std::pair("max", 0xffffffffu)}) {
    const std::uint32_t s = seed;
    cases.push_back(
        {fmt::format("render/seed-{}", name),
         "a seed at the end of the range",
         "radiance of a floor under a square light",
         RenderMeasurement{[s] {
                             SceneDescription scene = lit_floor(kMethods[2].integrator, 3, {}, kSamples);
                             scene.sampler.seed = s;
                             return scene;
                           },
                           first_pixel},
         {[] { return Quads{3 * kAlbedo * square_irradiance() / kQuadPi}; }, "Lambert's sum in 113 bits"},
         sampled(3 * kAlbedo * kLowest, 3 * kAlbedo * kHighest, kSamples)});
  }
}

/// A square light of size 1 that stands on the floor in the plane x = 1e-n, facing the point.
void add_walls(std::vector<Case>& cases) {
  for (const auto& [name, distance] :
       {std::pair("1e-2", 1e-2), std::pair("1e-4", 1e-4), std::pair("1e-6", 1e-6)}) {
    const double x = distance;
    for (const Method& m : {kMethods[0], kMethods[1]}) {
      cases.push_back(
          {fmt::format("render/wall-{}-{}", name, m.name),
           fmt::format("a point {} from the edge of a light that stands on the floor, {}", name, m.text),
           "radiance of the floor",
           RenderMeasurement{
               [x, m] {
                 SceneDescription scene = empty_scene(1, 1, m.spp, {-.9, .2, .8}, {0, 0, 0}, 1e-6);
                 const int grey = add_diffuse(scene, kAlbedo);
                 scene.shapes.push_back(quad_shape({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, grey, {}));
                 scene.shapes.push_back(quad_shape({x, -.5, 0}, {0, 0, 1}, {0, 1, 0}, kBlackBsdf, 3));
                 scene.integrator = m.integrator;
                 return scene;
               },
               first_pixel},
           {[x] {
              const Loop loop{{x, .5, 0}, {x, -.5, 0}, {x, -.5, 1}, {x, .5, 1}};
              return Quads{3 * kAlbedo * irradiance({loop}, {}, {0, 0, 1}) / kQuadPi};
            },
            "Lambert's sum in 113 bits"},
           relative(std::string(m.name) == "analytic" ? 64 * kUlp : 1e-4,
                    std::string(m.name) == "analytic"
                        ? "64 roundings of coordinates and colours"
                        : "SMALL_PROJECTED_AREA: relative error of a projected solid angle below 1e-4")});
    }
  }
}

/// The square among triangles without area, needles and a copy of itself.
void add_broken_meshes(std::vector<Case>& cases) {
  for (const Method& m : kMethods) {
    cases.push_back(
        {fmt::format("render/broken-light-{}", m.name),
         fmt::format("collinear, repeated and doubled triangles in a light, {}", m.text),
         "radiance of a floor under a square light",
         RenderMeasurement{
             [m] {
               SceneDescription scene = lit_floor(m.integrator, 3, {}, m.spp);
               auto& mesh = std::get<Mesh>(scene.shapes[1].geometry);
               mesh.positions.emplace_back(0, 0, 1);
               mesh.positions.emplace_back(.25, .25, 1);
               mesh.triangles.insert(mesh.triangles.end(), {{0, 0, 1}, {0, 4, 5}, {0, 1, 2}, {3, 3, 3}});
               return scene;
             },
             first_pixel},
         {[] { return Quads{3 * kAlbedo * square_irradiance() / kQuadPi}; }, "Lambert's sum in 113 bits"},
         allowed_of(m, 3 * kAlbedo)});
  }
}

Numbers brightest_pixel(const FilmAccumulator& film) {
  double brightest = 0;
  for (int y = 0; y < film.height(); ++y)
    for (int x = 0; x < film.width(); ++x) brightest = std::max<double>(brightest, film.at(x, y).mean[0]);
  return {brightest};
}

/// A slanted light that emits to both sides and reflects, but does not see itself: it is flat. Rounding puts
/// its points to either side of its plane, where it covers half the sphere or nothing.
void add_own_surface(std::vector<Case>& cases) {
  for (const auto& [name, scale] : {std::pair("1e-4", 1e-4), std::pair("1", 1.), std::pair("1e5", 1e5)}) {
    const Placement place{scale, scale * glm::dvec3(.31, .17, -.23)};
    cases.push_back(
        {fmt::format("render/own-surface-{}", name),
         fmt::format("points of a light of {} units itself, closed form", name),
         "largest radiance that a two-sided light reflects of itself",
         RenderMeasurement{
             [place] {
               SceneDescription scene = empty_scene(16, 16, 4, {.5, .4, 2}, {0, 0, 0}, 20, place);
               const int grey = add_diffuse(scene, kAlbedo);
               Shape light = quad_shape({-1, -.8, -.3}, {1.7, .2, .4}, {.3, 1.4, .2}, grey, 3, place);
               light.two_sided_emission = true;
               scene.shapes.push_back(light);
               scene.integrator = analytic();
               scene.integrator.hide_emitters = true;
               return scene;
             },
             brightest_pixel},
         known(0, "a flat surface does not see itself"),
         absolute(0, "a light's own closed form is left out")});
  }
}

void add_points(std::vector<Case>& cases) {
  for (const auto& [name, distance] : {std::pair("1e-3", 1e-3), std::pair("1", 1.), std::pair("1e4", 1e4)}) {
    const double d = distance;
    cases.push_back({fmt::format("render/point-light-{}", name),
                     fmt::format("a point light {} above the floor", name),
                     "radiance of the floor",
                     RenderMeasurement{[d] {
                                         SceneDescription scene =
                                             lit_floor(emitter_samples(EmitterSampling::kArea), 0, {}, 4);
                                         scene.shapes.pop_back();
                                         scene.emitters.emplace_back(PointLight{{0, 0, d}, glm::vec3(2)});
                                         return scene;
                                       },
                                       first_pixel},
                     {[d] { return Quads{2 * kAlbedo / kQuadPi / (Quad(d) * d)}; }, "inverse square law"},
                     // The floor's point is off by its stated error, 2^-20 of coordinates up to 2.
                     relative(64 * kUlp + 8 * 16 * kUlp * 2 / std::min(d, 1.0),
                              "the shadow ray starts 2^-20 of coordinates off the floor; inverse square")});
  }
}

}  // namespace

void add(std::vector<Case>& cases) {
  add_placements(cases);
  add_radiances(cases);
  add_seeds(cases);
  add_walls(cases);
  add_broken_meshes(cases);
  add_own_surface(cases);
  add_points(cases);
}

}  // namespace render_light_cases

void add_render_light_cases(std::vector<Case>& cases) { render_light_cases::add(cases); }

}  // namespace penumbra::stress
