// From finished cells to the report's numbers, pictures and files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scheduler/cli/report_plan.h"

namespace penumbra {

/// Of a scene: its reference, curves, crops; no plots yet. Cells that are missing are left out, with a
/// remark. Nothing where the reference is missing. `missing` grows by the cells, and the references, that are
/// not there. Errors: an image that cannot be read any more.
Expected<std::optional<SceneReport>> assemble_scene(const ReportOptions& options, const ScenePlan& plan,
                                                    const CellStore& store, const ReportData& report,
                                                    std::size_t& missing);

}  // namespace penumbra
