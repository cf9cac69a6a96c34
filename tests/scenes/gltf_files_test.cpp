// glTF files as exporters write them: rest poses, URIs of every kind, missing and superfluous parts.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "scenes/gltf/data_address.h"
#include "tests/scenes/gltf_text.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class GltfFiles : public GltfText {};

TEST_F(GltfFiles, MorphTargetsRestAtTheirDefaultWeights) {
  GltfFile file = triangle();
  file.accessor<float>("VEC3", {0, 0, 4, 0, 0, 4, 0, 0, 4}, 3);
  const int where = file.view(std::vector<std::uint8_t>{1});
  const int what = file.view(std::vector<float>{8, 0, 0});
  file.raw_accessor(fmt::format(
      R"({{"componentType": 5126, "count": 3, "type": "VEC3", "sparse": {{"count": 1,
 "indices": {{"bufferView": {}, "componentType": 5121}}, "values": {{"bufferView": {}}}}}}})",
      where, what));
  const auto position = [&](std::string_view mesh_weights, std::string_view node_weights) {
    return mesh(good_gltf(file.text(fmt::format(
                    R"("scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0{}}}], "meshes": [{{"primitives":
[{{"attributes": {{"POSITION": 0}}, "targets": [{{"POSITION": 2}}, {{"POSITION": 3}}]}}]{}}}])",
                    node_weights, mesh_weights))))
        .positions.at(1);
  };
  EXPECT_EQ(position("", ""), glm::dvec3(1, 0, 0));
  EXPECT_EQ(position(R"(, "weights": [0.5, 0.25])", ""), glm::dvec3(3, 0, 2));
  EXPECT_EQ(position(R"(, "weights": [0.5, 0.25])", R"(, "weights": [1, 0])"), glm::dvec3(1, 0, 4));
}

TEST_F(GltfFiles, SkinsRestWhereTheirJointsAre) {
  GltfFile file = triangle();
  file.accessor<std::uint8_t>("VEC4", {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, 3);
  file.accessor<std::uint8_t>("VEC4", {255, 0, 0, 0, 255, 0, 0, 0, 51, 204, 0, 0}, 3,
                              R"(, "normalized": true)");
  // The inverse of where joint 1 was bound, (0, 0, -1).
  file.accessor<float>(
      "MAT4",
      {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1}, 2);
  const std::string text = file.text(
      R"("scenes": [{"nodes": [0, 1]}], "nodes": [{"mesh": 0, "skin": 0, "translation": [100, 0, 0]},
{"children": [2], "translation": [0, 0, 7]}, {"translation": [0, 0, 3], "scale": [2, 2, 2]}],
"skins": [{"joints": [1, 2], "inverseBindMatrices": 4}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 2, "WEIGHTS_0": 3}}]}])");
  const SceneDescription scene = good_gltf(text);
  EXPECT_EQ(mesh(scene).positions[0], glm::dvec3(0, 0, 7)) << "the node's own transform is ignored";
  EXPECT_EQ(mesh(scene).positions[1], glm::dvec3(2, 0, 12));
  // 0.2 of (0, 1, 7) and 0.8 of (0, 2, 12).
  EXPECT_NEAR(mesh(scene).positions[2].y, 1.8, 1e-12);
  EXPECT_NEAR(mesh(scene).positions[2].z, 11.0, 1e-12);

  std::string no_joint = text;
  no_joint.replace(no_joint.find("[1, 2]"), 6, "[1, 9]");
  EXPECT_THAT(gltf_error(no_joint), HasSubstr("skin 0: a joint is the node 9, which is not there"));
  std::string fewer = text;
  fewer.replace(fewer.find("[1, 2]"), 6, "[1]   ");
  EXPECT_THAT(gltf_error(fewer), HasSubstr("JOINTS_0: a joint 1, where the skin has 1"));
  std::string no_weights = text;
  no_weights.replace(no_weights.find("WEIGHTS_0"), 9, "_UNKNOWN_");
  EXPECT_THAT(gltf_error(no_weights), HasSubstr("of JOINTS_0 and WEIGHTS_0 only one is there"));
}

