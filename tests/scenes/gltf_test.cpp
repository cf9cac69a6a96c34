// Reading glTF: meshes, nodes, cameras, lights, materials.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "scenes/gltf/texture_builder.h"
#include "tests/scenes/gltf_text.h"
#include "tests/support/tga_file.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

void expect_near(glm::dvec3 a, glm::dvec3 b, double tolerance = 1e-12) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST_F(GltfText, ATriangleIsFacetedAndSeenFromInFront) {
  const SceneDescription scene = good_gltf(triangle().text(one_mesh(kTriangle)));
  ASSERT_EQ(scene.shapes.size(), 1u);
  EXPECT_TRUE(mesh(scene).normals.empty());
  EXPECT_EQ(mesh(scene).positions[1], glm::dvec3(1, 0, 0));
  EXPECT_EQ(mesh(scene).texcoords[0], glm::vec2(0, 1));
  EXPECT_EQ(mesh(scene).triangles, std::vector<glm::uvec3>({{0, 1, 2}}));
  EXPECT_THAT(warnings(scene), AllOf(HasSubstr("no camera"), HasSubstr("'Cameras'"),
                                     HasSubstr("no light; a white sky"), HasSubstr("'Punctual Lights'")));
  const auto& material = std::get<OpenPbrBsdf>(scene.bsdfs.at(std::size_t(scene.shapes[0].front_bsdf)).model);
  EXPECT_EQ(material.base_color.value, glm::vec3(1.0f));
  EXPECT_EQ(material.base_metalness.value, 1.0f);
  EXPECT_EQ(material.specular_roughness.value, 1.0f);
  EXPECT_EQ(scene.shapes[0].front_bsdf, scene.shapes[0].back_bsdf);
}

TEST_F(GltfText, BinaryFilesAndExternalBuffersAreTheSame) {
  const GltfFile file = triangle();
  write("scene.glb", file.binary(one_mesh(kTriangle)));
  const auto binary = read_scene(folder_ / "scene.glb", {});
  ASSERT_TRUE(binary) << binary.error().message;
  write("a b.bin", file.buffer());
  const SceneDescription external =
      good_gltf(fmt::format("{{\"asset\": {{\"version\": \"2.0\"}}, {}, {}}}", one_mesh(kTriangle),
                            file.buffers("\"uri\": \"a%20b.bin\", ")),
                {.confine_to = folder_.path()});
  const SceneDescription embedded = good_gltf(file.text(one_mesh(kTriangle)));
  EXPECT_EQ(mesh(*binary).positions, mesh(embedded).positions);
  EXPECT_EQ(mesh(external).positions, mesh(embedded).positions);
  EXPECT_EQ(external.files.size(), 2u) << "the buffer is one of the scene's files";
}

