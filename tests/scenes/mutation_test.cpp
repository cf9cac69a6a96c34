// Scenes with flipped bytes and with removed, swapped and duplicated parts: each is either read or rejected
// with a message, without a crash or a hang. What is read must be renderable.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <random>
#include <tuple>

#include "scenes/scene_reader.h"
#include "scenes/transform.h"
#include "scenes/volume_file.h"
#include "tests/scenes/gltf_text.h"
#include "tests/scenes/ply_writer.h"
#include "tests/scenes/sdf_writer.h"
#include "tests/scenes/serialized_writer.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tga_file.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

/// PENUMBRA_MUTATIONS=20000 makes a long search of a short test.
int mutations_per_file() {
  const char* text = std::getenv("PENUMBRA_MUTATIONS");
  return text != nullptr ? std::atoi(text) : 200;
}
constexpr std::chrono::seconds kLongest(
    20);  // generous: a sanitizer's build on a busy machine takes milliseconds

class Mutator {
 public:
  explicit Mutator(std::uint32_t seed) : random_(seed) {}

  std::string mutate(std::string text) {
    const int times = 1 + below(3);
    for (int i = 0; i < times; ++i) once(text);
    return text;
  }

 private:
  int below(std::size_t n) { return n == 0 ? 0 : int(random_() % n); }

  /// A token: a run of bytes between separators.
  std::pair<std::size_t, std::size_t> token(const std::string& text) {
    const char* separators = " \t\n\"<>=/,";
    std::size_t begin = std::size_t(below(text.size()));
    begin = text.find_first_not_of(separators, begin);
    if (begin == text.npos) return {0, std::min<std::size_t>(text.size(), 1)};
    const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
    return {begin, end - begin};
  }

  void once(std::string& text) {
    if (text.empty()) return;
    const std::size_t at = std::size_t(below(text.size()));
    switch (below(9)) {
      case 0:
        text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
        break;
      case 1:
        text[at] = static_cast<char>(below(256));
        break;
      case 2:
        text.erase(at, 1 + std::size_t(below(40)));
        break;
      case 3:
        text.resize(at);
        break;
      case 4: {
        const auto [begin, size] = token(text);
        text.insert(begin, text.substr(begin, size) + " ");
        break;
      }
      case 5: {
        const auto [begin, size] = token(text);
        const auto [other, other_size] = token(text);
        const std::string piece = text.substr(other, other_size);
        text.replace(begin, size, piece);
        break;
      }
      case 6: {
        static const char* const kNumbers[] = {
            "0",          "-1",         "1e39", "1e308", "-1e-320", "nan",  "inf", "99999999999999999999",
            "4294967296", "2147483648", "",     "$",     "#ffffff", "../x", "&lt;"};
        const auto [begin, size] = token(text);
        text.replace(begin, size, kNumbers[below(std::size(kNumbers))]);
        break;
      }
      case 7: {  // a line doubled
        const std::size_t begin = text.rfind('\n', at) == text.npos ? 0 : text.rfind('\n', at);
        const std::size_t end = std::min(text.find('\n', at + 1), text.size());
        text.insert(begin, text.substr(begin, end > begin ? end - begin : 0));
        break;
      }
      default:
        std::swap(text[at], text[std::size_t(below(text.size()))]);
        break;
    }
  }

  std::mt19937 random_;
};