TEST_F(GltfFiles, DataAddressesAreOfAnyMediaType) {
  using gltf::data_of_address;
  EXPECT_EQ(data_of_address("data:application/octet-stream;base64,AAEC"), std::string("\0\1\2", 3));
  EXPECT_EQ(data_of_address("DATA:model/gltf-buffer;charset=x;base64,AA=="), std::string("\0", 1));
  EXPECT_EQ(data_of_address("data:;base64,%41%41%3D%3D"), std::string("\0", 1));
  EXPECT_EQ(data_of_address("data:text/plain,a%20b"), std::string("a b"));
  EXPECT_EQ(data_of_address("data:;base64,"), std::string());
  EXPECT_FALSE(data_of_address("data:base64"));
  EXPECT_FALSE(data_of_address("data:;base64,A*=="));
  const std::string text = triangle().text(one_mesh(kTriangle));
  for (const char* type : {"application/gltf-buffer", "application/binary", "x/y;charset=utf-8"}) {
    std::string other = text;
    const std::string usual = "application/octet-stream";
    other.replace(other.find(usual), usual.size(), type);
    EXPECT_EQ(mesh(good_gltf(other)).positions[1], glm::dvec3(1, 0, 0)) << type;
  }
}

TEST_F(GltfFiles, NamesOfFilesAreDecodedAndFilesMayBeLonger) {
  const GltfFile file = triangle();
  const auto with = [&](std::string_view uri) {
    return "{\"asset\": {\"version\": \"2.0\"}, " + one_mesh(kTriangle) + ", " +
           file.buffers(fmt::format("\"uri\": \"{}\", ", uri)) + "}";
  };
  for (const auto& [name, uri] : {std::pair("a b.bin", "a%20b.bin"), std::pair("ä.bin", "%C3%A4.bin"),
                                  std::pair("ü.bin", "ü.bin"), std::pair("50%25.bin", "50%25.bin")}) {
    write(name, file.buffer() + "more than the file needs");
    EXPECT_EQ(mesh(good_gltf(with(uri))).positions[1], glm::dvec3(1, 0, 0)) << uri;
  }
  write("short.bin", file.buffer().substr(1));
  EXPECT_THAT(
      gltf_error(with("short.bin")),
      AllOf(HasSubstr("buffer 0 has 59 bytes, where 'byteLength' says 60"), HasSubstr("scene.gltf:4:21")));
  EXPECT_THAT(gltf_error(with("https://example.org/a.bin")), HasSubstr("only files are read"));
}

TEST_F(GltfFiles, IndicesMayBeSparseAlone) {
  GltfFile file = triangle();
  const int where = file.view(std::vector<std::uint8_t>{1, 2});
  const int what = file.view(std::vector<std::uint16_t>{1, 2});
  file.raw_accessor(fmt::format(
      R"({{"componentType": 5123, "count": 3, "type": "SCALAR", "sparse": {{"count": 2,
 "indices": {{"bufferView": {}, "componentType": 5121}}, "values": {{"bufferView": {}}}}}}})",
      where, what));
  EXPECT_EQ(
      mesh(good_gltf(file.text(one_mesh(R"({"attributes": {"POSITION": 0}, "indices": 2})")))).triangles,
      std::vector<glm::uvec3>({{0, 1, 2}}));
}

TEST_F(GltfFiles, FilesWithoutMeshesScenesOrBuffersAreRead) {
  for (const char* members :
       {R"("nodes": [{"name": "Empty"}], "scenes": [{"nodes": [0]}, {"name": "Empty"}])",
        R"("materials": [{}])", R"("scene": 1, "scenes": [{"name": "a"}, {"name": "b"}])",
        R"("extensions": {})"}) {
    const SceneDescription scene =
        good_gltf(fmt::format(R"({{"asset": {{"version": "2.0"}}, {}}})", members));
    EXPECT_TRUE(scene.shapes.empty()) << members;
    EXPECT_FALSE(scene.warnings.empty()) << members;
  }
  const std::string json = R"({"asset": {"version": "2.0"}}   )";
  const auto word = [](std::size_t value) {
    const auto v = std::uint32_t(value);
    return std::string(reinterpret_cast<const char*>(&v), 4);
  };
  write("a.glb", "glTF" + word(2) + word(20 + json.size()) + word(json.size()) + "JSON" + json);
  EXPECT_TRUE(read_scene(folder_ / "a.glb", {})) << "a GLB file without a binary part";
}

TEST_F(GltfFiles, NodesOfAFileWithoutScenesAreShown) {
  const SceneDescription scene = good_gltf(triangle().text(
      R"("nodes": [{"children": [1], "translation": [0, 0, 5]}, {"mesh": 0}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}])"));
  EXPECT_EQ(mesh(scene).positions[1], glm::dvec3(1, 0, 5));
}

