// glTF extensions: the values of supported ones, and the messages about others.
#include <gmock/gmock.h>

#include <cmath>

#include "scenes/interiors.h"
#include "tests/scenes/gltf_text.h"
#include "tests/support/tga_file.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class GltfExtensions : public GltfText {
 protected:
  static const BsdfModel& front(const SceneDescription& scene, std::size_t shape = 0) {
    return scene.bsdfs.at(std::size_t(scene.shapes.at(shape).front_bsdf)).model;
  }
  static const Bitmap& image(const SceneDescription& scene, int texture) {
    const auto& model = std::get<BitmapTexture>(scene.textures.at(std::size_t(texture)).model);
    return *scene.bitmaps.at(std::size_t(model.bitmap));
  }
  static double texel(const SceneDescription& scene, int texture, std::size_t x, std::size_t c) {
    const Bitmap& map = image(scene, texture);
    const float gamma = std::get<BitmapTexture>(scene.textures.at(std::size_t(texture)).model).gamma;
    return bitmap_value(map, x * std::size_t(map.channels) + c, gamma);
  }
};

/// What libdraco made of a quad (0,0,0) (2,0,0) (2,3,0) (0,3,0), sequentially and by its edgebreaker, with
/// colours of bytes (255,0,0,255) (0,51,0,255) (0,0,102,255) (255,255,255,255), texture coordinates (0,1)
/// (1,1) (1,0) (0,0) and joints 0, 1, 1, 0: attributes 0 to 3.
constexpr const char* kSequential =
    "RFJBQ08CAgEAAAACBAEAAQIAAgMBBAAJAwAAAgIEAQEDCQIAAgQEBAADAAEAAQAAAAAAAAAAAAAAAAAAAEAAAAAAAAAAAAAAAEAAAEBA"
    "AAAAAAAAAAAA"
    "AEBAAAAAAAABAQAJAwEQEwEQASADAFCRKTADAABlzAABAc0AAAAAAP8AAAAAAAAAAACAPwAAgD8AAIA/"
    "AACAPwAAAAAAAAAAAAAAAAABAQACAwFAAQAQEAAAAAABAAAA";
constexpr const char* kEdgebreaker =
    "RFJBQ08CAgEBAAAABAIDAgAAAR//ARH/ARH/ARH/"
    "AREE/"
    "wAAAAAAAQAAAgAAAQAJAwAAAAECAgQBAQEBAwkCAAIAAQQEBAADAQAAAAAAAAAAAAAAAAAAAEAAAEBAAAAAAAAAAAAAAEBAAAAAAAAAA"
    "EAAAAAA"
    "AAAAAAEBAQAJAwEQEwEQASADADCQKQDADBAQ0AwAMAMAAAAAAP8AAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAAAAAAIA/"
    "AACAPwEBAQACAwFAAQAQAQAAAAABAAAA";

/// A file with a compressed mesh, whose accessors have no buffer views.
std::string draco_file(std::string_view compressed, std::string_view more = "",
                       std::string_view attributes = "", std::string_view node = "") {
  return fmt::format(R"({{"asset": {{"version": "2.0"}},
"extensionsUsed": ["KHR_draco_mesh_compression"], "extensionsRequired": ["KHR_draco_mesh_compression"],
"scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0{}}}],
"meshes": [{{"primitives": [{{"attributes": {{"POSITION": 1, "COLOR_0": 2, "TEXCOORD_0": 3{}}}, "indices": 0,
"extensions": {{"KHR_draco_mesh_compression": {{"bufferView": 0, "attributes":
{{"POSITION": 0, "COLOR_0": 1, "TEXCOORD_0": 2, "JOINTS_0": 3}}}}}}}}]}}],
"accessors": [{{"componentType": 5123, "count": 6, "type": "SCALAR"}},
{{"componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [2, 3, 0]}},
{{"componentType": 5121, "count": 4, "type": "VEC4", "normalized": true}},
{{"componentType": 5126, "count": 4, "type": "VEC2"}}{}],
"bufferViews": [{{"buffer": 0, "byteLength": {}}}],
"buffers": [{{"byteLength": {}, "uri": "data:application/octet-stream;base64,{}"}}]}})",
                     node, attributes, more, compressed.size() / 4 * 3, compressed.size() / 4 * 3,
                     compressed);
}

