#include "gl/analytic_pass.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>

#include "kernels/features.h"
#include "kernels/host/device_scene.h"
#include "kernels/sampler/filter.h"

namespace penumbra {
namespace {

/// Near limit in units of the scene's size: what is nearer is not drawn, even if the camera's own clipping
/// plane is nearer or missing.
constexpr float kNearest = 1e-9f;
/// Beyond everything, in the same unit; the quotient of both is a normal number, as depths are.
constexpr float kFarthestClip = 1e20f;

/// The pixels by which the viewport of the primitives is larger than the film, on each side.
int margin(int pixels) { return pixels / 8 + 1; }
/// The largest film whose viewport is at most `viewport`.
int largest_film(int viewport) { return (viewport - 2) / 5 * 4; }

glm::dvec3 vector(vec3 v) { return {v.x, v.y, v.z}; }

/// Saves the bound framebuffers and the viewport, restores them, and disables everything else.
class KeptState {
 public:
  KeptState() {
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &draws_);
    glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &reads_);
    glGetIntegerv(GL_VIEWPORT, viewport_.data());
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_SCISSOR_TEST);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  }
  KeptState(const KeptState&) = delete;
  KeptState& operator=(const KeptState&) = delete;
  ~KeptState() {
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    glBindVertexArray(0);
    glUseProgram(0);
    glActiveTexture(GL_TEXTURE0);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(draws_));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(reads_));
    glViewport(viewport_[0], viewport_[1], viewport_[2], viewport_[3]);
  }

 private:
  GLint draws_ = 0, reads_ = 0;
  std::array<GLint, 4> viewport_{};
};

/// Lets the sampler `name` of the current program read `texture` through that unit.
void set_texture(const Program& program, const char* name, int unit, GLenum target, GLuint texture) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(target, texture);
  set_uniform(program, name, unit);
}
void set_table(const Program& program, const char* name, int unit, const BufferTexture& table) {
  set_texture(program, name, unit, GL_TEXTURE_BUFFER, table.texture.name());
}

/// Point n of the two-dimensional sequence of Roberts 2018; point 0 is (1/2, 1/2).
std::array<float, 2> spread_numbers(int n) {
  constexpr double kPlastic = 1.32471795724474602596;
  const auto number = [n](double step) {
    const double x = 0.5 + n * step;
    return std::min(static_cast<float>(x - std::floor(x)), ONE_MINUS_EPSILON);
  };
  return {number(1 / kPlastic), number(1 / (kPlastic * kPlastic))};
}

Expected<Program> link_shaders(std::string_view vertex, std::string_view fragment) {
  return link_program(fragment, text_of(analytic_shaders(), vertex), text_of(analytic_shaders(), fragment));
}

}  // namespace

AnalyticPass::AnalyticPass(const DeviceScene& scene) : scene_(scene.header) {
  const auto filter = table<float>(scene, {FILTER_TABLE_SIZE, scene.header.tables.filter_table.offset});
  filter_table_.assign(filter.begin(), filter.end());
}

Expected<std::unique_ptr<AnalyticPass>> AnalyticPass::create(const DeviceScene& scene) {
  std::unique_ptr<AnalyticPass> pass(new AnalyticPass(scene));
  auto tables = make_analytic_tables(scene);
  if (!tables) return std::unexpected(tables.error());
  pass->tables_ = std::move(*tables);
  const bool glossy = (scene.header.families & ONLY(PHONG)) != 0;
  auto triangles = link_shaders("triangles.vert", "triangles.frag");
  auto quadrics = link_shaders("quadrics.vert", "quadrics.frag");
  const bool lobes = (scene.header.features & FEATURE_LTC) != 0;
  auto shade = link_shaders("screen.vert", lobes ? glossy ? "shade_phong_ltc.frag" : "shade_diffuse_ltc.frag"
                                           : glossy ? "shade_phong.frag"
                                                    : "shade_diffuse.frag");
  for (const auto* program : {&triangles, &quadrics, &shade})
    if (!*program) return std::unexpected(program->error());
  pass->triangles_ = std::move(*triangles);
  pass->quadrics_ = std::move(*quadrics);
  pass->shade_ = std::move(*shade);
  pass->vertices_ = VertexArray::create();
  return pass;
}

Expected<void> AnalyticPass::begin(const SceneHeader& view, int width, int height) {
  GLint most = 0;
  std::array<GLint, 2> viewport{};
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport.data());
  most = std::min({most, largest_film(viewport[0]), largest_film(viewport[1])});
  if (width < 1 || height < 1 || width > most || height > most)
    return fail(fmt::format("this OpenGL draws pictures of 1 x 1 to {} x {} pixels, not {} x {}", most, most,
                            width, height));
  const KeptState kept;
  if (width != width_ || height != height_) {
    ids_ = make_texture(GL_R32I, width, height, GL_RED_INTEGER, GL_INT);
    depth_ = make_texture(GL_DEPTH_COMPONENT32F, width, height, GL_DEPTH_COMPONENT, GL_FLOAT);
    closed_form_ = make_texture(GL_RGBA32F, width, height, GL_RGBA, GL_FLOAT);
    emission_ = make_texture(GL_RGBA32F, width, height, GL_RGBA, GL_FLOAT);
    const GLuint ids[] = {ids_.name()}, means[] = {closed_form_.name(), emission_.name()};
    auto id_target = make_framebuffer(ids, depth_.name());
    auto mean_target = make_framebuffer(means);
    width_ = height_ = 0;
    if (!id_target) return std::unexpected(id_target.error());
    if (!mean_target) return std::unexpected(mean_target.error());
    id_target_ = std::move(*id_target);
    mean_target_ = std::move(*mean_target);
    width_ = width;
    height_ = height;
  }
  view_ = view;
  frames_ = 0;
  weights_ = 0;
  glBindFramebuffer(GL_FRAMEBUFFER, mean_target_.name());
  const GLfloat nothing[4] = {0, 0, 0, 0};
  glClearBufferfv(GL_COLOR, 0, nothing);
  glClearBufferfv(GL_COLOR, 1, nothing);
  return {};
}

