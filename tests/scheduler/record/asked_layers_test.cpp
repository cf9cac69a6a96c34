// The layers that a scene has only if film.layers asks for them, against closed forms and other integrators.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "scenes/device/device_scene_builder.h"
#include "scenes/settings.h"
#include "scheduler/record/film_image.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/support/render_scene.h"
#include "tests/support/statistics.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int kSide = 24;
constexpr std::uint32_t kSamples = 16;
constexpr const char* kAll = "position,uv,geometric_normal,shape,direct,indirect";
constexpr const char* kGeometry = "position,uv,geometric_normal,shape";

void set(SceneDescription& scene, const char* key, const char* value) {
  const auto done = apply_setting(scene, key, value);
  ASSERT_TRUE(done) << done.error().message;
}

SceneDescription with_layers(SceneDescription scene, const char* layers) {
  set(scene, "film.layers", layers);
  return scene;
}

SceneDescription cornell_box(const char* layers) {
  SceneDescription scene = read_or_throw(project_file("scenes/cornell-small/cornell-small.xml"));
  resize_film(scene, kSide, kSide);
  scene.sampler.spp = kSamples;
  return with_layers(std::move(scene), layers);
}

Image render(const SceneDescription& scene, const TestDevice& device = native_device()) {
  return image_of_film(render_or_throw(scene, device), scene.film.width, scene.film.height);
}

double value(const Image& image, int x, int y, const std::string& channel) {
  return double(image.at(x, y, image.channel(channel).value()));
}

// --- closed forms

/// A camera at `eye` that looks along +x, with +z up and a field of view of 40 degrees.
const glm::dvec3 kEye(100, 200, -50);
constexpr double kFov = 40;

SceneDescription seen_scene() {
  SceneDescription scene = empty_scene(kSide, kSide, kSamples, 3);
  scene.camera = look_at(kEye, kEye + glm::dvec3(1, 0, 0), {0, 0, 1}, kFov);
  return scene;
}

/// The unit direction of the camera ray through a film point in pixels from the upper left corner.
glm::dvec3 direction(double x, double y) {
  const double half = std::tan(kFov / 2 * std::numbers::pi / 180);
  return glm::normalize(
      glm::dvec3(1, half * (1 - 2 * x / kSide), half * (1 - 2 * y / kSide)));  // +y is on the left
}

/// What a camera ray in that direction sees at its first hit.
using Seen = std::function<std::vector<double>(glm::dvec3)>;

/// Compares channels with means of closed forms over the pixels, computed at points of a grid. A pixel's
/// samples are independent: their mean deviates by at most 5 standard errors, which one of 2 million normal
/// deviates exceeds. Positions of up to 300 have rounding errors of a few 2^-24 of that.
void expect_means(const Image& image, const std::vector<std::string>& channels, const Seen& seen) {
  constexpr int kGrid = 16;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      std::vector<statistics::Sample> means(channels.size());
      for (int i = 0; i < kGrid * kGrid; ++i) {
        const std::vector<double> at =
            seen(direction(x + (i % kGrid + 0.5) / kGrid, y + (i / kGrid + 0.5) / kGrid));
        for (std::size_t c = 0; c < channels.size(); ++c) means[c].add(at[c]);
      }
      for (std::size_t c = 0; c < channels.size(); ++c)
        ASSERT_NEAR(value(image, x, y, channels[c]), means[c].mean(),
                    5 * std::sqrt(means[c].variance() / kSamples) + 1e-4)
            << channels[c] << " of pixel " << x << ' ' << y;
    }
}

