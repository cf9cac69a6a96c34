// Plans a report: lists and checks all images before rendering begins.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scheduler/report/cell_store.h"
#include "scheduler/report/peers.h"
#include "scheduler/report/report_data.h"
#include "scheduler/report/report_options.h"

namespace penumbra {

/// One image to render.
struct CellPlan {
  CellId id;
  nlohmann::ordered_json settings;  ///< everything on which the image and its times depend
  RenderOptions options;
  std::string what;  ///< for messages
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
  PixelWindow window;  ///< the crop window of the film
  std::vector<CurvePlan> curves;
  std::vector<Peer> peers;
  std::string reference_quantity;                      ///< of a reference that is rendered; else empty
  std::vector<CellPlan> reference_cells;               ///< two, or none
  std::vector<std::filesystem::path> reference_files;  ///< one or two, or none
};

/// Short unique names of scene files: the file name without its extension, made unique by the folder's name
/// or a number.
std::vector<std::string> scene_names(const std::vector<std::string>& files);

/// The seed of an image. It is a hash, so no two images of a report share samples. `role` distinguishes
/// curves from references.
std::uint32_t cell_seed(std::uint32_t base, const std::string& role, std::uint32_t spp, int index);

/// Reads every scene with every method. `worker_hash` identifies the program that renders; cells of another
/// one are not reused. All errors are errors of the input: an invalid scene or setting, a method that a
/// backend does not support, a reference or peer that is missing or has another size.
Expected<std::vector<ScenePlan>> plan_report(const ReportOptions& options, const CellStore& store,
                                             const std::string& worker_hash);

}  // namespace penumbra
