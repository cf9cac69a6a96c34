#include "scheduler/report/cell_store.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <nlohmann/json.hpp>

#include "kernels/host/atomic_file.h"
#include "kernels/host/plain_file.h"
#include "kernels/host/text.h"
#include "scheduler/image/image_files.h"
#include "scheduler/record/render_record.h"

namespace penumbra {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMaxCellBytes = std::uint64_t{16} << 20;
constexpr std::uint64_t kMaxImageBytes = std::uint64_t{16} << 30;

Json phases_json(const PhaseSeconds& seconds) {
  return {{"build", seconds.build},
          {"transfer", seconds.transfer},
          {"render", seconds.render},
          {"total", seconds.total}};
}

ImageResult result_from_json(const Json& json) {
  ImageResult result;
  const Json& seconds = json.at("seconds");
  result.seconds = {seconds.at("build"), seconds.at("transfer"), seconds.at("render"), seconds.at("total")};
  result.render_seconds = json.at("render_seconds").get<std::vector<double>>();
  result.seed = json.at("seed");
  result.load_before = json.at("load_average").at("before");
  result.load_after = json.at("load_average").at("after");
  result.film_hash = json.at("film_hash");
  result.bad_samples = json.at("bad_samples");
  return result;
}

}  // namespace

CellId make_cell_id(const std::string& name, const Json& settings) {
  const std::string text = settings.dump(-1, ' ', false, Json::error_handler_t::replace);
  CellId id;
  id.key = fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
  constexpr std::size_t kLongestName = 120;
  for (const char c : name.substr(0, kLongestName)) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '.' || c == '_';
    id.name += plain ? c : '_';
  }
  return id;
}

Expected<CellStore> CellStore::open(const std::filesystem::path& folder) {
  if (auto writable = check_writable(folder / "cell.json"); !writable)
    return std::unexpected(writable.error());
  return CellStore(folder);
}

std::filesystem::path CellStore::image_path(const CellId& id) const {
  return folder_ / (id.name + "." + id.key + ".exr");
}

std::filesystem::path CellStore::json_path(const CellId& id) const {
  return folder_ / (id.name + "." + id.key + ".json");
}

std::optional<ImageResult> CellStore::find(const CellId& id, std::string* damage) const {
  const auto damaged = [&](const std::filesystem::path& path, const char* what) {
    if (damage != nullptr) *damage = fmt::format("{} {}", path.string(), what);
    return std::nullopt;
  };
  const auto json_text = read_plain_file(json_path(id), kMaxCellBytes);
  if (!json_text) return std::nullopt;
  ImageResult result;
  std::string image_hash;
  try {
    const Json json = Json::parse(*json_text);
    if (make_cell_id(id.name, json.at("settings")).key != id.key)
      return damaged(json_path(id), "is of other settings");
    image_hash = json.at("image_hash");
    result = result_from_json(json);
  } catch (const Json::exception&) {
    return damaged(json_path(id), "is damaged, or of another version");
  }
  result.file = image_path(id);
  const auto image = read_plain_file(result.file, kMaxImageBytes);
  if (!image) return damaged(result.file, "is missing");
  if (hash_text(XXH3_64bits(image->data(), image->size())) != image_hash)
    return damaged(result.file, "is not the image that was rendered");
  return result;
}

Expected<void> CellStore::save(const CellId& id, const Image& image, const ImageResult& result,
                               const Json& settings) const {
  const auto exr = encode_exr(beauty_only(image));
  if (!exr) return std::unexpected(exr.error());
  if (auto made = make_folders(image_path(id)); !made) return made;
  if (auto written = write_file_atomically(image_path(id), *exr); !written) return written;
  const Json json = {{"settings", settings},
                     {"seed", result.seed},
                     {"seconds", phases_json(result.seconds)},
                     {"render_seconds", result.render_seconds},
                     {"load_average", {{"before", result.load_before}, {"after", result.load_after}}},
                     {"film_hash", result.film_hash},
                     {"image_hash", hash_text(XXH3_64bits(exr->data(), exr->size()))},
                     {"bad_samples", result.bad_samples}};
  const std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  return write_file_atomically(json_path(id), bytes_of(text));
}

Image beauty_only(const Image& image) {
  const auto channels = image.beauty_channels();
  if (!channels) return image;
  Image beauty{image.data, image.display, {"R", "G", "B"}, {}, image.metadata};
  beauty.values.reserve(image.pixels() * 3);
  for (std::size_t p = 0; p < image.pixels(); ++p) {
    for (const std::size_t c : *channels)
      beauty.values.push_back(image.values[p * image.channels.size() + c]);
  }
  return beauty;
}

}  // namespace penumbra
