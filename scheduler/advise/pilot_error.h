// The error of a render as pilots show it.
#pragma once

#include <span>
#include <vector>

#include "scheduler/advise/pilot.h"

namespace penumbra {

/// Relative squared error, per tile: sums over its pixels of the variance over reference^2 + 0.01, mean over
/// channels (relative_mse, scheduler/image/metrics/error_metrics.h).
struct TileError {
  double paths = 0;    ///< of one sample per pixel
  double photons = 0;  ///< of one photon map
  double missed = 0;   ///< of one sample per pixel: light that another technique finds and this one did not
};

/// The mean of all pilots over 4 x 4 pixels, as laid out in Pilot.
std::vector<double> pilot_reference(std::span<const Pilot* const> pilots, std::span<const PilotTile> tiles);

/// `has_photons`: whether the pilot's batches have a photon map each.
std::vector<TileError> tile_errors(const Pilot& pilot, bool has_photons, std::span<const PilotTile> tiles,
                                   std::span<const double> reference);

/// Adds to `errors` what `pilot` lacks on the mean over each tile in comparison with `other`, as far as the
/// spread of their batches does not explain it. Rare bright samples that a pilot did not meet leave it
/// without spread, but darker: this is a lower bound of their variance.
void add_missed(const Pilot& pilot, const Pilot& other, std::span<const PilotTile> tiles,
                std::span<const double> reference, std::vector<TileError>& errors);

}  // namespace penumbra
