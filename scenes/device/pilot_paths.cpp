#include "scenes/device/pilot_paths.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels/block/block_flight.h"
#include "kernels/camera/camera.h"
#include "kernels/host/device_scene.h"
#include "kernels/intersect/bvh.h"
#include "kernels/light/light.h"
#include "kernels/light/light_tree.h"
#include "kernels/math/frame.h"
#include "kernels/sampler/sampler.h"
#include "scenes/device/records_view.h"

namespace penumbra {
namespace {

constexpr int kCameraRays = 1024, kBounces = 3, kMostPassed = 16;
constexpr int kSamples = 8;  // samples of each infinite light at a vertex, and of all other lights together
constexpr double kLaterWeight = 0.5;  // weight of a vertex relative to the previous one on its path
// The smallest intensity of an infinite light, as a fraction of its equal share.
constexpr double kLeastOfInfinite = 0.05;

/// The contribution of one light sample to a vertex.
struct Arrival {
  double light = 0;      ///< radiance times the receiver's cosine, averaged over channels; 0: no light
  double pdf = 1;        ///< per solid angle, including the choice among the lights of its group
  double other_pdf = 0;  ///< density of diffuse BSDF sampling for the same direction
};

class PilotPaths {
 public:
  PilotPaths(const Scene& scene, std::span<const int> infinite) : scene_(scene), infinite_(infinite) {}

  InfiniteLights run() {
    for (int k = 0; k < kCameraRays; ++k)
      follow(k, [&](const Surface& s, bool all_around, double weight) { visit(s, all_around, weight); });
    return found();
  }

  std::vector<PilotVertex> places() {
    std::vector<PilotVertex> all;
    for (int k = 0; k < kCameraRays; ++k)
      follow(k, [&](const Surface& s, bool all_around, double weight) {
        all.push_back({s.p, all_around ? make_vec3(0, 0, 0) : s.shading, weight});
      });
    return all;
  }

 private:
  /// The samples at a vertex that received light: of the finite lights, and of each infinite light.
  struct Place {
    double weight, importance, irradiance;
    std::vector<Arrival> finite;
    std::vector<std::vector<Arrival>> infinite;
  };

  float number() { return unit_float(hash_uint(count_++)); }

  /// The leaf BSDF at which a path is most likely scattered. Null if rays pass through.
  const Material* leaf_of(int index) const {
    while (index >= 0 && scene_.materials[index].branches != 0) {
      const Material& m = scene_.materials[index];
      const int likely = m.weight > 0.5f ? m.second : m.first, other = m.weight > 0.5f ? m.first : m.second;
      index = likely >= 0 ? likely : other;
    }
    return index < 0 || scene_.materials[index].passes == PASSES_ALL ? nullptr : scene_.materials + index;
  }

  /// The closest hit in (0, tmax), ignoring the primitive on which the ray starts: `skip` of instance
  /// `skip_instance`.
  [[nodiscard]] Hit closest(vec3 o, vec3 d, float tmax, int skip, int skip_instance) const {
    const bool instances = scene_.header.tables.instances.count > 0;
    return intersect_levels(&scene_, o, d, tmax, skip, skip_instance, instances);
  }
  [[nodiscard]] Surface surface_of(const Hit& hit, vec3 o, vec3 d) const {
    return hit.instance >= 0 ? surface_at_instance(&scene_, hit.primitive, hit.instance, o, d)
                             : surface_at(&scene_, hit.primitive, o, d);
  }

  /// Whether the sample is visible from `s`. Only surfaces that certainly block light count.
  [[nodiscard]] bool is_seen(const LightSample& sample, const Surface& s) const {
    vec3 origin = sample.origin;
    float left = sample.tmax;
    int skip = s.primitive, skip_instance = s.instance;
    for (int k = 0; k < kMostPassed && left > 0; ++k) {
      const Hit hit = closest(origin, sample.toward, left, skip, skip_instance);
      if (hit.primitive < 0) return true;
      if (share_behind(&scene_, hit.primitive) == 0.0f) return false;
      origin = add_scaled(origin, hit.t, sample.toward);
      if (left < NO_LIMIT) left -= hit.t;
      skip = hit.primitive;
      skip_instance = hit.instance;
    }
    return false;
  }

