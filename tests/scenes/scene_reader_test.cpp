#include "scenes/scene_reader.h"

#include <gmock/gmock.h>

#include "tests/scenes/scene_text.h"

namespace penumbra {
namespace {

using ::testing::HasSubstr;
using SceneReader = SceneText;

TEST_F(SceneReader, TellsFormatsByNameAndContent) {
  write("a.XML", scene(""));
  EXPECT_TRUE(read_scene(folder_ / "a.XML", {}));
  write("b", "  \n" + scene(""));
  EXPECT_TRUE(read_scene(folder_ / "b", {}));
  write("c.blend", "BLENDER");
  EXPECT_THAT(
      read_scene(folder_ / "c.blend", {}).error().message,
      HasSubstr("c.blend: not a scene in a format that Penumbra reads; it reads: Mitsuba XML (.xml)"));
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

}  // namespace
}  // namespace penumbra
