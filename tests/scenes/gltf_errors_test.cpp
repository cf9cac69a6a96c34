// Errors in glTF files: clear messages with file positions, and warnings about what is left out.
#include <gmock/gmock.h>

#include "tests/scenes/gltf_text.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct BadGltf {
  std::string name, members, error;
};
class BadGltfText : public GltfText, public ::testing::WithParamInterface<BadGltf> {};

TEST_P(BadGltfText, IsAClearErrorWithItsPlace) {
  const std::string message = gltf_error(triangle().text(GetParam().members));
  EXPECT_THAT(message, HasSubstr("scene.gltf:"));
  EXPECT_THAT(message, HasSubstr(GetParam().error));
}

std::string meshed(std::string_view node, std::string_view more = "") {
  return fmt::format(R"("scenes": [{{"nodes": [0]}}], "nodes": [{}],
"meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}]{})",
                     node, more);
}
std::string primitive(std::string_view text) {
  return fmt::format(R"("nodes": [{{"mesh": 0}}], "meshes": [{{"primitives": [{}]}}])", text);
}

INSTANTIATE_TEST_SUITE_P(
    All, BadGltfText,
    ::testing::Values(
        BadGltf{"NotJson", "\"nodes\": [,]", "scene.gltf:3:11: error: not JSON"},
        BadGltf{"Cycle", meshed(R"({"children": [1]}, {"children": [0]})"),
                "node 0 is there twice, or below itself"},
        BadGltf{"TwoParents", meshed(R"({"children": [1, 2]}, {"children": [2]}, {"mesh": 0})"),
                "node 2 is there twice"},
        BadGltf{"NoSuchChild", meshed(R"({"children": [7]})"), "there is no node 7"},
        BadGltf{"NoSuchMesh", meshed(R"({"mesh": 4})"), "scene.gltf:3:39: error: node 0: there is no mesh 4"},
        BadGltf{"NoSuchCamera", meshed(R"({"camera": 4})"), "there is no camera 4"},
        BadGltf{"NoSuchMaterial", primitive(R"({"attributes": {"POSITION": 0}, "material": 3})"),
                "there is no material 3"},
        BadGltf{"WrongShape", primitive(R"({"attributes": {"POSITION": 1}})"),
                "POSITION: accessor 1 is not of vectors of 3"},
        BadGltf{"IndicesOfVectors", primitive(R"({"attributes": {"POSITION": 0}, "indices": 0})"),
                "indices: accessor 0 is not of numbers"},
        BadGltf{"RequiredExtension", meshed(R"({"mesh": 0})", R"(, "extensionsRequired": ["KHR_draco"])"),
                "requires the extension 'KHR_draco'"},
        BadGltf{"FlatCamera",
                meshed(R"({"mesh": 0, "camera": 0})",
                       R"(, "cameras": [{"type": "perspective", "perspective": {"yfov": 0, "znear": 1}}])"),
                "yfov must be between 0 and pi"},
        BadGltf{
            "FarBeforeNear",
            meshed(
                R"({"mesh": 0, "camera": 0})",
                R"(, "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 2, "zfar": 1}}])"),
            "zfar must be beyond znear"},
        BadGltf{"Perspective", meshed(R"({"mesh": 0, "matrix": [1,0,0,1, 0,1,0,0, 0,0,1,0, 0,0,0,1]})"),
                "the last row of its matrix must be 0 0 0 1"},
        BadGltf{
            "NegativeLight",
            meshed(
                R"({"mesh": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}})",
                R"(, "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": -1}]}})"),
            "at least 0 and finite"},
        BadGltf{"TooFarAway", meshed(R"({"mesh": 0, "translation": [1e38, 0, 0]})"), "too far away"}),
    [](const auto& test) { return test.param.name; });

