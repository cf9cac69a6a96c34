// The film of the watched render: the workers' tiles as textures for drawing and as numbers for saving.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gl/gl_objects.h"
#include "kernels/host/error.h"
#include "scheduler/plan/tile_snapshot.h"

namespace penumbra {

/// Rows run from the top of the film, the first at texture coordinate 0; pixels row by row.
class FilmTextures {
 public:
  /// At least 1×1 pixels. Errors: larger than GL_MAX_TEXTURE_SIZE, or not enough memory on the device.
  static Expected<FilmTextures> create(int width, int height);

  /// Discards all samples. From now on, tiles of earlier views are ignored.
  void clear(std::uint32_t view);

  /// Copies a tile into the film. Returns false, without changes, if the tile belongs to an earlier view, is
  /// not within the film, or its arrays do not match its size. A tile of a later view clears the film first.
  bool apply(const TileSnapshot& tile);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] std::uint32_t view() const { return view_; }
  /// Changes with every change of the film.
  [[nodiscard]] std::uint64_t version() const { return version_; }
  /// Whether any tile of this view had a difference.
  [[nodiscard]] bool has_difference() const { return has_difference_; }

  /// RGBA32F: mean radiance, and the number of samples (0 if there are none yet).
  [[nodiscard]] GLuint radiance_texture() const { return radiance_texture_.name(); }
  /// RGB32F; 0 if there is none.
  [[nodiscard]] GLuint difference_texture() const { return difference_texture_.name(); }
  /// R32F; NaN below two samples.
  [[nodiscard]] GLuint standard_error_texture() const { return standard_error_texture_.name(); }

  /// The textures' contents, exactly as received: four, three and one numbers per pixel.
  [[nodiscard]] std::span<const float> radiance() const { return radiance_; }
  [[nodiscard]] std::span<const float> difference() const { return difference_; }
  [[nodiscard]] std::span<const float> standard_error() const { return standard_error_; }

 private:
  FilmTextures(int width, int height);
  void upload(int x, int y, int width, int height) const;

  int width_, height_;
  std::uint32_t view_ = 0;
  std::uint64_t version_ = 0;
  bool has_difference_ = false;
  Texture radiance_texture_, difference_texture_, standard_error_texture_;
  std::vector<float> radiance_, difference_, standard_error_;
};

}  // namespace penumbra
