#include "scheduler/record/render_record.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <climits>
#include <filesystem>

#include "kernels/host/text.h"
#include "scenes/number.h"
#include "scenes/settings.h"
#include "scheduler/files/quoting.h"
#include "scheduler/record/version.h"
#include "scheduler/render/frames.h"

namespace penumbra {
namespace {

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

MetadataValue recorded_value(const RenderOption& option, const std::vector<std::string>& values) {
  if (option.kind == OptionKind::kInteger) return integer_value(*parse_integer(values.front()));
  if (option.kind == OptionKind::kNumber && !option.recorded_as_text) return *parse_number(values.front());
  return fmt::format("{}", fmt::join(values, "\n"));
}

}  // namespace

std::string repeat_command(const RenderRecord& record, bool with_crop) {
  std::string command = "penumbra render " + shell_quoted_file(record.scene.file);
  for (const RenderOption& option : all_render_options()) {
    if (option.effect == OptionEffect::kNone || !option.counts_for(record)) continue;
    if (!with_crop && option.name() == "crop") continue;
    for (const std::string& value : option.setting ? option.setting(record) : given_values(option, record)) {
      command += " " + option.word();
      if (option.kind != OptionKind::kFlag) command += (option.is_flag() ? "=" : " ") + shell_quoted(value);
    }
  }
  return command;
}

std::vector<std::pair<std::string, MetadataValue>> record_entries(const RenderRecord& record) {
  std::vector<std::pair<std::string, MetadataValue>> entries;
  entries.emplace_back("scene", record.scene.file);
  entries.emplace_back("scene_hash", hash_text(record.scene_hash));
  for (const Setting& setting : all_settings()) {
    if (!setting.recorded || !setting.belongs_to(record) || (setting.matters && !setting.matters(record)))
      continue;
    entries.emplace_back(setting.option.empty() ? setting.key : setting.option,
                         recorded_value(setting, record));
  }
  for (const RenderOption& option : all_render_options())
    if (const auto values = option.print(record);
        option.effect == OptionEffect::kPixels && !values.empty() && option.counts_for(record))
      entries.emplace_back(option.record_name(), recorded_value(option, values));
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
  portable.scene.file = std::filesystem::path(record.scene.file).filename().string();
  std::vector<std::pair<std::string, MetadataValue>> metadata;
  metadata.emplace_back("penumbra:version", std::string(kVersion));
  metadata.emplace_back(rendered.repeatable() ? "penumbra:command" : "penumbra:nearest_command",
                        repeat_command(portable, true));
  for (const auto& [name, value] : record_entries(portable)) metadata.emplace_back("penumbra:" + name, value);
  if (record.scene.frame) metadata.emplace_back("penumbra:time", frame_seconds(record.scene));
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