TEST(AskedLayers, PositionsAndTextureCoordinatesOfARectangle) {
  SceneDescription scene = seen_scene();
  const glm::dvec3 corner = kEye + glm::dvec3(3, -2, -2), u(0, 4, 0), v(1, 0, 4);
  Shape sheet = parallelogram(corner, u, v, add_diffuse(scene, 0.5f));
  // Coordinates that grow along u and v, from 2 to 5 and from 0 to 1.
  auto& mesh = std::get<Mesh>(sheet.geometry);
  for (const glm::dvec3& p : mesh.positions) {
    const glm::dvec3 at = p - corner;
    mesh.texcoords.emplace_back(2 + 3 * at.y / 4, at.z / 4);
  }
  scene.shapes.push_back(sheet);
  const glm::dvec3 normal = glm::normalize(glm::cross(u, v));
  expect_means(render(with_layers(scene, kGeometry)),
               {"position.X", "position.Y", "position.Z", "uv.U", "uv.V", "geometric_normal.X",
                "geometric_normal.Z", "shape.ID"},
               [&](const glm::dvec3& d) -> std::vector<double> {
                 const double t = glm::dot(corner - kEye, normal) / glm::dot(d, normal);
                 const glm::dvec3 p = kEye + t * d, at = p - corner;
                 const glm::dvec3 facing = glm::dot(normal, d) < 0 ? normal : -normal;
                 return {p.x, p.y, p.z, 2 + 3 * at.y / 4, at.z / 4, facing.x, facing.z, 1};
               });
}

TEST(AskedLayers, PositionsAndTextureCoordinatesOfASphere) {
  SceneDescription scene = seen_scene();
  const glm::dvec3 centre = kEye + glm::dvec3(3, 0, 0);
  Shape ball{.name = "ball", .geometry = Sphere{.center = centre, .radius = 0.7}, .radiance = {}};
  ball.front_bsdf = add_diffuse(scene, 0.5f);
  scene.shapes.push_back(ball);
  expect_means(
      render(with_layers(scene, kGeometry)),
      {"position.X", "position.Y", "position.Z", "uv.U", "uv.V", "geometric_normal.X", "geometric_normal.Y",
       "geometric_normal.Z"},
      [&](const glm::dvec3& d) -> std::vector<double> {
        const glm::dvec3 from = kEye - centre;
        const double b = glm::dot(from, d), c = glm::dot(from, from) - 0.7 * 0.7, q = b * b - c;
        if (q < 0) return std::vector<double>(8, 0.0);
        const glm::dvec3 p = kEye + (-b - std::sqrt(q)) * d, n = (p - centre) / 0.7;
        const double longitude = std::atan2(n.y, n.x) / (2 * std::numbers::pi);
        return {p.x, p.y, p.z, longitude < 0 ? longitude + 1 : longitude, std::acos(n.z) / std::numbers::pi,
                n.x, n.y, n.z};
      });
}

