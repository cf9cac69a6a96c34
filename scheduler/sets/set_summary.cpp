#include "scheduler/sets/set_summary.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "kernels/host/atomic_file.h"
#include "kernels/host/text.h"
#include "scheduler/files/folder_locks.h"
#include "scheduler/files/json_number.h"
#include "scheduler/files/quoting.h"
#include "scheduler/run/progress.h"

namespace penumbra {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 6> kStateNames{"waiting",    "done",   "unchanged",
                                                      "incomplete", "failed", "not begun"};

std::filesystem::path folder_of_summary(const std::filesystem::path& summary) {
  return std::filesystem::absolute(summary).lexically_normal().parent_path();
}

/// Names of files below the summary's folder are relative to it, so that the folder may be moved.
std::vector<std::string> names_in(const std::filesystem::path& folder,
                                  const std::vector<std::string>& files) {
  std::vector<std::string> names;
  for (const std::string& file : files) {
    const std::filesystem::path relative = std::filesystem::path(file).lexically_relative(folder);
    names.push_back(relative.empty() || *relative.begin() == ".." ? file : relative.string());
  }
  return names;
}

Json json_of(const SetEntry& entry, const std::filesystem::path& folder) {
  Json json = {{"name", entry.name},
               {"scene", entry.scene},
               {"options", Json::object()},
               {"state", set_state_name(entry.state)},
               {"files", names_in(folder, entry.files)}};
  for (const auto& [name, value] : entry.choices) json["options"][name] = value;
  if (!entry.remade.empty()) json["remade"] = names_in(folder, entry.remade);
  if (!entry.key.empty()) json["key"] = entry.key;
  if (!entry.error.empty()) json["error"] = entry.error;
  if (entry.samples > 0) {
    json["samples_per_pixel"] = entry.samples;
    if (entry.budget_of > 0) {
      json["asked_samples_per_pixel"] = entry.budget_of;
      json["ended_by"] = "time_budget";
    }
    json["seconds"] = entry.seconds;
    json["relative_error"] = std::isfinite(entry.relative_error) ? Json(entry.relative_error) : Json(nullptr);
  }
  return json;
}

/// Throws the library's exceptions if the JSON is not valid.
SetEntry entry_of(const nlohmann::json& json, const std::filesystem::path& folder) {
  SetEntry entry;
  entry.name = json.value("name", "");
  entry.scene = json.at("scene").get<std::string>();
  const auto state = json.at("state").get<std::string>();
  const auto known = std::ranges::find(kStateNames, state);
  // A version of this program that has other states counts as if the render had not begun.
  if (known != kStateNames.end()) entry.state = SetState(known - kStateNames.begin());
  const auto paths_of = [&](const nlohmann::json& names) {
    auto paths = names.get<std::vector<std::string>>();
    for (std::string& path : paths) path = (folder / path).lexically_normal().string();
    return paths;
  };
  entry.files = paths_of(json.at("files"));
  entry.remade = paths_of(json.value("remade", nlohmann::json::array()));
  if (known != kStateNames.end()) entry.key = json.value("key", "");
  entry.error = json.value("error", "");
  for (const auto& [name, value] : json.value("options", nlohmann::json::object()).items())
    entry.choices.emplace_back(name, value.get<std::string>());
  entry.samples = json.value("samples_per_pixel", std::uint64_t(0));
  entry.budget_of = json.value("asked_samples_per_pixel", std::uint64_t(0));
  entry.seconds = json.value("seconds", 0.0);
  if (const auto error = json.find("relative_error"); error != json.end())
    entry.relative_error = error->is_number() ? error->get<double>() : std::nan("");
  return entry;
}

/// Whether it is finished and all its files exist or are remade.
bool is_there(const SetEntry& entry) {
  return !entry.key.empty() && std::ranges::all_of(entry.files, [&](const std::string& name) {
    std::error_code ignored;
    return std::filesystem::exists(name, ignored) ||
           std::ranges::find(entry.remade, name) != entry.remade.end();
  });
}

}  // namespace

std::string_view set_state_name(SetState state) { return kStateNames[std::size_t(state)]; }

Expected<void> write_set_summary(const std::filesystem::path& path, const std::vector<SetEntry>& entries) {
  Json json = {{"format", "penumbra jobs 1"}, {"jobs", Json::array()}};
  const std::filesystem::path folder = folder_of_summary(path);
  const FolderLocks lock({folder});
  std::set<std::vector<std::string>> here;
  for (const SetEntry& entry : entries) {
    json["jobs"].push_back(json_of(entry, folder));
    here.insert(entry.files);
  }
  for (const SetEntry& other : read_set_summary(path)) {
    const bool is_over =
        other.state == SetState::kFailed || other.state == SetState::kIncomplete || is_there(other);
    if (is_over && here.insert(other.files).second) json["earlier"].push_back(json_of(other, folder));
  }
  const std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  return write_output(path, bytes_of(text));
}