TEST_F(GltfText, StripsAndFansHaveTheTrianglesOfTheSpecification) {
  // Section 3.7.2.1: strips p(i) = {v(i), v(i + 1 + i % 2), v(i + 2 - i % 2)}, fans {v(i + 1), v(i + 2),
  // v(0)}.
  GltfFile file;
  file.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, 5);
  const auto triangles = [&](int mode) {
    return mesh(good_gltf(file.text(
                    one_mesh(fmt::format(R"({{"attributes": {{"POSITION": 0}}, "mode": {}}})", mode)))))
        .triangles;
  };
  EXPECT_EQ(triangles(5), std::vector<glm::uvec3>({{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
  EXPECT_EQ(triangles(6), std::vector<glm::uvec3>({{1, 2, 0}, {2, 3, 0}, {3, 4, 0}}));
}

TEST_F(GltfText, AllComponentTypesAndSparseAccessors) {
  GltfFile file;
  file.accessor<std::int8_t>("VEC3", {0, 0, 0, 127, 0, 0, 0, -128, 0}, 3, R"(, "normalized": true)");
  file.accessor<std::uint8_t>("SCALAR", {0, 1, 2}, 3);
  file.accessor<std::uint16_t>("SCALAR", {2, 1, 0}, 3);
  file.accessor<std::uint32_t>("SCALAR", {1, 2, 0}, 3);
  file.accessor<std::uint16_t>("VEC2", {0, 0, 65535, 0, 0, 65535}, 3, R"(, "normalized": true)");
  file.accessor<std::int16_t>("VEC3", {0, 0, 0, 300, 0, 0, 0, -7, 0}, 3);
  const int where = file.view(std::vector<std::uint16_t>{1, 2});
  const int what = file.view(std::vector<float>{4, 0, 0, 0, 5, 0});
  const int sparse = file.raw_accessor(fmt::format(
      R"({{"componentType": 5126, "count": 3, "type": "VEC3", "sparse": {{"count": 2,
 "indices": {{"bufferView": {}, "componentType": 5123}}, "values": {{"bufferView": {}}}}}}})",
      where, what));
  const SceneDescription scene = good_gltf(file.text(one_mesh(fmt::format(
      R"({{"attributes": {{"POSITION": 0, "TEXCOORD_0": 4}}, "indices": 1}},
{{"attributes": {{"POSITION": 5}}, "indices": 2}}, {{"attributes": {{"POSITION": {}}}, "indices": 3}})",
      sparse))));
  ASSERT_EQ(scene.shapes.size(), 3u);
  EXPECT_EQ(mesh(scene, 0).positions[1], glm::dvec3(1, 0, 0));
  EXPECT_EQ(mesh(scene, 0).positions[2], glm::dvec3(0, -1, 0)) << "-128 of 127 is -1";
  EXPECT_EQ(mesh(scene, 0).texcoords[2], glm::vec2(0, 1));
  EXPECT_EQ(mesh(scene, 1).positions[1], glm::dvec3(300, 0, 0));
  EXPECT_EQ(mesh(scene, 1).triangles, std::vector<glm::uvec3>({{2, 1, 0}}));
  EXPECT_EQ(mesh(scene, 2).positions[0], glm::dvec3(0, 0, 0));
  EXPECT_EQ(mesh(scene, 2).positions[1], glm::dvec3(4, 0, 0));
  EXPECT_EQ(mesh(scene, 2).positions[2], glm::dvec3(0, 5, 0));
  EXPECT_EQ(mesh(scene, 2).triangles, std::vector<glm::uvec3>({{1, 2, 0}}));
}

TEST_F(GltfText, NodesAreNestedAndMirrorsKeepTheFront) {
  // (1, 0, 0), twice as large, turned by 90 degrees about z, moved by (0, 0, 3), below a mirror in x.
  const double s = std::sqrt(0.5);
  const std::string nodes = fmt::format(
      R"("scenes": [{{"nodes": [0]}}], "nodes": [{{"children": [1], "matrix": [-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}},
{{"mesh": 0, "translation": [0,0,3], "rotation": [0,0,{:.17g},{:.17g}], "scale": [2,2,2]}}],
"meshes": [{{"primitives": [{}]}}])",
      s, s, kTriangle);
  const SceneDescription scene = good_gltf(triangle().text(nodes));
  expect_near(mesh(scene).positions[1], {0, 2, 3});
  expect_near(mesh(scene).positions[2], {2, 0, 3});
  // The front of the triangle, +z, is so still.
  const auto& m = mesh(scene);
  const glm::uvec3 t = m.triangles.at(0);
  EXPECT_GT(glm::cross(m.positions[t.y] - m.positions[t.x], m.positions[t.z] - m.positions[t.x]).z, 0.0);
}

