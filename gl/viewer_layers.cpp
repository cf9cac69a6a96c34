// What a Viewer shows beside the image itself: files, layers, comparisons, the pixel below the mouse.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "gl/viewer.h"
#include "kernels/host/text.h"
#include "scenes/diagnostic.h"
#include "scenes/names.h"

namespace penumbra {
namespace {

constexpr const char* kSamplesLayer = "samples";
constexpr const char* kVarianceLayer = "variance";

/// Names of the layers that are not named ones.
constexpr std::array<std::pair<std::string_view, Layer>, 4> kBuiltIn{{{"image", Layer::kComposite},
                                                                      {"closed_form", Layer::kAnalytic},
                                                                      {"difference", Layer::kDifference},
                                                                      {"standard_error", Layer::kError}}};

LayerKind kind_of_render_layer(const std::string& name, std::size_t per_pixel) {
  if (name == kMatteLayer || name == "shape") return LayerKind::kIdentity;
  if (name.find("normal") != std::string::npos) return LayerKind::kNormal;
  return per_pixel == 1 ? LayerKind::kQuantity : LayerKind::kColor;
}

/// The beauty layer as the tile of a render, with what the file knows of its noise.
TileSnapshot tile_of(const LayeredPicture& picture) {
  TileSnapshot tile;
  tile.x = picture.area.x;
  tile.y = picture.area.y;
  tile.width = picture.area.width;
  tile.height = picture.area.height;
  tile.samples = 1;
  const PictureLayer* image = picture.layer(kImageLayer);
  tile.radiance = image != nullptr ? image->values : std::vector<float>(3 * tile.pixels(), 0.0f);
  tile.standard_error.assign(tile.pixels(), std::numeric_limits<float>::quiet_NaN());
  if (const PictureLayer* samples = picture.layer(kSamplesLayer))
    for (const float count : samples->values)
      if (std::isfinite(count))
        tile.samples = std::max(tile.samples, std::uint32_t(std::clamp(count, 0.0f, 4e9f)));
  const PictureLayer* variance = picture.layer(kVarianceLayer);
  for (std::size_t i = 0; variance != nullptr && i < tile.pixels(); ++i) {
    const float* channels = variance->values.data() + 3 * i;
    tile.standard_error[i] = std::sqrt((channels[0] + channels[1] + channels[2]) / 3);
  }
  return tile;
}

}  // namespace

// --- Files

Expected<std::unique_ptr<Viewer>> Viewer::show_file(Window& window, const std::filesystem::path& path) {
  Expected<CompositePass> composite = CompositePass::create();
  if (!composite) return std::unexpected(composite.error());
  std::unique_ptr<Viewer> viewer(new Viewer(window, std::move(*composite)));
  viewer->file_ = path;
  if (Expected<void> read = viewer->read_file(); !read) return std::unexpected(read.error());
  return viewer;
}

Expected<void> Viewer::read_file() {
  const Expected<Image> image = read_linear_image(file_);
  if (!image) return std::unexpected(image.error());
  LayeredPicture picture = layers_of(*image, file_.string());
  std::vector<std::string> names;
  for (const PictureLayer& layer : picture.layers) names.push_back(layer.name);
  if (Expected<void> shown =
          show_picture(picture, file_, metadata_text(*image, "penumbra:integrator"), names);
      !shown)
    return shown;
  layers_ = std::move(picture);
  return {};
}

Expected<void> Viewer::show_picture(const LayeredPicture& picture, const std::filesystem::path& file,
                                    const std::string& integrator, const std::vector<std::string>& names) {
  const bool is_first = !film_;
  if (!film_ || film_->width() != picture.width || film_->height() != picture.height) {
    Expected<FilmTextures> film = FilmTextures::create(picture.width, picture.height);
    if (!film) return std::unexpected(film.error());
    film_.emplace(std::move(*film));
  }
  const TileSnapshot tile = tile_of(picture);
  // A picture of the whole film replaces all of it; frames that play come one after the other.
  if (picture.area != PixelRectangle{0, 0, film_->width(), film_->height()}) film_->clear(0);
  if (!film_->apply(tile))
    return fail(fmt::format("{}: its data window is not within its display window", file.string()));
  job_.emplace();
  job_->film_width = picture.width;
  job_->film_height = picture.height;
  job_->x = tile.x;
  job_->y = tile.y;
  job_->width = tile.width;
  job_->height = tile.height;
  ++denoised_view_;
  status_.connection = ConnectionState::kFile;
  status_.scene = file.string();
  status_.integrator = integrator;
  status_.film_width = picture.width;
  status_.film_height = picture.height;
  status_.finished = true;
  status_.spp_done = tile.samples;
  status_.named_layers.clear();
  for (const std::string& name : names)
    if (name != kImageLayer) status_.named_layers.push_back(name);
  const bool has_image = std::ranges::find(names, kImageLayer) != names.end();
  if (is_first && !has_image && !status_.named_layers.empty()) {
    settings_.layer = Layer::kNamed;
    settings_.named = status_.named_layers.front();
  }
  stale_ = true;
  return {};
}

// --- Layers

void Viewer::take_layers(const TileSnapshot& tile) {
  for (const TileLayer& from : tile.layers) {
    const std::size_t per_pixel = from.values.size() / std::max<std::size_t>(tile.pixels(), 1);
    auto to = std::ranges::find(layers_.layers, from.name, &PictureLayer::name);
    if (to == layers_.layers.end()) {
      PictureLayer layer{.name = from.name, .kind = kind_of_render_layer(from.name, per_pixel), .values = {}};
      layer.has_gaps = true;
      layer.values.assign(3 * std::size_t(layers_.width) * std::size_t(layers_.height),
                          std::numeric_limits<float>::quiet_NaN());
      to = layers_.layers.insert(layers_.layers.end(), std::move(layer));
    }
    for (std::size_t i = 0; i < tile.pixels(); ++i) {
      const std::size_t x = std::size_t(tile.x) + i % std::size_t(tile.width);
      const std::size_t y = std::size_t(tile.y) + i / std::size_t(tile.width);
      for (std::size_t c = 0; c < 3; ++c)
        to->values[3 * (y * std::size_t(layers_.width) + x) + c] = per_pixel == 1 ? from.values[i]
                                                                   : c < per_pixel
                                                                       ? from.values[per_pixel * i + c]
                                                                       : 0.0f;
    }
  }
}

const LayeredPicture* Viewer::shown_layers() {
  if (settings_.layer != Layer::kNamed) return nullptr;
  if (shot_ != nullptr) return frame_ == nullptr ? nullptr : &frame_->picture;
  if (client_ == nullptr) return &layers_;
  const bool is_samples = settings_.named == kSamplesLayer, is_variance = settings_.named == kVarianceLayer;
  if (!is_samples && !is_variance) {
    if (wanted_layers_.insert(settings_.named).second) client_->want_layer(settings_.named);
    for (PictureLayer& layer : layers_.layers)
      if (layer.name == settings_.named) find_range(layer);
    return &layers_;
  }
  std::vector<float> values;
  const std::span<const float> radiance = film_->radiance();
  for (std::size_t i = 0; i < film_->standard_error().size(); ++i) {
    const float error = film_->standard_error()[i];
    values.push_back(is_samples ? radiance[4 * i + 3] : error * error);
  }
  std::erase_if(layers_.layers, [&](const PictureLayer& layer) { return layer.name == settings_.named; });
  layers_.layers.push_back(make_layer(settings_.named, LayerKind::kQuantity, std::move(values), 1));
  layers_.layers.back().has_gaps = true;
  return &layers_;
}

bool Viewer::has_shown_layer() {
  const LayeredPicture* layers = film_ ? shown_layers() : nullptr;
  const PictureLayer* layer = layers == nullptr ? nullptr : layers->layer(settings_.named);
  if (layer == nullptr) return false;
  if (!layer->has_gaps) return true;
  for (std::size_t i = 0; i < layer->values.size() / 3; ++i)
    if (std::isnan(layer->values[3 * i]) && film_->radiance()[4 * i + 3] > 0) return false;
  return true;
}

Expected<void> Viewer::show_layer(const std::string& name) {
  for (const auto& [built_in, layer] : kBuiltIn) {
    if (name != built_in) continue;
    if ((layer == Layer::kAnalytic || layer == Layer::kDifference) && !status_.hybrid)
      return fail(fmt::format("this picture has no layer '{}'", name));
    settings_.layer = layer;
    stale_ = true;
    return {};
  }
  if (std::ranges::find(status_.named_layers, name) == status_.named_layers.end()) {
    std::vector<std::string> names = status_.named_layers;
    for (const auto& [built_in, layer] : kBuiltIn) names.emplace_back(built_in);
    return fail(fmt::format("there is no layer '{}'; there are: {}", name, list_names(names)));
  }
  settings_.layer = Layer::kNamed;
  settings_.named = name;
  stale_ = true;
  return {};
}

void Viewer::next_layer() {
  std::vector<std::string> names{"image", "standard_error"};
  if (status_.hybrid) names.insert(names.end(), {"closed_form", "difference"});
  names.insert(names.end(), status_.named_layers.begin(), status_.named_layers.end());
  const auto found = std::ranges::find(names, shown_layer_name());
  const std::size_t next = found == names.end() ? 0 : std::size_t(found - names.begin()) + 1;
  [[maybe_unused]] const auto done = show_layer(names[next % names.size()]);
}

// --- Comparison

Expected<void> Viewer::open_reference(const std::filesystem::path& path) {
  const Expected<Image> image = read_linear_image(path);
  if (!image) return std::unexpected(image.error());
  reference_ = layers_of(*image, path.string());
  status_.reference = reference_->name;
  stale_ = true;
  return {};
}

void Viewer::keep_reference() {
  if (!film_) return;
  LayeredPicture kept{
      .name = fmt::format("kept at {} of {}", counted(least_samples(), "sample"), status_.scene),
      .width = film_->width(),
      .height = film_->height(),
      .area = {0, 0, film_->width(), film_->height()},
      .layers = {}};
  const ShownComparison comparison = std::exchange(settings_.comparison, ShownComparison::kNone);
  if (compose_shown()) {
    kept.layers.push_back(make_layer(shown_layer_name(), LayerKind::kColor, composite_.read_linear(), 3));
    status_.reference = kept.name;
    reference_ = std::move(kept);
    say("the picture is kept as reference");
  }
  settings_.comparison = comparison;
}

void Viewer::compare(ShownComparison comparison) {
  if (!reference_) {
    if (comparison != ShownComparison::kNone)
      say(fmt::format(
          "warning: there is no reference yet: '{}' keeps the picture as one, --reference opens a file",
          info_of(Action::kKeepReference).key));
    return;
  }
  settings_.comparison = comparison;
  stale_ = true;
}

void Viewer::next_comparison() {
  switch (settings_.comparison) {
    case ShownComparison::kDifference:
      return compare(ShownComparison::kRelativeError);
    case ShownComparison::kRelativeError:
      return compare(ShownComparison::kNone);
    default:
      return compare(ShownComparison::kDifference);
  }
}

std::string Viewer::shown_layer_name() const {
  if (settings_.layer == Layer::kNamed) return settings_.named;
  for (const auto& [name, layer] : kBuiltIn)
    if (settings_.layer == layer) return std::string(name);
  return "";
}

void Viewer::compare_composed() {
  status_.difference.reset();
  if (!reference_ || settings_.comparison == ShownComparison::kNone) return;
  const auto give_up = [this](std::string why) {
    say("warning: no comparison: " + why);
    settings_.comparison = ShownComparison::kNone;
  };
  if (reference_->width != film_->width() || reference_->height != film_->height())
    return give_up(fmt::format("the reference has {} × {} pixels, the picture {} × {}", reference_->width,
                               reference_->height, film_->width(), film_->height()));
  const PictureLayer* layer = reference_->layer(shown_layer_name());
  if (layer == nullptr) return give_up(fmt::format("the reference has no layer '{}'", shown_layer_name()));
  status_.difference = composite_.compare(*layer, reference_->area, settings_.comparison);
}

// --- The pixel below the mouse

std::string Viewer::name_of_shown_values() {
  switch (settings_.comparison) {
    case ShownComparison::kReference:
      return "reference";
    case ShownComparison::kDifference:
      return "difference";
    case ShownComparison::kRelativeError:
      return "relative error";
    case ShownComparison::kNone:
      break;
  }
  return denoised_values().empty() ? "" : "denoised";
}

void Viewer::look_at_pixel(const PixelRectangle& place) {
  status_.pixel.reset();
  const auto pointer = window_.pointer();
  if (!pointer || (*pointer)[0] >= picture_area_.x + picture_area_.width) return;
  const auto pixel = film_pixel_at(place, film_->width(), film_->height(), (*pointer)[0], (*pointer)[1]);
  if (!pixel) return;
  const auto [x, y] = *pixel;
  const auto value = composite_.read_pixel(x, y);
  if (!value) return;
  const std::size_t at = std::size_t(y) * std::size_t(film_->width()) + std::size_t(x);
  const float error = film_->standard_error()[at];
  // Samples and their error are of the render, not of a reference, a difference or a denoised picture.
  const std::string of = name_of_shown_values();
  const bool has_error = settings_.layer == Layer::kComposite && of.empty() && !std::isnan(error);
  status_.pixel = PixelValue{.x = x,
                             .y = y,
                             .value = *value,
                             .of = of,
                             .samples = of.empty() ? film_->radiance()[4 * at + 3] : 0,
                             .standard_error = has_error ? std::optional(error) : std::nullopt};
}

}  // namespace penumbra
