#include "scheduler/record/render_record.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <climits>
#include <filesystem>

#include "scenes/number.h"
#include "scenes/settings.h"
#include "scheduler/files/quoting.h"
#include "scheduler/record/version.h"

namespace penumbra {
namespace {

bool has_crop(const Film& film) {
  return film.crop_x != 0 || film.crop_y != 0 || film.crop_width != film.width ||
         film.crop_height != film.height;
}

/// The format's int if the value fits, else a double, which represents unsigned 32-bit values exactly.
MetadataValue integer_value(std::int64_t value) {
  if (value >= INT_MIN && value <= INT_MAX) return int(value);
  return double(value);
}

/// The format's float if that is the same number, which holds for settings stored as float.
MetadataValue number_value(const std::string& text) {
  const double value = *parse_number(text);
  if (fmt::to_string(float(value)) == text) return float(value);
  return value;
}

/// Numbers are recorded as numbers.
MetadataValue recorded_value(const Setting& setting, const RenderRecord& record) {
  const std::string text = setting.print(record);
  if (setting.kind == SettingKind::kInteger) return integer_value(*parse_integer(text));
  if (setting.kind == SettingKind::kNumber) return number_value(text);
  return text;
}

}  // namespace

std::string hash_text(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

std::string repeat_command(const RenderRecord& record, bool with_crop) {
  std::string command = "penumbra render " + shell_quoted_file(record.scene);
  const auto add = [&](const std::string& option, const std::string& value) {
    command += " " + option + " " + shell_quoted(value);
  };
  for (const std::string& define : record.defines) add("-D", define);
  for (const std::string& setting : record.settings) add("--set", setting);
  if (record.scale) add("--scale", fmt::to_string(*record.scale));
  if (record.lenient) command += " --lenient";
  if (!record.dialect.empty()) add("--dialect", record.dialect);
  for (const Setting& setting : all_settings()) {
    if (setting.option.empty()) continue;
    add("--" + setting.option, setting.print(record));
  }
  visit_options(record.plan, [&](const char*, const std::string& option, auto value) {
    command += " " + option + (std::is_same_v<decltype(value), bool> ? "" : " " + fmt::to_string(value));
  });
  add("--intersector", record.embree ? "embree" : "portable");
  if (!record.isa.empty()) add("--isa", record.isa);
  if (record.backend != Backend::kNative) add("--backend", std::string(backend_name(record.backend)));
  if (!record.feature_layers) command += " --no-features";
  if (record.cryptomatte) command += " --cryptomatte";
  if (record.film.denoise != Denoise::kOff) command += " --denoise=" + print_setting(record, "film.denoise");
  if (!record.film.layers.empty()) add("--layers", print_setting(record, "film.layers"));
  const Film& film = record.film;
  if (with_crop && has_crop(film)) {
    add("--crop", fmt::format("{},{},{},{}", film.crop_x, film.crop_y, film.crop_x + film.crop_width,
                              film.crop_y + film.crop_height));
  }
  return command;
}

std::vector<std::pair<std::string, MetadataValue>> record_entries(const RenderRecord& record) {
  std::vector<std::pair<std::string, MetadataValue>> entries;
  const auto text = [&](const char* name, std::string_view value) {
    entries.emplace_back(name, std::string(value));
  };
  text("scene", record.scene);
  text("scene_hash", hash_text(record.scene_hash));
  for (const Setting& setting : all_settings()) {
    if (!setting.recorded || !setting.belongs_to(record) || (setting.matters && !setting.matters(record)))
      continue;
    entries.emplace_back(setting.option.empty() ? setting.key : setting.option,
                         recorded_value(setting, record));
  }
  visit_options(record.plan, [&](const char* name, const char*, auto value) {
    if constexpr (std::is_integral_v<decltype(value)> && sizeof(value) == sizeof(int))
      entries.emplace_back(name, integer_value(value));
    else
      entries.emplace_back(name, fmt::to_string(value));
  });
  text("intersector", record.embree ? "embree" : "portable");
  text("backend", std::string(backend_name(record.backend)));
  if (!record.isa.empty()) text("isa", record.isa);
  if (!record.defines.empty()) text("defines", fmt::format("{}", fmt::join(record.defines, "\n")));
  if (record.scale) entries.emplace_back("scale", *record.scale);
  if (!record.settings.empty()) text("set", fmt::format("{}", fmt::join(record.settings, "\n")));
  return entries;
}

RenderRecord record_of_rendered(RenderRecord record, const RenderedSamples& rendered) {
  // With gaps, counts do not determine which samples there are.
  if (rendered.has_gaps || rendered.ended_by_tile || rendered.most == 0) return record;
  if (rendered.least != rendered.most && rendered.units_in_order) {
    record.plan.stop_after_units = rendered.units_in_order;
    return record;
  }
  record.plan.stop_after_units.reset();  // with equally many samples per pixel the tile size does not matter
  if (rendered.most < record.sampler.spp) record.plan.stop_after = std::uint32_t(rendered.most);
  return record;
}

std::vector<std::pair<std::string, MetadataValue>> record_metadata(const RenderRecord& record,
                                                                   std::uint64_t film_hash,
                                                                   const RenderedSamples& rendered) {
  RenderRecord portable = record;
  portable.scene = std::filesystem::path(record.scene).filename().string();
  std::vector<std::pair<std::string, MetadataValue>> metadata;
  metadata.emplace_back("penumbra:version", std::string(kVersion));
  metadata.emplace_back(rendered.repeatable() ? "penumbra:command" : "penumbra:nearest_command",
                        repeat_command(portable, true));
  for (const auto& [name, value] : record_entries(portable)) metadata.emplace_back("penumbra:" + name, value);
  metadata.emplace_back("penumbra:film.width", record.film.width);
  metadata.emplace_back("penumbra:film.height", record.film.height);
  if (!rendered.backends.empty())
    metadata.emplace_back("penumbra:rendered_by", std::string(rendered.backends));
  metadata.emplace_back("penumbra:film_hash", hash_text(film_hash));
  if (rendered.scene_warnings > 0)
    metadata.emplace_back("penumbra:scene_warnings", int(rendered.scene_warnings));
  if (!rendered.complete) metadata.emplace_back("penumbra:incomplete", 1);
  if (!rendered.repeatable()) {
    metadata.emplace_back("penumbra:samples_per_pixel",
                          fmt::format("{} to {}", rendered.least, rendered.most));
  }
  return metadata;
}

}  // namespace penumbra
