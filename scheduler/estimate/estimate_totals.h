// The estimates of all renders of a set, and their totals.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scheduler/estimate/render_estimate.h"
#include "worker/protocol/asset_manifest.h"

namespace penumbra {

struct SetMemberEstimate {
  std::string name, scene;                                        ///< as in SetMember
  std::vector<std::pair<std::string, std::string>> choices = {};  ///< as in SetMember
  std::vector<AssetPiece> pieces = {};                            ///< of its device scene
  std::optional<RenderEstimate> estimate = {};
  std::string error = {};  ///< why there is no estimate
};

struct EstimateTotals {
  std::size_t renders = 0;  ///< that have an estimate
  double samples = 0, core_seconds = 0;
  std::uint64_t units = 0, result_bytes = 0, image_bytes = 0;
  std::uint64_t scene_bytes = 0;  ///< to each worker, each piece once
  std::vector<WallTime> wall = {};
  // The largest of all renders.
  std::uint64_t worker_memory_bytes = 0, scheduler_memory_bytes = 0;
  double relative_error = 0;  ///< NaN: unknown for a render
};

/// Sums of the renders' estimates. They run one after the other, so wall times add up too.
EstimateTotals totals_of(const std::vector<SetMemberEstimate>& members);

/// The heading and the rows of a table. Names take `width` columns.
std::string estimate_heading(std::size_t width);
std::string estimate_row(const SetMemberEstimate& member, std::size_t width);
std::string totals_text(const EstimateTotals& totals, std::size_t members);
std::string set_estimate_json(const std::vector<SetMemberEstimate>& members);

}  // namespace penumbra