TEST_F(GltfText, BrokenBuffersAreErrors) {
  const auto with = [&](std::string_view accessor) {
    GltfFile file = triangle();
    file.raw_accessor(std::string(accessor));
    return gltf_error(file.text(one_mesh(R"({"attributes": {"POSITION": 2}})")));
  };
  EXPECT_THAT(with(R"({"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"})"),
              HasSubstr("POSITION: accessor 2: 4 elements end beyond the 36 bytes of buffer view 0"));
  EXPECT_THAT(
      with(R"({"bufferView": 0, "byteOffset": 4, "componentType": 5126, "count": 3, "type": "VEC3"})"),
      HasSubstr("end beyond"));
  EXPECT_THAT(with(R"({"bufferView": 9, "componentType": 5126, "count": 3, "type": "VEC3"})"),
              HasSubstr("there is no buffer view 9"));
  EXPECT_THAT(with(R"({"componentType": 5126, "count": 4000000000, "type": "VEC3"})"), HasSubstr("too many"));
  GltfFile nan;
  nan.accessor<float>("VEC3", {0, 0, 0, 1, 0, std::nanf(""), 0, 1, 0}, 3);
  EXPECT_THAT(gltf_error(nan.text(one_mesh(R"({"attributes": {"POSITION": 0}})"))), HasSubstr("not finite"));
  GltfFile index = triangle();
  index.accessor<std::uint8_t>("SCALAR", {0, 1, 3}, 3);
  EXPECT_THAT(gltf_error(index.text(one_mesh(R"({"attributes": {"POSITION": 0}, "indices": 2})"))),
              HasSubstr("an index 3, where there are 3 vertices"));
  EXPECT_THAT(gltf_error("{\"asset\": {\"version\": \"2.0\"}, " + one_mesh(kTriangle) + ", " +
                         triangle().buffers("\"uri\": \"none.bin\", ") + "}"),
              HasSubstr("none.bin"));
}

TEST_F(GltfText, FilesOutsideTheirFolderAreRefused) {
  const TemporaryFolder elsewhere;
  write_text(elsewhere / "x.bin", triangle().buffer());
  const std::string text =
      "{\"asset\": {\"version\": \"2.0\"}, " + one_mesh(kTriangle) + ", " +
      triangle().buffers(fmt::format("\"uri\": \"{}\", ", (elsewhere / "x.bin").string())) + "}";
  EXPECT_TRUE(read_gltf(text));
  EXPECT_THAT(gltf_error(text, {.confine_to = folder_.path()}), HasSubstr("leads outside the folder"));
}

TEST_F(GltfText, BinaryFilesWithWrongLengthsAreErrors) {
  const std::string good = triangle().binary(one_mesh(kTriangle));
  const auto error_of = [&](std::string bytes) {
    write("scene.glb", bytes);
    const auto result = read_scene(folder_ / "scene.glb", {});
    EXPECT_FALSE(result);
    return result ? "" : result.error().message;
  };
  EXPECT_THAT(error_of(good.substr(0, 10)), HasSubstr("ends in its header"));
  EXPECT_THAT(error_of(good.substr(0, good.size() - 8)), HasSubstr("which says that it has"));
  std::string version = good;
  version[4] = 1;
  EXPECT_THAT(error_of(version), HasSubstr("GLB version 1"));
  std::string chunk = good;
  chunk[15] = 0x7f;
  EXPECT_THAT(error_of(chunk), HasSubstr("longer than the file"));
}

TEST_F(GltfText, DeepNestingIsAnErrorNotACrash) {
  std::string deep = "\"extras\": ";
  for (int i = 0; i < 100000; ++i) deep += "[";
  for (int i = 0; i < 100000; ++i) deep += "]";
  EXPECT_THAT(gltf_error(triangle().text(deep)), HasSubstr("nested more than 64 deep"));
}

TEST_F(GltfText, LeniencyLeavesOutWhatIsUnknown) {
  const std::string text = triangle().text(
      one_mesh(kTriangle,
               R"(, "extensionsRequired": ["EXT_unknown"], "extensionsUsed": ["EXT_unknown", "EXT_other"])"));
  EXPECT_FALSE(read_gltf(text));
  EXPECT_THAT(warnings(good_gltf(text, {.lenient = true})),
              AllOf(HasSubstr("requires the extension 'EXT_unknown'"), HasSubstr("what it does is left out"),
                    HasSubstr("the extension 'EXT_other' is ignored")));
}

TEST_F(GltfText, PointsAreLeftOut) {
  const SceneDescription scene = good_gltf(triangle().text(
      one_mesh(R"({"attributes": {"POSITION": 0}, "mode": 0}, {"attributes": {"POSITION": 0}})")));
  EXPECT_EQ(scene.shapes.size(), 1u);
  EXPECT_THAT(warnings(scene), HasSubstr("points and lines have no surface"));
}

TEST_F(GltfText, PrimitivesWithoutPositionsAreLeftOut) {
  const SceneDescription scene = good_gltf(
      triangle().text(one_mesh(R"({"attributes": {"NORMAL": 0}}, {"attributes": {"POSITION": 0}})")));
  EXPECT_EQ(scene.shapes.size(), 1u);
  EXPECT_THAT(warnings(scene), HasSubstr("without POSITION"));
}

}  // namespace
}  // namespace penumbra