TEST_F(GltfText, ACameraLooksAlongItsNegativeZ) {
  const SceneDescription scene = good_gltf(triangle().text(one_mesh(
      kTriangle,
      R"(, "cameras": [{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.5, "aspectRatio": 2.0}}])",
      R"(, "camera": 0, "translation": [1, 2, 3])")));
  EXPECT_NEAR(scene.camera.fov, 180.0 / std::numbers::pi, 1e-12);
  EXPECT_EQ(scene.camera.fov_axis, FovAxis::kY);
  EXPECT_EQ(scene.film.width, 2 * scene.film.height);
  EXPECT_EQ(scene.camera.near_clip, 0.5);
  // A point to the right of and above the axis is to the right and above: in camera space +x is left.
  const glm::dvec4 seen = glm::inverse(scene.camera.to_world) * glm::dvec4(1 + 0.25, 2 + 0.5, 3 - 2.0, 1);
  expect_near(glm::dvec3(seen), {-0.25, 0.5, 2.0});
}

TEST_F(GltfText, CandelaAreWattsBy683) {
  const SceneDescription scene = good_gltf(triangle().text(one_mesh(
      kTriangle,
      R"(, "extensionsUsed": ["KHR_lights_punctual"], "extensions": {"KHR_lights_punctual": {"lights":
 [{"type": "point", "intensity": 1366, "color": [1, 0.5, 0]}]}})",
      R"(, "translation": [0, 5, 0], "extensions": {"KHR_lights_punctual": {"light": 0}})")));
  const PointLight light = only<PointLight>(scene);
  EXPECT_EQ(light.intensity, glm::vec3(2, 1, 0));
  EXPECT_EQ(light.position, glm::dvec3(0, 5, 0));
}

