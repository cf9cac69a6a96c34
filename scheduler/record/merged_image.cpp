#include "scheduler/record/merged_image.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "kernels/host/sample_buffer.h"
#include "kernels/host/text.h"
#include "scenes/number.h"
#include "scheduler/record/cryptomatte.h"
#include "scheduler/record/film_image.h"

namespace penumbra {
namespace {

constexpr std::size_t kMatteLayers = 2, kValuesOfMatteLayer = 2 * kCryptomatteRanks;
// Coverage is stored as float: what it lacks to 1, or to a whole number of samples, is rounding below this.
constexpr double kCoverageRounding = 1e-4;
constexpr double kMostSamples = 0x1p53;  // up to here all whole numbers are numbers

/// The name of the mean of which the channel is the variance; empty: it is no variance.
std::string mean_of_variance(const std::string& channel) {
  const auto [layer, letter] = split_channel(channel);
  if (layer == "variance") return std::string(letter);
  constexpr std::string_view kEnding = "_variance";
  if (!layer.ends_with(kEnding)) return {};
  return fmt::format("{}.{}", layer.substr(0, layer.size() - kEnding.size()), letter);
}

/// Whether the channel is a mean of samples in the images of film_image.h.
bool is_mean(const std::string& channel) {
  if (channel == "R" || channel == "G" || channel == "B") return true;
  const auto [layer, letter] = split_channel(channel);
  return std::ranges::any_of(kFilmLayers, [&](const FilmLayerInfo& each) {
    return each.name == layer && each.channels.find(letter) != std::string_view::npos;
  });
}

bool is_on_target_error(const MergeSource& source) {
  return std::ranges::any_of(source.renders, [](const MergedRender& render) {
    return render.command.find(" --target-error ") != std::string::npos;
  });
}

/// Merged images no longer tell how many samples share a map; their halves are equal.
std::uint32_t samples_per_map(const MergeSource& source) {
  if (metadata_text(source.header, "penumbra:integrator") != "ppm") return 1;
  const auto pass = parse_integer(metadata_text(source.header, "penumbra:samples_per_pass"), 1, UINT32_MAX);
  return pass ? std::uint32_t(*pass) : 1;
}

}  // namespace

double samples_of_half_a(std::uint64_t samples, std::uint32_t samples_per_map) {
  const auto is_in_a = [](std::uint64_t map) { return std::popcount(map) % 2 == 0; };
  const std::uint64_t maps = samples / samples_per_map, rest = samples % samples_per_map;
  std::uint64_t whole_in_a = maps / 2;  // each aligned pair has one
  if (maps % 2 == 1 && is_in_a(maps - 1)) ++whole_in_a;
  return double(whole_in_a * samples_per_map + (is_in_a(maps) ? rest : 0));
}

ImageMerge::ImageMerge(const std::vector<MergeSource>& sources)
    : sources_(sources), by_samples_(std::ranges::none_of(sources, is_on_target_error)) {
  choose_channels();
  const std::size_t pixels = sources.front().header.pixels();
  values_.resize(pixels * (channels_.size() - mattes_));
  pixels_.resize(pixels);
  if (mattes_ > 0) coverage_.resize(pixels * kMatteLayers);
}

void ImageMerge::choose_channels() {
  std::vector<std::string> common;
  for (const MergeSource& source : sources_)
    for (const std::string& name : source.header.channels) {
      const bool in_all = std::ranges::all_of(
          sources_, [&](const MergeSource& s) { return s.header.channel(name).has_value(); });
      std::vector<std::string>& names = in_all ? common : left_out_;
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  std::ranges::sort(common);
  const auto index_of = [&](const std::string& name) -> std::optional<std::size_t> {
    const auto found = std::ranges::find(channels_, name, &Channel::name);
    return found == channels_.end() ? std::nullopt : std::optional(std::size_t(found - channels_.begin()));
  };
  const std::vector<std::string> matte_channels = cryptomatte_channels();
  const bool has_mattes = std::ranges::all_of(matte_channels, [&](const std::string& name) {
    return std::ranges::find(common, name) != common.end();
  });
  for (const std::string& name : common) {
    const std::string_view layer = split_channel(name).layer;
    if (name == "samples.Y")
      channels_.push_back({name, Kind::kSamples});
    else if (layer == "half_a")
      channels_.push_back({name, Kind::kHalfA});
    else if (layer == "half_b")
      channels_.push_back({name, Kind::kHalfB});
    else if (layer == kFilmLayers[LAYER_SHAPE].name)
      channels_.push_back({name, Kind::kFirst});  // of IDs there is no mean
    else if (mean_of_variance(name).empty() && is_mean(name))
      channels_.push_back({name, Kind::kMean});
  }
  for (const std::string& name : common) {
    const std::string of = mean_of_variance(name);
    if (const auto mean = of.empty() ? std::nullopt : index_of(of))
      channels_.push_back({name, Kind::kVariance, *mean});
    else if (!index_of(name) &&
             !(has_mattes && std::ranges::find(matte_channels, name) != matte_channels.end()))
      left_out_.push_back(name);
  }
  if (!has_mattes) return;
  for (const std::string& name : matte_channels) channels_.push_back({name, Kind::kMatte});
  mattes_ = matte_channels.size();
}

Expected<void> ImageMerge::add(const MergeSource& source, const Image& image) {
  if (image.data != source.header.data || image.channels != source.header.channels)
    return fail(fmt::format("{} has changed while it was read", source.file.string()));
  std::vector<std::size_t> from;
  for (const Channel& channel : channels_) from.push_back(*image.channel(channel.name));
  if (auto checked = check_values(source.file.string(), image, from); !checked) return checked;
  const std::size_t samples = *image.channel("samples.Y");
  const std::uint32_t per_map = samples_per_map(source);
  std::vector<float> values(channels_.size());
  for (std::size_t at = 0; at < pixels_.size(); ++at) {
    const float* pixel = &image.values[at * image.channels.size()];
    const double n = pixel[samples];
    if (n < 1) continue;
    for (std::size_t c = 0; c < channels_.size(); ++c) values[c] = pixel[from[c]];
    const double share_of_a =
        source.renders.size() > 1 ? 0.5 : samples_of_half_a(std::uint64_t(n), per_map) / n;
    add_pixel(at, values, by_samples_ ? n : source.weight, share_of_a);
    pixels_[at].samples += n;
  }
  return {};
}

Expected<void> ImageMerge::check_values(const std::string& name, const Image& image,
                                        std::span<const std::size_t> from) const {
  const std::size_t stored = channels_.size() - mattes_;
  // IDs, of shapes and in the first of each two channels of Cryptomatte, are no numbers.
  const auto is_right = [&](std::size_t c, float value) {
    const Kind kind = channels_[c].kind;
    if (kind == Kind::kFirst || (kind == Kind::kMatte && (c - stored) % 2 == 0)) return true;
    if (kind == Kind::kSamples) return value >= 0 && value <= kMostSamples;
    return std::isfinite(value) && (value >= 0 || kind != Kind::kVariance);
  };
  std::uint64_t pixels = 0;
  std::string first;
  for (std::size_t at = 0; at < pixels_.size(); ++at) {
    const float* pixel = &image.values[at * image.channels.size()];
    for (std::size_t c = 0; c < from.size(); ++c) {
      if (is_right(c, pixel[from[c]])) continue;
      if (pixels++ == 0)
        first =
            fmt::format("{} is {} at pixel {}, {}", channels_[c].name, pixel[from[c]],
                        image.data.x + int(at) % image.data.width, image.data.y + int(at) / image.data.width);
      break;
    }
  }
  if (pixels == 0) return {};
  return fail(
      fmt::format("{} has {} with values that no render has (NaN, infinite, negative variance); the "
                  "first: {}",
                  name, counted(pixels, "pixel"), first));
}

void ImageMerge::add_pixel(std::size_t at, std::span<const float> values, double weight, double share_of_a) {
  Pixel& pixel = pixels_[at];
  const std::size_t stored = channels_.size() - mattes_;
  double* merged = &values_[at * stored];
  const double before = pixel.weight;
  pixel.weight += weight;
  const auto merge_mean = [](double& mean, double value, double& sum, double more) {
    sum += more;
    if (more > 0) mean += (value - mean) * (more / sum);
  };
  // Variances first: they need the means as they were.
  for (std::size_t c = 0; c < stored; ++c) {
    if (channels_[c].kind != Kind::kVariance) continue;
    const double variance = values[c];
    if (!by_samples_) {
      merged[c] += weight * weight * variance;
      continue;
    }
    const std::size_t mean = channels_[c].mean;
    const double difference = double(values[mean]) - merged[mean];
    const double m2 = weight < 2 ? 0 : variance * weight * (weight - 1);
    merged[c] += m2 + difference * difference * (before * (weight / pixel.weight));
  }
  double half_a = pixel.half_a, half_b = pixel.half_b;
  for (std::size_t c = 0; c < stored; ++c) {
    half_a = pixel.half_a;
    half_b = pixel.half_b;
    double all = before;
    if (channels_[c].kind == Kind::kMean) merge_mean(merged[c], values[c], all, weight);
    if (channels_[c].kind == Kind::kFirst && before == 0 && weight > 0) merged[c] = values[c];
    if (channels_[c].kind == Kind::kHalfA) merge_mean(merged[c], values[c], half_a, weight * share_of_a);
    if (channels_[c].kind == Kind::kHalfB)
      merge_mean(merged[c], values[c], half_b, weight * (1 - share_of_a));
  }
  pixel.half_a += weight * share_of_a;
  pixel.half_b += weight * (1 - share_of_a);
  if (mattes_ > 0) add_mattes(at, values.subspan(stored), weight);
}

void ImageMerge::add_mattes(std::size_t at, std::span<const float> values, double weight) {
  bool is_full = false;
  for (std::size_t layer = 0; layer < kMatteLayers; ++layer) {
    const float* rank = &values[layer * kValuesOfMatteLayer];
    double sum = 0;
    int ranks = 0;
    for (int k = 0; k < kCryptomatteRanks; ++k, rank += 2) {
      if (!(rank[1] > 0)) continue;
      ++ranks;
      sum += rank[1];
      const double product = weight * rank[1], whole = std::round(product);
      const bool is_whole =
          by_samples_ && std::abs(product - whole) < kCoverageRounding * std::max(1.0, whole);
      coverage_[at * kMatteLayers + layer][std::bit_cast<std::uint32_t>(rank[0])] +=
          is_whole ? whole : product;
    }
    is_full = is_full || (ranks == kCryptomatteRanks && sum < 1 - kCoverageRounding);
  }
  full_pixels_ += is_full ? 1 : 0;
}

void ImageMerge::append_mattes(std::size_t at, std::vector<float>& values) const {
  for (std::size_t layer = 0; layer < kMatteLayers; ++layer) {
    const Coverage& coverage = coverage_[at * kMatteLayers + layer];
    std::vector<std::pair<double, std::uint32_t>> ranks;  // sorted by falling coverage, then by ID
    for (const auto& [id, sum] : coverage) ranks.emplace_back(-sum, id);
    std::ranges::sort(ranks);
    for (std::size_t k = 0; k < std::size_t(kCryptomatteRanks); ++k) {
      const bool is_there = k < ranks.size();
      values.push_back(is_there ? std::bit_cast<float>(ranks[k].second) : 0.0f);
      values.push_back(is_there ? float(-ranks[k].first / pixels_[at].weight) : 0.0f);
    }
  }
}

float ImageMerge::value_of(std::size_t at, std::size_t channel) const {
  const Pixel& pixel = pixels_[at];
  const double value = values_[at * (channels_.size() - mattes_) + channel];
  if (channels_[channel].kind == Kind::kSamples) return float(pixel.samples);
  if (channels_[channel].kind != Kind::kVariance) return float(value);
  if (by_samples_) return float(variance_of_mean(std::uint64_t(pixel.samples), value));
  return pixel.weight > 0 ? float(value / (pixel.weight * pixel.weight)) : 0.0f;
}

Expected<Image> ImageMerge::image() const {
  const Image& first = sources_.front().header;
  Image image;
  image.data = first.data;
  image.display = first.display;
  image.chromaticities = first.chromaticities;
  image.camera = first.camera;
  image.metadata = merged_metadata(sources_);
  for (const Channel& channel : channels_) image.channels.push_back(channel.name);
  image.exact_channels = mattes_;
  if (const auto [least, most] = std::ranges::minmax(pixels_, {}, &Pixel::samples);
      least.samples != most.samples)
    image.metadata.emplace_back("penumbra:samples_per_pixel",
                                fmt::format("{} to {}", least.samples, most.samples));
  if (mattes_ == 0)
    std::erase_if(image.metadata, [](const auto& entry) { return entry.first.starts_with("cryptomatte/"); });
  image.values.reserve(image.pixels() * channels_.size());
  for (std::size_t at = 0; at < pixels_.size(); ++at) {
    for (std::size_t c = 0; c < channels_.size() - mattes_; ++c) image.values.push_back(value_of(at, c));
    if (mattes_ > 0) append_mattes(at, image.values);
  }
  std::vector<std::size_t> same(channels_.size());
  std::iota(same.begin(), same.end(), 0);
  if (auto checked = check_values("the merged image", image, same); !checked)
    return std::unexpected(checked.error());
  return image;
}

std::vector<std::string> ImageMerge::remarks() const {
  std::vector<std::string> remarks;
  std::vector<std::string> layers;
  for (const std::string& channel : left_out_) {
    const std::string layer(split_channel(channel).layer), name = layer.empty() ? channel : layer;
    if (std::ranges::find(layers, name) == layers.end()) layers.push_back(name);
  }
  std::ranges::sort(layers);
  if (!layers.empty())
    remarks.push_back(fmt::format("left out, because not all images have it, or it cannot be merged: {}",
                                  fmt::join(layers, ", ")));
  // A compression that changes floats keeps Cryptomatte in another part of the file.
  const bool had_mattes = std::ranges::all_of(sources_, [](const MergeSource& source) {
    return source.renders.front().command.find(" --cryptomatte") != std::string::npos;
  });
  if (had_mattes && mattes_ == 0 && left_out_.empty())
    remarks.emplace_back("left out: Cryptomatte, which is in a second part of files with lossy compression");
  if (full_pixels_ > 0)
    remarks.push_back(
        fmt::format("Cryptomatte is approximate: {} pixels of the images may cover more than {} IDs, and "
                    "files hold no more",
                    full_pixels_, kCryptomatteRanks));
  if (std::ranges::any_of(channels_, [](const Channel& c) { return c.name == "visibility.Y"; }))
    remarks.emplace_back("visibility.Y is approximate: the mean of the images' quotients");
  return remarks;
}

}  // namespace penumbra
