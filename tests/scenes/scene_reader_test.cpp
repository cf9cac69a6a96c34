#include "scenes/scene_reader.h"

#include <gmock/gmock.h>

#include "tests/scenes/gzip_writer.h"
#include "tests/scenes/tinyrender_text.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using SceneReader = TinyRenderText;

TEST_F(SceneReader, TellsFormatsByNameAndContent) {
  write("a.XML", scene(""));
  EXPECT_TRUE(read_scene(folder_ / "a.XML", {}));
  write("b", "  \n" + scene(""));
  EXPECT_TRUE(read_scene(folder_ / "b", {}));
  write("c.blend", "BLENDER");
  EXPECT_THAT(read_scene(folder_ / "c.blend", {}).error().message,
              HasSubstr("c.blend: Blender has to export such files"));
  write("c.fbx", "Kaydara");
  EXPECT_THAT(read_scene(folder_ / "c.fbx", {}).error().message,
              HasSubstr("c.fbx: not a scene in a format that Penumbra reads; it reads: Rainbow XML (.xml), "
                        "Nori XML (.xml), Mitsuba XML (.xml), "));
}

TEST_F(SceneReader, GzipFilesAreUnpacked) {
  const std::string packed = gzip_of(scene("<shape type='sphere'/>"));
  write("a.xml.gz", packed);
  const auto read = read_scene(folder_ / "a.xml.gz", {});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->shapes.size(), 1u);
  write("a.xml.gz", packed.substr(0, packed.size() / 2));
  EXPECT_THAT(read_scene(folder_ / "a.xml.gz", {}).error().message, HasSubstr("ends early"));
  // Much more than it may unpack to.
  write("a.xml.gz", gzip_of(std::string(std::size_t{80} << 20, ' ')));
  EXPECT_THAT(read_scene(folder_ / "a.xml.gz", {}).error().message, HasSubstr("unpacks to more than"));
}

TEST_F(SceneReader, MissingAndOddFiles) {
  EXPECT_THAT(read_scene(folder_ / "none.xml", {}).error().message, HasSubstr("there is no file"));
  EXPECT_THAT(read_scene(folder_.path(), {}).error().message, HasSubstr("is not a plain file"));
  EXPECT_THAT(read_scene("/dev/zero", {}).error().message, HasSubstr("is not a plain file"));
  EXPECT_THAT(read_scene("", {}).error().message, HasSubstr("there is no file"));
}

TEST_F(SceneReader, KeepsTheSource) {
  write("a.xml", scene(""));
  EXPECT_EQ(read_scene(folder_ / "a.xml", {}).value().source, (folder_ / "a.xml").string());
}

TEST_F(SceneReader, WarnsOfScenesThatAreBlack) {
  const auto mitsuba = [&](std::string_view content) {
    const auto result = read(scene(content));
    EXPECT_TRUE(result) << result.error().message;
    return result ? result->warnings : std::vector<std::string>{};
  };
  const std::string sphere = "<shape type='sphere'/>", point = "<emitter type='point'/>",
                    sky = "<emitter type='constant'/>";
  const auto no_shapes = HasSubstr("scene.xml: warning: the scene has no shapes; the image is black");
  const auto no_light = HasSubstr("scene.xml: warning: nothing in the scene emits light; the image is black");
  EXPECT_THAT(mitsuba(""), ElementsAre(no_shapes));
  EXPECT_THAT(mitsuba(point), ElementsAre(no_shapes));
  EXPECT_THAT(mitsuba(sky),
              ElementsAre(HasSubstr("scene.xml: warning: the scene has no shapes; only its sky is seen")));
  EXPECT_THAT(mitsuba(sphere), ElementsAre(no_light));
  EXPECT_THAT(mitsuba("<shape type='sphere'><emitter type='area'><rgb name='radiance' value='0'/></emitter>"
                      "</shape><emitter type='point'><rgb name='intensity' value='0'/></emitter>"
                      "<emitter type='constant'><rgb name='radiance' value='0'/></emitter>"),
              ElementsAre(no_light));
  EXPECT_THAT(mitsuba(sphere + point), IsEmpty());
  EXPECT_THAT(mitsuba(sphere + sky), IsEmpty());
  EXPECT_THAT(mitsuba("<shape type='sphere'><emitter type='area'/></shape>"), IsEmpty());
}

TEST_F(SceneReader, WarnsOfMeshesWithoutFaces) {
  const std::string no_vertices =
      "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 0\nproperty list uchar int vertex_indices\nend_header\n";
  for (const auto& [name, text] : {std::pair<std::string, std::string>("empty.obj", ""),
                                   {"points.obj", "v 0 0 0\nv 1 0 0\n"},
                                   {"empty.ply", no_vertices}}) {
    write(name, text);
    const auto result = read(scene("<shape type='" + name.substr(name.size() - 3) +
                                   "'><string name='filename' value='" + name + "'/></shape>"));
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_THAT(result->warnings, ElementsAre(AllOf(HasSubstr("scene.xml:2:2: warning: "),
                                                    HasSubstr(name + ": the shape has no")),
                                              HasSubstr("the scene has no shapes")));
  }
  for (const std::string text : {"", "mtllib m.mtl\nv 0 0 0\n"}) {
    use(text);
    const auto result = read_toml(scene_with(kDirect));
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_THAT(result->warnings, ElementsAre(HasSubstr("m.obj:1:1: warning: the file has no faces"),
                                              HasSubstr("scene.toml: warning: the scene has no shapes")));
  }
}

}  // namespace
}  // namespace penumbra
