// Statistics of a render: everything about it that is not in its pixels.
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
  int workers = 1;  ///< processes on this machine that it was begun with
  const RenderOutcome* outcome = nullptr;
  std::vector<std::string> warnings;                                 ///< of the scene's reader
  std::vector<std::pair<std::string, std::string>> needs, left_out;  ///< of the scene, see SceneSummary
  std::optional<SceneInventory> inventory;                           ///< what that saves
  std::string contradictory_shape;           ///< of the first sample whose boundaries contradict each other
  double build_seconds = 0;                  ///< reading the scene and building its device form
  std::vector<std::filesystem::path> files;  ///< images written
};

/// How many samples the image came to have.
RenderedSamples rendered_samples(const RenderOutcome& outcome);
/// Of the workers that did any of it: "native", "opencl", "native, opencl".
std::string_view backends_of(const RenderOutcome& outcome);

/// The fields and their units are explained in the README of this folder. What only the end tells is for
/// add_end.
nlohmann::ordered_json statistics_json(const RenderStatistics& statistics);
/// Puts in when the images were written, in what time, and the memory that all of it took.
void add_end(nlohmann::ordered_json& statistics, double write_seconds);

/// An object with each name once; the values of a name that occurs more than once become an array.
nlohmann::ordered_json grouped_json(const std::vector<std::pair<std::string, std::string>>& entries);

/// Samples per second of rendering, all workers together.
double samples_per_second(const RenderOutcome& outcome);

}  // namespace penumbra