TEST_F(GltfText, MetalRoughnessEmissionAndExtensions) {
  const SceneDescription scene = good_gltf(triangle().text(one_mesh(
      R"({"attributes": {"POSITION": 0}, "material": 0}, {"attributes": {"POSITION": 0}, "material": 1},
{"attributes": {"POSITION": 0}, "material": 2}, {"attributes": {"POSITION": 0}, "material": 3})",
      R"(, "extensionsUsed": ["KHR_materials_emissive_strength", "KHR_materials_transmission", "KHR_materials_ior",
"KHR_materials_volume", "KHR_materials_unlit"],
"materials": [{"name": "area_light", "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 1], "roughnessFactor": 0.4,
"metallicFactor": 0.6}, "emissiveFactor": [1, 0.5, 0.25], "doubleSided": true,
"extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8}}},
{"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0}, "extensions": {"KHR_materials_transmission":
{"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.33}}},
{"pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": {"KHR_materials_transmission":
{"transmissionFactor": 1}, "KHR_materials_volume": {"thicknessFactor": 1}}},
{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.25, 0.5]}, "alphaMode": "BLEND",
"extensions": {"KHR_materials_unlit": {}}}])")));
  ASSERT_EQ(scene.shapes.size(), 4u);
  const auto bsdf = [&](std::size_t shape) -> const BsdfModel& {
    return scene.bsdfs.at(std::size_t(scene.shapes[shape].front_bsdf)).model;
  };
  const auto& area_light = std::get<OpenPbrBsdf>(bsdf(0));
  EXPECT_EQ(area_light.base_color.value, glm::vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(area_light.specular_roughness.value, 0.4f);
  EXPECT_EQ(area_light.base_metalness.value, 0.6f);
  EXPECT_NEAR(area_light.specular_ior, 1.5f, 1e-6f);
  EXPECT_EQ(scene.shapes[0].radiance, glm::vec3(8, 4, 2));
  EXPECT_TRUE(scene.shapes[0].two_sided_emission);
  const auto& pane = std::get<OpenPbrBsdf>(bsdf(1));
  EXPECT_NEAR(pane.specular_ior, 1.33f, 1e-6f);
  EXPECT_EQ(pane.transmission_weight.value, 1.0f);
  EXPECT_TRUE(pane.thin_walled);
  EXPECT_TRUE(std::get<OpenPbrBsdf>(bsdf(2)).transmits());
  EXPECT_FALSE(std::get<OpenPbrBsdf>(bsdf(2)).thin_walled) << "a volume has an inside";
  EXPECT_TRUE(std::get<OpenPbrBsdf>(scene.bsdfs.at(std::size_t(scene.shapes[2].back_bsdf)).model).inside);
  EXPECT_EQ(std::get<MaskBsdf>(bsdf(3)).opacity.value, 0.5f);
  EXPECT_EQ(std::get<MaskBsdf>(bsdf(3)).inside, kBlackBsdf);
  EXPECT_EQ(scene.shapes[3].radiance, glm::vec3(0.25f, 0.25f, 0.125f)) << "half of it is there";
}

TEST_F(GltfText, SpecularColourAndClearCoatKeepTheirFactors) {
  const SceneDescription scene = good_gltf(triangle().text(one_mesh(
      R"({"attributes": {"POSITION": 0}, "material": 0})",
      R"(, "extensionsUsed": ["KHR_materials_specular", "KHR_materials_clearcoat", "KHR_materials_ior"],
"materials": [{"extensions": {"KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [2, 0.4, 1]},
"KHR_materials_clearcoat": {"clearcoatFactor": 0.75, "clearcoatRoughnessFactor": 0.25},
"KHR_materials_ior": {"ior": 0}}}])")));
  const auto& surface = std::get<OpenPbrBsdf>(scene.bsdfs.at(0).model);
  EXPECT_TRUE(surface.gltf) << "the specular colour is not the metal's";
  EXPECT_EQ(surface.specular_weight.value, 0.5f);
  const float below = surface.effective_ior(), step = (below - 1) / (below + 1);
  EXPECT_NEAR(surface.specular_color.value.y * step * step, 0.4f, 1e-5f)
      << "all is reflected along the normal";
  EXPECT_EQ(surface.coat_weight.value, 0.75f);
  EXPECT_EQ(surface.coat_roughness.value, 0.25f);
  EXPECT_EQ(surface.coat_ior, 1.5f);
  EXPECT_EQ(surface.coat_darkening, 0.0f) << "glTF's coat has no light to and fro below it";
}

TEST_F(GltfText, SpecularColoursAreReflectancesAlongTheNormal) {
  const SceneDescription scene = good_gltf(triangle().text(one_mesh(
      R"({"attributes": {"POSITION": 0}, "material": 0})",
      R"(, "extensionsUsed": ["KHR_materials_specular"], "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0},
"extensions": {"KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [2, 0.4, 1]}}}])")));
  const auto& surface = std::get<OpenPbrBsdf>(scene.bsdfs.at(0).model);
  const float step = (surface.specular_ior - 1) / (surface.specular_ior + 1);
  const glm::vec3 seen = surface.specular_color.value * (step * step);
  EXPECT_NEAR(seen.x, 0.08f, 1e-5f);
  EXPECT_NEAR(seen.y, 0.016f, 1e-5f);
  EXPECT_NEAR(seen.z, 0.04f, 1e-5f);
  EXPECT_EQ(surface.specular_weight.value, 0.5f) << "of all angles";
  EXPECT_FLOAT_EQ(surface.specular_ior, 1.5f) << "that of refraction";
}

TEST_F(GltfText, SurfacesMayTransmitPartly) {
  const SceneDescription scene = good_gltf(triangle().text(
      one_mesh(R"({"attributes": {"POSITION": 0}, "material": 0})",
               R"(, "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0}, "extensions":
{"KHR_materials_transmission": {"transmissionFactor": 0.25}}}])")));
  const auto& surface =
      std::get<OpenPbrBsdf>(scene.bsdfs.at(std::size_t(scene.shapes.at(0).front_bsdf)).model);
  EXPECT_EQ(surface.transmission_weight.value, 0.25f);
  EXPECT_TRUE(surface.thin_walled);
}

TEST_F(GltfText, SheenIsFuzzOfItsColour) {
  const SceneDescription scene = good_gltf(triangle().text(one_mesh(
      R"({"attributes": {"POSITION": 0}, "material": 0})",
      R"(, "extensionsUsed": ["KHR_materials_sheen"], "materials": [{"extensions": {"KHR_materials_sheen":
{"sheenColorFactor": [0.5, 0.25, 0], "sheenRoughnessFactor": 0.4}}}])")));
  const auto& surface = std::get<OpenPbrBsdf>(scene.bsdfs.at(0).model);
  EXPECT_EQ(surface.fuzz_weight.value, 0.5f);
  EXPECT_EQ(surface.fuzz_color.value, glm::vec3(1, 0.5f, 0));
  EXPECT_EQ(surface.fuzz_roughness.value, 0.4f);
}

TEST_F(GltfText, AnisotropyIsTurnedFromTheTangent) {
  const SceneDescription scene = good_gltf(triangle().text(
      one_mesh(R"({"attributes": {"POSITION": 0}, "material": 0})",
               R"(, "extensionsUsed": ["KHR_materials_anisotropy"], "materials": [{"pbrMetallicRoughness":
{"roughnessFactor": 0.4}, "extensions": {"KHR_materials_anisotropy": {"anisotropyStrength": 0.5,
"anisotropyRotation": 7}}}])")));
  const auto& surface = std::get<OpenPbrBsdf>(scene.bsdfs.at(0).model);
  EXPECT_TRUE(surface.gltf);
  EXPECT_EQ(surface.specular_roughness.value, 0.4f);
  EXPECT_EQ(surface.specular_anisotropy.value, 0.5f);
  EXPECT_NEAR(scene.bsdfs.at(0).turn.angle, 7 - 2 * std::numbers::pi, 1e-6);
  EXPECT_EQ(scene.bsdfs.at(0).turn.texture, kNoTexture);
}

TEST_F(GltfText, ColoursOfVerticesAreTheBaseColour) {
  GltfFile file;
  file.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  file.accessor<std::uint8_t>("VEC4", {255, 0, 0, 255, 0, 51, 0, 255, 0, 0, 102, 255}, 3,
                              R"(, "normalized": true)");
  const SceneDescription scene = good_gltf(file.text(
      one_mesh(R"({"attributes": {"POSITION": 0, "COLOR_0": 1}, "material": 0})",
               R"(, "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1]}}])")));
  EXPECT_EQ(mesh(scene).colours[1], glm::vec3(0, 0.2f, 0));
  const auto& material = std::get<OpenPbrBsdf>(scene.bsdfs.at(0).model);
  const auto& scale =
      std::get<ScaleTexture>(scene.textures.at(std::size_t(material.base_color.texture)).model);
  EXPECT_EQ(scale.scale.value, glm::vec3(0.5f, 1, 1));
  EXPECT_TRUE(
      std::holds_alternative<MeshAttributeTexture>(scene.textures.at(std::size_t(scale.texture)).model));
}