TEST_F(GltfExtensions, DracoDecompresses) {
  const SceneDescription scene = good_gltf(draco_file(kSequential));
  EXPECT_EQ(mesh(scene).positions, std::vector<glm::dvec3>({{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}}));
  EXPECT_EQ(mesh(scene).triangles, std::vector<glm::uvec3>({{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(mesh(scene).colours, std::vector<glm::vec3>({{1, 0, 0}, {0, 0.2f, 0}, {0, 0, 0.4f}, {1, 1, 1}}));
  EXPECT_EQ(mesh(scene).texcoords, std::vector<glm::vec2>({{0, 1}, {1, 1}, {1, 0}, {0, 0}}));
}

TEST_F(GltfExtensions, DracosEdgebreakerKeepsEachCornersValues) {
  const SceneDescription scene = good_gltf(draco_file(kEdgebreaker));
  const Mesh& quad = mesh(scene);
  ASSERT_EQ(quad.positions.size(), 4u);
  double area = 0;
  for (const glm::uvec3& t : quad.triangles)
    area +=
        0.5 *
        glm::cross(quad.positions[t.y] - quad.positions[t.x], quad.positions[t.z] - quad.positions[t.x]).z;
  EXPECT_EQ(area, 6.0);
  for (std::size_t i = 0; i < 4; ++i) {
    const glm::dvec3& p = quad.positions[i];
    EXPECT_EQ(quad.texcoords[i], glm::vec2(p.x / 2, 1 - p.y / 3));
    const glm::vec3 colour = p.x == 0   ? (p.y == 0 ? glm::vec3(1, 0, 0) : glm::vec3(1))
                             : p.y == 0 ? glm::vec3(0, 0.2f, 0)
                                        : glm::vec3(0, 0, 0.4f);
    EXPECT_EQ(quad.colours[i], colour);
  }
}

TEST_F(GltfExtensions, DamagedDracoIsAnErrorOfItsPrimitive) {
  std::string damaged = kSequential;
  damaged.replace(20, 16, "////////////////");
  EXPECT_THAT(gltf_error(draco_file(damaged)),
              AllOf(HasSubstr("scene.gltf:4:"), HasSubstr("KHR_draco_mesh_compression: Draco: ")));
  std::string unknown = draco_file(kSequential);
  unknown.replace(unknown.find("\"TEXCOORD_0\": 2"), 15, "\"TEXCOORD_0\": 7");
  EXPECT_THAT(gltf_error(unknown), HasSubstr("there is no attribute 7"));
}

/// A triangle (0,0,0) (2,0,0) (0,3,0) that meshoptimizer compressed: its positions, its indices, and normals
/// (0,0,1) (0,0,1) (1,0,0) by the octahedral filter.
std::string meshopt_file(std::string_view mode, std::string_view indices, std::string_view extension) {
  constexpr std::string_view kPositions =
      "oAAAAAE8AAAAgH8AAAEMAAAAgAEMAAAAgAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA==";
  constexpr std::string_view kNormals = "oAEMAAAA/gAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAH8A";
  return fmt::format(
      R"({{"asset": {{"version": "2.0"}}, "extensionsRequired": ["{0}", "KHR_mesh_quantization"],
"scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
"meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "NORMAL": 1}}, "indices": 2}}]}}],
"accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}},
{{"bufferView": 1, "componentType": 5120, "count": 3, "type": "VEC3", "normalized": true}},
{{"bufferView": 2, "componentType": 5123, "count": 3, "type": "SCALAR"}}],
"bufferViews": [{{"buffer": 3, "byteLength": 36, "byteStride": 12, "extensions": {{"{0}":
{{"buffer": 0, "byteLength": 61, "byteStride": 12, "count": 3, "mode": "ATTRIBUTES"}}}}}},
{{"buffer": 3, "byteOffset": 36, "byteLength": 12, "byteStride": 4, "extensions": {{"{0}":
{{"buffer": 1, "byteLength": 42, "byteStride": 4, "count": 3, "mode": "ATTRIBUTES", "filter": "OCTAHEDRAL"}}}}}},
{{"buffer": 3, "byteOffset": 48, "byteLength": 6, "extensions": {{"{0}":
{{"buffer": 2, "byteLength": {1}, "byteStride": 2, "count": 3, "mode": "{2}"}}}}}}],
"buffers": [{{"byteLength": 61, "uri": "data:;base64,{3}"}}, {{"byteLength": 42, "uri": "data:;base64,{4}"}},
{{"byteLength": {1}, "uri": "data:;base64,{5}"}},
{{"byteLength": 54, "extensions": {{"{0}": {{"fallback": true}}}}}}]}})",
      extension, mode == "TRIANGLES" ? 18 : 8, mode, kPositions, kNormals, indices);
}