TEST(AskedLayers, GeometricNormalsAreThoseOfFacets) {
  // An octahedron whose vertex normals make it look round.
  SceneDescription scene = seen_scene();
  const glm::dvec3 centre = kEye + glm::dvec3(3, 0.2, 0.1);
  Mesh mesh;
  for (const glm::vec3& corner :
       {glm::vec3(1, 0, 0), {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
    mesh.positions.push_back(centre + glm::dvec3(corner));
    mesh.normals.push_back(corner);
  }
  for (const unsigned x : {0u, 1u})
    for (const unsigned y : {2u, 3u})
      for (const unsigned z : {4u, 5u})
        mesh.triangles.push_back((x + y + z) % 2 == 0 ? glm::uvec3(x, y, z) : glm::uvec3(x, z, y));
  Shape shape{.name = "octahedron", .geometry = mesh, .radiance = {}};
  shape.front_bsdf = shape.back_bsdf = add_diffuse(scene, 0.5f);
  scene.shapes.push_back(shape);
  const Image image = render(with_layers(scene, "geometric_normal"));
  int inside = 0, bent = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const glm::dvec3 n(value(image, x, y, "geometric_normal.X"), value(image, x, y, "geometric_normal.Y"),
                         value(image, x, y, "geometric_normal.Z"));
      if (glm::length(n) < 0.999999) continue;  // at an edge
      ++inside;
      // The facets that the camera sees have normals (-1, +-1, +-1) / sqrt 3.
      const double part = 1 / std::sqrt(3.0);
      EXPECT_NEAR(n.x, -part, 1e-6);
      EXPECT_NEAR(std::abs(n.y), part, 1e-6);
      EXPECT_NEAR(std::abs(n.z), part, 1e-6);
      const glm::dvec3 shading(value(image, x, y, "normal.X"), value(image, x, y, "normal.Y"),
                               value(image, x, y, "normal.Z"));
      bent += glm::length(shading - n) > 0.1 ? 1 : 0;
    }
  EXPECT_GT(inside, 60);
  EXPECT_GT(bent, inside / 2);
}

// --- shapes

/// Four spheres in a row from left to right, the second and third of a group, the third of which emits.
SceneDescription row_of_spheres() {
  SceneDescription scene = seen_scene();
  const int bsdf = add_diffuse(scene, 0.5f);
  const auto ball = [&](double left) {
    Shape shape{.name = "ball",
                .geometry = Sphere{.center = kEye + glm::dvec3(4, left, 0), .radius = 0.3},
                .radiance = {}};
    shape.front_bsdf = bsdf;
    return shape;
  };
  scene.shapes = {ball(1.05), ball(-1.05)};
  Shape lamp = ball(-0.35);
  lamp.radiance = glm::vec3(1.0f);
  // An unused group has numbers, too.
  scene.groups = {{.name = "unused", .shapes = {ball(9)}, .instances = {}},
                  {.name = "pair", .shapes = {ball(0.35), lamp}, .instances = {}}};
  scene.instances = {{.name = "there", .group = 1}};
  return scene;
}

TEST(AskedLayers, ShapesHaveTheirNumbers) {
  const SceneDescription scene = with_layers(row_of_spheres(), "shape");
  const std::pair<double, int> expected[] = {{1.05, 1}, {-1.05, 2}, {0.35, 4}, {-0.35, 5}};
  TestDevice device = native_device();
  for (const std::uint32_t pass : {16u, 5u, 1u}) {
    device.samples_per_pass = pass;
    const Image image = render(scene, device);
    std::set<double> found;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) found.insert(value(image, x, y, "shape.ID"));
    EXPECT_THAT(found, ::testing::ElementsAre(0, 1, 2, 4, 5));
    for (const auto& [left, number] : expected) {
      const double half = std::tan(kFov / 2 * std::numbers::pi / 180);
      const int x = int((1 - left / 4 / half) / 2 * kSide);
      EXPECT_EQ(value(image, x, kSide / 2, "shape.ID"), number) << left;
    }
  }
}

TEST(AskedLayers, TheShapeIsThatOfTheFirstSample) {
  const SceneDescription description = with_layers(row_of_spheres(), "shape");
  const FilmAccumulator film = render_or_throw(description);
  SceneDescription one = description;
  one.sampler.spp = 1;
  const FilmAccumulator first = render_or_throw(one);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      ASSERT_EQ(film.layer(x, y, LAYER_SHAPE), first.layer(x, y, LAYER_SHAPE)) << x << ' ' << y;
}

TEST(AskedLayers, TheMeanOfTwoFilmsKeepsShapes) {
  const FilmLayers layers(FEATURE_SHAPE_LAYER | FEATURE_POSITION_LAYER);
  const auto film = [&](float number) {
    FilmAccumulator filled(0, 0, 1, 1, layers);
    SampleBuffer buffer{.width = 1, .height = 1, .planes = layers.planes(), .sample_count = 4, .values = {}};
    buffer.values.assign(std::size_t(layers.planes()), number);
    if (number > 0) filled.add(0, 0, buffer);
    return filled;
  };
  FilmAccumulator mean(0, 0, 1, 1, layers);
  mean.set_mean_of(film(2), film(5));
  EXPECT_EQ(mean.layer(0, 0, LAYER_SHAPE), 2);
  EXPECT_EQ(mean.layer(0, 0, LAYER_POSITION), 3.5);
  mean.set_mean_of(film(0), film(5));
  EXPECT_EQ(mean.layer(0, 0, LAYER_SHAPE), 5);
}

// --- direct and indirect light

/// Sums of floats: each layer's mean has a few roundings of the pixel's largest samples.
void expect_sums(const Image& image) {
  for (int y = 0; y < image.data.height; ++y)
    for (int x = 0; x < image.data.width; ++x)
      for (const char* channel : {"R", "G", "B"}) {
        const double all = value(image, x, y, channel);
        const std::string name = std::string(".") + channel;
        ASSERT_NEAR(value(image, x, y, "direct" + name) + value(image, x, y, "indirect" + name), all,
                    1e-6 * all + 1e-12)
            << channel << " of pixel " << x << ' ' << y;
      }
}

