#include "gl/overlay_workers.h"

#include <fmt/format.h>

#include <algorithm>

#include "gl/overlay_text.h"
#include "gl/overlay_widgets.h"
#include "gl/worker_colors.h"
#include "kernels/host/text.h"

namespace penumbra {
namespace {

/// Filled while the worker has a tile.
void draw_color(const WorkerView& worker) {
  const float unit = overlay_unit(), line = ImGui::GetTextLineHeight();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec2 low{corner.x, corner.y + 0.5f * line - 5 * unit}, high{low.x + 10 * unit, low.y + 10 * unit};
  const ImU32 color = packed(worker_color(worker.number));
  if (worker.width > 0)
    ImGui::GetWindowDrawList()->AddRectFilled(low, high, color, 2 * unit);
  else
    ImGui::GetWindowDrawList()->AddRect(low, high, color, 2 * unit, 0, 1.5f * unit);
}

}  // namespace

void draw_workers(DisplaySettings& settings, const ViewStatus& status) {
  if (!section(fmt::format("Workers: {}###Workers", status.workers.size()).c_str())) return;
  ImGui::Checkbox("outline the tiles in hand", &settings.outlines);
  tooltip(with_key("Each worker's tile in its colour", Action::kToggleOutlines));
  if (status.workers.empty()) return wrapped(overlay_color::kDim, "none has come yet");
  const float unit = overlay_unit(), line = ImGui::GetTextLineHeight();
  constexpr int kLines = 9;
  const float height = line * float(std::min(std::size_t(kLines), 3 * status.workers.size())) + 2 * unit;
  constexpr ImGuiTableFlags kFlags = ImGuiTableFlags_ScrollY | ImGuiTableFlags_SizingFixedFit;
  if (!ImGui::BeginTable("workers", 3, kFlags, {0, height})) return;
  ImGui::TableSetupColumn("colour", 0, 12 * unit);
  ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch);
  ImGui::TableSetupColumn("units", 0, 48 * unit);
  for (const WorkerView& worker : status.workers) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    draw_color(worker);
    ImGui::TableNextColumn();
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
    wrapped(overlay_color::kText, worker.name);
    wrapped(overlay_color::kDim, worker.device);
    ImGui::PopStyleVar();
    tooltip(fmt::format("{} of work done, {}", counted(worker.units, "unit"),
                        worker.width > 0 ? fmt::format("{} × {} pixels at {}, {} in hand", worker.width,
                                                       worker.height, worker.x, worker.y)
                                         : "idle"));
    ImGui::TableNextColumn();
    const std::string units = count_text(double(worker.units));
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() +
                         std::max(0.0f, 46 * unit - ImGui::CalcTextSize(units.c_str()).x));
    ImGui::TextUnformatted(units.c_str());
  }
  ImGui::EndTable();
}

}  // namespace penumbra