bool finite(glm::dvec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void expect_fit(const SceneDescription& scene) {
  const int bsdfs = int(scene.bsdfs.size());
  for (const Shape& shape : scene.shapes) {
    ASSERT_TRUE(shape.front_bsdf >= kBlackBsdf && shape.front_bsdf < bsdfs);
    ASSERT_TRUE(shape.back_bsdf >= kBlackBsdf && shape.back_bsdf < bsdfs);
    ASSERT_TRUE(!shape.radiance || finite(*shape.radiance));
    if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
      ASSERT_TRUE(finite(sphere->center) && sphere->radius > 0.0 && std::isfinite(sphere->radius));
    }
    if (const auto* mesh = std::get_if<Mesh>(&shape.geometry)) {
      ASSERT_FALSE(mesh->triangles.empty());
      for (const glm::dvec3& p : mesh->positions) ASSERT_TRUE(finite(p));
      for (const glm::vec3& n : mesh->normals) ASSERT_NEAR(glm::length(n), 1.0f, 1e-5f);
      ASSERT_TRUE(mesh->normals.empty() || mesh->normals.size() == mesh->positions.size());
      ASSERT_TRUE(mesh->texcoords.empty() || mesh->texcoords.size() == mesh->positions.size());
      for (const glm::uvec3& t : mesh->triangles) {
        ASSERT_LT(std::max(t.x, std::max(t.y, t.z)), mesh->positions.size());
      }
    }
  }
  for (const ParticipatingMedium& medium : scene.media) {
    if (!medium.density) continue;
    const VolumeGrid& grid = *medium.density->grid;
    ASSERT_EQ(grid.values.size(), std::size_t(grid.nx) * std::size_t(grid.ny) * std::size_t(grid.nz) *
                                      std::size_t(grid.channels));
    for (const float value : grid.values) ASSERT_TRUE(std::isfinite(value) && value >= 0.0f);
    ASSERT_FALSE(is_singular(medium.density->to_world));
  }
  ASSERT_TRUE(scene.camera.fov > 0.0 && scene.camera.fov < 180.0);
  ASSERT_NEAR(std::abs(glm::determinant(glm::dmat3(scene.camera.to_world))), 1.0, 1e-3);
  ASSERT_TRUE(scene.film.crop_x + scene.film.crop_width <= scene.film.width);
  ASSERT_GE(scene.sampler.spp, 1u);
}

/// Reads `scene` in `folder` for every mutation of `mutated`, a file there.
void expect_survival(const fs::path& folder, const std::string& scene, const std::string& mutated,
                     std::uint32_t seed) {
  const std::string original = file_contents(folder / mutated);
  Mutator mutator(seed);
  const int mutations = mutations_per_file();
  int good = 0;
  for (int i = 0; i < mutations; ++i) {
    const std::string text = mutator.mutate(original);
    SCOPED_TRACE("mutation " + std::to_string(i) + " of " + mutated);
    write_text(folder / mutated, text);
    const auto start = std::chrono::steady_clock::now();
    const auto result = read_scene(folder / scene, {.lenient = i % 2 == 1, .confine_to = folder});
    EXPECT_LT(std::chrono::steady_clock::now() - start, kLongest);
    if (result) {
      ++good;
      expect_fit(*result);
    } else {
      EXPECT_FALSE(result.error().message.empty());
    }
    if (::testing::Test::HasFailure()) {
      write_text(fs::temp_directory_path() / "penumbra-mutation", text);
      FAIL() << "left in " << fs::temp_directory_path() / "penumbra-mutation";
    }
  }
  write_text(folder / mutated, original);
  // Both outcomes must be there, or the mutations are too weak or too strong to test anything.
  EXPECT_GT(good, 0);
  EXPECT_LT(good, mutations);
}

struct MutationCase {
  std::string folder;  ///< below scenes/
  std::string scene;
  std::string mutated;
  std::uint32_t seed;
};

class Mutations : public ::testing::TestWithParam<MutationCase> {};

TEST_P(Mutations, AreReadOrRefused) {
  const TemporaryFolder folder;
  fs::copy(fs::path(PENUMBRA_SOURCE_DIR) / "scenes" / GetParam().folder, folder.path(),
           fs::copy_options::recursive);
  expect_survival(folder.path(), GetParam().scene, GetParam().mutated, GetParam().seed);
}

INSTANTIATE_TEST_SUITE_P(
    OwnScenes, Mutations,
    ::testing::Values(MutationCase{"cornell", "cornell.xml", "cornell.xml", 1001},
                      MutationCase{"cornell", "cornell.xml", "meshes/tall-block.ply", 1002},
                      MutationCase{"cornell-small", "cornell-small.xml", "cornell-small.xml", 1003},
                      MutationCase{"veach-mis", "veach-mis.xml", "veach-mis.xml", 1004},
                      MutationCase{"furnace", "furnace.xml", "furnace.xml", 1005},
                      MutationCase{"polygon-lights", "polygon-lights.xml", "polygon-lights.xml", 1006},
                      MutationCase{"polygon-lights", "polygon-lights.xml", "light-1.obj", 1007},
                      MutationCase{"polygon-lights", "polygon-2.xml", "polygon-2.xml", 1008}));

