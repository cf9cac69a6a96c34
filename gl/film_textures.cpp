#include "gl/film_textures.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace penumbra {
namespace {

/// Clears all error flags, so that later errors are not those of earlier calls. The number of calls is
/// limited: a lost context would return errors forever.
GLenum drain_errors() {
  GLenum first = GL_NO_ERROR;
  for (int i = 0; i < 16; ++i) {
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR) break;
    if (first == GL_NO_ERROR) first = error;
  }
  return first;
}

bool lengths_fit(const TileSnapshot& tile) {
  return tile.radiance.size() == 3 * tile.pixels() && tile.standard_error.size() == tile.pixels() &&
         (tile.difference.empty() || tile.difference.size() == 3 * tile.pixels());
}

}  // namespace

FilmTextures::FilmTextures(int width, int height)
    : width_(width),
      height_(height),
      radiance_texture_(make_texture(GL_RGBA32F, width, height, GL_RGBA, GL_FLOAT)),
      difference_texture_(make_texture(GL_RGB32F, width, height, GL_RGB, GL_FLOAT)),
      standard_error_texture_(make_texture(GL_R32F, width, height, GL_RED, GL_FLOAT)) {
  const std::size_t pixels = std::size_t(width) * std::size_t(height);
  radiance_.resize(4 * pixels);
  difference_.resize(3 * pixels);
  standard_error_.resize(pixels);
}

Expected<FilmTextures> FilmTextures::create(int width, int height) {
  if (width < 1 || height < 1) return fail(fmt::format("a film of {} × {} pixels has none", width, height));
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  if (width > limit || height > limit) {
    return fail(fmt::format(
        "the film has {} × {} pixels, and this OpenGL draws at most {} × {} (GL_MAX_TEXTURE_SIZE): "
        "watch a smaller film or a crop of it",
        width, height, limit, limit));
  }
  drain_errors();
  FilmTextures film(width, height);
  film.clear(0);
  if (drain_errors() != GL_NO_ERROR) {
    return fail(fmt::format("OpenGL has not enough memory for a film of {} × {} pixels", width, height));
  }
  return film;
}

void FilmTextures::clear(std::uint32_t view) {
  view_ = view;
  ++version_;
  has_difference_ = false;
  std::ranges::fill(radiance_, 0.0f);
  std::ranges::fill(difference_, 0.0f);
  std::ranges::fill(standard_error_, std::numeric_limits<float>::quiet_NaN());
  upload(0, 0, width_, height_);
}

bool FilmTextures::apply(const TileSnapshot& tile) {
  if (tile.view < view_ || tile.width < 1 || tile.height < 1 || tile.x < 0 || tile.y < 0) return false;
  if (tile.width > width_ - tile.x || tile.height > height_ - tile.y || !lengths_fit(tile)) return false;
  if (tile.view > view_) clear(tile.view);
  for (int row = 0; row < tile.height; ++row) {
    for (int column = 0; column < tile.width; ++column) {
      const std::size_t from = std::size_t(row) * std::size_t(tile.width) + std::size_t(column);
      const std::size_t to = std::size_t(tile.y + row) * std::size_t(width_) + std::size_t(tile.x + column);
      for (std::size_t c = 0; c < 3; ++c) {
        radiance_[4 * to + c] = tile.radiance[3 * from + c];
        difference_[3 * to + c] = tile.difference.empty() ? 0.0f : tile.difference[3 * from + c];
      }
      radiance_[4 * to + 3] = float(tile.samples);
      standard_error_[to] = tile.standard_error[from];
    }
  }
  ++version_;
  has_difference_ = has_difference_ || !tile.difference.empty();
  upload(tile.x, tile.y, tile.width, tile.height);
  return true;
}

void FilmTextures::upload(int x, int y, int width, int height) const {
  const std::size_t first = std::size_t(y) * std::size_t(width_) + std::size_t(x);
  glActiveTexture(GL_TEXTURE0);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, width_);
  glBindTexture(GL_TEXTURE_2D, radiance_texture_.name());
  glTexSubImage2D(GL_TEXTURE_2D, 0, x, y, width, height, GL_RGBA, GL_FLOAT, radiance_.data() + 4 * first);
  glBindTexture(GL_TEXTURE_2D, difference_texture_.name());
  glTexSubImage2D(GL_TEXTURE_2D, 0, x, y, width, height, GL_RGB, GL_FLOAT, difference_.data() + 3 * first);
  glBindTexture(GL_TEXTURE_2D, standard_error_texture_.name());
  glTexSubImage2D(GL_TEXTURE_2D, 0, x, y, width, height, GL_RED, GL_FLOAT, standard_error_.data() + first);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
  glBindTexture(GL_TEXTURE_2D, 0);
}

}  // namespace penumbra
