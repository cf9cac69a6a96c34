// What a report has to render, all of it checked before any of it is rendered.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scheduler/cli/report_options.h"
#include "scheduler/report/cell_store.h"
#include "scheduler/report/peers.h"
#include "scheduler/report/report_data.h"

namespace penumbra {

/// One image to render.
struct CellPlan {
  CellId id;
  nlohmann::ordered_json settings;  ///< everything that image and times depend on
  RenderOptions options;
  std::string what;  ///< for people
};

/// cells[i][j]: budget i, seed j.
struct CurvePlan {
  CurveName name;
  std::vector<std::uint32_t> budgets;
  std::vector<std::vector<CellPlan>> cells;
};

struct ScenePlan {
  std::string name;
  std::filesystem::path file;
  PixelWindow window;  ///< the crop of the film that is rendered
  std::vector<CurvePlan> curves;
  std::vector<Peer> peers;
  std::string reference_quantity;                      ///< of a reference to render; else empty
  std::vector<CellPlan> reference_cells;               ///< two, or none
  std::vector<std::filesystem::path> reference_files;  ///< one or two, or none
};

/// Short unique names of scene files: the stem, with the folder's name or a number where stems are alike.
std::vector<std::string> scene_names(const std::vector<std::string>& files);

/// Seed of an image: a hash, so that no two images of a report share samples, whatever they have in common.
/// `role` tells curves from references.
std::uint32_t cell_seed(std::uint32_t base, const std::string& role, std::uint32_t spp, int index);

/// Reads every scene with every method. `worker_hash` stands for the program that renders: cells of another
/// one are not taken up. Errors, all of them of the input: a bad scene or setting, a method that a backend
/// cannot do, a reference or peer that is missing or of another size.
Expected<std::vector<ScenePlan>> plan_report(const ReportOptions& options, const CellStore& store,
                                             const std::string& worker_hash);

}  // namespace penumbra