  /// A sample of the light at the surface with the random number `u`.
  Arrival arriving(const Surface& s, bool all_around, int light, float u, double pmf) {
    const LightReceiver r = receiver_of(s);
    if (is_own_light(&scene_, r, light)) return {};
    const float v = number();
    LightSample found = no_light_sample();
    LightSampling sampling = no_light_sampling();
    const bool glows = scene_.lights[light].kind == LIGHT_MEDIUM;
    if (glows) sampling = sample_glow(&scene_, light, u, v, sampling);
    switch (scene_.lights[light].kind) {
#define SAMPLE_KIND(name, NAME, number, ways, description)                                          \
  case LIGHT_##NAME:                                                                                \
    found = sample_##name##_light(&scene_, light, load_light(scene_.lights + light),                \
                                  still_axes(&scene_, light, LIGHT_##NAME), r, u, v, sampling, 0u); \
    break;
      LIGHT_KINDS(SAMPLE_KIND)
#undef SAMPLE_KIND
      default:
        return {};
    }
    if (glows) found.radiance = mul(found.radiance, glow_emission(&scene_, light, sampling));
    if (!(found.tmax > 0 && found.pdf > 0) || (is_beneath(s, found.wi) && !all_around)) return {};
    const double cosine = double(dot3(s.shading, found.wi));
    const double kept = all_around ? std::abs(cosine) : std::max(cosine, 0.0);
    const double mean = (double(found.radiance.x) + found.radiance.y + found.radiance.z) / 3;
    const Arrival arrival{mean * kept, double(found.pdf) * pmf, found.delta ? 0.0 : kept / double(PI_F)};
    const double irradiance = arrival.light / arrival.pdf;
    if (!(irradiance > 0) || !std::isfinite(irradiance * irradiance)) return {};
    return is_seen(found, s) ? arrival : Arrival{};
  }

  void visit(const Surface& s, bool all_around, double weight) {
    LitPlaces places;
    LightSamplings chosen;
    LitPlace lit;
    float u[LANES], fine[LANES];
    lit.p = s.p;
    lit.facing = all_around ? make_vec3(0, 0, 0) : s.shading;
    for (int j = 0; j < LANES; ++j) {
      store_lit_place(&places, j, lit);
      u[j] = number();
      fine[j] = number();
    }
    LightScales scales;
    choose_by_tree(&scene_, &places, u, fine, &chosen, &scales);
    Place place{weight, 0, 0, {}, {}};
    for (int k = 0; k < scene_.header.light_cut; ++k)
      place.importance += double(light_importance(scene_.light_nodes + k, lit));
    const auto add = [&](std::vector<Arrival>& to, const Arrival& arrival) {
      if (!(arrival.light > 0)) return;
      place.irradiance += arrival.light / arrival.pdf / kSamples;
      to.push_back(arrival);
    };
    for (int j = 0; j < kSamples; ++j)
      if (chosen.pmf[j] > 0)
        add(place.finite, arriving(s, all_around, chosen.light[j], u[j], double(chosen.pmf[j])));
    for (const int light : infinite_) {
      place.infinite.emplace_back();
      for (int k = 0; k < kSamples; ++k)
        add(place.infinite.back(), arriving(s, all_around, light, number(), 1));
    }
    if (place.irradiance > 0) places_.push_back(std::move(place));
  }

  /// Follows the k-th camera ray and scattered light from there.
  template <typename Visit>
  void follow(int k, const Visit& visited) {
    const SceneHeader& h = scene_.header;
    // An additive recurrence (Roberts 2018), plus separate random numbers for each ray.
    const double x = std::fmod(0.5 + k * 0.7548776662466927, 1.0) * h.film.width;
    const double y = std::fmod(0.5 + k * 0.5698402909980532, 1.0) * h.film.height;
    count_ = hash_uint(std::uint32_t(k));
    const Ray ray = camera_ray(h.camera, h.film, int(x), int(y), float(x - std::floor(x)) - 0.5f,
                               float(y - std::floor(y)) - 0.5f);
    vec3 origin = ray.origin, toward = ray.direction;
    float limit = ray.tmax;
    int skip = -1, skip_instance = -1;
    double weight = 1;
    for (int bounce = 0, passed = 0; bounce < kBounces && passed < kMostPassed;) {
      const Hit hit = closest(origin, toward, limit, skip, skip_instance);
      if (hit.primitive < 0) return;
      const Surface s = surface_of(hit, origin, toward);
      const Material* leaf = leaf_of(s.material);
      skip = hit.primitive;
      skip_instance = hit.instance;
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
        const bool all_around = is_lit_all_around(closure);
        visited(s, all_around, weight);
        weight *= kLaterWeight;
        ++bounce;
        const float u = number(), v = number();
        toward = sample_cosine_hemisphere(s.shading, u, v);
      }
      if (is_beneath(s, toward)) return;
      origin = leave_surface(s.p, s.geometric, s.error, toward);
    }
  }

