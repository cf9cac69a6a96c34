// Height fields of Mitsuba 0.6: positions of vertices, normals against bilinear patches, their image formats,
// errors, and conversion to meshes.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <cmath>

#include "kernels/math/vec3.h"
#include "scenes/heightfield.h"
#include "scenes/image/bitmap_values.h"
#include "tests/scenes/mitsuba_text.h"
#include "tests/support/tga_file.h"
#include "tests/support/written_scene.h"

namespace penumbra {
namespace {

class Heightfields : public MitsubaPlugins {
 protected:
  /// An image of floats, rows from the top.
  void write_exr(const std::string& name, int width, int height, const std::vector<float>& values) {
    const std::string path = (folder_ / name).string();
    auto output = OIIO::ImageOutput::create(path);
    ASSERT_TRUE(output);
    OIIO::ImageSpec spec(width, height, 1, OIIO::TypeFloat);
    spec.channelnames = {"Y"};
    ASSERT_TRUE(output->open(path, spec)) << output->geterror();
    ASSERT_TRUE(output->write_image(OIIO::TypeFloat, values.data()));
    ASSERT_TRUE(output->close());
  }
  static const Mesh& mesh(const SceneDescription& s) { return std::get<Mesh>(s.shapes.at(0).geometry); }
  static std::string field(const std::string& inside) {
    return in("shape", "heightfield", "<string name='filename' value='h.exr'/>" + inside);
  }
};

Mesh made(int width, int height, const std::vector<double>& values, bool smooth, double scale = 1) {
  const auto mesh = make_heightfield(float_bitmap("test", width, height, 1, values), 1.0f, scale, smooth);
  EXPECT_TRUE(mesh) << mesh.error().message;
  return mesh ? *mesh : Mesh{};
}

TEST_F(Heightfields, VerticesAreTexelsAndTheTopRowIsAtTheLowEnd) {
  write_exr("h.exr", 3, 2, {1, 2, 3, 4, 5, 8});
  const SceneDescription scene =
      good(field("<float name='scale' value='0.5'/>" + to_world("<translate x='10'/>")));
  const Mesh& m = mesh(scene);
  ASSERT_THAT(m.positions, SizeIs(6));
  ASSERT_THAT(m.texcoords, SizeIs(6));
  EXPECT_THAT(m.normals, SizeIs(6));
  EXPECT_EQ(m.positions[0], glm::dvec3(9, -1, 0.5));
  EXPECT_EQ(m.positions[1], glm::dvec3(10, -1, 1));
  EXPECT_EQ(m.positions[5], glm::dvec3(11, 1, 4));
  EXPECT_EQ(m.texcoords[1], glm::vec2(0.5f, 0));
  EXPECT_EQ(m.texcoords[5], glm::vec2(1, 1));
  ASSERT_THAT(m.triangles, SizeIs(4));
  // Seen from above they cover the square once, all facing up, and share the way to larger x and y.
  double area = 0;
  for (const glm::uvec3& t : m.triangles) {
    const glm::dvec3 a = m.positions[t.x], b = m.positions[t.y], c = m.positions[t.z];
    const double above = 0.5 * glm::cross(b - a, c - a).z;
    EXPECT_GT(above, 0);
    area += above;
  }
  EXPECT_DOUBLE_EQ(area, 4.0);
  EXPECT_EQ(m.triangles[0], glm::uvec3(0, 1, 4));
  EXPECT_EQ(m.triangles[1], glm::uvec3(0, 4, 3));
}

TEST_F(Heightfields, APlaneHasItsNormalEverywhere) {
  // z = 0.75 x - 0.25 y on a grid whose steps differ.
  std::vector<double> values;
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 9; ++x) values.push_back(0.75 * (x / 4.0 - 1) - 0.25 * (y / 2.0 - 1));
  const Mesh m = made(9, 5, values, true);
  const auto normal = glm::vec3(glm::normalize(glm::dvec3(-0.75, 0.25, 1)));
  ASSERT_THAT(m.normals, SizeIs(45));
  for (const glm::vec3& n : m.normals) EXPECT_LT(glm::distance(n, normal), 1e-6f);
  EXPECT_THAT(made(9, 5, values, false).normals, IsEmpty());
}

TEST_F(Heightfields, NormalsOfASmoothSurfaceComeNearItsOwn) {
  // Second order inside: halving the steps quarters the largest error.
  const auto largest_error = [](int cells) {
    std::vector<double> values;
    const auto place = [&](int i) { return 2.0 * i / cells - 1; };
    for (int y = 0; y <= cells; ++y)
      for (int x = 0; x <= cells; ++x) values.push_back(0.3 * std::sin(2 * place(x)) * std::cos(place(y)));
    const Mesh m = made(cells + 1, cells + 1, values, true);
    double largest = 0;
    for (int y = 1; y < cells; ++y)
      for (int x = 1; x < cells; ++x) {
        const double u = place(x), v = place(y);
        const glm::dvec3 exact = glm::normalize(
            glm::dvec3(-0.6 * std::cos(2 * u) * std::cos(v), 0.3 * std::sin(2 * u) * std::sin(v), 1));
        const glm::dvec3 own(m.normals[std::size_t(y * (cells + 1) + x)]);
        largest = std::max(largest, glm::distance(own, exact));
      }
    return largest;
  };
  const double coarse = largest_error(32), fine = largest_error(64);
  EXPECT_LT(fine, 1e-3);
  EXPECT_NEAR(coarse / fine, 4.0, 0.4);
}

TEST_F(Heightfields, ColoursCountByTheirLuminanceAndWholeNumbersByTheirEncoding) {
  write("h.tga",
        tga_file(2, 2, 3, std::vector<std::uint8_t>{255, 0, 0, 0, 255, 0, 0, 0, 255, 128, 128, 128}));
  const auto heights = [&](const std::string& inside) {
    const SceneDescription scene = good(in("shape", "heightfield", inside));
    std::vector<double> z;
    for (const glm::dvec3& p : mesh(scene).positions) z.push_back(p.z);
    return z;
  };
  const std::string name = "<string name='filename' value='h.tga'/>";
  const std::vector<double> own = heights(name);
  EXPECT_FLOAT_EQ(float(own[0]), luminance(make_vec3(1, 0, 0)));
  EXPECT_FLOAT_EQ(float(own[1]), luminance(make_vec3(0, 1, 0)));
  EXPECT_FLOAT_EQ(float(own[3]), decoded_value(128, 255, kSrgb));
  const std::vector<double> linear =
      heights(in("texture", "bitmap", name + "<float name='gamma' value='1'/>"));
  EXPECT_FLOAT_EQ(float(linear[3]), 128.0f / 255.0f);
  const std::vector<double> scaled =
      heights("<float name='scale' value='3'/>" +
              in("texture", "scale", "<float name='scale' value='2'/>" + in("texture", "bitmap", name)));
  for (std::size_t i = 0; i < 4; ++i) EXPECT_FLOAT_EQ(float(scaled[i]), float(6 * own[i]));
}

TEST_F(Heightfields, AreFacetedAndTurnedRoundWhereTheyAreAskedToBe) {
  write_exr("h.exr", 3, 3, {0, 1, 0, 1, 2, 1, 0, 1, 0});
  const SceneDescription scene = good(field(
      "<boolean name='shadingNormals' value='false'/><boolean name='flipNormals' value='true'/><integer "
      "name='width' value='9'/>" +
      in("bsdf", "diffuse")));
  EXPECT_THAT(mesh(scene).normals, IsEmpty());
  EXPECT_TRUE(scene.shapes[0].flip_normals);
  EXPECT_THAT(scene.warnings, IsEmpty());
}

TEST_F(Heightfields, AreWrittenAsMeshes) {
  write_exr("h.exr", 3, 3, {0, 1, 0, 1, 2, 1, 0, 1, 0});
  const SceneDescription scene = good(field(to_world("<scale x='2'/><rotate y='1' angle='30'/>")));
  const auto written = write_scene(scene, folder_ / "written.xml");
  ASSERT_TRUE(written) << written.error().message;
  const auto again = read_scene(folder_ / "written.xml", {});
  ASSERT_TRUE(again) << again.error().message;
  const Mesh &before = mesh(scene), &after = mesh(*again);
  EXPECT_EQ(after.positions, before.positions);
  EXPECT_EQ(after.texcoords, before.texcoords);
  EXPECT_EQ(after.triangles, before.triangles);
  ASSERT_EQ(after.normals.size(), before.normals.size());
  for (std::size_t i = 0; i < after.normals.size(); ++i)
    EXPECT_LT(glm::distance(after.normals[i], before.normals[i]), 1e-6f);
}

TEST_F(Heightfields, WhatIsWrongIsNamed) {
  write_exr("h.exr", 2, 2, {0, 1, 0, 1});
  write_exr("thin.exr", 1, 4, {0, 1, 0, 1});
  const auto wrong = [&](const std::string& inside) {
    return error(scene(in("shape", "heightfield", inside)));
  };
  const std::string texture = in("texture", "bitmap", "<string name='filename' value='h.exr'/>");
  EXPECT_THAT(wrong(""), HasSubstr("needs a <string name=\"filename\""));
  EXPECT_THAT(wrong("<string name='filename' value='h.exr'/>" + texture), HasSubstr("not both"));
  EXPECT_THAT(wrong("<string name='filename' value='thin.exr'/>"),
              HasSubstr("at least 2 x 2 texels, not 1 x 4"));
  EXPECT_THAT(wrong("<string name='filename' value='none.exr'/>"), HasSubstr("there is no file 'none.exr'"));
  EXPECT_THAT(wrong(in("texture", "checkerboard")), HasSubstr("has no texels of its own"));
  EXPECT_THAT(wrong(in("texture", "scale")), HasSubstr("holds the texture that it scales"));
  EXPECT_THAT(wrong(in("texture", "scale", "<rgb name='scale' value='1,2,3'/>" + texture)),
              HasSubstr("scaled by a number"));
  EXPECT_THAT(wrong("<string name='filename' value='h.exr'/><float name='scale' value='1e300'/>"),
              HasSubstr("too far away"));
  EXPECT_THAT(wrong("<string name='filename' value='h.exr'/><float name='size' value='1'/>"),
              HasSubstr("size"));
}

}  // namespace
}  // namespace penumbra
