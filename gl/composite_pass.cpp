#include "gl/composite_pass.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include "scheduler/image/metrics/color_map.h"

namespace penumbra {
namespace {

constexpr std::array<GLfloat, 4> kNothing{};

Expected<Program> composite_program(std::string_view vertex, std::string_view fragment) {
  const auto text = [](std::string_view name) {
    return text_of(composite_shaders(), fmt::format("gl/shaders/{}", name));
  };
  return link_program(fragment, text(vertex), text(fragment));
}

Texture heat_texture() {
  constexpr int kEntries = 256;
  std::vector<float> entries;
  for (int i = 0; i < kEntries; ++i) {
    for (const float channel : heat_color(double(i) / (kEntries - 1))) entries.push_back(channel);
  }
  Texture texture = make_texture(GL_RGB32F, kEntries, 1, GL_RGB, GL_FLOAT);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, kEntries, 1, GL_RGB, GL_FLOAT, entries.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  return texture;
}

void bind_texture(const Program& program, const char* name, int unit, GLuint texture) {
  glActiveTexture(GL_TEXTURE0 + GLenum(unit));
  glBindTexture(GL_TEXTURE_2D, texture);
  set_uniform(program, name, unit);
}

/// Resets the OpenGL state that affects drawing.
void plain_state() {
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_STENCIL_TEST);
  glDisable(GL_CULL_FACE);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_FRAMEBUFFER_SRGB);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

PixelRectangle intersection(const PixelRectangle& a, const PixelRectangle& b) {
  const int x = std::max(a.x, b.x), y = std::max(a.y, b.y);
  return {x, y, std::min(a.x + a.width, b.x + b.width) - x, std::min(a.y + a.height, b.y + b.height) - y};
}

bool has_size(GLuint texture, int width, int height) {
  if (texture == 0) return false;
  GLint found_width = 0, found_height = 0;
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture);
  glGetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_WIDTH, &found_width);
  glGetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_HEIGHT, &found_height);
  return found_width == width && found_height == height;
}

}  // namespace

Expected<CompositePass> CompositePass::create() {
  CompositePass pass;
  auto linear = composite_program("composite.vert", "composite_linear.frag");
  if (!linear) return std::unexpected(linear.error());
  auto display = composite_program("composite.vert", "composite_display.frag");
  if (!display) return std::unexpected(display.error());
  auto outline = composite_program("composite_outline.vert", "composite_outline.frag");
  if (!outline) return std::unexpected(outline.error());
  pass.linear_ = std::move(*linear);
  pass.display_ = std::move(*display);
  pass.outline_ = std::move(*outline);
  pass.nothing_ = VertexArray::create();
  pass.outline_array_ = VertexArray::create();
  pass.outline_buffer_ = Buffer::create();
  pass.heat_ = heat_texture();
  glBindVertexArray(pass.outline_array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, pass.outline_buffer_.name());
  glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(OutlineVertex), nullptr);
  glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, sizeof(OutlineVertex),
                        reinterpret_cast<const void*>(offsetof(OutlineVertex, red)));
  glEnableVertexAttribArray(0);
  glEnableVertexAttribArray(1);
  glBindVertexArray(0);
  glBindBuffer(GL_ARRAY_BUFFER, 0);
  return pass;
}

Expected<void> CompositePass::make_targets(int width, int height) {
  if (width == width_ && height == height_) return {};
  Texture values = make_texture(GL_RGBA32F, width, height, GL_RGBA, GL_FLOAT);
  Texture lights = make_texture(GL_RGBA32F, width, height, GL_RGBA, GL_FLOAT);
  auto target = make_framebuffer(std::array{values.name(), lights.name()});
  if (!target) return std::unexpected(target.error());
  values_ = std::move(values);
  lights_ = std::move(lights);
  values_target_ = std::move(*target);
  width_ = width;
  height_ = height;
  return {};
}

bool CompositePass::is_on_film(const PixelRectangle& area) const {
  return area.x >= 0 && area.y >= 0 && area.x + area.width <= width_ && area.y + area.height <= height_;
}