TEST(MutatedMeshes, EveryPlyEncoding) {
  const TemporaryFolder folder;
  write_text(folder / "scene.xml",
             "<scene version='3.0.0'><sensor type='perspective'/>"
             "<shape type='ply'><string name='filename' value='m.ply'/></shape></scene>");
  for (const PlyEncoding encoding :
       {PlyEncoding::kAscii, PlyEncoding::kLittleEndian, PlyEncoding::kBigEndian}) {
    write_text(folder / "m.ply", odd_square_ply(encoding));
    expect_survival(folder.path(), "scene.xml", "m.ply", 77);
  }
}

/// Bytes of the file, which is compressed, and of what a mesh unpacks to.
TEST(MutatedMeshes, Serialized) {
  const TemporaryFolder folder;
  write_text(folder / "scene.xml",
             "<scene version='3.0.0'><sensor type='perspective'/>"
             "<shape type='serialized'><string name='filename' value='m.serialized'/>"
             "<integer name='shape_index' value='1'/></shape></scene>");
  for (const int version : {3, 4}) {
    SerializedWriter writer(version);
    for (const double x : {0.0, 1.0}) writer.add(serialized_square(x), {version});
    write_text(folder / "m.serialized", writer.file());
    expect_survival(folder.path(), "scene.xml", "m.serialized", 101);
  }
  Mutator mutator(102);
  std::string data;
  for (const std::uint32_t word : {0xbu, 4u, 0u, 2u, 0u}) SerializedWriter::put(data, word);
  const Mesh mesh = serialized_square(0);
  for (const glm::dvec3& p : mesh.positions) SerializedWriter::put(data, glm::vec3(p));
  for (const glm::vec3& n : mesh.normals) SerializedWriter::put(data, n);
  for (const glm::vec2& t : mesh.texcoords) SerializedWriter::put(data, t);
  for (const glm::vec3& c : mesh.colours) SerializedWriter::put(data, c);
  for (const glm::uvec3& t : mesh.triangles) SerializedWriter::put(data, t);
  int good = 0;
  for (int i = 0; i < mutations_per_file(); ++i) {
    SerializedWriter writer(3);
    writer.add(mesh, {3});
    writer.add_packed(i == 0 ? data : mutator.mutate(data));
    write_text(folder / "m.serialized", writer.file());
    const auto result = read_scene(folder / "scene.xml", {.confine_to = folder.path()});
    if (i == 0) ASSERT_TRUE(result) << result.error().message;
    if (result) expect_fit(*result);
    good += result ? 1 : 0;
  }
  EXPECT_GT(good, 1);
  EXPECT_LT(good, mutations_per_file());
}

TEST(MutatedMeshes, CurvesAndDistances) {
  const TemporaryFolder folder;
  for (const char* type : {"bsplinecurve", "linearcurve"}) {
    write_text(folder / "scene.xml", "<scene version='3.0.0'><sensor type='perspective'/><shape type='" +
                                         std::string(type) +
                                         "'><string name='filename' value='c.txt'/></shape></scene>");
    write_text(folder / "c.txt",
               "0 0 0 0.1\n1 0.5 0 0.2\n2 0 1e-3 0.1\n3 1 0 0\n4 0 0 0.3\n\n0 1 0 0.1\n1 1 1 0.1\n2 1 0 "
               "0.1\n3 1 0 0.1\n");
    expect_survival(folder.path(), "scene.xml", "c.txt", 103);
  }
  write_text(
      folder / "scene.xml",
      "<scene version='3.0.0'><sensor type='perspective'/><shape type='sdfgrid'><string name='filename' "
      "value='g.vol'/></shape></scene>");
  write_text(folder / "g.vol", sdf_file(ball_of_distances(4, 0.3)));
  expect_survival(folder.path(), "scene.xml", "g.vol", 104);
}