TEST_F(GltfExtensions, MeshoptDecompresses) {
  for (const auto& [mode, indices] :
       {std::pair("TRIANGLES", "4PAAdodWZ3iphmWJaJgBaQAA"), std::pair("INDICES", "0AAEBAAAAAA=")})
    for (const char* extension : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
      const SceneDescription scene = good_gltf(meshopt_file(mode, indices, extension));
      EXPECT_EQ(mesh(scene).positions, std::vector<glm::dvec3>({{0, 0, 0}, {2, 0, 0}, {0, 3, 0}}));
      EXPECT_NEAR(mesh(scene).normals.at(0).z, 1.0f, 1e-6f);
      EXPECT_NEAR(mesh(scene).normals.at(2).x, 1.0f, 1e-6f);
      EXPECT_EQ(mesh(scene).triangles, std::vector<glm::uvec3>({{0, 1, 2}}));
    }
  EXPECT_THAT(gltf_error(meshopt_file("STRIPS", "0AAEBAAAAAA=", "EXT_meshopt_compression")),
              AllOf(HasSubstr("buffer view 2"), HasSubstr("no mode 'STRIPS'")));
  EXPECT_THAT(gltf_error(meshopt_file("TRIANGLES", "////dodWZ3iphmWJaJgBaQAA", "EXT_meshopt_compression")),
              HasSubstr("damaged"));
}

TEST_F(GltfExtensions, MeshoptOfVersion1Decompresses) {
  // 48 positions (i / 4, i² mod 7, i mod 3) of single precision, and colours (i / 47, 1 - i / 47, 1/2, 1) by
  // the filter for colours, of 8 bits: what the Python package meshopt made of them.
  constexpr std::string_view kPositions =
      "oWhq6gECAQ8fKg//"
      "+Pj0xPTEoGAQMBj4HPJi4mLyYuJiPB7xMXEx8TFxMX4PFT0f9H9//v5/f/7+f3/R/0f9/v5/f/7+f3/+H/R/0f5/f/7+f3/+AH//"
      "gH//gH//gH//"
      "gH//gH//gH//gH//gH//gH//gH//gH//gH//gH//gH//gH//AAAAAAAAAAAAAAAAAAAAAAAAAAAAYhIS";
  constexpr std::string_view kColours =
      "oZUqARMRMRMTETETETETETETETExExExExExKgZkZmRmRmZGZGZkZkZGZGZkZkZmRmRmZCoHd3eVeVl3d3d3lXlXd3d3lXlZd3d3d5"
      "UAAAAAAAAA"
      "AAAAAAAAAAAAAAAAn8Bf/wA=";
  const auto file = [&](std::string_view positions) {
    return fmt::format(R"({{"asset": {{"version": "2.0"}}, "extensionsRequired": ["KHR_meshopt_compression"],
"scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
"meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "COLOR_0": 1}}}}]}}],
"accessors": [{{"bufferView": 0, "componentType": 5126, "count": 48, "type": "VEC3"}},
{{"bufferView": 1, "componentType": 5121, "count": 48, "type": "VEC4", "normalized": true}}],
"bufferViews": [{{"buffer": 2, "byteLength": 576, "byteStride": 12, "extensions": {{"KHR_meshopt_compression":
{{"buffer": 0, "byteLength": 156, "byteStride": 12, "count": 48, "mode": "ATTRIBUTES"}}}}}},
{{"buffer": 2, "byteOffset": 576, "byteLength": 192, "byteStride": 4, "extensions": {{"KHR_meshopt_compression":
{{"buffer": 1, "byteLength": 101, "byteStride": 4, "count": 48, "mode": "ATTRIBUTES", "filter": "COLOR"}}}}}}],
"buffers": [{{"byteLength": 156, "uri": "data:;base64,{}"}}, {{"byteLength": 101, "uri": "data:;base64,{}"}},
{{"byteLength": 768}}]}})",
                       positions, kColours);
  };
  const SceneDescription scene = good_gltf(file(kPositions));
  ASSERT_EQ(mesh(scene).positions.size(), 48u);
  for (std::size_t i = 0; i < 48; ++i) {
    EXPECT_EQ(mesh(scene).positions[i], glm::dvec3(0.25 * double(i), double(i * i % 7), double(i % 3)));
    const glm::vec3 colour = mesh(scene).colours[i];
    EXPECT_NEAR(colour.x, double(i) / 47, 0.006);
    EXPECT_NEAR(colour.y, 1 - double(i) / 47, 0.006);
    EXPECT_NEAR(colour.z, 0.5, 0.006);
  }
  std::string damaged(kPositions);
  damaged[3] = 'A';
  EXPECT_THAT(gltf_error(file(damaged)), HasSubstr("the compressed data are damaged"));
}

