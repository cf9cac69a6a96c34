// Meshes that are read on several threads are those that one thread reads.
#include "scenes/meshes_ahead.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>

#include "tests/scenes/scene_text.h"

namespace penumbra::meshes_ahead_test {
namespace {

using ::testing::HasSubstr;

class MeshesReadAhead : public SceneText {
 protected:
  static std::string name(int i) { return fmt::format("m{}.obj", i); }
  /// A fan of triangles; every third file is bad.
  static std::string text(int i) {
    std::string text = "v 0 0 0\nv 1 0 0\n";
    for (int k = 0; k < 40 + i; ++k) text += fmt::format("v {} 1 {}\nf 1 2 {}\n", k, i, k + 3);
    return i % 3 == 2 ? text + fmt::format("f 1 2 {}\n", 1000 + i) : text;
  }
  MeshRequest request(int i) const { return {folder_ / name(i)}; }
  SourceFile source(int i, std::string content) const { return {folder_ / name(i), std::move(content)}; }

  static void expect_same(const Expected<MeshFile>& read, const Expected<MeshFile>& alone) {
    ASSERT_EQ(read.has_value(), alone.has_value());
    if (!read) {
      EXPECT_EQ(read.error().message, alone.error().message);
      return;
    }
    EXPECT_EQ(read->mesh.positions, alone->mesh.positions);
    EXPECT_EQ(read->mesh.triangles, alone->mesh.triangles);
    EXPECT_EQ(read->warnings, alone->warnings);
  }

  FileAccess files_{std::nullopt};
};

TEST_F(MeshesReadAhead, AreTheSameInAnyOrderAndWithLittleMemory) {
  constexpr int kCount = 30;
  std::vector<MeshRequest> requests;
  for (int i = 0; i < kCount; ++i) {
    write(name(i), text(i));
    requests.push_back(request(i));
  }
  for (const unsigned helpers : {0u, 1u, 4u})
    for (const std::size_t most_bytes : {std::size_t(0), MeshesAhead::kMostBytes})
      for (const bool backwards : {false, true}) {
        MeshesAhead meshes(requests, files_, helpers, most_bytes);
        for (int k = 0; k < kCount; ++k) {
          const int i = backwards ? kCount - 1 - k : k;
          const SourceFile file = source(i, text(i));
          expect_same(meshes.read(request(i), file), read_obj(file));
        }
      }
}

TEST_F(MeshesReadAhead, AreThoseOfTheTextThatIsGiven) {
  std::vector<MeshRequest> requests{request(1), request(0), {folder_ / "missing.obj"}};
  write(name(0), text(0));
  write(name(1), text(1));
  MeshesAhead meshes(requests, files_, 2);
  const SourceFile changed = source(0, text(7)), unasked = source(3, text(3));
  const SourceFile late{folder_ / "missing.obj", text(4)};
  expect_same(meshes.read(request(0), changed), read_obj(changed));
  expect_same(meshes.read(request(3), unasked), read_obj(unasked));
  expect_same(meshes.read({folder_ / "missing.obj"}, late), read_obj(late));
}

TEST_F(MeshesReadAhead, MayBeAskedForAsOftenAsRequestedAndMore) {
  write(name(0), text(0));
  write(name(1), text(1));
  MeshesAhead meshes({request(0), request(1), request(0)}, files_, 1);
  const SourceFile file = source(0, text(0));
  for (int turn = 0; turn < 4; ++turn) expect_same(meshes.read(request(0), file), read_obj(file));
  MeshesAhead alone({request(1)}, files_, 0);
  const SourceFile other = source(1, text(1));
  for (int turn = 0; turn < 3; ++turn) expect_same(alone.read(request(1), other), read_obj(other));
}

TEST_F(MeshesReadAhead, NeedNotBeAskedFor) {
  std::vector<MeshRequest> requests;
  for (int i = 0; i < 30; ++i) {
    write(name(i), text(i));
    requests.push_back(request(i));
  }
  const MeshesAhead meshes(requests, files_, 3, 0);
}

TEST_F(MeshesReadAhead, HaveTheirErrorsInTheOrderOfTheScene) {
  std::string shapes;
  for (int i = 0; i < 12; ++i) {
    write(name(i), text(i));
    shapes += fmt::format("<shape type='obj'><string name='filename' value='{}'/></shape>\n", name(i));
  }
  const std::string message = error(scene(shapes));
  std::vector<std::size_t> places;
  for (const int bad : {2, 5, 8, 11}) {
    places.push_back(message.find(name(bad) + ":"));
    EXPECT_THAT(message, HasSubstr(fmt::format("vertex index {} is out of range", 1000 + bad)));
  }
  EXPECT_TRUE(std::ranges::is_sorted(places)) << message;
}

}  // namespace
}  // namespace penumbra::meshes_ahead_test