std::string set_table(const std::vector<SetEntry>& entries) {
  const std::vector<std::string> first{"name", "scene"};
  const std::vector<std::string> last{"state", "samples_per_pixel", "seconds", "relative_error", "file",
                                      "error"};
  std::vector<std::string> parameters;
  for (const SetEntry& entry : entries)
    for (const auto& [name, value] : entry.choices)
      if (std::ranges::find(parameters, name) == parameters.end()) parameters.push_back(name);
  std::vector<std::string> header = first;
  for (const std::string& name : parameters) {
    const bool is_taken =
        std::ranges::find(first, name) != first.end() || std::ranges::find(last, name) != last.end();
    header.push_back(csv_quoted(is_taken ? "parameter." + name : name));
  }
  header.insert(header.end(), last.begin(), last.end());
  std::string table = csv_line(header);
  const auto number = [](double value) {
    return std::isfinite(value) ? fmt::to_string(value) : std::string();
  };
  for (const SetEntry& entry : entries) {
    std::vector<std::string> line{csv_quoted(entry.name), csv_quoted(entry.scene)};
    for (const std::string& name : parameters) {
      const auto found = std::ranges::find(entry.choices, name, &std::pair<std::string, std::string>::first);
      line.push_back(found == entry.choices.end() ? std::string() : csv_quoted(found->second));
    }
    const bool has_samples = entry.samples > 0;
    line.insert(line.end(),
                {std::string(set_state_name(entry.state)), has_samples ? fmt::to_string(entry.samples) : "",
                 has_samples ? number(entry.seconds) : "", has_samples ? number(entry.relative_error) : "",
                 entry.files.empty() ? "" : csv_quoted(entry.files.front()),
                 csv_quoted(entry.error.substr(0, entry.error.find('\n')))});
    table += csv_line(line);
  }
  return table;
}

std::vector<SetEntry> read_set_summary(const std::filesystem::path& path) {
  std::ifstream file(path);
  const auto json = nlohmann::json::parse(file, nullptr, false);
  if (!json.is_object() || json.value("format", nlohmann::json()) != "penumbra jobs 1") return {};
  const std::filesystem::path folder = folder_of_summary(path);
  std::vector<SetEntry> entries;
  try {
    for (const char* list : {"jobs", "earlier"}) {
      if (!json.contains(list)) continue;
      for (const nlohmann::json& job : json.at(list)) entries.push_back(entry_of(job, folder));
    }
  } catch (const nlohmann::json::exception&) {
    return {};  // not written by this program
  }
  return entries;
}

EarlierRenders EarlierRenders::read(const std::filesystem::path& path) {
  EarlierRenders finished;
  for (SetEntry& entry : read_set_summary(path))
    if (is_there(entry)) finished.entries_.emplace(entry.files, std::move(entry));
  return finished;
}

std::optional<SetEntry> EarlierRenders::take(const std::vector<std::string>& files) {
  auto found = entries_.extract(files);
  if (!found) return std::nullopt;
  return std::move(found.mapped());
}

std::vector<SetEntry> EarlierRenders::rest() && {
  std::vector<SetEntry> rest;
  for (auto& [files, entry] : entries_) rest.push_back(std::move(entry));
  return rest;
}

std::string set_line(const SetEntry& entry, std::size_t ended, std::size_t all, std::size_t widest) {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  std::string line =
      fmt::format("{:%H:%M:%S}  {:>{}} of {}  {:{}}  {:10}", local, ended, fmt::formatted_size("{}", all),
                  all, entry.name, widest, set_state_name(entry.state));
  if (entry.samples > 0) line += fmt::format("  {:>6} spp  {:8.2f} s", entry.samples, entry.seconds);
  if (entry.samples > 0 && std::isfinite(entry.relative_error))
    line += fmt::format("  error {:.2g}%", 100 * entry.relative_error);
  if (entry.budget_of > 0) line += fmt::format("  ended by the budget, of {} spp", entry.budget_of);
  if (!entry.error.empty()) line += "  " + entry.error.substr(0, entry.error.find('\n'));
  return line + "\n";
}

std::string set_totals(const std::vector<SetEntry>& entries, double seconds) {
  std::string text = counted(entries.size(), "render") + ":";
  for (const SetState state :
       {SetState::kDone, SetState::kUnchanged, SetState::kIncomplete, SetState::kFailed, SetState::kNotBegun})
    if (const auto count = std::ranges::count(entries, state, &SetEntry::state); count > 0)
      text += fmt::format(" {} {},", count, set_state_name(state));
  return fmt::format("{} in {}\n", text, clock_text(seconds));
}

}  // namespace penumbra