class GltfTextures : public GltfText {
 protected:
  /// 2 x 1 texels (51, 102, 153, 0) and (204, 255, 0, 128).
  GltfTextures() {
    const std::vector<std::uint8_t> texels = {51, 102, 153, 0, 204, 255, 0, 128};
    write("t.tga", tga_file(2, 1, 4, texels));
  }
  SceneDescription with_material(std::string_view material, std::string_view sampler = "{}") {
    return good_gltf(triangle().text(one_mesh(
        R"({"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0})",
        fmt::format(
            R"(, "images": [{{"uri": "t.tga"}}], "samplers": [{}], "textures": [{{"source": 0, "sampler": 0}}],
"extensionsUsed": ["KHR_texture_transform"], "materials": [{}])",
            sampler, material))));
  }
  static const BitmapTexture& bitmap(const SceneDescription& scene, int texture) {
    return std::get<BitmapTexture>(scene.textures.at(std::size_t(texture)).model);
  }
  /// Value of texel x, channel c.
  static double texel(const SceneDescription& scene, int texture, std::size_t x, std::size_t c) {
    const BitmapTexture& model = bitmap(scene, texture);
    const Bitmap& image = *scene.bitmaps.at(std::size_t(model.bitmap));
    return bitmap_value(image, x * std::size_t(image.channels) + c, model.gamma);
  }
};

