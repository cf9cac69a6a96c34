#include "scheduler/image/metrics/image_pair.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

bool is_beauty(std::string_view layer) { return layer.empty() || layer == "beauty"; }

/// "beauty, albedo, depth, …": the accepted values of --layer.
std::string layers_of(const Image& image) {
  std::vector<std::string> names;
  if (image.beauty_channels()) names.emplace_back("beauty");
  for (const std::string& channel : image.channels) {
    const std::size_t dot = channel.rfind('.');
    const std::string name = dot == std::string::npos ? channel : channel.substr(0, dot);
    const bool in_beauty = dot == std::string::npos && (name == "R" || name == "G" || name == "B");
    if (!in_beauty && std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string window_text(const PixelWindow& w) {
  return fmt::format("{} x {} pixels from {},{}", w.width, w.height, w.x, w.y);
}

Expected<void> same_window(const Image& image, const Image& reference) {
  const PixelWindow &a = image.data, &b = reference.data;
  if (a == b) return {};
  if (a.width != b.width || a.height != b.height) {
    return fail(
        fmt::format("the sizes differ: {} x {} against {} x {}", a.width, a.height, b.width, b.height));
  }
  return fail(fmt::format("the data windows (crops) differ: {} against {}", window_text(a), window_text(b)));
}

/// The part after the layer's name: R for albedo.R. The whole name for a channel without a layer.
std::string_view suffix(std::string_view channel) { return channel.substr(channel.rfind('.') + 1); }

bool same_suffixes(const LayerChannels& a, const LayerChannels& b) {
  return std::ranges::equal(a.names, b.names,
                            [](const auto& x, const auto& y) { return suffix(x) == suffix(y); });
}

/// Matches the channels of both sides. A grey side is repeated for a coloured one.
Expected<void> match(LayerChannels& a, LayerChannels& b, bool beauty) {
  if (beauty) {
    if (a.indices.size() == b.indices.size()) return {};
    LayerChannels& grey = a.indices.size() == 1 ? a : b;
    const LayerChannels& colour = a.indices.size() == 1 ? b : a;
    grey = {std::vector(3, grey.indices[0]), colour.names};
    return {};
  }
  if (same_suffixes(a, b)) return {};
  return fail(
      fmt::format("the channels differ: {} against {}", fmt::join(a.names, ", "), fmt::join(b.names, ", ")));
}

std::vector<float> selected(const Image& image, const std::vector<std::size_t>& indices) {
  std::vector<float> values;
  values.reserve(image.pixels() * indices.size());
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel) {
    for (const std::size_t index : indices)
      values.push_back(image.values[pixel * image.channels.size() + index]);
  }
  return values;
}

bool is_finite(const std::vector<float>& values, std::size_t pixel, std::size_t channels) {
  if (values.empty()) return true;
  return std::all_of(values.begin() + std::ptrdiff_t(pixel * channels),
                     values.begin() + std::ptrdiff_t((pixel + 1) * channels),
                     [](float v) { return std::isfinite(v); });
}

void mark_finite(ImagePair& pair, std::size_t pixels) {
  pair.finite.resize(pixels);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    const bool image = is_finite(pair.image, pixel, pair.channels.size());
    const bool reference = is_finite(pair.reference, pixel, pair.channels.size()) &&
                           is_finite(pair.second_reference, pixel, pair.channels.size());
    pair.image_non_finite += !image;
    pair.reference_non_finite += !reference;
    pair.finite[pixel] = image && reference;
    pair.compared_pixels += pair.finite[pixel];
  }
}

}  // namespace

Expected<LayerChannels> layer_channels(const Image& image, std::string_view layer) {
  LayerChannels found;
  if (is_beauty(layer)) {
    const auto beauty = image.beauty_channels();
    if (!beauty) {
      return fail(fmt::format("has no channels R, G, B; it has {}", fmt::join(image.channels, ", ")));
    }
    found.indices.assign(beauty->begin(), beauty->end());
    if (beauty->front() == beauty->back()) found.indices.resize(1);  // grey
  } else if (const auto whole = image.channel(layer)) {
    found.indices = {*whole};
  } else {
    for (std::size_t i = 0; i < image.channels.size(); ++i) {
      const std::string_view name = image.channels[i];
      if (name.starts_with(layer) && name.substr(layer.size()).starts_with('.')) found.indices.push_back(i);
    }
    if (found.indices.empty())
      return fail(fmt::format("has no layer '{}'; it has {}", layer, layers_of(image)));
    // Files may store channels in any order. Here colours are R, G, B, and all others are sorted by name.
    const auto place = [&](std::size_t i) {
      const std::string_view last = suffix(image.channels[i]);
      const auto colour = std::string_view("RGB").find(last);
      return std::pair(last.size() == 1 && colour != std::string_view::npos ? int(colour) : 3, last);
    };
    std::ranges::sort(found.indices, {}, place);
  }
  for (const std::size_t index : found.indices) found.names.push_back(image.channels[index]);
  return found;
}

