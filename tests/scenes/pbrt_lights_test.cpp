// Area lights and image lights of pbrt-v4, and the faces of meshes.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <span>

#include "scenes/image/bitmap_values.h"
#include "scenes/pbrt/mesh_faces.h"
#include "tests/scenes/pbrt_text.h"
#include "tests/scenes/png_writer.h"
#include "tests/support/tga_file.h"

namespace penumbra::pbrt_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class PbrtLights : public PbrtText {
 protected:
  static constexpr const char* kLit = "AreaLightSource \"diffuse\" \"rgb L\" [4 4 4]\n";
  static std::string triangle_with(const std::string& more) {
    return "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"point2 uv\" [0 0 1 0 0 1] " + more +
           "\n";
  }
};

TEST_F(PbrtLights, AlphaCutsEmission) {
  EXPECT_EQ(good_pbrt(kLit + triangle_with("\"float alpha\" 0.25")).shapes[0].radiance, glm::vec3(1.0f));
  EXPECT_EQ(good_pbrt(kLit + triangle_with("\"float alpha\" 3")).shapes[0].radiance, glm::vec3(4.0f));
  const SceneDescription unseen = good_pbrt(kLit + triangle_with("\"float alpha\" 0"));
  EXPECT_EQ(unseen.shapes[0].radiance, glm::vec3(4.0f)) << "a light that no ray meets";
  EXPECT_TRUE(unseen.shapes[0].unseen_emission);
  write("a.png", png_file(2, 1, 1, std::vector<std::uint8_t>{255, 51}));
  const std::string alpha =
      "Texture \"a\" \"float\" \"imagemap\" \"string filename\" \"a.png\" \"string encoding\" \"linear\"\n";
  const SceneDescription cut = good_pbrt(alpha + kLit + triangle_with("\"texture alpha\" \"a\""));
  EXPECT_EQ(cut.shapes[0].radiance_texture, std::get<MaskBsdf>(front(cut)).opacity.texture);
  write("l.tga", tga_file(2, 1, 1, std::vector<std::uint8_t>{255, 255}));
  const SceneDescription both =
      good_pbrt(alpha + "AreaLightSource \"diffuse\" \"string filename\" \"l.tga\"\n" +
                triangle_with("\"texture alpha\" \"a\""));
  const auto& model =
      std::get<BitmapTexture>(both.textures.at(std::size_t(both.shapes[0].radiance_texture)).model);
  const Bitmap& product = *both.bitmaps.at(std::size_t(model.bitmap));
  EXPECT_NEAR(bitmap_value(product, 0, 1.0f), 1.0, 1e-3);
  EXPECT_NEAR(bitmap_value(product, 3, 1.0f), 0.2, 1e-3);
}

TEST_F(PbrtLights, InterfacesDoNotShine) {
  const SceneDescription scene = good_pbrt("Material \"interface\"\n" + (kLit + triangle_with("")));
  EXPECT_FALSE(scene.shapes[0].radiance);
  EXPECT_THAT(warnings(scene), HasSubstr("an area light on the material 'interface' is ignored"));
}

TEST_F(PbrtLights, EachFaceHasThePower) {
  // Triangles of areas 1/2 and 2.
  const SceneDescription scene = good_pbrt(
      "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] \"float power\" 6\n"
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 5 0 0 7 0 0 5 2 0] \"integer indices\" [0 1 2 "
      "3 4 5]\n");
  ASSERT_EQ(scene.shapes.size(), 2u);
  EXPECT_NEAR(scene.shapes[0].radiance->x, 6 / (std::numbers::pi * 0.5), 1e-5);
  EXPECT_NEAR(scene.shapes[1].radiance->x, 6 / (std::numbers::pi * 2), 1e-6);
  EXPECT_EQ(mesh(scene, 1).positions.size(), 3u);
  const SceneDescription patch = good_pbrt(
      "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] \"float power\" 6\n"
      "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0] \"integer indices\" [0 1 2 3]\n");
  ASSERT_EQ(patch.shapes.size(), 1u);
  EXPECT_NEAR(patch.shapes[0].radiance->x, 6 / std::numbers::pi, 1e-6) << "a patch is one light";
}

