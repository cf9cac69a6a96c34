#include "scenes/device/light_survey.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "kernels/host/material_closure.h"
#define FEATURES FEATURE_ALL
#include "kernels/camera/camera.h"
#include "kernels/intersect/bvh.h"
#include "kernels/light/light.h"
#include "kernels/light/light_tree.h"
#include "kernels/math/frame.h"
#include "kernels/sampler/sampler.h"

namespace penumbra {
namespace {

constexpr int kCameraRays = 1024, kBounces = 3, kMostPassed = 16;
constexpr int kSamples = 2;           // of each light at a place, and of all others together
constexpr double kLaterWeight = 0.5;  // of a place against the one from which it was found
// No infinite light gets less than this of what all of them get, per light.
constexpr double kLeastOfInfinite = 0.05;

/// A place's irradiance from one sample of a light, channels averaged.
struct Arrival {
  LightSample sample;
  double irradiance;  ///< if nothing is in the way
};

class Survey {
 public:
  Survey(const DeviceScene& scene, std::span<const int> infinite)
      : scene_(make_scene(scene.header, scene.words.data())), infinite_(infinite) {}

  std::vector<double> run() {
    for (int k = 0; k < kCameraRays; ++k) follow(k);
    return intensities();
  }

 private:
  /// What a place gets: `finite` and each of the infinite lights in shares of all.
  struct Place {
    double weight, importance, finite;
    std::vector<double> infinite;
  };

  float number() { return unit_float(hash_uint(count_++)); }

  /// The leaf that a path scatters at most likely; nothing if rays pass.
  const Material* leaf_of(int index) const {
    while (index >= 0 && scene_.materials[index].branches != 0) {
      const Material& m = scene_.materials[index];
      const int likely = m.weight > 0.5f ? m.second : m.first, other = m.weight > 0.5f ? m.first : m.second;
      index = likely >= 0 ? likely : other;
    }
    return index < 0 || scene_.materials[index].passes == PASSES_ALL ? nullptr : scene_.materials + index;
  }
  [[nodiscard]] bool may_pass(int primitive) const {
    const SideMaterials sides = side_materials(&scene_, primitive);
    return scene_.materials[sides.front].passes != PASSES_NONE ||
           scene_.materials[sides.back].passes != PASSES_NONE;
  }

  /// Whether nothing that is certain to be in the way blocks the sample.
  [[nodiscard]] bool is_seen(const LightSample& sample, int skip) const {
    vec3 origin = sample.origin;
    float left = sample.tmax;
    for (int k = 0; k < kMostPassed && left > 0; ++k) {
      const Hit hit = intersect_bvh(&scene_, origin, sample.toward, left, skip);
      if (hit.primitive < 0) return true;
      if (!may_pass(hit.primitive)) return false;
      origin = add_scaled(origin, hit.t, sample.toward);
      if (left < NO_LIMIT) left -= hit.t;
      skip = hit.primitive;
    }
    return false;
  }

  /// A sample of the light at the surface, by `u`.
  std::optional<Arrival> sample(const Surface& s, bool all_around, int light, float u, double pmf) {
    const LightReceiver r = receiver_of(s);
    if (is_own_light(&scene_, r, light)) return std::nullopt;
    const float v = number();
    LightSample found = no_light_sample();
    switch (scene_.lights[light].kind) {
#define SAMPLE_KIND(name, NAME, number, ways, description)                           \
  case LIGHT_##NAME:                                                                 \
    found = sample_##name##_light(&scene_, light, r, u, v, no_light_sampling(), 0u); \
    break;
      LIGHT_KINDS(SAMPLE_KIND)
#undef SAMPLE_KIND
      default:
        return std::nullopt;
    }
    if (!(found.tmax > 0 && found.pdf > 0) || (is_beneath(s, found.wi) && !all_around)) return std::nullopt;
    const double cosine = double(dot3(s.shading, found.wi));
    const double kept = all_around ? std::abs(cosine) : std::max(cosine, 0.0);
    const double mean = (double(found.radiance.x) + found.radiance.y + found.radiance.z) / 3;
    const double irradiance = mean * kept / (double(found.pdf) * pmf);
    if (!(irradiance > 0) || !std::isfinite(irradiance)) return std::nullopt;
    return Arrival{found, irradiance};
  }
  double arriving(const Surface& s, bool all_around, int light, float u, double pmf) {
    const std::optional<Arrival> arrival = sample(s, all_around, light, u, pmf);
    return arrival && is_seen(arrival->sample, s.primitive) ? arrival->irradiance : 0.0;
  }

