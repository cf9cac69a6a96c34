#include "kernels/host/photon_map_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <vector>

#include "kernels/host/bounds.h"
#include "kernels/photon/photon_search.h"

namespace penumbra {
namespace {

constexpr float kLeastRadius = 1e-12f;       // its cube, and the inverse, are numbers in single precision
constexpr std::uint32_t kLeastBuckets = 16;  // so that reads of 8 photons at once end within the map

/// A stable counting sort of `order` by keys[index], which are below `end`. Returns the first position of
/// each key, and the end.
std::vector<std::uint32_t> sort_by(std::vector<std::uint32_t>& order, std::span<const std::uint32_t> keys,
                                   std::size_t end) {
  std::vector<std::uint32_t> starts(end + 1, 0);
  for (const std::uint32_t i : order) ++starts[keys[i] + 1];
  std::inclusive_scan(starts.begin(), starts.end(), starts.begin());
  std::vector<std::uint32_t> next(starts.begin(), starts.end() - 1), sorted(order.size());
  for (const std::uint32_t i : order) sorted[next[keys[i]]++] = i;
  order = std::move(sorted);
  return starts;
}

// Radii up to this map are products; beyond it their relative error is 1e-6.
constexpr std::uint32_t kMostFactors = 1 << 20;

/// Of a number in (0, 1], by Newton's method: with the same bits on every machine, unlike std::cbrt.
double cube_root(double x) {
  double root = 1;
  for (int i = 0; i < 100; ++i) root = (2 * root + x / (root * root)) / 3;
  return root;
}

struct MapSize {
  double radius;
  double beam_radius;  ///< 0: no estimates along beams
  int paths;
};

MapSize size_of(const IntegratorParameters& p, const PhotonTask& task, int map) {
  const auto radius = [&](float initial, int dimensions) {
    return progressive_radius(initial, p.radius_alpha, task.map, dimensions);
  };
  switch (map) {
    case PHOTON_MAP_CAUSTIC:
      return {radius(p.caustic_radius, 2), 0, p.caustic_photons};
    case PHOTON_MAP_VOLUME:
      return {radius(p.volume_radius, 3), p.photons == PHOTONS_PROGRESSIVE ? radius(p.volume_radius, 2) : 0,
              p.volume_photons};
    default:
      return {radius(p.surface_radius, 2), 0, p.surface_photons};
  }
}

float map_radius(double radius) { return std::max(float(radius), kLeastRadius); }

bool is_finite(const Photon& photon) {
  return is_finite3(photon.p) && is_finite3(photon.wi) && is_finite3(photon.power);
}

/// Words of the photon in the order of their arrays in a map, see PHOTON_MAP_FIELDS.
std::array<std::uint32_t, PHOTON_WORDS> words_of(const Photon& photon) {
  std::array<std::uint32_t, PHOTON_WORDS> words;
  std::size_t k = 0;
  for (const vec3& v : {photon.p, photon.wi, photon.normal, photon.power})
    for (const float x : {v.x, v.y, v.z}) words[k++] = std::bit_cast<std::uint32_t>(x);
  words[k] = std::uint32_t(photon.edges);
  return words;
}

// Christensen 1999: a fraction of the photons suffices.
constexpr std::size_t kPhotonsPerIrradiance = 4;

/// The irradiance from photons of a map on the photon's surface.
vec3 irradiance_at(const PhotonTable& table, const Photon& photon) {
  const PhotonSearch near =
      search_photons(&table, photon.p, photon.normal, false, std::numeric_limits<int>::max());
  PhotonSearch search = near;
  vec3 sum = make_vec3(0.0f, 0.0f, 0.0f);
  for (int i = next_photon(&table, &search); i >= 0; i = next_photon(&table, &search))
    sum = add(sum, photon_irradiance(&table, &near, photon.normal, i));
  return scale(sum, table.map.share * inverse_extent(false, near.radius2));
}

/// Some photons of the first two maps, with irradiances in place of powers.
std::vector<Photon> irradiance_photons(std::span<const Photon> photons, std::span<const std::uint32_t> order,
                                       const AlignedVector<std::uint32_t>& words) {
  const PhotonTable surface = photon_table(words.data(), PHOTON_MAP_SURFACE),
                    caustic = photon_table(words.data(), PHOTON_MAP_CAUSTIC);
  std::vector<Photon> chosen;
  std::size_t next = 0;
  for (const std::uint32_t i : order) {
    if (photons[i].map == PHOTON_MAP_VOLUME || next++ % kPhotonsPerIrradiance != 0) continue;
    Photon photon = photons[i];
    photon.power = add(irradiance_at(surface, photon), irradiance_at(caustic, photon));
    photon.edges = 0;
    chosen.push_back(photon);
  }
  return chosen;
}

int bucket_of(const Photon& photon, const PhotonMap& map) {
  return photon_bucket(photon_cell(photon.p, map.cells), map.buckets);
}

/// The mean number of photons that a photon has in its bucket, itself included; from every kStride-th photon.
double crowd(std::span<const Photon> photons, std::span<const std::uint32_t> order, const PhotonMap& map) {
  constexpr std::size_t kStride = 16;
  std::vector<std::uint32_t> sizes(std::size_t(map.buckets), 0);
  double others = 0, counted = 0;
  for (std::size_t k = 0; k < order.size(); k += kStride, ++counted)
    others += 2 * sizes[std::size_t(bucket_of(photons[order[k]], map))]++;
  return 1 + kStride * others / std::max(counted, 1.0);
}

/// Sets what beams need: the bounds, and larger cells, because they visit many, and it takes longer to visit
/// a cell than to test a few photons.
void prepare_for_beams(std::span<const Photon> photons, std::span<const std::uint32_t> order,
                       PhotonMap& map) {
  constexpr double kCrowd = 64;
  constexpr float kMostAlong = 512;  // cells along a beam
  Box bounds;
  for (const std::uint32_t i : order) bounds.include(photons[i].p);
  map.low = make_vec3(bounds.low[0], bounds.low[1], bounds.low[2]);
  map.high = make_vec3(bounds.high[0], bounds.high[1], bounds.high[2]);
  const float longest = std::max(max_component(sub(map.high, map.low)), kLeastRadius);
  const float smallest = std::min(map.cells, kMostAlong / longest);
  const double evenly = std::max(1.0, double(order.size()) / kCrowd);  // cells of a cube
  map.cells = std::min(smallest, float(1 / cube_root(1 / evenly)) / longest);
  while (map.cells < smallest && crowd(photons, order, map) > kCrowd)
    map.cells = std::min(smallest, 1.5f * map.cells);
}

/// Appends the map of those photons that `order` lists, sorted by path and edges.
PhotonMap append_map(std::span<const Photon> photons, std::vector<std::uint32_t> order, const MapSize& size,
                     float scene_radius, AlignedVector<std::uint32_t>& words) {
  PhotonMap map{};
  const bool all_finite = std::erase_if(order, [&](auto i) { return !is_finite(photons[i]); }) == 0;
  map.share = !all_finite      ? std::numeric_limits<float>::quiet_NaN()
              : size.paths > 0 ? 1.0f / float(size.paths)
                               : 0.0f;
  map.count = int(order.size());
  map.buckets = int(std::bit_ceil(std::max(kLeastBuckets, std::uint32_t(order.size()))));
  map.radius = map_radius(size.radius);
  map.beam_radius = map_radius(size.beam_radius);
  map.cells = cells_per_unit(map.radius, scene_radius);
  if (size.beam_radius > 0) prepare_for_beams(photons, order, map);
  map.offset = std::uint32_t(words.size());
  std::vector<std::uint32_t> buckets(photons.size());
  for (const std::uint32_t i : order) buckets[i] = std::uint32_t(bucket_of(photons[i], map));
  const std::vector<std::uint32_t> starts = sort_by(order, buckets, std::size_t(map.buckets));
  words.resize(words.size() + order.size() * PHOTON_WORDS);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto own = words_of(photons[order[k]]);
    for (std::size_t array = 0; array < own.size(); ++array)
      words[map.offset + array * order.size() + k] = own[array];
  }
  words.insert(words.end(), starts.begin(), starts.end());
  return map;
}

}  // namespace