Expected<ImagePair> pair_images(const Image& image, const Image& reference, const Image* second_reference,
                                std::string_view layer) {
  auto a = layer_channels(image, layer);
  if (!a) return fail("the image " + a.error().message);
  ImagePair pair;
  pair.window = image.data;
  for (const bool second : {false, true}) {
    const Image* other = second ? second_reference : &reference;
    if (other == nullptr) continue;
    if (const auto same = same_window(image, *other); !same) {
      return fail(same.error().message + (second ? " (the second reference)" : ""));
    }
    auto b = layer_channels(*other, layer);
    if (!b) return fail(fmt::format("the {}reference {}", second ? "second " : "", b.error().message));
    const bool was_grey = a->indices.size() == 1;
    if (const auto matched = match(*a, *b, is_beauty(layer)); !matched) {
      return std::unexpected(matched.error());
    }
    // If only the second reference has colours, the first is expanded to match.
    if (second && was_grey && a->indices.size() == 3) {
      auto first = layer_channels(reference, layer);
      first->indices.assign(3, first->indices[0]);
      pair.reference = selected(reference, first->indices);
    }
    (second ? pair.second_reference : pair.reference) = selected(*other, b->indices);
  }
  pair.channels = a->names;
  pair.image = selected(image, a->indices);
  mark_finite(pair, image.pixels());
  if (pair.compared_pixels == 0) {
    return fail(
        fmt::format("no pixel is finite in all images: {} of {} pixels of the image are NaN or infinite, "
                    "{} of the reference",
                    pair.image_non_finite, image.pixels(), pair.reference_non_finite));
  }
  return pair;
}

ImagePair block_means(const ImagePair& pair, int side) {
  // Rounds down for negative coordinates too.
  const auto block_of = [side](int at) { return at >= 0 ? at / side : -((-at - 1) / side) - 1; };
  const PixelWindow& w = pair.window;
  ImagePair blocks;
  blocks.channels = pair.channels;
  blocks.window.x = block_of(w.x);
  blocks.window.y = block_of(w.y);
  blocks.window.width = w.width > 0 ? block_of(w.x + w.width - 1) - blocks.window.x + 1 : 0;
  blocks.window.height = w.height > 0 ? block_of(w.y + w.height - 1) - blocks.window.y + 1 : 0;
  const std::size_t channels = pair.channels.size();
  const std::size_t count = std::size_t(blocks.window.width) * std::size_t(blocks.window.height);
  std::vector<std::size_t> block(pair.pixels()), size(count);
  blocks.finite.assign(count, 1);
  for (std::size_t p = 0; p < pair.pixels(); ++p) {
    const int x = w.x + int(p % std::size_t(w.width)), y = w.y + int(p / std::size_t(w.width));
    block[p] = std::size_t(block_of(y) - blocks.window.y) * std::size_t(blocks.window.width) +
               std::size_t(block_of(x) - blocks.window.x);
    ++size[block[p]];
    blocks.finite[block[p]] &= pair.finite[p];
  }
  const auto means_of = [&](const std::vector<float>& values) {
    std::vector<double> sums(values.empty() ? 0 : count * channels);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t b = block[i / channels];
      sums[b * channels + i % channels] += double(values[i]) / double(size[b]);
    }
    return std::vector<float>(sums.begin(), sums.end());
  };
  blocks.image = means_of(pair.image);
  blocks.reference = means_of(pair.reference);
  blocks.second_reference = means_of(pair.second_reference);
  blocks.compared_pixels = std::uint64_t(std::ranges::count(blocks.finite, 1));
  return blocks;
}

}  // namespace penumbra