void CompositePass::clear_lights() {
  glBindFramebuffer(GL_FRAMEBUFFER, values_target_.name());
  glClearBufferfv(GL_COLOR, 1, kNothing.data());
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

/// Without a layer no pixel has a value.
void CompositePass::show_layer(const PictureLayer* layer, const PixelRectangle& area) {
  glBindFramebuffer(GL_FRAMEBUFFER, values_target_.name());
  glClearBufferfv(GL_COLOR, 0, kNothing.data());
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  clear_lights();
  if (layer == nullptr || !is_on_film(area)) return;
  std::vector<float> values;
  values.reserve(layer->values.size() / 3 * 4);
  for (std::size_t i = 0; i + 2 < layer->values.size(); i += 3)
    values.insert(values.end(), {layer->values[i], layer->values[i + 1], layer->values[i + 2],
                                 layer->has_gaps && std::isnan(layer->values[i]) ? 0.0f : 1.0f});
  glActiveTexture(GL_TEXTURE0);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glBindTexture(GL_TEXTURE_2D, values_.name());
  glTexSubImage2D(GL_TEXTURE_2D, 0, area.x, area.y, area.width, area.height, GL_RGBA, GL_FLOAT,
                  values.data());
  glBindTexture(GL_TEXTURE_2D, 0);
}

Expected<void> CompositePass::compose(const FilmTextures& film, const AnalyticTextures& analytic,
                                      const DisplaySettings& settings, const LayeredPicture* layers) {
  if (auto made = make_targets(film.width(), film.height()); !made) return made;
  const bool has_layers = layers != nullptr && layers->width == width_ && layers->height == height_;
  const PictureLayer* named = has_layers ? layers->layer(settings.named) : nullptr;
  shown_ = shown_as(settings, named);
  if (settings.layer == Layer::kNamed) {
    plain_state();
    show_layer(named, named == nullptr ? PixelRectangle{} : layers->area);
    return {};
  }
  const bool hybrid =
      has_size(analytic.closed_form, width_, height_) && has_size(analytic.emission, width_, height_);
  plain_state();
  glBindFramebuffer(GL_FRAMEBUFFER, values_target_.name());
  glViewport(0, 0, width_, height_);
  glUseProgram(linear_.name());
  bind_texture(linear_, "radiance", 0, film.radiance_texture());
  bind_texture(linear_, "difference", 1, film.difference_texture());
  bind_texture(linear_, "standard_error", 2, film.standard_error_texture());
  bind_texture(linear_, "analytic", 3, hybrid ? analytic.closed_form : film.radiance_texture());
  bind_texture(linear_, "emission", 4, hybrid ? analytic.emission : film.radiance_texture());
  set_uniform(linear_, "layer", int(settings.layer));
  set_uniform(linear_, "hybrid", int(hybrid));
  set_uniform(linear_, "alpha", settings.alpha);
  glBindVertexArray(nothing_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
  glUseProgram(0);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  return {};
}

void CompositePass::draw_picture(const FilmTextures& film, const DisplaySettings& settings,
                                 const PixelRectangle& place, const PixelRectangle& visible,
                                 int target_height, float scale) {
  plain_state();
  const int top = target_height - place.y;  // OpenGL counts rows from below
  glViewport(visible.x, target_height - visible.y - visible.height, visible.width, visible.height);
  glUseProgram(display_.name());
  bind_texture(display_, "linear_values", 0, values_.name());
  bind_texture(display_, "radiance", 1, film.radiance_texture());
  bind_texture(display_, "heat", 2, heat_.name());
  bind_texture(display_, "lights", 3, lights_.name());
  set_uniform(display_, "origin", float(place.x), float(top));
  set_uniform(display_, "film_per_pixel", float(width_) / float(place.width),
              float(height_) / float(place.height));
  set_uniform(display_, "display", int(shown_.display));
  set_uniform(display_, "tone_map", int(settings.tone_map));
  set_uniform(display_, "gain", std::exp2(settings.exposure));
  set_uniform(display_, "over_brightness", int(shown_.over_brightness));
  set_uniform(display_, "heat_range", shown_.log10_low, shown_.log10_high);
  set_uniform(display_, "check_size", std::max(1.0f, std::round(8 * scale)));
  glBindVertexArray(nothing_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
  glUseProgram(0);
}

void CompositePass::draw_outlines(const std::vector<OutlineVertex>& vertices, int target_width,
                                  int target_height) {
  if (vertices.empty()) return;
  glViewport(0, 0, target_width, target_height);
  glUseProgram(outline_.name());
  set_uniform(outline_, "target_size", float(target_width), float(target_height));
  glBindVertexArray(outline_array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, outline_buffer_.name());
  glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(vertices.size() * sizeof(OutlineVertex)), vertices.data(),
               GL_STREAM_DRAW);
  glDrawArrays(GL_TRIANGLES, 0, GLsizei(vertices.size()));
  glBindBuffer(GL_ARRAY_BUFFER, 0);
  glBindVertexArray(0);
  glUseProgram(0);
}

PixelRectangle CompositePass::show(const FilmTextures& film, const DisplaySettings& settings,
                                   std::span<const WorkerView> workers, const DisplayTarget& target) {
  const PixelRectangle place = film_place(settings.view, target.area, width_, height_);
  const PixelRectangle visible = intersection(place, target.area);
  if (visible.width < 1 || visible.height < 1) return place;
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  draw_picture(film, settings, place, visible, target.height, target.scale);
  if (settings.outlines) {
    const int thickness = std::max(1, int(std::lround(2 * target.scale)));
    glEnable(GL_SCISSOR_TEST);
    glScissor(visible.x, target.height - visible.y - visible.height, visible.width, visible.height);
    draw_outlines(outline_triangles(workers, place, width_, height_, thickness), target.width, target.height);
    glDisable(GL_SCISSOR_TEST);
  }
  return place;
}

void CompositePass::replace_values(const PixelRectangle& area, std::span<const float> values) {
  if (values.size() != 3 * std::size_t(area.width) * std::size_t(area.height)) return;
  glActiveTexture(GL_TEXTURE0);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glBindTexture(GL_TEXTURE_2D, values_.name());
  glTexSubImage2D(GL_TEXTURE_2D, 0, area.x, area.y, area.width, area.height, GL_RGB, GL_FLOAT, values.data());
  glBindTexture(GL_TEXTURE_2D, 0);
}

std::vector<float> CompositePass::read_linear() const {
  std::vector<float> values(3 * std::size_t(width_) * std::size_t(height_));
  if (values.empty()) return values;
  glBindFramebuffer(GL_FRAMEBUFFER, values_target_.name());
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width_, height_, GL_RGB, GL_FLOAT, values.data());  // row 0 is the film's top row
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  return values;
}

std::optional<std::array<float, 3>> CompositePass::read_pixel(int x, int y) const {
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return std::nullopt;
  std::array<float, 4> value{};
  glBindFramebuffer(GL_FRAMEBUFFER, values_target_.name());
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(x, y, 1, 1, GL_RGBA, GL_FLOAT, value.data());
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  if (value[3] == 0) return std::nullopt;
  return std::array{value[0], value[1], value[2]};
}

Difference CompositePass::compare(const PictureLayer& reference, const PixelRectangle& area,
                                  ShownComparison comparison) {
  std::vector<float> values = read_linear();
  if (values.empty() || !is_on_film(area)) return {};
  std::vector<float> shown;
  shown.reserve(reference.values.size());
  double sum = 0, relative_squares = 0, count = 0;
  for (std::size_t i = 0; i + 2 < reference.values.size(); i += 3) {
    const int x = area.x + int(i / 3) % area.width, y = area.y + int(i / 3) / area.width;
    const float* value = values.data() + 3 * (std::size_t(y) * std::size_t(width_) + std::size_t(x));
    std::array<float, 3> less{};
    float squares = 0, reference_squares = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const float truth = reference.values[i + c];
      less[c] = value[c] - truth;
      squares += less[c] * less[c];
      reference_squares += truth * truth;
      if (!std::isfinite(less[c])) continue;
      sum += double(less[c]);
      relative_squares += double(less[c]) * double(less[c]) / (double(truth) * double(truth) + 0.01);
      ++count;
    }
    const float relative = std::sqrt(squares / 3) / (std::sqrt(reference_squares / 3) + 0.01f);
    for (std::size_t c = 0; c < 3; ++c)
      shown.push_back(comparison == ShownComparison::kRelativeError ? relative
                      : comparison == ShownComparison::kDifference  ? less[c]
                                                                    : reference.values[i + c]);
  }
  if (comparison != ShownComparison::kNone) {
    replace_values(area, shown);
    clear_lights();  // they are not the reference's
  }
  return count > 0 ? Difference{sum / count, relative_squares / count} : Difference{};
}

Expected<std::vector<std::uint8_t>> CompositePass::read_display(const FilmTextures& film,
                                                                const DisplaySettings& settings) {
  std::vector<std::uint8_t> bytes(3 * std::size_t(width_) * std::size_t(height_));
  if (bytes.empty()) return bytes;
  const Texture picture = make_texture(GL_RGBA8, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE);
  const auto target = make_framebuffer(std::array{picture.name()});
  if (!target) return std::unexpected(target.error());
  glBindFramebuffer(GL_FRAMEBUFFER, target->name());
  const PixelRectangle whole{0, 0, width_, height_};
  draw_picture(film, settings, whole, whole, height_, 1);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width_, height_, GL_RGB, GL_UNSIGNED_BYTE, bytes.data());
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  const std::size_t row = 3 * std::size_t(width_);
  for (int y = 0; y < height_ / 2; ++y) {
    std::swap_ranges(bytes.begin() + std::ptrdiff_t(row * std::size_t(y)),
                     bytes.begin() + std::ptrdiff_t(row * std::size_t(y + 1)),
                     bytes.begin() + std::ptrdiff_t(row * std::size_t(height_ - 1 - y)));
  }
  return bytes;
}

}  // namespace penumbra