TEST_F(GltfExtensions, QuantisedMeshesAreInTheirNodesScale) {
  GltfFile file;
  file.accessor<std::uint16_t>("VEC3", {0, 0, 0, 0, 65535, 0, 0, 0, 0, 65535, 0, 0}, 3,
                               R"(, "normalized": true)");
  std::string text = file.text(one_mesh(R"({"attributes": {"POSITION": 0}})",
                                        R"(, "extensionsRequired": ["KHR_mesh_quantization"])",
                                        R"(, "scale": [2, 4, 8], "translation": [1, 0, 0])"));
  const std::string packed = R"("byteOffset": 0, )";
  text.replace(text.find(packed), packed.size(), R"("byteOffset": 0, "byteStride": 8, )");
  EXPECT_EQ(mesh(good_gltf(text)).positions, std::vector<glm::dvec3>({{1, 0, 0}, {3, 0, 0}, {1, 4, 0}}));
}

TEST_F(GltfExtensions, TheDefaultMaterialOfVariantsIsShown) {
  const SceneDescription scene = good_gltf(triangle().text(one_mesh(
      R"({"attributes": {"POSITION": 0}, "material": 1, "extensions": {"KHR_materials_variants":
{"mappings": [{"material": 0, "variants": [0]}]}}})",
      R"(, "extensionsUsed": ["KHR_materials_variants"],
"extensions": {"KHR_materials_variants": {"variants": [{"name": "red"}]}},
"materials": [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}},
{"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 1, 1]}}])")));
  EXPECT_EQ(std::get<OpenPbrBsdf>(front(scene)).base_color.value, glm::vec3(0, 0, 1));
  EXPECT_THAT(warnings(scene), Not(HasSubstr("variants")));
}

