#include "gl/picture_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "kernels/host/atomic_file.h"
#include "scenes/names.h"
#include "scheduler/image/image_files.h"

namespace penumbra {
namespace {

struct Plane {
  const std::vector<float>* values;
  std::size_t per_pixel;
};

/// Red, green and blue of a float texture, row 0 first.
std::vector<float> texture_values(GLuint texture, int width, int height) {
  std::vector<float> values(3 * std::size_t(width) * std::size_t(height));
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glGetTexImage(GL_TEXTURE_2D, 0, GL_RGB, GL_FLOAT, values.data());
  glBindTexture(GL_TEXTURE_2D, 0);
  return values;
}

/// From each four numbers, `count` numbers from `first` on.
std::vector<float> every(std::span<const float> four, std::size_t first, std::size_t count) {
  std::vector<float> values;
  values.reserve(four.size() / 4 * count);
  for (std::size_t i = 0; i < four.size(); i += 4)
    values.insert(values.end(), four.begin() + std::ptrdiff_t(i + first),
                  four.begin() + std::ptrdiff_t(i + first + count));
  return values;
}

Expected<std::vector<std::uint8_t>> exr_of(const Picture& picture) {
  Image image;
  image.data = image.display = {0, 0, picture.width, picture.height};
  image.metadata = picture.metadata;
  std::vector<Plane> planes;
  const auto add = [&](const std::vector<float>& values, std::initializer_list<const char*> channels) {
    if (values.empty()) return;
    planes.push_back({&values, channels.size()});
    image.channels.insert(image.channels.end(), channels.begin(), channels.end());
  };
  add(picture.linear, {"R", "G", "B"});
  add(picture.difference, {"difference.R", "difference.G", "difference.B"});
  add(picture.analytic, {"analytic.R", "analytic.G", "analytic.B"});
  add(picture.standard_error, {"standard_error.Y"});
  add(picture.samples, {"samples.Y"});
  for (const Plane& plane : planes) {
    if (plane.values->size() != image.pixels() * plane.per_pixel)
      return fail("the picture to be saved has layers of different sizes");
  }
  image.values.reserve(image.pixels() * image.channels.size());
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel) {
    for (const Plane& plane : planes) {
      const auto first = plane.values->begin() + std::ptrdiff_t(pixel * plane.per_pixel);
      image.values.insert(image.values.end(), first, first + std::ptrdiff_t(plane.per_pixel));
    }
  }
  return encode_exr(image);
}

}  // namespace

Expected<Picture> capture_picture(CompositePass& pass, const FilmTextures& film,
                                  const AnalyticTextures& analytic,
                                  const std::function<Expected<void>()>& compose_shown,
                                  const DisplaySettings& settings, const ViewStatus& status) {
  Picture picture;
  picture.width = film.width();
  picture.height = film.height();
  const bool hybrid = analytic.closed_form != 0 && analytic.emission != 0;
  if (hybrid) {
    DisplaySettings composite = settings;
    composite.layer = Layer::kComposite;
    if (auto done = pass.compose(film, analytic, composite); !done) return std::unexpected(done.error());
    picture.linear = pass.read_linear();
    picture.analytic = texture_values(analytic.closed_form, picture.width, picture.height);
  } else {
    picture.linear = every(film.radiance(), 0, 3);
  }
  if (film.has_difference()) picture.difference.assign(film.difference().begin(), film.difference().end());
  picture.standard_error.assign(film.standard_error().begin(), film.standard_error().end());
  picture.samples = every(film.radiance(), 3, 1);

  if (auto done = compose_shown(); !done) return std::unexpected(done.error());
  auto display = pass.read_display(film, settings);
  if (!display) return std::unexpected(display.error());
  picture.display = std::move(*display);

  picture.metadata.emplace_back("penumbra:version", std::string(PENUMBRA_VERSION));
  picture.metadata.emplace_back("penumbra:scene", status.scene);
  picture.metadata.emplace_back("penumbra:integrator", status.integrator);
  picture.metadata.emplace_back("penumbra:view", int(film.view()));
  picture.metadata.emplace_back("penumbra:spp", int(status.spp_done));
  if (hybrid) picture.metadata.emplace_back("penumbra:alpha", settings.alpha);
  if (!status.finished) picture.metadata.emplace_back("penumbra:incomplete", 1);
  return picture;
}

Expected<void> save_picture(const std::filesystem::path& path, const Picture& picture) {
  const std::string extension = extension_of(path);
  if (extension != ".exr" && extension != ".png") {
    return fail(
        fmt::format("cannot tell from '{}' how to save the picture: the name ends in .exr for its numbers "
                    "or in .png for what is shown",
                    path.string()));
  }
  const auto bytes = extension == ".exr" ? exr_of(picture)
                                         : encode_png_bytes(picture.width, picture.height, picture.display);
  if (!bytes) return std::unexpected(bytes.error());
  return write_output(path, *bytes);
}

}  // namespace penumbra