TEST_F(GltfTextures, MetalnessIsBlueAndRoughnessGreenBothLinear) {
  const SceneDescription scene = with_material(
      R"({"pbrMetallicRoughness": {"metallicRoughnessTexture": {"index": 0}, "roughnessFactor": 0.5,
"baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.25, 0.5], "scale": [2, 4]}}}}})",
      R"({"wrapS": 33071, "wrapT": 33648, "magFilter": 9728})");
  const auto& material = std::get<OpenPbrBsdf>(scene.bsdfs.at(0).model);
  EXPECT_NEAR(texel(scene, material.base_metalness.texture, 0, 0), 0.6, 1e-6);
  const auto& rough =
      std::get<ScaleTexture>(scene.textures.at(std::size_t(material.specular_roughness.texture)).model);
  EXPECT_EQ(rough.scale.value, glm::vec3(0.5f));
  EXPECT_NEAR(texel(scene, rough.texture, 0, 0), 0.4, 1e-6);
  const int base = material.base_color.texture;
  EXPECT_NEAR(texel(scene, base, 0, 2), std::pow((0.6 + 0.055) / 1.055, 2.4), 1e-6) << "colours are sRGB";
  EXPECT_EQ(bitmap(scene, base).wrap_u, WRAP_CLAMP);
  EXPECT_EQ(bitmap(scene, base).wrap_v, WRAP_MIRROR);
  EXPECT_EQ(bitmap(scene, base).filter, BitmapFilter::kNearest);
  EXPECT_EQ(scene.textures.at(std::size_t(base)).to_uv * glm::dvec3(1, 1, 1), glm::dvec3(2.25, 4.5, 1));
}

TEST_F(GltfTextures, AlphaIsCutOrBlended) {
  const auto mask = [&](std::string_view mode) {
    const SceneDescription scene = with_material(fmt::format(
        R"({{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}, "baseColorFactor": [1, 1, 1, 0.5]}}, {}}})",
        mode));
    const auto& found = std::get<MaskBsdf>(scene.bsdfs.at(std::size_t(scene.shapes.at(0).front_bsdf)).model);
    double factor = 1;
    int texture = found.opacity.texture;
    if (const auto* scaled = std::get_if<ScaleTexture>(&scene.textures.at(std::size_t(texture)).model)) {
      factor = double(scaled->scale.value.x);
      texture = scaled->texture;
    }
    return std::pair(factor * texel(scene, texture, 0, 0), factor * texel(scene, texture, 1, 0));
  };
  EXPECT_EQ(mask(R"("alphaMode": "MASK", "alphaCutoff": 0.25)"), std::pair(0.0, 1.0));  // 128 / 255 / 2 > 1/4
  EXPECT_EQ(mask(R"("alphaMode": "MASK", "alphaCutoff": 0.26)"), std::pair(0.0, 0.0));
  const auto blend = mask(R"("alphaMode": "BLEND")");
  EXPECT_EQ(blend.first, 0.0);
  EXPECT_NEAR(blend.second, 0.5 * 128 / 255, 1e-6);
}