TEST(MutatedMeshes, Grids) {
  const TemporaryFolder folder;
  write_text(folder / "scene.xml",
             "<scene version='3.0.0'><integrator type='volpath'/><sensor type='perspective'/><shape "
             "type='cube'><medium type='heterogeneous' name='interior'><volume type='gridvolume' "
             "name='sigma_t'><string name='filename' value='s.vol'/><boolean name='use_grid_bbox' "
             "value='true'/></volume></medium></shape></scene>");
  VolumeGrid grid{4, 3, 2, 3, std::vector<float>(72, 0.5f)};
  grid.values[7] = 2.0f;
  write_text(folder / "s.vol", vol_of(grid));
  expect_survival(folder.path(), "scene.xml", "s.vol", 105);
}

TEST(MutatedMeshes, Animations) {
  const TemporaryFolder folder;
  write_text(
      folder / "scene.xml",
      "<scene version='3.0.0'><sensor type='perspective'><float name='shutter_open' value='0.3'/><animation "
      "name='to_world'><transform time='0'><rotate y='1' angle='9'/></transform><transform time='1'><scale "
      "value='2'/><translate x='1'/></transform></animation></sensor><emitter type='point'/></scene>");
  expect_survival(folder.path(), "scene.xml", "scene.xml", 105);
}

TEST(MutatedMeshes, ObjWithEverything) {
  const TemporaryFolder folder;
  write_text(folder / "scene.xml",
             "<scene version='3.0.0'><sensor type='perspective'/>"
             "<shape type='obj'><string name='filename' value='m.obj'/></shape></scene>");
  write_text(folder / "m.obj",
             "# all of it\nmtllib a.mtl\no thing\nv 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 "
             "1\nvn 0 0 1\n"
             "vn 0 1 0\ng group\nusemtl red\ns 1\nf 1/1/1 2/2/1 3/3/2\nf -4/-3/-2 -2/-1/-1 \\\n 4/2/1\nf 1 2 "
             "3 4\nl 1 2\n");
  expect_survival(folder.path(), "scene.xml", "m.obj", 99);
}

class MutatedTinyRender
    : public ::testing::TestWithParam<std::tuple<std::string, std::string, std::uint32_t>> {};

TEST_P(MutatedTinyRender, AreReadOrRefused) {
  const auto& [renderer, mutated, seed] = GetParam();
  const TemporaryFolder folder;
  write_text(
      folder / "scene.toml",
      "# all of it\n[input]\nobjfile = \"m.obj\"\n[camera]\neye = [5.0, 3.0, -2]\nat = [-2.0, 0.4, 1.0]\n"
      "up = [0.0, 1.0, 0.0]\nfov = 35.0\n\n[film]\nwidth = 60\nheight = 40\n\n[renderer]\n" +
          renderer);
  // A star of ten corners, a square with a hole, a warped and a smooth face.
  write_text(
      folder / "m.obj",
      "mtllib m.mtl\no star\nv -3 .69 0\nv -3 .04 -.88\nv -3 1.08 -.53\nv -3 1.71 -1.43\nv -3 1.7 -.33\n"
      "v -3 2.75 0\nv -3 1.7 .33\nv -3 1.71 1.43\nv -3 1.08 .53\nv -3 .04 .88\nvn 1 0 0\nusemtl area_light\n"
      "s off\nf 1//1 2//1 3//1 4//1 5//1 6//1 7//1 8//1 9//1 10//1\no floor\nv -4 0 4\nv 4 0 4\nv 4 0 -4\n"
      "v -4 0 -4\nv -1 0 1\nv 1 0 1\nv 1 .2 -1\nv -1 0 -1\nvn 0 1 0\nvn .1 1 0\nusemtl white\n"
      "f 11//2 12//2 13//2 14//2 11//2 15//2 18//2 17//2 16//2 15//2\nusemtl shiny\nf 15//2 16//3 17//2 18\n"
      "f -1//2 -2//3 -3//-1\n");
  write_text(folder / "m.mtl",
             "# three\nnewmtl area_light\nKe 12 8.5 4\n\nnewmtl white\nKd 0.5 0.5 0.5\nillum 7\nnewmtl "
             "shiny\nNs 100.0\n"
             "Kd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\nKa 0 0 0\nNi 1.0\nd 1.0\nmap_Kd wood.png\nillum 2\n");
  expect_survival(folder.path(), "scene.toml", mutated, seed);
}

