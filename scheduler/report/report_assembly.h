// Assembles a report from finished cells: numbers, pictures and files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scheduler/report/report_plan.h"

namespace penumbra {

/// Computes a scene's reference, curves and crops, but no plots. Missing cells are left out, with a remark.
/// Returns nothing if the reference is missing. `missing` is increased by the number of missing cells and
/// references. Errors: an image cannot be read any more.
Expected<std::optional<SceneReport>> assemble_scene(const ReportOptions& options, const ScenePlan& plan,
                                                    const CellStore& store, const ReportData& report,
                                                    std::size_t& missing);

}  // namespace penumbra