  /// From lights of the hierarchy, and what the choice among them takes that to be.
  double arriving_by_tree(const Surface& s, bool all_around, const LitPlace& lit, double& importance) {
    LitPlaces places;
    LightSamplings chosen;
    float u[LANES], fine[LANES];
    for (int j = 0; j < LANES; ++j) {
      store_lit_place(&places, j, lit);
      u[j] = number();
      fine[j] = number();
    }
    choose_by_tree(&scene_, &places, u, fine, &chosen);
    importance = 0;
    for (int k = 0; k < scene_.header.light_cut; ++k)
      importance += double(light_importance(scene_.light_nodes + k, lit));
    double sum = 0;
    for (int j = 0; j < std::min(kSamples, LANES); ++j)
      if (chosen.pmf[j] > 0) sum += arriving(s, all_around, chosen.light[j], u[j], double(chosen.pmf[j]));
    return sum;
  }

  void visit(const Surface& s, bool all_around, double weight) {
    LitPlace lit;
    lit.p = s.p;
    lit.facing = all_around ? make_vec3(0, 0, 0) : s.shading;
    Place place{weight, 0, 0, {}};
    place.finite = arriving_by_tree(s, all_around, lit, place.importance);
    double all = place.finite;
    for (const int light : infinite_) {
      double sum = 0;
      for (int k = 0; k < kSamples; ++k) sum += arriving(s, all_around, light, number(), 1);
      place.infinite.push_back(sum);
      all += sum;
    }
    if (!(all > 0) || !std::isfinite(all)) return;
    place.finite /= all;
    for (double& share : place.infinite) share /= all;
    places_.push_back(std::move(place));
  }

  /// The k-th camera ray and where light goes on from there.
  void follow(int k) {
    const SceneHeader& h = scene_.header;
    // An additive sequence (Roberts 2018), and numbers of its own for each ray.
    const double x = std::fmod(0.5 + k * 0.7548776662466927, 1.0) * h.film.width;
    const double y = std::fmod(0.5 + k * 0.5698402909980532, 1.0) * h.film.height;
    count_ = hash_uint(std::uint32_t(k));
    const Ray ray = camera_ray(h.camera, h.film, int(x), int(y), float(x - std::floor(x)) - 0.5f,
                               float(y - std::floor(y)) - 0.5f);
    vec3 origin = ray.origin, toward = ray.direction;
    float limit = ray.tmax;
    int skip = -1;
    double weight = 1;
    for (int bounce = 0, passed = 0; bounce < kBounces && passed < kMostPassed;) {
      const Hit hit = intersect_bvh(&scene_, origin, toward, limit, skip);
      if (hit.primitive < 0) return;
      const Surface s = surface_at(&scene_, hit.primitive, origin, toward);
      const Material* leaf = leaf_of(s.material);
      skip = hit.primitive;
      limit = NO_LIMIT;
      ++passed;
      if (leaf != nullptr && leaf->family == FAMILY_BLACK) return;
      const Closure closure = leaf != nullptr ? closure_of(*leaf) : black_closure();
      if (leaf == nullptr || (is_among(closure, families_with(DELTA)) && lets_light_through(closure))) {
        origin = leave_surface(s.p, s.geometric, s.error, toward);
        continue;
      }
      if (is_among(closure, families_with(DELTA))) {
        toward = sub(scale(s.shading, 2 * dot3(s.shading, s.wo)), s.wo);
      } else {
        const bool all_around = lets_light_through(closure);
        visit(s, all_around, weight);
        weight *= kLaterWeight;
        ++bounce;
        const float u = number(), v = number();
        toward = sample_cosine_hemisphere(s.shading, u, v);
      }
      if (is_beneath(s, toward)) return;
      origin = leave_surface(s.p, s.geometric, s.error, toward);
    }
  }

  /// Mean probability of the infinite lights, of intensity x all together.
  [[nodiscard]] double mean_share(double x) const {
    double sum = 0;
    for (const Place& p : places_) sum += p.weight * (x / (x + p.importance));
    return sum;
  }

  [[nodiscard]] std::vector<double> intensities() const {
    std::vector<double> of_each(infinite_.size(), 0.0);
    double wanted = 0;
    for (const Place& p : places_)
      for (std::size_t i = 0; i < of_each.size(); ++i) {
        of_each[i] += p.weight * p.infinite[i];
        wanted += p.weight * p.infinite[i];
      }
    double low = -60, high = 60;  // of log x
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (mean_share(std::exp(middle)) < wanted ? low : high) = middle;
    }
    const double all = places_.empty() ? 1.0 : std::exp(0.5 * (low + high));
    const double least = kLeastOfInfinite / double(infinite_.size());
    double sum = 0;
    for (double& x : of_each) sum += x = std::max(wanted > 0 ? x / wanted : 0.0, least);
    for (double& x : of_each) x *= all / sum;
    return of_each;
  }

  Scene scene_;
  std::span<const int> infinite_;
  std::vector<Place> places_;
  std::uint32_t count_ = 0;
};

}  // namespace

std::vector<double> survey_infinite_lights(const DeviceScene& scene, std::span<const int> infinite) {
  return Survey(scene, infinite).run();
}

}  // namespace penumbra
