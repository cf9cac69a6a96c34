#include "tests/support/render_scene.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "scenes/device/device_scene_builder.h"
#include "scenes/scene_reader.h"

namespace penumbra {
namespace {

template <typename T>
T value_or_throw(Expected<T> expected) {
  if (!expected) throw std::runtime_error(expected.error().message);
  return std::move(*expected);
}

}  // namespace

std::filesystem::path project_file(const std::string& name) {
  return std::filesystem::path(PENUMBRA_SOURCE_DIR) / name;
}

SceneDescription read_or_throw(const std::filesystem::path& file,
                               const std::vector<std::pair<std::string, std::string>>& defines) {
  ReadOptions options;
  options.defines = defines;
  return value_or_throw(read_scene(file, options));
}

DeviceScene build_or_throw(const SceneDescription& description, bool embree) {
  DeviceSceneOptions options;
  options.intersector = embree ? IntersectorChoice::kEmbree : IntersectorChoice::kPortable;
  options.feature_layers = true;
  return value_or_throw(build_device_scene(description, options));
}

void resize_film(SceneDescription& description, int width, int height) {
  Film& film = description.film;
  film.width = film.crop_width = width;
  film.height = film.crop_height = height;
  film.crop_x = film.crop_y = 0;
}

TestDevice native_device() {
  TestDevice device;
  device.options.isa = best_isa();
  device.options.threads = 2;
  return device;
}

TestDevice opencl_device() {
  TestDevice device;
  device.options.backend = Backend::kOpenCl;
  device.options.threads = 2;
  return device;
}

void share_needs(std::span<DeviceScene> scenes) {
  SceneHeader all = scenes.front().header;
  for (const DeviceScene& scene : scenes) {
    all.features |= scene.header.features;
    all.families |= scene.header.families;
    all.light_kinds |= scene.header.light_kinds;
    all.texture_kinds |= scene.header.texture_kinds;
  }
  for (DeviceScene& scene : scenes) {
    scene.header.features =
        (all.features & ~std::uint64_t(FEATURE_BVH)) | (scene.header.features & FEATURE_BVH);
    scene.header.families = all.families;
    scene.header.light_kinds = all.light_kinds;
    scene.header.texture_kinds = all.texture_kinds;
  }
}

FilmAccumulator render_or_throw(const DeviceScene& scene, const TestDevice& test_device) {
  const auto device = value_or_throw(make_device(scene, test_device.options));
  const int width = scene.header.film.width, height = scene.header.film.height;
  const std::uint32_t spp = scene.header.sampler.spp, per_pass = std::min(spp, test_device.samples_per_pass);
  FilmAccumulator film =
      FilmAccumulator(0, 0, width, height, FilmLayers(scene.header.features, scene.header.matte_count));
  for (std::uint32_t first = 0; first < spp; first += per_pass) {
    const RenderUnit unit{.x = 0,
                          .y = 0,
                          .width = width,
                          .height = height,
                          .first_sample = first,
                          .sample_count = std::min(per_pass, spp - first)};
    film.add(0, 0, value_or_throw(device->render(unit)));
  }
  return film;
}

FilmAccumulator render_or_throw(const SceneDescription& description, const TestDevice& device) {
  return render_or_throw(build_or_throw(description, device.embree), device);
}

statistics::Sample pixel_sample(const FilmAccumulator& film, int x, int y, int channel) {
  const PixelStatistics& pixel = film.at(x, y);
  return {pixel.count, pixel.mean[channel], pixel.m2[channel]};
}

statistics::Sample film_sample(const FilmAccumulator& film, int channel) {
  std::uint64_t count = 0;
  double mean = 0, m2 = 0;
  for (int y = film.y(); y < film.y() + film.height(); ++y) {
    for (int x = film.x(); x < film.x() + film.width(); ++x) {
      // Chan, Golub and LeVeque's pairwise update.
      const PixelStatistics& pixel = film.at(x, y);
      const double delta = pixel.mean[channel] - mean;
      const double n = double(count), pixel_n = double(pixel.count), total = n + pixel_n;
      mean += delta * pixel_n / total;
      m2 += pixel.m2[channel] + delta * delta * n * pixel_n / total;
      count += pixel.count;
    }
  }
  return {count, mean, m2};
}

statistics::Image mean_image(const FilmAccumulator& film) {
  statistics::Image image(film.width(), film.height(), 3);
  for (int y = 0; y < film.height(); ++y) {
    for (int x = 0; x < film.width(); ++x) {
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = film.at(film.x() + x, film.y() + y).mean[c];
    }
  }
  return image;
}

double mean_variance(const FilmAccumulator& film) {
  double sum = 0;
  for (int y = film.y(); y < film.y() + film.height(); ++y) {
    for (int x = film.x(); x < film.x() + film.width(); ++x) {
      for (int c = 0; c < 3; ++c) sum += pixel_sample(film, x, y, c).variance();
    }
  }
  return sum / (3.0 * film.width() * film.height());
}

statistics::Estimate block_estimate(SceneDescription description, int batches, std::uint32_t first_seed,
                                    int block, const TestDevice& device) {
  std::vector<statistics::Image> images;
  for (int batch = 0; batch < batches; ++batch) {
    description.sampler.seed = first_seed + std::uint32_t(batch);
    images.push_back(statistics::block_average(mean_image(render_or_throw(description, device)), block));
  }
  return statistics::estimate_from_batches(images);
}

}  // namespace penumbra