double progressive_radius(double initial, double alpha, std::uint32_t map, int dimensions) {
  // The square, in media the cube, of r_N / r_1 is the product of (i + alpha) / (i + 1) over i = 1 ... N - 1,
  // which is Gamma(N + alpha) / (Gamma(1 + alpha) Gamma(N + 1)) and falls like N^(alpha - 1).
  const std::uint32_t factors = std::min(map, kMostFactors);
  double shrunk = 1;
  for (std::uint32_t i = 1; i <= factors; ++i) shrunk *= (i + alpha) / (i + 1.0);
  if (map > factors) shrunk *= exp_f(float(alpha - 1) * log_f(float(map) / float(factors)));
  return initial * (dimensions == 2 ? std::sqrt(shrunk) : cube_root(shrunk));
}

Error too_many_photons() {
  return {fmt::format("photons arrive at more than {} places; fewer photons, or a lower max_depth, would do",
                      kMostPhotons)};
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
  std::vector<std::uint32_t> order(photons.size()), paths(photons.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::transform(photons, paths.begin(), [](const Photon& p) { return std::uint32_t(p.path); });
  sort_by(order, paths, std::size_t(task.paths));
  std::array<std::vector<std::uint32_t>, PHOTON_MAPS> own;
  for (const std::uint32_t i : order) own[std::size_t(photons[i].map)].push_back(i);
  std::array<PhotonMap, PHOTON_MAPS> maps{};
  AlignedVector<std::uint32_t> words(sizeof(maps) / sizeof(std::uint32_t));
  words.reserve(words.size() + photons.size() * (PHOTON_WORDS + 2));
  const auto append = [&](int map, std::span<const Photon> from, std::vector<std::uint32_t> listed) {
    maps[std::size_t(map)] = append_map(from, std::move(listed), size_of(header.integrator, task, map),
                                        header.integrator.emission_radius, words);
    std::memcpy(words.data(), maps.data(), sizeof(maps));
  };
  for (const int map : {PHOTON_MAP_SURFACE, PHOTON_MAP_CAUSTIC, PHOTON_MAP_VOLUME})
    append(map, photons, std::move(own[std::size_t(map)]));
  if (header.integrator.gathering == GATHER_SECOND) {
    const std::vector<Photon> known = irradiance_photons(photons, order, words);
    std::vector<std::uint32_t> all(known.size());
    std::iota(all.begin(), all.end(), 0u);
    append(PHOTON_MAP_IRRADIANCE, known, std::move(all));
  }
  return words;
}

}  // namespace penumbra