TEST_F(PbrtLights, MeshesWithoutCoordinatesHavePbrts) {
  write("t.tga", tga_file(1, 1, 1, std::vector<std::uint8_t>{255}));
  const std::string material =
      "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.tga\"\n"
      "Material \"diffuse\" \"texture reflectance\" \"t\"\n";
  const SceneDescription scene = good_pbrt(
      material +
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0] \"integer indices\" [0 1 2 3 2 1]\n"
      "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0] \"integer indices\" [0 1 2 3]\n");
  using glm::vec2;
  EXPECT_THAT(mesh(scene, 0).texcoords,
              ElementsAre(vec2(0, 0), vec2(1, 0), vec2(1, 1), vec2(0, 0), vec2(1, 0), vec2(1, 1)));
  // Of a patch they are its u and v.
  const Mesh& patch = mesh(scene, 1);
  for (std::size_t i = 0; i < patch.positions.size(); ++i)
    EXPECT_EQ(patch.texcoords[i], vec2(patch.positions[i].x, patch.positions[i].y));
  EXPECT_EQ(mesh(good_pbrt(kTriangle)).texcoords.size(), 0u) << "nothing needs them";
}

TEST_F(PbrtLights, CoordinatesAreThoseOfTheFilesTriangles) {
  write("t.tga", tga_file(1, 1, 1, std::vector<std::uint8_t>{255}));
  const std::string material =
      "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.tga\"\n"
      "Material \"diffuse\" \"texture reflectance\" \"t\"\n";
  using glm::vec2;
  // The first patch is a pole: its corners (0, 0) and (1, 0) are one point, so that of its two triangles the
  // second alone is left. The second patch is the unit square moved by 5 along x.
  const std::string patches =
      "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 0 0 0 0 1 0 1 1 0 5 0 0 6 0 0 5 1 0 6 1 0] "
      "\"integer indices\" [0 1 2 3 4 5 6 7]\n";
  const SceneDescription scene = good_pbrt(material + patches);
  const Mesh& pole = mesh(scene);
  ASSERT_EQ(pole.triangles.size(), 3u);
  EXPECT_THAT(std::span(pole.texcoords).first(3), ElementsAre(vec2(0, 0), vec2(1, 1), vec2(0, 1)));
  for (std::size_t i = 3; i < 9; ++i)
    EXPECT_EQ(pole.texcoords[i], vec2(pole.positions[i].x - 5, pole.positions[i].y)) << i;
  // Of which each has its own power: areas of 1/2 and 1.
  const SceneDescription lit =
      good_pbrt(material + "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] \"float power\" 6\n" + patches);
  ASSERT_EQ(lit.shapes.size(), 2u);
  EXPECT_EQ(mesh(lit, 0).triangles.size(), 1u);
  EXPECT_EQ(mesh(lit, 1).triangles.size(), 2u);
  EXPECT_NEAR(lit.shapes[0].radiance->x, 6 / (std::numbers::pi * 0.5), 1e-5);
  EXPECT_NEAR(lit.shapes[1].radiance->x, 6 / std::numbers::pi, 1e-6);
  EXPECT_THAT(mesh(lit, 0).texcoords, ElementsAre(vec2(0, 0), vec2(1, 1), vec2(0, 1)));
  // Normals against the winding, and mirrors, turn triangles; each vertex keeps its coordinates.
  const std::string triangle =
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 1 0] \"integer indices\" [0 1 2]";
  for (const std::string& turned :
       {triangle + " \"normal N\" [0 0 -1 0 0 -1 0 0 -1]\n", "Scale 1 1 -1\n" + triangle + "\n"}) {
    const SceneDescription against = good_pbrt(material + turned);
    EXPECT_LT(front_normal(against).z, 0.0);
    const Mesh& m = mesh(against);
    ASSERT_EQ(m.texcoords.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(m.texcoords[i], vec2(m.positions[i].x, m.positions[i].y)) << turned;
  }
}

TEST_F(PbrtLights, SpheresCountVFromBelow) {
  const SceneDescription scene = good_pbrt("Shape \"sphere\"");
  expect_near(std::get<Sphere>(scene.shapes.at(0).geometry).z_axis, {0, 0, -1});
}