TEST_F(GltfTextures, ClearCoatsHaveNormalsOfTheirOwnOrNone) {
  const auto material = [&](const std::string& normals, const std::string& coat) {
    const SceneDescription scene = with_material(
        "{" + normals + R"("extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": )" + coat + "}}}");
    for (const std::string& warning : scene.warnings) EXPECT_THAT(warning, Not(HasSubstr("coat")));
    const Bsdf leaf = scene.bsdfs.at(0), behind = scene.bsdfs.at(1);
    EXPECT_EQ(leaf.coat_bend.has_value(), behind.coat_bend.has_value());
    if (leaf.coat_bend && leaf.coat_bend->kind != BendKind::kNone) {
      EXPECT_EQ(leaf.coat_bend->scale, -behind.coat_bend->scale);
      EXPECT_NEAR(texel(scene, leaf.coat_bend->texture, 0, 0), 51 / 255., 1e-6);
      EXPECT_NE(leaf.coat_bend->texture, leaf.bend.texture);
    }
    return leaf;
  };
  const std::string below = R"("normalTexture": {"index": 0, "scale": 0.5}, )";
  const Bsdf bare = material(below, "0"), smooth = material(below, "0.5"),
             both = material(below, R"(1, "clearcoatNormalTexture": {"index": 0})"),
             alone = material("", R"(1, "clearcoatNormalTexture": {"index": 0})");
  EXPECT_EQ(bare.bend.kind, BendKind::kNormalMap);
  EXPECT_FALSE(bare.coat_bend);
  EXPECT_EQ(smooth.bend.kind, BendKind::kNormalMap);
  ASSERT_TRUE(smooth.coat_bend && both.coat_bend && alone.coat_bend);
  EXPECT_EQ(smooth.coat_bend->kind, BendKind::kNone);
  EXPECT_EQ(both.bend.kind, BendKind::kNormalMap);
  EXPECT_EQ(both.coat_bend->kind, BendKind::kNormalMap);
  EXPECT_EQ(alone.bend.kind, BendKind::kNone);
  EXPECT_EQ(alone.coat_bend->kind, BendKind::kNormalMap);
}

TEST_F(GltfTextures, NormalsAreLinearAndTheirScaleFlattensThem) {
  const auto normal = [&](std::string_view scale) {
    const SceneDescription scene =
        with_material(fmt::format(R"({{"normalTexture": {{"index": 0{}}}}})", scale));
    const SurfaceBend& bend = scene.bsdfs.at(0).bend;
    EXPECT_EQ(bend.kind, BendKind::kNormalMap);
    glm::dvec3 n;
    for (int c = 0; c < 3; ++c) n[c] = 2 * texel(scene, bend.texture, 0, std::size_t(c)) - 1;
    return n;
  };
  const glm::dvec3 stored(2 * 51 / 255. - 1, 2 * 102 / 255. - 1, 2 * 153 / 255. - 1);
  expect_near(normal(""), stored, 1e-6);
  expect_near(normal(R"(, "scale": 0.5)"),
              glm::normalize(glm::dvec3(0.5 * stored.x, 0.5 * stored.y, stored.z)), 1e-6);
}

TEST_F(GltfTextures, AnisotropyHasDirectionsInRedAndGreenAndItsStrengthInBlue) {
  const SceneDescription scene = with_material(
      R"({"extensions": {"KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyTexture": {"index": 0}}}})");
  const auto& surface = std::get<OpenPbrBsdf>(scene.bsdfs.at(0).model);
  const auto& strength =
      std::get<ScaleTexture>(scene.textures.at(std::size_t(surface.specular_anisotropy.texture)).model);
  EXPECT_EQ(strength.scale.value, glm::vec3(0.5f));
  EXPECT_NEAR(texel(scene, strength.texture, 0, 0), 0.6, 1e-6);
  const SurfaceTurn& turn = scene.bsdfs.at(0).turn;
  EXPECT_NEAR(texel(scene, turn.texture, 0, 0), 0.2, 1e-6);
  EXPECT_NEAR(texel(scene, turn.texture, 0, 1), 0.4, 1e-6);
  EXPECT_FALSE(turn.mirrored);
}