TEST_F(GltfExtensions, SpecularGlossinessBeatsTheOtherModel) {
  const SceneDescription scene =
      good_gltf(triangle().text(one_mesh(R"({"attributes": {"POSITION": 0}, "material": 0})",
                                         R"(, "extensionsRequired": ["KHR_materials_pbrSpecularGlossiness"],
"materials": [{"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}, "extensions":
{"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [0.5, 0.25, 0, 0.5], "specularFactor": [0.04, 0.04, 0.04],
"glossinessFactor": 0.5}}}])")));
  const auto& mask = std::get<MaskBsdf>(front(scene));
  EXPECT_EQ(mask.opacity.value, 0.5f);
  const auto& solid = std::get<OpenPbrBsdf>(scene.bsdfs.at(std::size_t(mask.inside)).model);
  EXPECT_NEAR(solid.base_color.value.x, 0.5f, 1e-6f);
  EXPECT_NEAR(solid.base_color.value.y, 0.25f, 1e-6f);
  EXPECT_EQ(solid.base_metalness.value, 0.0f);
  EXPECT_EQ(solid.specular_ior, 1.5f) << "it reflects 0.04";
  EXPECT_NEAR(solid.specular_color.value.x, 1.0f, 1e-6f);
  EXPECT_EQ(solid.specular_roughness.value, 0.5f);
}

TEST_F(GltfExtensions, TexturesOfSpecularGlossinessAreConverted) {
  // Gold of a glossiness of 0.4 (alpha 102), and a black dielectric of 0.8.
  const std::vector<std::uint8_t> specular = {255, 188, 0, 102, 56, 56, 56, 204}, diffuse = {0, 0, 0, 255};
  write("s.tga", tga_file(2, 1, 4, specular));
  write("d.tga", tga_file(1, 1, 4, diffuse));
  const SceneDescription scene = good_gltf(triangle().text(one_mesh(
      R"({"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0})",
      R"(, "images": [{"uri": "d.tga"}, {"uri": "s.tga"}], "textures": [{"source": 0}, {"source": 1}],
"materials": [{"extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseTexture": {"index": 0},
"specularGlossinessTexture": {"index": 1}, "glossinessFactor": 0.5}}}])")));
  const auto& solid = std::get<OpenPbrBsdf>(front(scene));
  const auto& of_index =
      std::get<ScaleTexture>(scene.textures.at(std::size_t(solid.specular_color.texture)).model);
  EXPECT_EQ(of_index.scale.value, glm::vec3(25.0f)) << "over the index's 0.04";
  EXPECT_NEAR(texel(scene, of_index.texture, 0, 0), 1.0, 1e-6);
  EXPECT_NEAR(texel(scene, of_index.texture, 0, 1), decoded_value(188, 255, kSrgb), 1e-6);
  EXPECT_NEAR(texel(scene, solid.base_color.texture, 0, 0), 0.0, 1e-6);
  EXPECT_NEAR(texel(scene, solid.specular_roughness.texture, 0, 0), 0.8, 0.003);
  EXPECT_NEAR(texel(scene, solid.specular_roughness.texture, 1, 0), 0.6, 0.003);
}

TEST_F(GltfExtensions, UnlitSurfacesShineFromBothSidesInTheirColours) {
  GltfFile file;
  file.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  file.accessor<std::uint16_t>("VEC3", {65535, 0, 0, 0, 13107, 0, 0, 0, 0}, 3, R"(, "normalized": true)");
  const SceneDescription scene = good_gltf(file.text(
      one_mesh(R"({"attributes": {"POSITION": 0, "COLOR_0": 1}, "material": 0})",
               R"(, "extensionsUsed": ["KHR_materials_unlit"], "materials": [{"emissiveFactor": [1, 1, 1],
"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1]}, "extensions": {"KHR_materials_unlit": {}}}])")));
  EXPECT_EQ(scene.shapes.at(0).radiance, glm::vec3(0.5f, 1, 1)) << "and nothing else";
  EXPECT_TRUE(scene.shapes[0].two_sided_emission);
  EXPECT_EQ(scene.shapes[0].front_bsdf, kBlackBsdf);
  EXPECT_TRUE(std::holds_alternative<MeshAttributeTexture>(
      scene.textures.at(std::size_t(scene.shapes[0].radiance_texture)).model));
  EXPECT_EQ(mesh(scene).colours[1], glm::vec3(0, 0.2f, 0));
}