INSTANTIATE_TEST_SUITE_P(
    All, MutatedTinyRender,
    ::testing::Values(
        std::tuple(
            "type = \"direct\"\nsamplingStrategy = \"mis\"\nemitterSamples = 4\nbsdfSamples = 0\nspp = 2\n",
            "scene.toml", 2001u),
        std::tuple(
            "type = \"polygonal\"\nmethod = \"controlVariates\"\nalpha = 0.9\nvisSamples = 4\nbonus = true\n",
            "scene.toml", 2002u),
        std::tuple("type = \"polygonal\"\nrealtime = true\ntest = true\n", "m.obj", 2003u),
        std::tuple("type = \"path\"\nmaxDepth = 5\n", "m.mtl", 2004u)),
    [](const auto& test) {
      return "of_" + std::get<1>(test.param).substr(0, 1) + std::to_string(test.index);
    });

/// A file with a texture, a strip, sparse numbers, a light, a camera, nested nodes.
GltfFile everything_of_gltf() {
  GltfFile file;
  file.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, 4);
  file.accessor<float>("VEC2", {0, 1, 1, 1, 0, 0, 1, 0}, 4);
  file.accessor<std::uint16_t>("SCALAR", {0, 1, 2, 3}, 4);
  file.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 4);
  const int where = file.view(std::vector<std::uint16_t>{1});
  const int what = file.view(std::vector<float>{2, 0, 0});
  file.raw_accessor(fmt::format(
      R"({{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "sparse": {{"count": 1,
 "indices": {{"bufferView": {}, "componentType": 5123}}, "values": {{"bufferView": {}}}}}}})",
      where, what));
  return file;
}
constexpr const char* kEverythingOfGltf =
    R"("scene": 0, "scenes": [{"nodes": [0, 3]}], "extensionsUsed": ["KHR_lights_punctual"],
"nodes": [{"mesh": 0, "children": [1, 2], "scale": [1, 2, 3]}, {"mesh": 1, "rotation": [0, 0, 0, 1]},
{"camera": 0, "translation": [0, 0, 5]}, {"extensions": {"KHR_lights_punctual": {"light": 0}}}],
"cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1, "zfar": 100, "aspectRatio": 1.5}}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 3, "TEXCOORD_0": 1}, "indices": 2, "mode": 5, "material": 0}]},
{"primitives": [{"attributes": {"POSITION": 4}, "mode": 6, "material": 1}]}],
"images": [{"uri": "t.tga"}], "samplers": [{"wrapS": 33071}], "textures": [{"source": 0, "sampler": 0}],
"materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 0}, "metallicRoughnessTexture": {"index": 0},
"baseColorFactor": [0.5, 0.5, 0.5, 1]}, "normalTexture": {"index": 0, "scale": 0.5}, "alphaMode": "MASK"},
{"emissiveFactor": [1, 1, 1], "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 3},
"KHR_materials_transmission": {"transmissionFactor": 0.5}}}],
"extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 100, "color": [1, 1, 0.5]}]}})";

