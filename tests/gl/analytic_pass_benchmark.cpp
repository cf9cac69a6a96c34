// Time of a frame of the closed form, by OpenGL's timer: `xvfb-run -a analytic_pass_benchmark [SCENE]`. Not a
// test.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "gl/analytic_pass.h"
#include "tests/gl/gl_test_context.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/oracles.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

constexpr int kWidth = 600, kHeight = 400, kFrames = 9;

/// The median of some frames, in seconds, of which the first few are not counted.
double seconds_of_frame(AnalyticPass& pass) {
  std::vector<double> seconds;
  const Query query = Query::create();
  for (int k = 0; k < kFrames + 2; ++k) {
    glBeginQuery(GL_TIME_ELAPSED, query.name());
    pass.add_frame();
    glEndQuery(GL_TIME_ELAPSED);
    GLuint64 nanoseconds = 0;
    glGetQueryObjectui64v(query.name(), GL_QUERY_RESULT, &nanoseconds);
    if (k >= 2) seconds.push_back(1e-9 * double(nanoseconds));
  }
  std::ranges::nth_element(seconds, seconds.begin() + kFrames / 2);
  return seconds[kFrames / 2];
}

double seconds_of_scene(SceneDescription description) {
  description.integrator = integrator_of(IntegratorKind::kPolygonAnalytic);
  resize_film(description, kWidth, kHeight);
  const DeviceScene scene = build_or_throw(description);
  auto pass = AnalyticPass::create(scene);
  if (!pass) throw std::runtime_error(pass.error().message);
  if (auto begun = (*pass)->begin(scene.header, kWidth, kHeight); !begun)
    throw std::runtime_error(begun.error().message);
  return seconds_of_frame(**pass);
}

/// A floor that fills the picture, under a light of so many edges.
SceneDescription under_a_light(int edges, const Bsdf& bsdf) {
  SceneDescription scene;
  scene.bsdfs = {bsdf};
  Shape floor;
  Mesh square;
  square.positions = {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  floor.geometry = square;
  floor.front_bsdf = 0;
  scene.shapes.push_back(floor);
  Shape light;
  Mesh disk;
  for (int k = 0; k < edges; ++k) {
    const double angle = 2 * std::numbers::pi * k / edges;
    disk.positions.push_back({4 + std::cos(angle), 0.3, 1.5 + std::sin(angle)});
    if (k >= 2) disk.triangles.push_back({0u, glm::uint(k), glm::uint(k - 1)});
  }
  light.geometry = disk;
  light.radiance = glm::vec3(4);
  light.two_sided_emission = true;
  scene.shapes.push_back(light);
  // From above, looking down.
  scene.camera.to_world = glm::dmat4(glm::dvec4(1, 0, 0, 0), glm::dvec4(0, -1, 0, 0), glm::dvec4(0, 0, -1, 0),
                                     glm::dvec4(0, 0, 3, 1));
  scene.camera.fov = 60;
  return scene;
}

void print_cost_of_edges(const char* name, const Bsdf& bsdf) {
  constexpr int kFew = 4, kMany = 36;
  const double few = seconds_of_scene(under_a_light(kFew, bsdf)),
               many = seconds_of_scene(under_a_light(kMany, bsdf));
  const double per_edge = (many - few) / (kMany - kFew) / (kWidth * kHeight);
  fmt::print("{:24} {:7.2f} ms for each shaded megapixel and edge ({:.1f} ns a pixel)\n", name,
             1e9 * per_edge, 1e9 * per_edge);
}

void run(const std::vector<std::string>& files) {
  fmt::print("{}\n", reinterpret_cast<const char*>(glGetString(GL_RENDERER)));
  for (const std::string& file : files) {
    const double seconds = seconds_of_scene(read_or_throw(file));
    fmt::print("{}, {} x {}: {:.1f} ms, {:.0f} frames a second\n", file, kWidth, kHeight, 1e3 * seconds,
               1 / seconds);
  }
  print_cost_of_edges("irradiance alone", {"diffuse", DiffuseBsdf{}});
  for (const float exponent : {1.0f, 10.0f, 100.0f, 1e4f})
    print_cost_of_edges(fmt::format("with Phong, exponent {}", exponent).c_str(),
                        {"phong", PhongBsdf{glm::vec3(0.3f), glm::vec3(0.4f), exponent}});
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) {
  if (const std::string reason = penumbra::make_gl_context(); !reason.empty()) {
    fmt::print(stderr, "{}\n", reason);
    return 1;
  }
  std::vector<std::string> files(argv + 1, argv + argc);
  if (files.empty()) {
    files.push_back(penumbra::project_file("scenes/star-light/star-light.xml"));
    if (const auto grid = penumbra::find_oracle("tinyrender-a4/grid/tinyrender"))
      files.push_back(*grid / "grid_analytic.toml");
  }
  penumbra::run(files);
}