TEST_F(GltfExtensions, UnlitSurfacesAreNoLightForTheOthers) {
  const auto said = [&](std::string_view second) {
    return warnings(good_gltf(triangle().text(one_mesh(
        fmt::format(
            R"({{"attributes": {{"POSITION": 0}}, "material": 0}}, {{"attributes": {{"POSITION": 0}}, "material": {}}})",
            second),
        R"(, "materials": [{"extensions": {"KHR_materials_unlit": {}}}, {}, {"emissiveFactor": [1, 1, 1]}])"))));
  };
  EXPECT_THAT(said("0"), Not(HasSubstr("no light")));
  EXPECT_THAT(said("1"), HasSubstr("no light; a white sky"));
  EXPECT_THAT(said("2"), Not(HasSubstr("no light")));
}

TEST_F(GltfExtensions, InstancesOfAMeshAreWhereTheirAttributesSay) {
  GltfFile file = triangle();
  file.accessor<float>("VEC3", {0, 0, 0, 0, 0, 5, 1, 1, 1}, 3);
  file.accessor<std::int16_t>("VEC4", {0, 0, 0, 32767, 0, 0, 32767, 0, 0, 0, 0, 32767}, 3,
                              R"(, "normalized": true)");
  file.accessor<float>("VEC3", {1, 1, 1, 2, 2, 2, 0, 0, 0}, 3);
  const SceneDescription scene = good_gltf(file.text(
      one_mesh(R"({"attributes": {"POSITION": 0}})", R"(, "extensionsRequired": ["EXT_mesh_gpu_instancing"])",
               R"(, "translation": [10, 0, 0], "extensions": {"EXT_mesh_gpu_instancing": {"attributes":
{"TRANSLATION": 2, "ROTATION": 3, "SCALE": 4}}})")));
  EXPECT_TRUE(scene.shapes.empty());
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_THAT(warnings(scene), HasSubstr("1 of 3 instances are flattened"));
  // (1, 0, 0), turned by 180 degrees about z, twice as large, moved by (0, 0, 5) and by the node.
  const glm::dvec4 placed = scene.instances[1].to_world * glm::dvec4(1, 0, 0, 1);
  EXPECT_NEAR(placed.x, 8, 1e-9);
  EXPECT_NEAR(placed.y, 0, 1e-9);
  EXPECT_NEAR(placed.z, 5, 1e-9);
  EXPECT_EQ(std::get<Mesh>(scene.groups.at(0).shapes.at(0).geometry).positions[1], glm::dvec3(1, 0, 0));
  // The camera that stands in sees them all.
  EXPECT_GT(scene.camera.to_world[3].z, 5.0);
}

TEST_F(GltfExtensions, WhatIsInvisibleIsNotThere) {
  const std::string nodes = R"("scenes": [{"nodes": [0, 2]}], "extensionsUsed": ["KHR_node_visibility"],
"nodes": [{"children": [1], "extensions": {"KHR_node_visibility": {"visible": false}}}, {"mesh": 0, "name": "no"},
{"mesh": 0, "name": "yes", "extensions": {"KHR_node_visibility": {"visible": true}}}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}])";
  const SceneDescription scene = good_gltf(triangle().text(nodes));
  ASSERT_EQ(scene.shapes.size(), 1u);
  EXPECT_EQ(scene.shapes[0].name, "yes");
}

std::string textured(std::string_view texture, std::string_view more) {
  return fmt::format(
      R"("scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
"meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "TEXCOORD_0": 1}}, "material": 0}}]}}],
"materials": [{{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}}}}}], "textures": [{}], {})",
      texture, more);
}