/// A skin, morph targets, instances, and keys of them all; indices that are sparse alone, another model of
/// materials.
GltfFile moving_gltf() {
  GltfFile file;
  file.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  file.accessor<std::uint8_t>("VEC4", {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, 3);
  file.accessor<std::uint8_t>("VEC4", {255, 0, 0, 0, 255, 0, 0, 0, 51, 204, 0, 0}, 3,
                              R"(, "normalized": true)");
  file.accessor<float>(
      "MAT4",
      {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1}, 2);
  file.accessor<float>("VEC3", {0, 0, 4, 0, 0, 4, 0, 0, 4}, 3);
  file.accessor<std::int16_t>("VEC4", {0, 0, 0, 32767, 0, 0, 32767, 0}, 2, R"(, "normalized": true)");
  file.accessor<float>("VEC3", {1, 1, 1, 2, 2, 2}, 2);
  const int where = file.view(std::vector<std::uint8_t>{1, 2});
  const int what = file.view(std::vector<std::uint16_t>{1, 2});
  file.raw_accessor(fmt::format(
      R"({{"componentType": 5123, "count": 3, "type": "SCALAR", "sparse": {{"count": 2,
 "indices": {{"bufferView": {}, "componentType": 5121}}, "values": {{"bufferView": {}}}}}}})",
      where, what));
  file.accessor<float>("SCALAR", {0, 1.5f}, 2);
  file.accessor<float>("SCALAR", {0, 0.25f, 1, 2, 0.75f, 0}, 6);
  return file;
}
constexpr const char* kMovingGltf =
    R"("scenes": [{"nodes": [0, 1, 3]}], "extensionsRequired": ["EXT_mesh_gpu_instancing"], "animations": [{"channels": [
{"sampler": 0, "target": {"node": 1, "path": "translation"}}, {"sampler": 1, "target": {"node": 3, "path": "weights"}},
{"sampler": 2, "target": {"node": 3, "path": "rotation"}}], "samplers": [{"input": 8, "output": 6},
{"input": 8, "output": 9, "interpolation": "CUBICSPLINE"}, {"input": 8, "output": 5, "interpolation": "STEP"}]}],
"nodes": [{"mesh": 0, "skin": 0}, {"children": [2], "translation": [0, 0, 7]}, {"translation": [0, 0, 3], "scale": [2, 2, 2]},
{"mesh": 1, "weights": [1], "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"ROTATION": 5, "SCALE": 6}},
"KHR_node_visibility": {"visible": true}}}],
"skins": [{"joints": [1, 2], "inverseBindMatrices": 3}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}, "indices": 7, "material": 0}]},
{"weights": [0.5], "primitives": [{"attributes": {"POSITION": 0, "NORMAL": 4}, "targets": [{"POSITION": 4}], "material": 1}]}],
"images": [{"uri": "t.tga"}], "textures": [{"extensions": {"EXT_texture_webp": {"source": 0}}}],
"materials": [{"extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [0.5, 0.25, 0, 0.5],
"specularGlossinessTexture": {"index": 0}}}}, {"extensions": {"KHR_materials_unlit": {}}}])";

TEST(MutatedGltf, Moving) {
  const TemporaryFolder folder;
  const std::vector<std::uint8_t> texels = {51, 102, 153, 0, 204, 255, 0, 128};
  write_text(folder / "t.tga", tga_file(2, 1, 4, texels));
  write_text(folder / "scene.gltf", moving_gltf().text(kMovingGltf));
  const auto whole = read_scene(folder / "scene.gltf", {.confine_to = folder.path()});
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_EQ(whole->shapes.size(), 1u);
  EXPECT_EQ(whole->instances.size(), 2u);
  expect_survival(folder.path(), "scene.gltf", "scene.gltf", 3002);
}

TEST(MutatedGltf, TextAndBinary) {
  const TemporaryFolder folder;
  const std::vector<std::uint8_t> texels = {51, 102, 153, 0, 204, 255, 0, 128};
  write_text(folder / "t.tga", tga_file(2, 1, 4, texels));
  write_text(folder / "scene.gltf", everything_of_gltf().text(kEverythingOfGltf));
  write_text(folder / "scene.glb", everything_of_gltf().binary(kEverythingOfGltf));
  for (const char* file : {"scene.gltf", "scene.glb"}) {
    const auto whole = read_scene(folder / file, {.confine_to = folder.path()});
    ASSERT_TRUE(whole) << whole.error().message;
    EXPECT_EQ(whole->shapes.size(), 2u);
    expect_survival(folder.path(), file, file, 3001);
  }
}

TEST(MutatedNori, EverythingOfIt) {
  const TemporaryFolder folder;
  write_text(folder / "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n");
  write_text(
      folder / "scene.xml",
      "<scene>\n<integrator type=\"path_mis\"/>\n<camera type=\"perspective\">\n<float name=\"fov\" "
      "value=\"30\"/>\n<transform name=\"toWorld\"><scale value=\"-1,1,1\"/>\n<lookat target=\"0,0,1\" "
      "origin=\"0,0,-5\" up=\"0,1,0\"/></transform>\n<integer name=\"width\" value=\"80\"/>\n<rfilter "
      "type=\"gaussian\"/>\n</camera>\n<sampler type=\"independent\"><integer name=\"sampleCount\" "
      "value=\"4\"/></sampler>\n<mesh type=\"obj\">\n<string name=\"filename\" value=\"m.obj\"/>\n<transform "
      "name=\"toWorld\"><rotate axis=\"0,1,0\" angle=\"30\"/></transform>\n<bsdf type=\"microfacet\"><color "
      "name=\"kd\" value=\".1,.2,.3\"/></bsdf>\n<emitter type=\"area\"><color name=\"radiance\" "
      "value=\"1,2,3\"/></emitter>\n</mesh>\n<emitter type=\"point\"><point name=\"position\" "
      "value=\"1,2,3\"/><color name=\"power\" value=\"1,1,1\"/></emitter>\n</scene>\n");
  expect_survival(folder.path(), "scene.xml", "scene.xml", 4001);
}

