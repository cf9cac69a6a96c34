#include "kernels/host/photon_map_builder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <vector>

#include "kernels/photon/photon_map.h"

namespace penumbra {
namespace {

constexpr std::uint32_t kLeastBuckets = 16;  // so that reads of 8 photons at once end within the map

/// A stable counting sort of `order` by key(index), which is below `keys`. Returns the first position of each
/// key, and the end.
template <typename Key>
std::vector<std::uint32_t> sort_by(std::vector<std::uint32_t>& order, std::size_t keys, const Key& key) {
  std::vector<std::uint32_t> starts(keys + 1, 0);
  for (const std::uint32_t i : order) ++starts[key(i) + 1];
  std::inclusive_scan(starts.begin(), starts.end(), starts.begin());
  std::vector<std::uint32_t> next(starts.begin(), starts.end() - 1), sorted(order.size());
  for (const std::uint32_t i : order) sorted[next[key(i)]++] = i;
  order = std::move(sorted);
  return starts;
}

struct MapSize {
  double radius;
  int paths;
};

MapSize size_of(const IntegratorParameters& p, const PhotonTask& task, int map) {
  const auto radius = [&](float initial, int dimensions) {
    return progressive_radius(initial, p.radius_alpha, task.map, dimensions);
  };
  switch (map) {
    case PHOTON_MAP_CAUSTIC:
      return {radius(p.caustic_radius, 2), p.caustic_photons};
    case PHOTON_MAP_VOLUME:
      return {radius(p.volume_radius, 3), p.volume_photons};
    default:
      return {radius(p.surface_radius, 2), p.surface_photons};
  }
}

bool is_finite(const Photon& photon) {
  return is_finite3(photon.p) && is_finite3(photon.wi) && is_finite3(photon.power);
}

class MapWriter {
 public:
  MapWriter(AlignedVector<std::uint32_t>& words, std::span<const Photon> photons)
      : words_(words), photons_(photons) {}

  /// Appends the map of these photons, which are sorted by path and edges.
  void write(std::vector<std::uint32_t> order, const MapSize& size, float scene_radius, PhotonMap& map) {
    const bool all_finite = std::erase_if(order, [&](auto i) { return !is_finite(photons_[i]); }) == 0;
    map.share = !all_finite      ? std::numeric_limits<float>::quiet_NaN()
                : size.paths > 0 ? 1.0f / float(size.paths)
                                 : 0.0f;
    map.count = int(order.size());
    map.buckets = int(std::bit_ceil(std::max(kLeastBuckets, std::uint32_t(order.size()))));
    map.radius = std::max(float(size.radius), std::numeric_limits<float>::min());
    map.cells = cells_per_unit(map.radius, scene_radius);
    const auto bucket = [&](std::uint32_t i) {
      return std::size_t(photon_bucket(photon_cell(photons_[i].p, map.cells), map.buckets));
    };
    const std::vector<std::uint32_t> starts = sort_by(order, std::size_t(map.buckets), bucket);
    map.offset = std::uint32_t(words_.size());
    for (const auto member : {&Photon::p, &Photon::wi, &Photon::normal, &Photon::power})
      for (const auto axis : {&vec3::x, &vec3::y, &vec3::z})
        for (const std::uint32_t i : order)
          words_.push_back(std::bit_cast<std::uint32_t>(photons_[i].*member.*axis));
    for (const std::uint32_t i : order) words_.push_back(std::uint32_t(photons_[i].edges));
    words_.insert(words_.end(), starts.begin(), starts.end());
  }

 private:
  AlignedVector<std::uint32_t>& words_;
  std::span<const Photon> photons_;
};

}  // namespace

double progressive_radius(double initial, double alpha, std::uint32_t map, int dimensions) {
  // r^d of map N - 1 is initial^d Gamma(N + alpha) / (Gamma(1 + alpha) Gamma(N + 1)).
  const double n = double(map) + 1;
  const double shrunk = std::lgamma(n + alpha) - std::lgamma(1 + alpha) - std::lgamma(n + 1);
  return initial * std::exp(std::min(shrunk, 0.0) / dimensions);
}

PhotonTask photon_task(const IntegratorParameters& integrator, std::uint32_t first_sample,
                       std::uint32_t sequence) {
  const bool progressive = integrator.photons == PHOTONS_PROGRESSIVE;
  return {
      .map = progressive ? first_sample / std::uint32_t(std::max(1, integrator.samples_per_map)) : 0,
      .sequence = sequence,
      .paths = std::max({integrator.surface_photons, integrator.caustic_photons, integrator.volume_photons})};
}

AlignedVector<std::uint32_t> build_photon_maps(const SceneHeader& header, const PhotonTask& task,
                                               std::span<const Photon> photons) {
  std::vector<std::uint32_t> order(photons.size());
  std::iota(order.begin(), order.end(), 0u);
  sort_by(order, std::size_t(task.paths), [&](std::uint32_t i) { return std::size_t(photons[i].path); });
  std::array<PhotonMap, PHOTON_MAPS> maps{};
  AlignedVector<std::uint32_t> words(sizeof(maps) / sizeof(std::uint32_t));
  words.reserve(words.size() + photons.size() * (PHOTON_WORDS + 2));
  MapWriter writer(words, photons);
  for (int map = 0; map < PHOTON_MAPS; ++map) {
    std::vector<std::uint32_t> own;
    std::ranges::copy_if(order, std::back_inserter(own), [&](auto i) { return photons[i].map == map; });
    writer.write(std::move(own), size_of(header.integrator, task, map), header.integrator.emission_radius,
                 maps[std::size_t(map)]);
  }
  std::memcpy(words.data(), maps.data(), sizeof(maps));
  return words;
}

}  // namespace penumbra