TEST_F(PbrtLights, FloatTexturesAreMeansOfColours) {
  const std::vector<std::uint8_t> colour = {0, 51, 255};
  write("c.png", png_file(1, 1, 3, colour));
  write("c.tga", tga_file(1, 1, 3, colour));
  const auto value = [&](const std::string& parameters, const std::string& warning) {
    const SceneDescription scene = good_pbrt("Texture \"t\" \"float\" \"imagemap\" \"string filename\" " +
                                             parameters + "\n" + triangle_with("\"texture alpha\" \"t\""));
    EXPECT_THAT(warnings(scene), HasSubstr(warning));
    const auto& model = std::get<BitmapTexture>(
        scene.textures.at(std::size_t(std::get<MaskBsdf>(front(scene)).opacity.texture)).model);
    EXPECT_EQ(model.gamma, 1.0f);
    return double(bitmap_value(*scene.bitmaps.at(std::size_t(model.bitmap)), 0, 1.0f));
  };
  // By the curve of IEC 61966-2-1.
  const double linear = (1.0 + 0.2) / 3, srgb = (1.0 + std::pow((0.2 + 0.055) / 1.055, 2.4)) / 3;
  EXPECT_NEAR(value("\"c.png\"", ""), srgb, 1e-6);
  EXPECT_NEAR(value("\"c.png\" \"string encoding\" \"linear\"", ""), linear, 1e-6);
  EXPECT_NEAR(value("\"c.tga\"", ""), srgb, 1e-6);
  EXPECT_NEAR(value("\"c.tga\" \"string encoding\" \"linear\"", "the encoding 'linear' is ignored"), srgb,
              1e-6);
}

TEST_F(PbrtLights, GoniometricLightsHaveTheirPolesAlongY) {
  // 16 x 16: the central diamond, the upper hemisphere of the octahedron, is white.
  std::vector<std::uint8_t> texels(256, 0);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x)
      if (std::abs(x - 7.5) + std::abs(y - 7.5) < 7.5) texels[std::size_t(16 * y + x)] = 255;
  write("up.tga", tga_file(16, 16, 1, texels));
  const SceneDescription scene =
      good_pbrt(std::string(kTriangle) +
                "LightSource \"goniometric\" \"string filename\" \"up.tga\" \"rgb I\" [1 1 1]\n");
  // The faces of a cube, two of which look along y.
  ASSERT_EQ(scene.emitters.size(), 6u);
  int poles = 0;
  for (const Emitter& each : scene.emitters) {
    const auto& face = std::get<ProjectorLight>(each);
    const auto& scale = std::get<ScaleTexture>(scene.textures.at(std::size_t(face.irradiance.texture)).model);
    const auto& image = std::get<BitmapTexture>(scene.textures.at(std::size_t(scale.texture)).model);
    const Bitmap& bitmap = *scene.bitmaps.at(std::size_t(image.bitmap));
    const auto center = std::size_t(bitmap.height / 2 * bitmap.width + bitmap.width / 2);
    const double up = face.to_world[2].y;
    if (std::abs(up) <= 0.5) continue;
    ++poles;
    EXPECT_EQ(bitmap_value(bitmap, 3 * center, 1.0f) > 0.0, up > 0.0);
  }
  EXPECT_EQ(poles, 2);
}

TEST_F(PbrtLights, TransformBlocksKeepTheWholeState) {
  const SceneDescription scene = good_pbrt(
      "Material \"diffuse\" \"rgb reflectance\" [1 0 0]\nTransformBegin\nTranslate 1 0 0\n"
      "Material \"diffuse\" \"rgb reflectance\" [0 1 0]\nTransformEnd\n" +
      std::string(kTriangle));
  EXPECT_EQ(std::get<DiffuseBsdf>(front(scene)).reflectance.value, glm::vec3(1, 0, 0));
  expect_near(mesh(scene).positions[0], glm::dvec3(0.0));
}

TEST_F(PbrtLights, StringsHaveEscapes) {
  const SceneDescription scene = good_pbrt(
      "MakeNamedMaterial \"a\\\"b\" \"string type\" \"diffuse\" \"rgb reflectance\" [0 1 0]\n"
      "NamedMaterial \"a\\\"b\"\n" +
      std::string(kTriangle));
  EXPECT_EQ(std::get<DiffuseBsdf>(front(scene)).reflectance.value, glm::vec3(0, 1, 0));
  EXPECT_THAT(wrong("NamedMaterial \"a\\qb\""), HasSubstr("'\\q' is no escape"));
}

TEST_F(PbrtLights, ImagesAndColoursExcludeEachOther) {
  EXPECT_THAT(wrong("LightSource \"infinite\" \"string filename\" \"x.png\" \"rgb L\" [1 1 1]"),
              HasSubstr("exclude each other"));
  EXPECT_THAT(wrong("LightSource \"projection\""), HasSubstr("needs a \"string filename\""));
}

}  // namespace
}  // namespace penumbra::pbrt_test