void AnalyticPass::set_camera(const Program& program, float dx, float dy) const {
  const auto set_vector = [&program](const char* name, vec3 v) { set_uniform(program, name, v.x, v.y, v.z); };
  const float scale = 1 / tables_.unit;
  const vec3 origin = view_.camera.origin;
  set_vector("camera_origin", {origin.x * scale, origin.y * scale, origin.z * scale});
  set_vector("camera_x", view_.camera.x);
  set_vector("camera_y", view_.camera.y);
  set_vector("camera_z", view_.camera.z);
  set_uniform(program, "near_clip", std::max(view_.camera.near_clip * scale, kNearest));
  set_uniform(program, "far_clip", std::min(view_.camera.far_clip * scale, kFarthestClip));
  glUniform2i(glGetUniformLocation(program.name(), "size"), width_, height_);
  set_uniform(program, "offset", dx, dy);
  set_uniform(program, "look_through", view_.integrator.hide_emitters == HIDE_LOOK_THROUGH ? 1 : 0);
  const auto inside = [](int pixels) {
    return static_cast<float>(pixels) / static_cast<float>(pixels + 2 * margin(pixels));
  };
  set_uniform(program, "inside", inside(width_), inside(height_));
  const glm::dmat3 from_film(-vector(view_.camera.x), -vector(view_.camera.y), vector(view_.camera.z));
  const glm::mat3 to_film(glm::inverse(from_film));
  glUniformMatrix3fv(glGetUniformLocation(program.name(), "to_film"), 1, GL_FALSE, &to_film[0][0]);
}

void AnalyticPass::draw_ids(float dx, float dy) {
  glBindFramebuffer(GL_FRAMEBUFFER, id_target_.name());
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_GREATER);
  const GLint nothing[4] = {-1, 0, 0, 0};
  const GLfloat farthest = 0;
  glClearBufferiv(GL_COLOR, 0, nothing);
  glClearBufferfv(GL_DEPTH, 0, &farthest);
  const int across = margin(width_), down = margin(height_);
  glViewport(-across, -down, width_ + 2 * across, height_ + 2 * down);
  if (scene_.tables.triangles.count > 0) {
    glUseProgram(triangles_.name());
    set_camera(triangles_, dx, dy);
    set_table(triangles_, "triangles", 0, tables_.triangles);
    glDrawArrays(GL_TRIANGLES, 0, 3 * scene_.tables.triangles.count);
  }
  if (scene_.tables.quadrics.count > 0) {
    glUseProgram(quadrics_.name());
    set_camera(quadrics_, dx, dy);
    set_uniform(quadrics_, "triangle_count", scene_.tables.triangles.count);
    set_table(quadrics_, "quadrics", 1, tables_.quadrics);
    glDrawArraysInstanced(GL_TRIANGLES, 0, 36, scene_.tables.quadrics.count);
  }
  glDisable(GL_DEPTH_TEST);
}

void AnalyticPass::shade(float dx, float dy) {
  glBindFramebuffer(GL_FRAMEBUFFER, mean_target_.name());
  glViewport(0, 0, width_, height_);
  glUseProgram(shade_.name());
  set_camera(shade_, dx, dy);
  set_texture(shade_, "ids", 0, GL_TEXTURE_2D, ids_.name());
  set_table(shade_, "quadrics", 1, tables_.quadrics);
  set_table(shade_, "triangles", 2, tables_.triangles);
  set_table(shade_, "vertex_normals", 3, tables_.vertex_normals);
  set_table(shade_, "materials", 4, tables_.materials);
  set_table(shade_, "lights", 5, tables_.lights);
  set_table(shade_, "polygons", 6, tables_.polygons);
  set_table(shade_, "polygon_corners", 7, tables_.polygon_corners);
  if ((scene_.features & FEATURE_LTC) != 0) set_table(shade_, "control_lobes", 8, tables_.control_lobes);
  set_uniform(shade_, "triangle_count", scene_.tables.triangles.count);
  set_uniform(shade_, "polygon_count", scene_.tables.polygons.count);
  set_uniform(shade_, "environment", scene_.environment);
  set_uniform(shade_, "hide_emitters", view_.integrator.hide_emitters > HIDE_NOTHING ? 1 : 0);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void AnalyticPass::add_frame() {
  if (width_ == 0) return;
  const KeptState kept;
  glBindVertexArray(vertices_.name());
  const auto [u, v] = spread_numbers(frames_);
  const FilterSample x = sample_filter(view_.film.filter, filter_table_.data(), u);
  const FilterSample y = sample_filter(view_.film.filter, filter_table_.data(), v);
  const float dx = view_.film.filter_radius * x.x, dy = view_.film.filter_radius * y.x;
  draw_ids(dx, dy);
  // mean + (frame - mean) share; a frame's weight may be negative.
  const double weight = static_cast<double>(x.weight) * y.weight;
  weights_ += weight;
  const float share = frames_ == 0 ? 1.0f : static_cast<float>(weight / weights_);
  glEnable(GL_BLEND);
  glBlendEquation(GL_FUNC_ADD);
  glBlendFunc(GL_CONSTANT_COLOR, GL_ONE_MINUS_CONSTANT_COLOR);
  glBlendColor(share, share, share, share);
  shade(dx, dy);
  ++frames_;
}

}  // namespace penumbra