/// Paths of at most two edges have the same random numbers.
void expect_direct(const SceneDescription& scene) {
  SceneDescription twice = scene;
  set(twice, "integrator.max_depth", "2");
  const Image image = render(scene), direct = render(twice);
  expect_sums(image);
  double indirect = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (const char* channel : {"R", "G", "B"}) {
        const double expected = value(direct, x, y, channel);
        ASSERT_NEAR(value(image, x, y, std::string("direct.") + channel), expected, 1e-6 * expected);
        ASSERT_EQ(value(direct, x, y, std::string("indirect.") + channel), 0);
        indirect += value(image, x, y, std::string("indirect.") + channel);
      }
  EXPECT_GT(indirect, 0.01);
}

TEST(AskedLayers, DirectLightIsThatOfOneBounce) {
  expect_direct(cornell_box("direct,indirect"));
  SceneDescription smoke = read_or_throw(project_file("scenes/smoke/smoke.xml"));
  resize_film(smoke, kSide, kSide);
  smoke.sampler.spp = 4;
  expect_direct(with_layers(smoke, "direct,indirect"));
  SceneDescription glass = read_or_throw(project_file("scenes/materials/materials.xml"));
  resize_film(glass, kSide, kSide);
  glass.sampler.spp = 4;
  expect_direct(with_layers(glass, "indirect,direct"));
}

TEST(AskedLayers, DirectLightIsThatOfTheDirectIntegrator) {
  constexpr int kBatches = 16, kBlock = 2, kBlocks = kSide * kSide / (kBlock * kBlock);
  SceneDescription path = cornell_box("direct"), direct = cornell_box("none");
  direct.integrator = direct_integrator(1, 1);
  std::vector<statistics::Image> of_layer, of_image;
  for (int batch = 0; batch < kBatches; ++batch) {
    path.sampler.seed = std::uint32_t(100 + batch);
    direct.sampler.seed = std::uint32_t(200 + batch);
    const Image image = render(path);
    statistics::Image layer(kSide, kSide, 3);
    for (int i = 0; i < kSide * kSide; ++i)
      for (int c = 0; c < 3; ++c)
        layer.at(i % kSide, i / kSide, c) =
            value(image, i % kSide, i / kSide, std::string("direct.") + "RGB"[c]);
    of_layer.push_back(statistics::block_average(layer, kBlock));
    of_image.push_back(statistics::block_average(mean_image(render_or_throw(direct)), kBlock));
  }
  // The channels of a block may go together: then the mean of z^2 has the spread of the blocks' number alone.
  const statistics::ImageTestLimits limits{.mean_square = 1 + 2.33 * std::sqrt(2.0 / kBlocks)};
  const auto result = statistics::z_test(statistics::estimate_from_batches(of_layer),
                                         statistics::estimate_from_batches(of_image), limits);
  EXPECT_TRUE(result.passed) << result.summary();
}

TEST(AskedLayers, ChannelsWithRaysOfTheirOwnAreSplit) {
  SceneDescription scene = cornell_box("direct,indirect");
  set(scene, "camera.magnify_red", "0.02");
  expect_sums(render(scene));
}

TEST(AskedLayers, IntegratorsThatCannotSplitLightSaySo) {
  const auto error = [](const char* integrator, const char* layer, const char* more = "integrator.rr_depth") {
    SceneDescription scene = cornell_box(layer);
    set(scene, "integrator.type", integrator);
    if (std::string(more) == "integrator.nee") set(scene, more, "cv");
    const auto built = build_device_scene(scene, {});
    return built ? std::string("no error") : built.error().message;
  };
  for (const char* integrator : {"direct", "whitted", "ao", "ppm", "photonmapper", "polygon_cv"})
    for (const char* layer : {"direct", "indirect"})
      EXPECT_THAT(error(integrator, layer),
                  AllOf(HasSubstr("film.layers"), HasSubstr(std::string("'") + integrator + "'"),
                        HasSubstr("path and volpath")))
          << layer;
  EXPECT_THAT(error("path", "direct", "integrator.nee"), HasSubstr("set nee to sample"));
}