TEST(MutatedPbrt, EverythingOfIt) {
  const TemporaryFolder folder;
  const std::vector<std::uint8_t> texels = {51, 102, 153, 204};
  write_text(folder / "t.tga", tga_file(2, 2, 1, texels));
  write_text(folder / "m.pbrt", "Shape \"sphere\" \"float radius\" 2\n");
  write_text(folder / "m.ply", odd_square_ply(PlyEncoding::kAscii));
  write_text(folder / "scene.pbrt", R"(# all of it
LookAt 0 0 -5  0 0 0  0 1 0
Camera "perspective" "float fov" 40 "float screenwindow" [-1.5 1.5 -1 1]
Film "rgb" "integer xresolution" 60 "integer yresolution" 40 "float cropwindow" [0 1 0.25 1]
Sampler "halton" "integer pixelsamples" 4
Integrator "path" "integer maxdepth" 3
PixelFilter "mitchell" "float B" 0.3
WorldBegin
LightSource "point" "blackbody I" 3000 "point3 from" [1 2 3]
LightSource "infinite" "string filename" "t.tga" "float scale" 2
Texture "t" "spectrum" "imagemap" "string filename" "t.tga" "float uscale" 2
Texture "s" "spectrum" "scale" "texture tex" "t" "rgb scale" [0.5 0.5 1]
Texture "c" "spectrum" "checkerboard" "texture tex1" "s" "rgb tex2" [0 1 0]
MakeNamedMaterial "a" "string type" "diffuse" "texture reflectance" "c"
MakeNamedMaterial "b" "string type" "conductor" "spectrum eta" "metal-Au-eta" "float roughness" 0.1
AttributeBegin
  Material "mix" "string materials" ["a" "b"] "float amount" 0.25
  AreaLightSource "diffuse" "rgb L" [3 2 1] "bool twosided" true
  Rotate 30 0 1 0
  Shape "trianglemesh" "point3 P" [0 0 0 1 0 0 0 1 0] "integer indices" [0 1 2] "point2 uv" [0 0 1 0 0 1]
AttributeEnd
ObjectBegin "o"
  Material "coateddiffuse" "float roughness" 0.1 "float eta" 1.4
  Shape "plymesh" "string filename" "m.ply"
  Shape "disk" "float height" 1 "float alpha" 0.5
ObjectEnd
AttributeBegin
  ConcatTransform [2 0 0 0 0 2 0 0 0 0 2 0 1 1 1 1]
  ReverseOrientation
  ObjectInstance "o"
AttributeEnd
Material "dielectric" "float eta" 1.5
Include "m.pbrt"
ColorSpace "rec2020"
MakeNamedMedium "fog" "string type" "uniformgrid" "integer nx" 2 "float density" [1 2] "rgb sigma_s" [1 2 3]
MediumInterface "fog" ""
Material "subsurface" "string name" "Skin1" "texture roughness" "t"
Shape "cylinder" "float zmax" 2 "float phimax" 180
Shape "curve" "point3 P" [0 0 0 1 0 0 0 1 0] "float width1" 0.5 "integer degree" 2
Shape "loopsubdiv" "point3 P" [0 0 0 1 0 0 0 1 0 0 0 1] "integer indices" [0 1 2 0 3 1] "integer levels" 1
)");
  const auto whole = read_scene(folder / "scene.pbrt", {.confine_to = folder.path()});
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_EQ(whole->shapes.size(), 5u);
  EXPECT_EQ(whole->groups.size(), 1u);
  expect_survival(folder.path(), "scene.pbrt", "scene.pbrt", 5001);
}

}  // namespace
}  // namespace penumbra
