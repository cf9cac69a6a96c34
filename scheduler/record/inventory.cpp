#include "scheduler/record/inventory.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "kernels/host/device_scene.h"

namespace penumbra {
namespace {

using Json = nlohmann::ordered_json;

Json cost_json(const Cost& cost) {
  return {{"own", cost.own}, {"everything", cost.everything ? Json(*cost.everything) : Json(nullptr)}};
}

Cost scaled(Cost cost, std::uint64_t factor) {
  cost.own *= factor;
  if (cost.everything) *cost.everything *= factor;
  return cost;
}

Json native_json(const NativeCode& native) { return {{"isa", native.isa}, {"code_bytes", native.bytes}}; }

Json opencl_json(const CompileTimes& times) {
  return {{"device", times.device},
          {"compile_seconds", {{"own", times.own_seconds}, {"everything", times.everything_seconds}}},
          {"saved_seconds", times.everything_seconds - times.own_seconds}};
}

std::string row(const std::string& name, const std::string& own, const std::string& everything) {
  return fmt::format("  {:<40} {:>12} {:>12}\n", name, own, everything);
}

std::string row(const std::string& name, const Cost& cost) {
  return row(name, fmt::to_string(cost.own), cost.everything ? fmt::to_string(*cost.everything) : "?");
}

}  // namespace

Json inventory_json(const SceneInventory& inventory) {
  Json used = Json::array(), left_out = Json::array(), tables = Json::object();
  for (const FeatureUse& feature : inventory.feature_uses)
    (feature.used ? used : left_out)
        .push_back(Json{{"name", feature.name}, {"description", feature.description}});
  for (const TableCost& table : inventory.tables) tables[table.name] = cost_json(table.bytes);
  return {{"feature_bits", inventory.features},
          {"used", used},
          {"left_out", left_out},
          {"bytes",
           {{"device_scene", cost_json(inventory.device_scene)},
            {"tables", tables},
            {"path_state", cost_json(inventory.path_state)},
            {"block_state", cost_json(scaled(inventory.path_state, kBlockPaths))},
            {"result_per_pixel", cost_json(inventory.result)}}},
          {"native", inventory.native ? native_json(*inventory.native) : Json(nullptr)},
          {"opencl", inventory.opencl ? opencl_json(*inventory.opencl) : Json(nullptr)}};
}

std::string inventory_text(const SceneInventory& inventory) {
  std::string text = row("Bytes", "as it is", "everything");
  text.replace(0, 7, "Bytes  ");
  text += row("device scene, as shipped", inventory.device_scene);
  for (const TableCost& table : inventory.tables)
    if (table.bytes.own != 0 || table.bytes.everything != std::optional<std::uint64_t>(0))
      text += row("  " + table.name, table.bytes);
  text += row("state of a path", inventory.path_state);
  text += row(fmt::format("state of a block of {} paths", kBlockPaths),
              scaled(inventory.path_state, kBlockPaths));
  text += row("result, for each pixel of a unit", inventory.result);
  if (const auto& native = inventory.native)
    text += row(fmt::format("native kernels, {}", native->isa), {native->bytes, native->bytes});
  if (const auto& times = inventory.opencl) {
    text += fmt::format("\nSeconds, on {}\n", times->device);
    text += row("compiling OpenCL kernels, measured", fmt::format("{:.2f}", times->own_seconds),
                fmt::format("{:.2f}", times->everything_seconds));
  }
  return text;
}

}  // namespace penumbra
