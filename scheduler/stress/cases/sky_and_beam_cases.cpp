// Renders of a floor under skies and beams, and by cameras with a lens: spikes, poles, needles.
#include <fmt/format.h>

#include <memory>

#include "kernels/lang_cpp.h"
#include "kernels/light/envmap_grid.h"
#include "scheduler/stress/cases/cases.h"
#include "scheduler/stress/cases/inputs.h"
#include "scheduler/stress/cases/scene_pieces.h"

namespace penumbra::stress {
namespace sky_and_beam_cases {
namespace {

constexpr float kAlbedo = .5f;
constexpr std::uint32_t kSamples = 1 << 16;
constexpr int kWidth = 64, kHeight = 33;  // of the maps

/// The floor's point (0, 0, 0), from above.
SceneDescription floor_of(const Emitter& light, const IntegratorSettings& integrator, std::uint32_t spp) {
  SceneDescription scene = empty_scene(1, 1, spp, {.9, .2, .8}, {0, 0, 0}, 1e-6);
  scene.shapes.push_back(quad_shape({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, add_diffuse(scene, kAlbedo), {}));
  scene.emitters.push_back(light);
  scene.integrator = integrator;
  return scene;
}

/// Radiance 1, and of one texel more; its pole is up, along z.
EnvironmentMapLight sky(double spike, int spike_x, int spike_y) {
  Bitmap image{"sky", kWidth, kHeight, 1, TexelType::kFloat, {}};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const float texel = x == spike_x && y == spike_y ? float(1 + spike) : 1.0f;
      image.words.push_back(FLOAT_BITS(texel));
    }
  EnvironmentMapLight light;
  light.image = std::make_shared<const Bitmap>(std::move(image));
  // From y up to z up.
  light.to_world = glm::dmat4(glm::dvec4(1, 0, 0, 0), glm::dvec4(0, 0, 1, 0), glm::dvec4(0, -1, 0, 0),
                              glm::dvec4(0, 0, 0, 1));
  return light;
}

/// What a texel of 1 in row y, bilinear with its neighbours in longitude and polar angle, sends to the floor:
/// int tent(phi) dphi int tent(theta) cos sin dtheta, in closed form over each side of the row.
Quad texel_irradiance(int y) {
  const Quad step = kQuadPi / (kHeight - 1), across = 2 * kQuadPi / kWidth;
  // int (a + b t) sin(2 t) / 2 dt = -(a + b t) cos(2 t) / 4 + b sin(2 t) / 8.
  const auto side = [](Quad a, Quad b, Quad from, Quad to) {
    const auto primitive = [a, b](Quad t) { return b * sin_q(2 * t) / 8 - (a + b * t) * cos_q(2 * t) / 4; };
    return primitive(to) - primitive(from);
  };
  const Quad middle = step * y, half = kQuadPi / 2;
  Quad sum = 0;
  if (y > 0) sum += side(1 - middle / step, 1 / step, middle - step, middle);
  if (middle < half) sum += side(1 + middle / step, -1 / step, middle, middle + step);
  return across * sum;
}

void add_skies(std::vector<Case>& cases) {
  struct Entry {
    const char *name, *stiff;
    double spike;
    int row;
  };
  const Entry entries[] = {{"poles", "directions of the map's poles, where sin(theta) is 0", 0, 0},
                           {"spike-1e8", "one texel of 1e8 in a sky of 1", 1e8, 8},
                           {"spike-1e8-pole", "one texel of 1e8 at the map's pole", 1e8, 0}};
  for (const Entry& e : entries) {
    const auto radiance = [e] {
      return Quad(kAlbedo) / kQuadPi *
             (kQuadPi + Quad(double(float(1 + e.spike)) - 1) * texel_irradiance(e.row));
    };
    cases.push_back({fmt::format("render/sky-{}", e.name),
                     e.stiff,
                     "radiance of a floor under a sky",
                     RenderMeasurement{[e] {
                                         return floor_of(sky(e.spike, 5, e.row),
                                                         emitter_samples(EmitterSampling::kArea), kSamples);
                                       },
                                       first_pixel},
                     {[radiance] { return Quads{radiance()}; }, "integrals of a bilinear texel in 113 bits"},
                     // Densities are those of the radiance times the sine, between grid lines times what the
                     // sine is off: a sample is at most 4 times the mean.
                     {5 * 2 * double(radiance()) / std::sqrt(double(kSamples)),
                      0,
                      "5 deviations of 65536 samples in [0, 4 means]",
                      {}}});
  }
}

void add_beams(std::vector<Case>& cases) {
  for (const auto& [name, falloff] :
       {std::pair("linear", SpotFalloff::kLinear), std::pair("smoothstep", SpotFalloff::kSmoothstep)}) {
    for (const auto& [place, shift, share] :
         {std::tuple("axis", 0.0, 1.0), std::tuple("beside", 4e-5, 0.0)}) {
      const SpotFalloff by = falloff;
      const double x = shift;
      cases.push_back({fmt::format("render/spot-1e-3-degrees-{}-{}", name, place),
                       "a spot light of a thousandth of a degree",
                       "radiance of a floor under it",
                       RenderMeasurement{[by, x] {
                                           SpotLight spot;
                                           spot.cutoff_angle = 1e-3;
                                           spot.beam_width = 5e-4;
                                           spot.falloff = by;
                                           spot.intensity = glm::vec3(3);
                                           spot.to_world =
                                               glm::dmat4(glm::dvec4(1, 0, 0, 0), glm::dvec4(0, -1, 0, 0),
                                                          glm::dvec4(0, 0, -1, 0), glm::dvec4(x, 0, 1, 1));
                                           return floor_of(spot, emitter_samples(EmitterSampling::kArea), 4);
                                         },
                                         first_pixel},
                       known(3 * kAlbedo / 3.14159265358979324 * share, "closed form"),
                       {1e-30, 64 * kUlp, "64 roundings of coordinates and colours", {}}});
    }
  }
}

void add_lens(std::vector<Case>& cases) {
  cases.push_back({"render/lens-aperture-0",
                   "a lens without an aperture, beside the film's axis",
                   "radiance of a floor under a point light",
                   RenderMeasurement{[] {
                                       PointLight point;
                                       point.position = {0, 0, 1};
                                       SceneDescription scene =
                                           floor_of(point, emitter_samples(EmitterSampling::kArea), 4);
                                       scene.camera.aperture_radius = 0;
                                       scene.camera.focus_distance = 1e-3;
                                       scene.camera.principal_point_offset_x = .25;
                                       return scene;
                                     },
                                     first_pixel},
                   known(kAlbedo / 3.14159265358979324, "closed form"),
                   {1e-30, 64 * kUlp, "64 roundings of coordinates and colours", {}}});
}

}  // namespace

void add(std::vector<Case>& cases) {
  add_skies(cases);
  add_beams(cases);
  add_lens(cases);
}

}  // namespace sky_and_beam_cases

void add_sky_and_beam_cases(std::vector<Case>& cases) { sky_and_beam_cases::add(cases); }

}  // namespace penumbra::stress
