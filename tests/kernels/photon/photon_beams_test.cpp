// Photons along beams against brute force in double precision.
#include "kernels/photon/photon_beams.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "kernels/host/photon_map_builder.h"
#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra {
namespace {

constexpr float kExtinction = 0.5f;
constexpr int kMostEdges = 4;

struct FogTables : SceneTables {
  AlignedVector<std::uint32_t> words;
  std::vector<Photon> photons;

  /// `count` photons of power 1 about the centre, for beams of that radius; isotropic scattering.
  FogTables(RandomNumbers& random, int count, float radius, vec3 extent, vec3 centre) {
    IntegratorParameters& p = header.integrator;
    p.photons = PHOTONS_PROGRESSIVE;
    p.volume_photons = 1;
    p.surface_radius = p.caustic_radius = p.volume_radius = radius;
    p.radius_alpha = 1;
    p.emission_radius = length3(centre) + 2 * max_component(extent);
    phase_lobes.assign(PHASE_LOBES, PhaseLobe{});
    phase_lobes[0].weight = 1;
    for (int i = 0; i < count; ++i) {
      const auto within = [&](float half) { return half * float(random.between(-1, 1)); };
      Photon photon{};
      photon.p = add(centre, make_vec3(within(extent.x), within(extent.y), within(extent.z)));
      photon.wi = {0, 0, 1};
      photon.power = {1, 1, 1};
      photon.map = PHOTON_MAP_VOLUME;
      photon.edges = 2 + i % 4;
      photons.push_back(photon);
    }
    words = build_photon_maps(header, {.map = 0, .sequence = 0, .paths = 1}, photons);
  }

  /// The sum over a beam by the kernels.
  double gathered(const PhotonBeam& beam) {
    const Scene scene = this->scene();
    const PhotonTable table = photon_table(words.data(), PHOTON_MAP_VOLUME);
    Surfaces surfaces{};
    Closures closures{};
    PhotonPairs pairs;
    start_pairs(&pairs);
    float sums[3 * LANES] = {};
    Closure phase = black_closure();
    phase.family = FAMILY_PHASE;
    Surface s = surface_in_medium(beam.origin);
    s.wo = negate(beam.direction);
    store_surface(&surfaces, 0, s);
    store_closure(&closures, 0, phase);
    const BeamSums into = {&surfaces, &closures, 1u << FAMILY_PHASE, &pairs, sums};
    gather_along(&scene, &table, clip_beam(&table.map, beam), 0, &into);
    finish_pairs(&scene, into.families, &pairs, sums);
    return double(sums[0]) * 4 * std::numbers::pi;
  }
};

double dot(const double (&a)[3], const double (&b)[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// The least and the most that the sum may be: photons at the edges of beams may be in or out.
std::pair<double, double> expected(const std::vector<Photon>& photons, const PhotonBeam& beam, double radius,
                                   double rounding) {
  double least = 0, most = 0;
  for (const Photon& photon : photons) {
    if (photon.edges > kMostEdges) continue;
    const double d[3] = {double(photon.p.x) - beam.origin.x, double(photon.p.y) - beam.origin.y,
                         double(photon.p.z) - beam.origin.z};
    const double direction[3] = {beam.direction.x, beam.direction.y, beam.direction.z};
    const double along = dot(d, direction), off = std::sqrt(std::max(0.0, dot(d, d) - along * along));
    const double inside = std::min({along, beam.last - along, radius - off});
    const double passes = std::exp(-double(kExtinction) * std::max(along, 0.0));
    if (inside > rounding) least += passes;
    if (inside > -rounding) most += passes;
  }
  return {least, most};
}

struct Fog {
  int count;
  float radius;
  vec3 extent, centre;
};

class PhotonBeams : public ::testing::TestWithParam<Fog> {};

TEST_P(PhotonBeams, GatherWhatBruteForceFinds) {
  const auto& [count, radius, extent, centre] = GetParam();
  RandomNumbers random(count);
  FogTables fog(random, count, radius, extent, centre);
  const double size = double(length3(centre)) + 4 * max_component(extent);
  const double rounding = 8 * 0x1p-24 * size;  // of positions and of the beam's points
  double found_at_all = 0;
  for (int k = 0; k < 300; ++k) {
    PhotonBeam beam;
    const auto within = [&](float half) { return half * float(random.between(-1.5, 1.5)); };
    const Photon* aim = count > 0 ? &fog.photons[std::size_t(random.below(std::size_t(count)))] : nullptr;
    beam.origin = add(centre, make_vec3(within(extent.x), within(extent.y), within(extent.z)));
    const vec3 axis =
        make_vec3(k % 3 == 0 ? 1.0f : 0.0f, k % 3 == 1 ? 1.0f : 0.0f, k % 3 == 2 ? -1.0f : 0.0f);
    beam.direction = aim != nullptr && k % 2 == 0 ? normalize3(sub(aim->p, beam.origin)) : axis;
    beam.first = 0;
    beam.last = k % 5 == 0 ? NO_LIMIT : 2 * max_component(extent);
    beam.extinction = {kExtinction, kExtinction, kExtinction};
    beam.most_edges = kMostEdges;
    const auto [least, most] = expected(fog.photons, beam, radius, rounding);
    const double found = fog.gathered(beam), tolerance = 1e-5 * most;  // of sums in single precision
    EXPECT_GE(found, least - tolerance) << "beam " << k;
    EXPECT_LE(found, most + tolerance) << "beam " << k;
    found_at_all += found;
  }
  EXPECT_EQ(found_at_all > 0, count > 1);
}

// No photons, few, many; radii of many cells and of a small part of one; flat, thin and far clouds.
INSTANTIATE_TEST_SUITE_P(
    Fogs, PhotonBeams,
    ::testing::Values(Fog{0, 0.1f, {1, 1, 1}, {0, 0, 0}}, Fog{7, 0.2f, {1, 1, 1}, {0, 0, 0}},
                      Fog{5000, 0.001f, {1, 1, 1}, {0, 0, 0}}, Fog{5000, 0.02f, {1, 1, 1}, {0, 0, 0}},
                      Fog{500, 0.7f, {1, 1, 1}, {0, 0, 0}}, Fog{3000, 0.01f, {1, 1, 0}, {0, 0, 0}},
                      Fog{3000, 0.01f, {0, 1, 0}, {0, 0, 0}}, Fog{3000, 0.5f, {40, 1, 3}, {100, -300, 20}}));

}  // namespace
}  // namespace penumbra