TEST_F(GltfFiles, OtherVersionsAreNamed) {
  EXPECT_THAT(gltf_error(R"({"asset": {"version": "1.0"}, "nodes": {"a": {}}})"),
              AllOf(HasSubstr("scene.gltf:1:"), HasSubstr("glTF version '1.0' is not read; 2.0 is")));
  EXPECT_THAT(gltf_error(R"({"asset": {"version": 1}})"), HasSubstr("glTF version '1' is not read"));
  EXPECT_THAT(gltf_error(R"({"nodes": []})"), HasSubstr("no glTF 2.0"));
  EXPECT_TRUE(read_gltf(R"({"asset": {"version": "2.1", "minVersion": "2.0"}})"));
}

TEST_F(GltfFiles, OpacityOfVerticesIsIgnoredWithAWarning) {
  GltfFile file = triangle();
  file.accessor<float>("VEC4", {1, 1, 1, 1, 1, 1, 1, 0.5f, 1, 1, 1, 1}, 3);
  const auto said = [&](std::string_view mode) {
    return warnings(
        good_gltf(file.text(one_mesh(R"({"attributes": {"POSITION": 0, "COLOR_0": 2}, "material": 0})",
                                     fmt::format(R"(, "materials": [{{"alphaMode": "{}"}}])", mode)))));
  };
  EXPECT_THAT(said("BLEND"), HasSubstr("the alpha of COLOR_0"));
  EXPECT_THAT(said("OPAQUE"), Not(HasSubstr("the alpha of COLOR_0")));
}

TEST_F(GltfFiles, PlanesThatAreFlattenedAcrossStay) {
  GltfFile file;
  file.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  file.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  const auto scaled = [&](std::string_view scale) {
    return good_gltf(file.text(one_mesh(R"({"attributes": {"POSITION": 0, "NORMAL": 1}})", "",
                                        fmt::format(R"(, "scale": {})", scale))));
  };
  EXPECT_EQ(mesh(scaled("[2, 3, 0]")).positions[2], glm::dvec3(0, 3, 0));
  EXPECT_THAT(warnings(scaled("[0, 0, 0]")), HasSubstr("node 0 is flattened by its transform"));
  EXPECT_THAT(warnings(scaled("[1, 0, 1]")), HasSubstr("no triangles"));
}

TEST_F(GltfFiles, CamerasAndLightsMayBeRounded) {
  const auto with = [&](std::string_view more, std::string_view node) {
    return good_gltf(triangle().text(one_mesh(kTriangle, more, node)));
  };
  const SceneDescription spot = with(
      R"(, "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot",
"spot": {"innerConeAngle": 1.5707964, "outerConeAngle": 1.5707964}}]}})",
      R"(, "extensions": {"KHR_lights_punctual": {"light": 0}})");
  EXPECT_EQ(only<SpotLight>(spot).cutoff_angle, 90.0f);
  EXPECT_NEAR(only<SpotLight>(spot).beam_width, 90.0f, 0.01f);
  const SceneDescription flat = with(
      R"(, "cameras": [{"type": "orthographic", "orthographic": {"xmag": -2, "ymag": -1, "znear": 0, "zfar": 10}}])",
      R"(, "camera": 0)");
  EXPECT_EQ(flat.camera.projection, Projection::kOrthographic);
  EXPECT_EQ(flat.camera.scale_x, 2.0);
  EXPECT_EQ(flat.film.width, 2 * flat.film.height);
  const double s = std::sqrt(0.5);
  const SceneDescription sheared = good_gltf(triangle().text(fmt::format(
      R"("scenes": [{{"nodes": [0]}}], "nodes": [{{"children": [1], "scale": [1, 2, 1]}},
{{"camera": 0, "rotation": [{0}, 0, 0, {1}]}}, {{"mesh": 0}}], "meshes": [{{"primitives": [{2}]}}],
"cameras": [{{"type": "perspective", "perspective": {{"yfov": 1, "znear": 1}}}}])",
      std::sin(std::numbers::pi / 8), std::cos(std::numbers::pi / 8), kTriangle)));
  EXPECT_THAT(warnings(sheared), HasSubstr("shear"));
  // It looks along (0, s, -s), which the scale makes (0, 2 s, -s).
  const glm::dvec3 view = glm::normalize(glm::dvec3(0, 2 * s, -s));
  EXPECT_NEAR(glm::dot(glm::dvec3(sheared.camera.to_world[2]), view), 1.0, 1e-9);
}

}  // namespace
}  // namespace penumbra
