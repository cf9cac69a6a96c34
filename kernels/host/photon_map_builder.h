// Builds the maps that kernels search from the photons that kernels traced. A map is a pure function of the
// scene, the random sequence and the map's number, so every machine that needs it can make it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "kernels/host/cache_aligned.h"
#include "kernels/host/error.h"
#include "kernels/photon/photon_task.h"
#include "kernels/scene_types.h"

namespace penumbra {

/// The radius of density estimates of progressive map `map`, counted from 0 (Knaus and Zwicker 2011, in
/// closed form). `dimensions`: 2 on surfaces, 3 in media. Within (0, initial].
double progressive_radius(double initial, double alpha, std::uint32_t map, int dimensions);

/// The photon paths for a unit whose first sample is `first_sample`; `sequence`: see Unit.
PhotonTask photon_task(const IntegratorParameters& integrator, std::uint32_t first_sample,
                       std::uint32_t sequence);

/// The most photons that the maps of a task may have together: offsets in them are of 32 bits.
constexpr std::size_t kMostPhotons = std::size_t{1} << 26;
Error too_many_photons();

/// The words of all maps, see photon/photon_map.h. `photons`: in any order, but those of one path in the
/// order of their edges. If one is not finite, so are all estimates of its map: samples count them.
AlignedVector<std::uint32_t> build_photon_maps(const SceneHeader& header, const PhotonTask& task,
                                               std::span<const Photon> photons);

}  // namespace penumbra