TEST_F(GltfText, MirroredCoordinatesMirrorTheTurn) {
  GltfFile file;
  file.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  file.accessor<float>("VEC2", {0, 0, 1, 0, 0, 1}, 3);
  const SceneDescription scene = good_gltf(file.text(one_mesh(
      R"({"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0})",
      R"(, "materials": [{"extensions": {"KHR_materials_anisotropy": {"anisotropyStrength": 1, "anisotropyRotation": 1}}}])")));
  const Bsdf& bsdf = scene.bsdfs.at(std::size_t(scene.shapes.at(0).front_bsdf));
  EXPECT_TRUE(bsdf.turn.mirrored);
  EXPECT_EQ(bsdf.turn.angle, 1.0f);
}

TEST_F(GltfTextures, AnAreaLightShowsItsTexture) {
  const SceneDescription scene =
      with_material(R"({"emissiveFactor": [1, 1, 0.5], "emissiveTexture": {"index": 0}})");
  EXPECT_EQ(scene.shapes.at(0).radiance.value(), glm::vec3(1, 1, 0.5f));
  const int texture = scene.shapes.at(0).radiance_texture;
  const double green[] = {102, 255};
  for (const std::size_t x : {0u, 1u})
    EXPECT_NEAR(texel(scene, texture, x, 1), double(decoded_value(int(green[x]), 255, kSrgb)), 1e-6);
}

TEST_F(GltfTextures, ImagesInBuffersAndDataAddressesAreTheSame) {
  // A PNG of one texel (255, 0, 0).
  const std::string png =
      "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/pLvAAAAAElFTkSuQmCC";
  const SceneDescription data = good_gltf(triangle().text(one_mesh(
      R"({"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0})",
      fmt::format(R"(, "images": [{{"uri": "data:image/png;base64,{}"}}], "textures": [{{"source": 0}}],
"materials": [{{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}}}}}])",
                  png))));
  const auto& material = std::get<OpenPbrBsdf>(data.bsdfs.at(0).model);
  for (const std::size_t c : {0u, 1u, 2u})
    EXPECT_EQ(texel(data, material.base_color.texture, 0, c), c == 0 ? 1.0 : 0.0);
  EXPECT_EQ(bitmap(data, material.base_color.texture).wrap_u, WRAP_REPEAT);
}

TEST_F(GltfTextures, ImagesThatAreNotThereAreErrors) {
  const auto error_with = [&](std::string_view image) {
    return gltf_error(
        triangle().text(one_mesh(R"({"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0})",
                                 fmt::format(R"(, "images": [{}], "textures": [{{"source": 0}}],
"materials": [{{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}}}}}])",
                                             image))));
  };
  EXPECT_THAT(error_with(R"({"uri": "none.png"})"),
              AllOf(HasSubstr("scene.gltf:5:40"), HasSubstr("none.png")));
  EXPECT_THAT(error_with(R"({"bufferView": 0, "mimeType": "image/png"})"),
              HasSubstr("cannot be read as an image"));
  EXPECT_THAT(error_with(R"({"bufferView": 7, "mimeType": "image/png"})"), HasSubstr("error"));
}

TEST(GltfTextureTransform, TheExamplesOfTheExtension) {
  // "utilizes only the lower left quadrant of the source image, rotated": u' in [0, 1/2], v' in [1/2, 1].
  const glm::dmat3 quadrant = gltf::texture_transform({0, 1}, std::numbers::pi / 2, {0.5, 0.5});
  const auto at = [](const glm::dmat3& m, double u, double v) { return glm::dvec2(m * glm::dvec3(u, v, 1)); };
  for (const auto& [u, v] : {std::pair(0.0, 0.0), std::pair(1.0, 1.0), std::pair(0.25, 0.75)}) {
    EXPECT_NEAR(at(quadrant, u, v).x, 0.5 * v, 1e-12);
    EXPECT_NEAR(at(quadrant, u, v).y, 1.0 - 0.5 * u, 1e-12);
  }
  // "inverts the T axis".
  const glm::dmat3 inverted = gltf::texture_transform({0, 1}, 0, {1, -1});
  EXPECT_EQ(at(inverted, 0.25, 0.25), glm::dvec2(0.25, 0.75));
}

}  // namespace
}  // namespace penumbra
