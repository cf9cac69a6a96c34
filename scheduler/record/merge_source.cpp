#include "scheduler/record/merge_source.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <climits>
#include <map>
#include <set>
#include <tuple>

#include "scenes/names.h"
#include "scenes/number.h"
#include "scenes/settings.h"
#include "scheduler/render/render_option.h"

namespace penumbra {
namespace {

constexpr std::string_view kPrefix = "penumbra:";
constexpr const char *kSeeds = "penumbra:seeds", *kMerged = "penumbra:merged";

/// Metadata in which images of one scene and settings may differ, beside the options of a render.
constexpr std::string_view kOfOneRender[] = {"seed",
                                             "film.layers",
                                             "seeds",
                                             "merged",
                                             "spp",
                                             "command",
                                             "nearest_command",
                                             "film_hash",
                                             "samples_per_pixel",
                                             "incomplete",
                                             "rendered_by",
                                             "film.compression",
                                             "film.component_format",
                                             "film.denoise",
                                             "scene",
                                             "scene_warnings"};

bool may_differ(std::string_view key) {
  return std::ranges::find(kOfOneRender, key) != std::end(kOfOneRender) ||
         (key != "defines" && std::ranges::any_of(all_render_options(), [key](const RenderOption& option) {
            return option.effect == OptionEffect::kPixels && option.record_name() == key;
          }));
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

/// Whether images tell the setting's value elsewhere: in an entry of its own, or as size of the film or crop.
bool is_told(const Setting& setting) {
  return setting.recorded || setting.key == "film.width" || setting.key == "film.height" ||
         setting.key.starts_with("film.crop_");
}

/// What --set gives to other settings, such as those of the camera.
std::vector<std::string> unrecorded_settings(const Image& image) {
  std::vector<std::string> lines = lines_of(metadata_text(image, "penumbra:set"));
  std::erase_if(lines, [](const std::string& line) {
    const Setting* setting = find_setting(to_snake_case(line.substr(0, line.find('='))));
    return setting != nullptr && is_told(*setting);
  });
  return lines;
}

/// The entries in which two images of the same render with other seeds agree.
std::map<std::string, std::string> settings_of(const Image& image) {
  std::map<std::string, std::string> settings;
  // The samples of a pass share a photon map, whose radius follows from how many there were before.
  const bool has_maps = metadata_text(image, "penumbra:integrator") == "ppm";
  for (const auto& [name, value] : image.metadata) {
    if (!name.starts_with(kPrefix)) continue;
    const std::string key = name.substr(kPrefix.size());
    if (!may_differ(key) || (has_maps && key == "samples_per_pass"))
      settings[key] = metadata_text(image, name);
  }
  if (const auto set = unrecorded_settings(image); !set.empty())
    settings["set"] = fmt::format("{}", fmt::join(set, " "));
  return settings;
}

std::string window_text(const PixelWindow& w) {
  return fmt::format("{} x {} pixels at ({}, {})", w.width, w.height, w.x, w.y);
}

/// In what the images differ; empty: in nothing that matters.
std::string difference(const MergeSource& a, const MergeSource& b) {
  const Image &left = a.header, &right = b.header;
  const auto differ = [&](const std::string& what, const std::string& of_a, const std::string& of_b) {
    return fmt::format("{}: {} has {}, {} has {}", what, a.file.string(), of_a, b.file.string(), of_b);
  };
  auto of_a = settings_of(left), of_b = settings_of(right);
  if (of_a["scene_hash"] != of_b["scene_hash"])
    return differ("content of the scene (scene_hash)", of_a["scene_hash"], of_b["scene_hash"]);
  if (left.display != right.display)
    return differ("size of the film", window_text(left.display), window_text(right.display));
  if (left.data != right.data) return differ("crop", window_text(left.data), window_text(right.data));
  for (const auto& [name, value] : of_a) of_b.try_emplace(name);
  for (const auto& [name, value] : of_b) {
    const std::string& other = of_a[name];
    if (other != value) return differ(name, other.empty() ? "none" : other, value.empty() ? "none" : value);
  }
  for (const auto& [name, value] : left.metadata)
    if (name.starts_with("cryptomatte/") && right.attribute(name) && right.attribute(name) != value)
      return differ("names of Cryptomatte", "other ones", "these");
  if (left.camera != right.camera) return differ("camera", "another one", "this one");
  return {};
}

MetadataValue whole_number_value(double value) {
  return value <= INT_MAX ? MetadataValue(int(value)) : value;
}

Expected<std::vector<MergedRender>> renders_of(const Image& header) {
  const bool is_merged = header.attribute(kSeeds).has_value();
  const auto seeds = parse_numbers(metadata_text(header, is_merged ? kSeeds : "penumbra:seed"));
  std::vector<std::string> commands = lines_of(metadata_text(header, kMerged));
  if (!is_merged) {
    const std::string command = metadata_text(header, "penumbra:command");
    commands = {command.empty() ? metadata_text(header, "penumbra:nearest_command") : command};
  }
  if (!seeds || seeds->empty() || commands.size() != seeds->size())
    return fail(fmt::format("has no metadata {}, which a render writes",
                            is_merged ? "penumbra:merged for its seeds" : "penumbra:seed"));
  std::vector<MergedRender> renders;
  for (std::size_t i = 0; i < seeds->size(); ++i) {
    const double seed = (*seeds)[i];
    if (!(seed >= 0 && seed <= kMaxSeed)) return fail(fmt::format("has the seed {}, which is none", seed));
    renders.push_back({std::uint32_t(seed), commands[i]});
  }
  std::ranges::sort(renders);
  return renders;
}

}  // namespace

Expected<MergeSource> merge_source(const std::filesystem::path& file, Image header) {
  const auto refuse = [&](const std::string& why) { return fail(fmt::format("{} {}", file.string(), why)); };
  if (header.attribute("penumbra:denoised_by"))
    return refuse("is denoised: its pixels are not means of samples; merge the images before denoising them");
  std::vector<std::string> missing;
  for (const char* layer : {"", "variance."})
    for (const char* letter : {"R", "G", "B"})
      if (const std::string name = std::string(layer) + letter; !header.channel(name))
        missing.push_back(name);
  if (!header.channel("samples.Y")) missing.emplace_back("samples.Y");
  if (!missing.empty())
    return refuse(fmt::format(
        "cannot be merged without the {} {}: merging takes the EXR files of `penumbra render`, which hold "
        "number and variance of samples",
        missing.size() == 1 ? "channel" : "channels", fmt::join(missing, ", ")));
  if (metadata_text(header, "penumbra:scene_hash").empty())
    return refuse("has no metadata penumbra:scene_hash, which tells what scene it is of");
  auto renders = renders_of(header);
  if (!renders) return refuse(renders.error().message);
  const auto spp = parse_number(metadata_text(header, "penumbra:spp"));
  if (!spp || !(*spp > 0)) return refuse("has no metadata penumbra:spp, which a render writes");
  return MergeSource{file, std::move(header), std::move(*renders), *spp};
}

Expected<void> check_sources(std::vector<MergeSource>& sources) {
  if (sources.size() < 2) return fail("merging takes two images or more");
  std::ranges::sort(sources, {}, [](const MergeSource& s) { return std::tie(s.renders, s.file); });
  for (const MergeSource& source : sources)
    if (const std::string what = difference(sources.front(), source); !what.empty())
      return fail("the images are not of the same render with other seeds, but differ in " + what);
  std::map<std::uint32_t, const MergeSource*> by_seed;
  for (const MergeSource& source : sources)
    for (const MergedRender& render : source.renders) {
      const auto [other, is_new] = by_seed.emplace(render.seed, &source);
      if (!is_new)
        return fail(
            fmt::format("{} and {} both have the samples of seed {}; render one of them with another "
                        "--seed",
                        other->second->file.string(), source.file.string(), render.seed));
    }
  return {};
}

std::vector<MergedRender> all_renders(const std::vector<MergeSource>& sources) {
  std::vector<MergedRender> all;
  for (const MergeSource& source : sources)
    all.insert(all.end(), source.renders.begin(), source.renders.end());
  std::ranges::sort(all);
  return all;
}

std::string seeds_text(const std::vector<MergedRender>& renders) {
  std::vector<std::uint32_t> seeds;
  for (const MergedRender& render : renders) seeds.push_back(render.seed);
  return fmt::format("{}", fmt::join(seeds, ", "));
}

std::vector<std::pair<std::string, MetadataValue>> merged_metadata(const std::vector<MergeSource>& sources) {
  static const std::set<std::string, std::less<>> replaced = {
      "penumbra:seed",      "penumbra:seeds",      "penumbra:merged",
      "penumbra:spp",       "penumbra:command",    "penumbra:nearest_command",
      "penumbra:film_hash", "penumbra:incomplete", "penumbra:samples_per_pixel"};
  std::vector<std::pair<std::string, MetadataValue>> metadata;
  for (const auto& [name, value] : sources.front().header.metadata) {
    const bool is_common =
        std::ranges::all_of(sources, [&](const MergeSource& s) { return s.header.attribute(name) == value; });
    if (is_common && !describes_file(name) && !replaced.contains(name)) metadata.emplace_back(name, value);
  }
  const std::vector<MergedRender> renders = all_renders(sources);
  std::vector<std::string> commands;
  for (const MergedRender& render : renders) commands.push_back(render.command);
  double spp = 0;
  bool is_incomplete = false;
  for (const MergeSource& source : sources) {
    spp += source.weight;
    is_incomplete = is_incomplete || source.header.attribute("penumbra:incomplete");
  }
  metadata.emplace_back(kSeeds, seeds_text(renders));
  metadata.emplace_back(kMerged, fmt::format("{}", fmt::join(commands, "\n")));
  metadata.emplace_back("penumbra:spp", whole_number_value(spp));
  if (is_incomplete) metadata.emplace_back("penumbra:incomplete", 1);
  return metadata;
}

}  // namespace penumbra
