// Statistics of a render: everything about it except its pixels.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scenes/device/scene_inventory.h"
#include "scheduler/farm/render_job.h"
#include "scheduler/record/render_record.h"

namespace penumbra {

struct RenderStatistics {
  RenderRecord record;
  std::vector<std::string> command_line;  ///< as typed
  const RenderJob* job = nullptr;
  int workers = 1;  ///< local worker processes at the start
  const RenderOutcome* outcome = nullptr;
  std::vector<std::string> warnings;                                 ///< of the scene's reader
  std::vector<std::pair<std::string, std::string>> needs, left_out;  ///< of the scene; see SceneSummary
  std::optional<SceneInventory> inventory;                           ///< what leaving out features saves
  /// The shape of the first sample whose medium boundaries contradict each other.
  std::string contradictory_shape;
  std::string choice;                        ///< what `--integrator auto` has chosen; empty: it was not asked
  double build_seconds = 0;                  ///< for reading the scene and building the device scene
  std::vector<std::filesystem::path> files;  ///< images written
};

/// The samples that are in the image.
RenderedSamples rendered_samples(const RenderOutcome& outcome);
/// The backends of the workers that contributed: "native", "opencl", "native, opencl".
std::string_view backends_of(const RenderOutcome& outcome);

/// The README of this folder explains the fields and their units. add_end adds what is known only at the end.
nlohmann::ordered_json statistics_json(const RenderStatistics& statistics);
/// Adds the time when the images were written, how long that took, and the peak memory.
void add_end(nlohmann::ordered_json& statistics, double write_seconds);

/// A JSON object of these names and values. If a name occurs more than once, its values become an array.
nlohmann::ordered_json grouped_json(const std::vector<std::pair<std::string, std::string>>& entries);

/// Samples per second over all workers, from when the first of them has the scene.
double samples_per_second(const RenderOutcome& outcome);

}  // namespace penumbra