  /// The variance of the combined estimator by the balance heuristic: light samples, which choose the group
  /// with probability p, and BSDF samples. It is the integral of f^2 / (p pdf + other_pdf) minus the squares
  /// of both means. The choice among lights is well distributed and so makes little noise; therefore a
  /// group's mean is computed as if the group were always chosen.
  static double variance(const std::vector<Arrival>& samples, double p) {
    constexpr double kSpread = 0.5;
    double moment = 0, sum = 0, squares = 0, other_sum = 0, other_squares = 0;
    for (const Arrival& a : samples) {
      const double both = p * a.pdf + a.other_pdf, value = a.light / a.pdf;
      const double own = value * (p * a.pdf / both), other = value * (a.other_pdf / both);
      moment += value * a.light / both;
      sum += own;
      squares += own * own;
      other_sum += other;
      other_squares += other * other;
    }
    // Unbiased squared means from pairs of different samples.
    constexpr double kPairs = double(kSamples) * (kSamples - 1);
    const double mean2 = (sum * sum - squares) / kPairs,
                 other_mean2 = (other_sum * other_sum - other_squares) / kPairs;
    return moment / kSamples - kSpread * (mean2 / p + other_mean2);
  }

  /// The weight relative to the light there, as far as one vertex can tell.
  [[nodiscard]] double relative_weight(const Place& place) const {
    const double irradiance = place.irradiance + mean_irradiance_;
    return place.weight / (irradiance * irradiance);
  }

  /// The sum of variances over all vertices, if infinite lights have intensities that are `shares` of x,
  /// beside importances to the power of `exponent`.
  [[nodiscard]] double variance_of_all(double x, double exponent, std::span<const double> shares) const {
    double sum = 0;
    for (const Place& place : places_) {
      const double importance = place.importance, least = double(LEAST_LIGHT_SHARE);
      const bool any = importance > 0 || exponent == 0;
      const double p = any ? std::clamp(x / (x + std::pow(importance, exponent)), least, 1 - least) : 1.0;
      double here = p < 1 ? variance(place.finite, 1 - p) : 0.0;
      for (std::size_t i = 0; i < shares.size(); ++i) here += variance(place.infinite[i], p * shares[i]);
      sum += relative_weight(place) * here;
    }
    return sum;
  }

  [[nodiscard]] InfiniteLights found() {
    double irradiances = 0, weights = 0;
    for (const Place& place : places_) {
      irradiances += place.weight * place.irradiance;
      weights += place.weight;
    }
    mean_irradiance_ = weights > 0 ? irradiances / weights : 0.0;
    // Shares among infinite lights in proportion to the roots of their variances, which is optimal where only
    // one of them contributes.
    const double equal = 1 / double(infinite_.size());
    std::vector<double> shares(infinite_.size(), 0.0);
    double all = 0;
    for (std::size_t i = 0; i < shares.size(); ++i) {
      for (const Place& place : places_) shares[i] += relative_weight(place) * variance(place.infinite[i], 1);
      all += shares[i] = std::sqrt(std::max(shares[i], 0.0));
    }
    double sum = 0;
    for (double& share : shares)
      sum += share = std::max(all > 0 ? share / all : equal, kLeastOfInfinite * equal);
    for (double& share : shares) share /= sum;
    const double constant = constant_share(shares), x = least_intensity(shares);
    for (double& share : shares) share *= x;
    return {shares, constant};
  }

  /// Minimises the variance: first by factors of two, then around the best of them.
  [[nodiscard]] double least_intensity(std::span<const double> shares) const {
    double best = 0, least = std::numeric_limits<double>::infinity();
    const auto consider = [&](double k) {
      if (const double value = variance_of_all(std::exp2(k), 1, shares); value < least) {
        least = value;
        best = k;
      }
    };
    for (int k = -60; k <= 60; ++k) consider(k);
    for (double step = 0.5; step > 0.05; step *= 0.5)
      for (const double k : {best - step, best + step}) consider(k);
    return std::exp2(best);
  }

  /// The constant probability. It is one half, which well-distributed numbers divide best and whose variance
  /// is at most twice the optimum, unless another multiple of a power of two is predicted to be much better.
  [[nodiscard]] double constant_share(std::span<const double> shares) const {
    constexpr double kMuchLess = 0.7;
    double best = 0.5, least = kMuchLess * variance_of_all(1, 0, shares);
    for (const double share : {0.25, 0.75, 0.125, 0.875}) {
      if (const double value = variance_of_all(share / (1 - share), 0, shares); value < least) {
        least = value;
        best = share;
      }
    }
    return best;
  }

  Scene scene_;
  std::span<const int> infinite_;
  std::vector<Place> places_;
  double mean_irradiance_ = 0;
  std::uint32_t count_ = 0;
};

}  // namespace

std::vector<PilotVertex> pilot_vertices(const SceneHeader& header, const SceneRecords& records) {
  const RecordsView view(records, header);
  return PilotPaths(view.scene(), {}).places();
}

InfiniteLights weigh_infinite_lights(const SceneHeader& header, const SceneRecords& records,
                                     std::span<const int> infinite) {
  const RecordsView view(records, header);
  return PilotPaths(view.scene(), infinite).run();
}

}  // namespace penumbra