// --- what is asked for, and nothing else

TEST(AskedLayers, OnlyWhatIsAskedForIsThere) {
  const std::uint64_t plain = build_or_throw(cornell_box("none")).header.features;
  EXPECT_EQ(plain & LAYERS_ON_DEMAND, 0u);
  const std::pair<const char*, int> planes[] = {{"position", 3}, {"uv", 2},     {"geometric_normal", 3},
                                                {"shape", 1},    {"direct", 3}, {"indirect", 3}};
  int all = 0;
  for (const auto& [name, count] : planes) {
    const DeviceScene scene = build_or_throw(cornell_box(name));
    EXPECT_EQ(plane_count(scene.header.features), plane_count(plain) + count) << name;
    EXPECT_EQ(scene.header.tables.primitive_shapes.count > 0, std::string(name) == "shape");
    EXPECT_EQ(scene.header.tables.vertex_uvs.count > 0, std::string(name) == "uv");
    all += count;
  }
  EXPECT_EQ(plane_count(build_or_throw(cornell_box(kAll)).header.features), plane_count(plain) + all);
}

TEST(AskedLayers, DoNotChangeTheImage) {
  for (const char* integrator : {"path", "direct", "whitted", "ao", "polygon_cv", "ppm"}) {
    SceneDescription scene = cornell_box("none");
    set(scene, "integrator.type", integrator);
    const bool splits = std::string(integrator) == "path";
    const Image without = render(scene), with = render(with_layers(scene, splits ? kAll : kGeometry));
    for (const std::string& channel : without.channels)
      for (int i = 0; i < kSide * kSide; ++i)
        ASSERT_EQ(value(with, i % kSide, i / kSide, channel), value(without, i % kSide, i / kSide, channel))
            << integrator << ' ' << channel;
  }
}

TEST(AskedLayers, GeometryIsTheSameForEveryIntegrator) {
  const Image reference = render(cornell_box(kGeometry));
  for (const char* integrator : {"direct", "whitted", "ao", "ppm", "photonmapper"}) {
    SceneDescription scene = cornell_box(kGeometry);
    set(scene, "integrator.type", integrator);
    const Image image = render(scene);
    for (const char* channel : {"position.Y", "uv.U", "geometric_normal.X", "shape.ID"})
      for (int i = 0; i < kSide * kSide; ++i)
        ASSERT_EQ(value(image, i % kSide, i / kSide, channel),
                  value(reference, i % kSide, i / kSide, channel))
            << integrator << ' ' << channel;
  }
}

TEST(AskedLayers, OpenClGivesTheSameBits) {
  std::vector<DeviceScene> scenes = {build_or_throw(cornell_box(kAll)),
                                     build_or_throw(with_layers(row_of_spheres(), kAll))};
  share_needs(scenes);
  for (const DeviceScene& scene : scenes)
    EXPECT_EQ(render_or_throw(scene, opencl_device()).hash(), render_or_throw(scene).hash());
}

TEST(AskedLayers, OpenClGivesTheSameBitsOfSomeOfThem) {
  std::vector<SceneDescription> scenes = {cornell_box("shape"), cornell_box("indirect"),
                                          with_layers(row_of_spheres(), kGeometry)};
  for (const SceneDescription& scene : scenes)
    EXPECT_EQ(render_or_throw(scene, opencl_device()).hash(), render_or_throw(scene).hash());
}

TEST(AskedLayers, NonFiniteLightIsDroppedFromBothParts) {
  SceneDescription scene = cornell_box("direct,indirect");
  // Radiance whose reflection overflows a float: such samples are left out everywhere.
  for (Shape& shape : scene.shapes)
    if (shape.radiance) *shape.radiance = glm::vec3(2e38f);
  const FilmAccumulator film = render_or_throw(scene);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (int c = 0; c < 3; ++c) {
        const double all = film.at(x, y).mean[c];
        ASSERT_NEAR(film.layer(x, y, LAYER_DIRECT, c) + film.layer(x, y, LAYER_INDIRECT, c), all, 1e-6 * all);
      }
  EXPECT_GT(film.flagged()[BAD_INFINITE].count, 0u);
}

}  // namespace
}  // namespace penumbra
