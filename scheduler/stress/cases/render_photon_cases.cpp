// Whole renders with photon maps: closed rooms of known radiance, of extreme sizes, and places and radii
// where estimates have too few photons.
#include <fmt/format.h>

#include "scheduler/stress/cases/cases.h"
#include "scheduler/stress/cases/inputs.h"
#include "scheduler/stress/cases/scene_pieces.h"

namespace penumbra::stress {
namespace render_photon_cases {
namespace {

constexpr std::uint32_t kMaps = 256;
constexpr float kReflectance = .5f;

/// The inside of a cube of side 2, which emits 1 and reflects half: the radiance is 2 everywhere. The camera,
/// in its middle, looks at `target`.
SceneDescription closed_room(const glm::dvec3& target, const Placement& place, float radius, float alpha) {
  SceneDescription scene = empty_scene(1, 1, kMaps, glm::dvec3(0), target, 1e-4, place);
  ProgressivePhotonIntegrator ppm;
  ppm.photon_count = 3000;
  ppm.initial_radius = float(radius * place.scale);
  ppm.alpha = alpha;
  scene.integrator.method = ppm;
  const int grey = add_diffuse(scene, kReflectance);
  const glm::dvec3 x(2, 0, 0), y(0, 2, 0), z(0, 0, 2), low(-1), high(1);
  for (const auto& [u, v] : {std::pair(x, y), std::pair(y, z), std::pair(z, x)}) {
    scene.shapes.push_back(quad_shape(low, u, v, grey, 1, place));
    scene.shapes.push_back(quad_shape(high, -v, -u, grey, 1, place));
  }
  return scene;
}

}  // namespace

void add(std::vector<Case>& cases) {
  struct Entry {
    const char *name, *stiff;
    glm::dvec3 target;
    Placement place;
    float radius, alpha;
    double truth;  // emission 1, direct light .5, and a share of the other light, .5
  };
  const glm::dvec3 middle(.1, .2, 1);  // of a side: farther from its edges than the radius
  constexpr double kNear = 1e-5;
  const Entry entries[] = {
      {"scale-1e-4", "a room of size 1e-4", middle, {.scale = 1e-4}, .3f, .7f, 2},
      {"scale-1e5", "a room of size 1e5", middle, {.scale = 1e5}, .3f, .7f, 2},
      {"shift-1e6", "a room 1e6 away from the origin", middle, {.shift = glm::dvec3(1e6)}, .3f, .7f, 2},
      {"edge", "a disk of which half is beyond an edge", {1 - kNear, 0, 1}, {}, .3f, 1, 1.75},
      {"corner", "a disk of which a quarter is in a corner", {1 - kNear, 1 - kNear, 1}, {}, .3f, 1, 1.625},
      {"radius-1e-30", "a radius that no photon is within", middle, {}, 1e-30f, .7f, 1.5},
      {"alpha-1e-4", "radii that shrink as fast as they can", middle, {}, .9f, 1e-4f, 2}};
  for (const Entry& e : entries)
    cases.push_back({fmt::format("photons/{}", e.name), e.stiff,
                     "standard errors that its radiance is off by",
                     RenderMeasurement{[e] { return closed_room(e.target, e.place, e.radius, e.alpha); },
                                       errors_from(e.truth)},
                     known(0, "furnace"), absolute(5, "5 standard errors")});
}

}  // namespace render_photon_cases

void add_render_photon_cases(std::vector<Case>& cases) { render_photon_cases::add(cases); }

}  // namespace penumbra::stress