TEST_F(GltfExtensions, WebPIsRead) {
  // A texel (255, 0, 0), with losses.
  const SceneDescription scene = good_gltf(triangle().text(textured(
      R"({"extensions": {"EXT_texture_webp": {"source": 0}}})",
      R"("extensionsRequired": ["EXT_texture_webp"], "images": [{"uri": "data:image/webp;base64,UklGRkQAAABXRUJQVlA4IDgAAABQAgCdASoBAAEAAAAAJaACdLoB+AH6AfwAB5AA/v9vVv/8sPx/Unn/yxD//xPTm8RU8r/+JkAAAA=="}])")));
  const int texture = std::get<OpenPbrBsdf>(front(scene)).base_color.texture;
  EXPECT_NEAR(texel(scene, texture, 0, 0), 1.0, 0.05);
  EXPECT_NEAR(texel(scene, texture, 0, 1), 0.0, 0.05);
}

TEST_F(GltfExtensions, ATextureWithoutAnImageIsLeftOut) {
  const SceneDescription scene = good_gltf(triangle().text(textured("{}", "\"images\": []")));
  EXPECT_EQ(std::get<OpenPbrBsdf>(front(scene)).base_color.texture, kNoTexture);
  EXPECT_THAT(warnings(scene), HasSubstr("texture 0 has no image; it is left out"));
}

TEST_F(GltfExtensions, Ktx2IsNamedWhereThereIsNoOtherImage) {
  const std::string text = triangle().text(
      textured(R"({"extensions": {"KHR_texture_basisu": {"source": 0}}})",
               R"("extensionsRequired": ["KHR_texture_basisu"], "images": [{"uri": "t.ktx2"}])"));
  EXPECT_THAT(gltf_error(text), AllOf(HasSubstr("texture 0 has an image of KTX2 alone (KHR_texture_basisu)"),
                                      HasSubstr("convert it to PNG")));
  EXPECT_THAT(warnings(good_gltf(text, {.lenient = true})), HasSubstr("KHR_texture_basisu"));
  const std::vector<std::uint8_t> texels = {51, 102, 153, 255};
  write("t.tga", tga_file(1, 1, 4, texels));
  const SceneDescription scene = good_gltf(triangle().text(textured(
      R"({"source": 1, "extensions": {"KHR_texture_basisu": {"source": 0}}})",
      R"("extensionsUsed": ["KHR_texture_basisu"], "images": [{"uri": "t.ktx2"}, {"uri": "t.tga"}])")));
  EXPECT_EQ(image(scene, std::get<OpenPbrBsdf>(front(scene)).base_color.texture).width, 1);
}

TEST_F(GltfExtensions, DispersionIsAnAbbeNumber) {
  const auto glass = [&](const std::string& dispersion) {
    return std::get<OpenPbrBsdf>(front(good_gltf(triangle().text(
        one_mesh(R"({"attributes": {"POSITION": 0}, "material": 0})",
                 R"(, "materials": [{"extensions": {"KHR_materials_transmission": {"transmissionFactor": 1},
"KHR_materials_volume": {"thicknessFactor": 1}, "KHR_materials_dispersion": {)" +
                     dispersion + "}}}]")))));
  };
  EXPECT_FALSE(glass("").disperses());
  const OpenPbrBsdf half = glass(R"("dispersion": 0.5)");
  EXPECT_TRUE(half.disperses());
  EXPECT_FLOAT_EQ(half.dispersion_abbe / half.dispersion_scale, 40.0f);  // 20 over the extension's number
}

TEST_F(GltfExtensions, VolumesAbsorb) {
  const auto scene_of = [&](const std::string& volume) {
    return good_gltf(triangle().text(
        one_mesh(R"({"attributes": {"POSITION": 0}, "material": 0})",
                 R"(, "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1]},
"extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_volume": {)" +
                     volume + "}}}]")));
  };
  const SceneDescription scene =
      scene_of(R"("thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [1, 0.5, 0.25])");
  EXPECT_EQ(std::get<OpenPbrBsdf>(front(scene)).transmission_color.value, glm::vec3(0.5f, 1, 1));
  const auto inside = interior_of(scene, scene.shapes.at(0).front_bsdf);
  ASSERT_TRUE(inside.has_value());
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(inside->medium.extinction[c], c * std::log(2.0) / 2, 1e-6) << c;
  EXPECT_EQ(inside->medium.albedo, glm::vec3(0.0f));
  // Sheets have no inside; without a distance nothing is absorbed.
  for (const char* other : {R"("attenuationDistance": 2, "attenuationColor": [1, 0.5, 0.25])",
                            R"("thicknessFactor": 1, "attenuationColor": [1, 0.5, 0.25])",
                            R"("thicknessFactor": 1, "attenuationDistance": 2)"}) {
    const SceneDescription without = scene_of(other);
    EXPECT_FALSE(interior_of(without, without.shapes.at(0).front_bsdf).has_value()) << other;
  }
}

TEST_F(GltfExtensions, SheetsTransmitAShareOfTheirDiffuseLight) {
  const auto surface = [&](const std::string& more) {
    return good_gltf(triangle().text(
        one_mesh(R"({"attributes": {"POSITION": 0}, "material": 0})",
                 R"(, "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0.25}, "extensions": {
"KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.5, "diffuseTransmissionColorFactor": [1, 0.5, 0]})" +
                     more + "}}]")));
  };
  const SceneDescription scene = surface("");
  const auto& sheet = std::get<OpenPbrBsdf>(front(scene));
  EXPECT_TRUE(sheet.thin_walled);
  EXPECT_EQ(sheet.subsurface_weight.value, 0.5f);
  EXPECT_EQ(sheet.subsurface_color.value, glm::vec3(1, 0.5f, 0));
  EXPECT_EQ(sheet.subsurface_anisotropy, 1.0f) << "all of it to the other side";
  EXPECT_EQ(scene.shapes.at(0).front_bsdf, scene.shapes.at(0).back_bsdf);
  const SceneDescription volume = surface(
      R"(, "KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_volume": {"thicknessFactor": 1})");
  EXPECT_FALSE(std::get<OpenPbrBsdf>(front(volume)).thin_walled);
  EXPECT_THAT(warnings(volume), HasSubstr("KHR_materials_diffuse_transmission"));
}

TEST_F(GltfExtensions, IridescenceIsAThinFilm) {
  const auto film = [&](const std::string& content) {
    return std::get<OpenPbrBsdf>(front(good_gltf(triangle().text(
        one_mesh(R"({"attributes": {"POSITION": 0}, "material": 0})",
                 R"(, "materials": [{"extensions": {"KHR_materials_iridescence": {)" + content + "}}}]")))));
  };
  EXPECT_FALSE(film("").filmed());
  const OpenPbrBsdf plain = film(R"("iridescenceFactor": 0.5)");
  EXPECT_EQ(plain.film_weight.value, 0.5f);
  EXPECT_FLOAT_EQ(plain.film_thickness.value, 0.4f) << "the maximum, in micrometres";
  EXPECT_FLOAT_EQ(plain.film_ior, 1.3f);
  const OpenPbrBsdf other = film(
      R"("iridescenceFactor": 1, "iridescenceIor": 1.8, "iridescenceThicknessMinimum": 200, "iridescenceThicknessMaximum": 900)");
  EXPECT_FLOAT_EQ(other.film_thickness.value, 0.9f);
  EXPECT_FLOAT_EQ(other.film_least, 0.2f);
  EXPECT_FLOAT_EQ(other.film_ior, 1.8f);
}

TEST_F(GltfExtensions, WhatIsLeftOutIsSaidAndNoError) {
  const std::string text = triangle().text(one_mesh(
      R"({"attributes": {"POSITION": 0}, "material": 0})",
      R"(, "extensionsUsed": ["KHR_materials_sheen", "KHR_materials_subsurface", "EXT_lights_image_based",
"KHR_animation_pointer", "KHR_xmp_json_ld"], "extensionsRequired": ["EXT_lights_image_based"],
"materials": [{"extensions": {"KHR_materials_sheen": {"sheenColorFactor": [1, 1, 1]}}}])"));
  const std::string said = warnings(good_gltf(text));
  EXPECT_THAT(said,
              AllOf(HasSubstr("'EXT_lights_image_based' is ignored: the sky that it describes is left out"),
                    HasSubstr("'KHR_materials_subsurface' is ignored")));
  EXPECT_THAT(said, Not(AnyOf(HasSubstr("sheen"), HasSubstr("pointer"), HasSubstr("xmp"))));
  EXPECT_THAT(
      gltf_error(triangle().text(one_mesh(kTriangle, R"(, "extensionsRequired": ["KHR_techniques_webgl"])"))),
      AllOf(HasSubstr("'KHR_techniques_webgl'"), HasSubstr("use materials of metal and roughness")));
}

}  // namespace
}  // namespace penumbra
