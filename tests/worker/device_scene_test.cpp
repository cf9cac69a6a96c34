// The serialised device scene: reading it back gives the scene that was sent, or an error. It never gives a
// scene for which a kernel would read outside of it.
#include "kernels/host/device_scene.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>
#include "kernels/intersect/bvh_limits.h"
#include "scenes/device/device_scene_builder.h"
#include "tests/support/every_texture.h"
#include "tests/support/render_scene.h"
#include "tests/worker/device_scenes.h"

namespace penumbra {
namespace {

class DeviceScenes : public testing::TestWithParam<NamedScene> {
 protected:
  DeviceScene scene_ = build_or_throw(GetParam().make());
};
INSTANTIATE_TEST_SUITE_P(All, DeviceScenes, testing::ValuesIn(device_scenes()),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(DeviceScenes, SurviveTheWire) {
  const std::vector<std::uint8_t> bytes = scene_.serialize();
  const auto back = DeviceScene::deserialize(bytes);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(std::memcmp(&back->header, &scene_.header, sizeof scene_.header), 0);
  EXPECT_EQ(back->words, scene_.words);
  EXPECT_EQ(back->serialize(), bytes);
}

TEST_P(DeviceScenes, PassTheirOwnCheck) {
  const auto checked = check_device_scene(scene_);
  EXPECT_TRUE(checked) << checked.error().message;
}

TEST_P(DeviceScenes, AreErrorsWhenTruncated) {
  const std::vector<std::uint8_t> bytes = scene_.serialize();
  const std::size_t step = std::max<std::size_t>(1, bytes.size() / 3000);
  for (std::size_t length = 0; length < bytes.size(); length += length < 600 ? 1 : step) {
    const auto part = DeviceScene::deserialize(std::span(bytes).first(length));
    ASSERT_FALSE(part) << length << " of " << bytes.size() << " bytes";
    EXPECT_EQ(part.error().message.rfind("device scene: ", 0), 0u);
  }
  std::vector<std::uint8_t> longer = bytes;
  longer.push_back(0);
  EXPECT_FALSE(DeviceScene::deserialize(longer));
}

/// Seeded bits for mutations.
class Bits {
 public:
  explicit Bits(std::uint64_t seed) : state_(seed) {}
  std::uint64_t below(std::uint64_t n) {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;  // Knuth, MMIX
    return (state_ >> 33) % n;
  }

 private:
  std::uint64_t state_;
};

/// Where the words begin in the serialised form, and where their number stands.
constexpr std::size_t kPreamble = 16, kWordCountAt = 12, kWordsAt = kPreamble + sizeof(SceneHeader);

/// Renders a few pixels of whatever was accepted. Under the address sanitizer a read outside fails here.
void render_accepted(const DeviceScene& scene) {
  // A path may rightly be asked to go on for as long as it likes.
  const IntegratorParameters& p = scene.header.integrator;
  const bool is_path = p.kind == INTEGRATOR_PATH || p.kind == INTEGRATOR_WHITTED;
  if (is_path && p.max_depth > 1000 && p.rr_depth > 1000) return;
  if (p.kind == INTEGRATOR_WHITTED && p.bsdf_samples > 4) return;  // or branch as often
  DeviceOptions options;
  options.isa = best_isa();
  const auto device = make_device(scene, options);
  if (!device) return;  // an Embree scene that Embree refuses
  for (int x : {1, 12, 20}) {
    const auto buffer = (*device)->render({x, 9, 1, 1, 0, 2});
    ASSERT_TRUE(buffer) << buffer.error().message;
  }
}

TEST_P(DeviceScenes, WithTablesCutOffAreErrorsOrCanBeRendered) {
  // The announced number of words fits what is there: only the offsets tell.
  const std::vector<std::uint8_t> bytes = scene_.serialize();
  int errors = 0, tries = 0;
  for (std::size_t words = 0; words < scene_.words.size();
       words += std::max<std::size_t>(1, scene_.words.size() / 400)) {
    std::vector<std::uint8_t> part(bytes.begin(), bytes.begin() + std::ptrdiff_t(kWordsAt + 4 * words));
    const auto count = std::uint32_t(words);
    std::memcpy(part.data() + kWordCountAt, &count, sizeof count);
    const auto scene = DeviceScene::deserialize(part);
    ++tries;
    if (scene)
      render_accepted(*scene);
    else
      ++errors;
  }
  EXPECT_GE(errors, tries * 9 / 10);  // what is left is padding and records that only wider kernels read
}

TEST_P(DeviceScenes, WithFlippedBitsAreErrorsOrCanBeRendered) {
  const std::vector<std::uint8_t> bytes = scene_.serialize();
  Bits bits(17);
  int accepted = 0, refused = 0;
  for (int k = 0; k < 3000; ++k) {
    std::vector<std::uint8_t> mutated = bytes;
    const std::uint64_t flips = 1 + bits.below(3);
    for (std::uint64_t i = 0; i < flips; ++i) {
      // Half of them in the header, the rest anywhere.
      const std::size_t at = bits.below(2) != 0 ? bits.below(kWordsAt) : bits.below(bytes.size());
      mutated[at] ^= std::uint8_t(1u << bits.below(8));
    }
    const auto scene = DeviceScene::deserialize(mutated);
    if (scene) {
      ++accepted;
      if (accepted % 8 == 0) render_accepted(*scene);
    } else {
      ++refused;
    }
  }
  EXPECT_GT(accepted, 100);
  EXPECT_GT(refused, 100);
}

TEST_P(DeviceScenes, WithWildIndicesAreErrorsOrCanBeRendered) {
  const std::vector<std::uint8_t> bytes = scene_.serialize();
  const std::uint32_t wild[] = {0,          1,          0x7fffffff,
                                0x80000000, 0xffffffff, 0x3f800000,
                                0x7f800000, 0x7fc00000, std::uint32_t(scene_.words.size())};
  Bits bits(18);
  int accepted = 0;
  for (std::size_t word = 0; word < sizeof(SceneHeader) / 4 + 600; ++word) {
    // Every word of the header, then words anywhere.
    const std::size_t headers = sizeof(SceneHeader) / 4;
    const std::size_t at =
        kPreamble + 4 * (word < headers ? word : headers + bits.below(scene_.words.size()));
    for (std::uint32_t value : wild) {
      if (word >= headers && bits.below(4) != 0) continue;
      std::vector<std::uint8_t> mutated = bytes;
      std::memcpy(mutated.data() + at, &value, sizeof value);
      const auto scene = DeviceScene::deserialize(mutated);
      if (!scene) continue;
      ++accepted;
      render_accepted(*scene);
    }
  }
  EXPECT_GT(accepted, 100);
}

void expect_refused(const DeviceScene& scene, const std::string& because) {
  const auto checked = check_device_scene(scene);
  ASSERT_FALSE(checked) << "not refused: " << because;
  EXPECT_NE(checked.error().message.find(because), std::string::npos) << checked.error().message;
}

TEST(DeviceSceneCheck, NamesWhatIsWrong) {
  const DeviceScene scene = build_or_throw(everything());
  const SceneHeader& h = scene.header;
  const auto with_header = [&](auto change) {
    DeviceScene changed = scene;
    change(changed.header);
    return changed;
  };
  expect_refused(with_header([](SceneHeader& c) { c.families |= 0x80000000; }), "unknown families of BSDFs");
  expect_refused(with_header([](SceneHeader& c) { c.light_kinds |= 0x80000000; }), "unknown kinds of lights");
  expect_refused(with_header([](SceneHeader& c) { c.intersector = 7; }), "unknown intersector");
  expect_refused(with_header([](SceneHeader& c) { c.sampler.kind = -1; }), "unknown sampler");
  expect_refused(with_header([](SceneHeader& c) { c.film.filter = 3; }), "unknown filter");
  expect_refused(with_header([](SceneHeader& c) { c.integrator.kind = INTEGRATOR_OCCLUSION + 1; }),
                 "unknown integrator");
  expect_refused(with_header([](SceneHeader& c) { c.integrator.kind = INTEGRATOR_PATH; }),
                 "an integrator without its feature bit");
  expect_refused(with_header([](SceneHeader& c) { c.sampler.kind = SAMPLER_HALTON; }),
                 "a sampler without its feature bit");
  expect_refused(with_header([](SceneHeader& c) { c.film.width = 0; }), "empty film");
  expect_refused(with_header([](SceneHeader& c) { c.sampler.spp = 0; }), "no samples per pixel");
  expect_refused(with_header([](SceneHeader& c) { c.integrator.bsdf_samples = -1; }),
                 "number of emitter or BSDF samples");
  expect_refused(with_header([](SceneHeader& c) { c.integrator.emitter_samples = 1 << 30; }),
                 "number of emitter or BSDF samples");
  expect_refused(with_header([](SceneHeader& c) { c.environment = c.tables.lights.count; }),
                 "the environment names no light");
  expect_refused(with_header([](SceneHeader& c) { --c.tables.corners.count; }), "corners do not match");
  expect_refused(with_header([](SceneHeader& c) { c.features &= ~std::uint64_t(FEATURE_QUADRICS); }),
                 "quadrics without their feature bit");
  expect_refused(with_record<Triangle>(scene, h.tables.triangles, 3, [](Triangle& t) { t.back = 1000; }),
                 "a triangle names a material");
  expect_refused(with_record<Triangle>(scene, h.tables.triangles, 3, [](Triangle& t) { t.light = 1000; }),
                 "a triangle names a light");
  expect_refused(with_record<Triangle>(scene, h.tables.triangles, 3, [](Triangle& t) { t.normals = -2; }),
                 "a triangle names normals");
  expect_refused(with_record<Quadric>(scene, h.tables.quadrics, 0, [](Quadric& q) { q.front = -1; }),
                 "a quadric names a material");
  expect_refused(with_record<Quadric>(scene, h.tables.quadrics, 0, [](Quadric& q) { q.kind = 2; }),
                 "a quadric of unknown kind");
  expect_refused(with_record<Light>(scene, h.tables.lights, 0, [](Light& l) { l.start = -1; }),
                 "a light begins at no number");
  expect_refused(with_record<Light>(scene, h.tables.lights, 0, [](Light& l) { l.kind = LIGHT_KIND_COUNT; }),
                 "a light of unknown kind");
  for (const int family : {FAMILY_DIFFUSE, FAMILY_PHONG})
    expect_refused(with_header([&](SceneHeader& c) { c.families &= ~(std::uint64_t{1} << family); }),
                   "a material of a family of BSDFs that the header does not name");
  for (const int family : {-1, FAMILY_PHONG + 1, 31, 32, 63, 64, INT_MAX})
    expect_refused(
        with_record<Material>(scene, h.tables.materials, 1, [&](Material& m) { m.family = family; }),
        "a material of a family of BSDFs that the header does not name");
  SceneDescription under_map = everything();
  under_map.emitters.clear();
  EnvironmentMapLight map;
  map.image = std::make_shared<const Bitmap>(
      Bitmap{"map", 3, 2, 1, TexelType::kFloat, std::vector<std::uint32_t>(6, FLOAT_BITS(1.0f))});
  under_map.emitters.emplace_back(map);
  const DeviceScene mapped = build_device_scene(under_map, {}).value();
  EXPECT_TRUE(check_device_scene(mapped));
  for (TableSpan TableSpans::*span : {&TableSpans::envmap_texels, &TableSpans::envmap_rows,
                                      &TableSpans::envmap_columns, &TableSpans::envmaps}) {
    DeviceScene changed = mapped;
    --(changed.header.tables.*span).count;
    expect_refused(changed, "an environment map");
  }
  for (const int side : {1, 4, 1 << 16})
    expect_refused(with_record<EnvironmentMap>(mapped, mapped.header.tables.envmaps, 0,
                                               [&](EnvironmentMap& e) { e.width = side; }),
                   "an environment map's tables");
  DeviceSceneOptions with_uv;
  with_uv.surface_uv = true;
  const DeviceScene uvs = build_device_scene(everything(), with_uv).value();
  const auto with_uvs = [&](auto change) {
    DeviceScene changed = uvs;
    change(changed.header);
    return changed;
  };
  expect_refused(with_uvs([](SceneHeader& c) { c.features &= ~std::uint64_t(FEATURE_UV); }),
                 "texture coordinates without their feature bit");
  expect_refused(with_uvs([](SceneHeader& c) { --c.tables.vertex_uvs.count; }),
                 "texture coordinates do not match the triangles");
  expect_refused(with_uvs([](SceneHeader& c) { --c.tables.light_triangles.count; }),
                 "triangles of lights do not match the lights");
  for (const int triangle : {-2, uvs.header.tables.triangles.count})
    expect_refused(with_record<LightTriangles>(uvs, uvs.header.tables.light_triangles, 0,
                                               [&](LightTriangles& l) { l.second = triangle; }),
                   "a light names a triangle");
  expect_refused(with_record<Corner>(scene, h.tables.corners, 0, [](Corner& c) { c.v2 = 128; }),
                 "a corner names a vertex");
}

TEST(DeviceSceneCheck, NamesWhatIsWrongWithTextures) {
  SceneDescription description = everything();
  add_every_texture(description);
  const DeviceScene scene = build_or_throw(description);
  const SceneHeader& h = scene.header;
  const auto with_texture = [&](int index, auto change) {
    return with_record<TextureNode>(scene, h.tables.textures, index, change);
  };
  // As add_every_texture has them: bitmaps of 8 bit, 16 bit, halves and floats first, checkerboard, noise,
  // colours, scaled ones.
  constexpr int kColours = 12, kScaled = 13;
  expect_refused(with_texture(0, [](TextureNode& t) { t.kind = TEXTURE_KIND_COUNT; }), "a texture of a kind");
  expect_refused(with_texture(0, [](TextureNode& t) { t.kind = -1; }), "a texture of a kind");
  for (const int width : {0, -1, 1 << 20})
    for (const int index : {0, 1, 2, 3})
      expect_refused(with_texture(index, [&](TextureNode& t) { t.width = width; }), "a bitmap");
  expect_refused(with_texture(0, [](TextureNode& t) { t.channels = 2; }), "a bitmap of implausible");
  expect_refused(with_texture(0, [](TextureNode& t) { t.wrap_v = 5; }), "a bitmap of implausible");
  expect_refused(with_texture(0, [](TextureNode& t) { t.texels = -1; }), "a bitmap's texels are not there");
  expect_refused(with_texture(3, [&](TextureNode& t) { t.texels = h.tables.texels.count - 9 * 13 * 3; }),
                 "a bitmap's texels are not there");
  expect_refused(with_texture(0, [](TextureNode& t) { t.decoding = -1; }), "a bitmap's table of values");
  expect_refused(with_texture(1, [&](TextureNode& t) { t.decoding = h.tables.texels.count - 65535; }),
                 "a bitmap's table of values");
  expect_refused(with_texture(kScaled, [](TextureNode& t) { t.texture0 = kScaled; }),
                 "a texture holds one that does not come before it");
  expect_refused(with_texture(kColours, [](TextureNode& t) { t.attribute = 99; }),
                 "an implausible attribute");
  expect_refused(with_texture(kColours, [](TextureNode& t) { t.attribute = 1; }),
                 "a triangle has colours that are not there");
  expect_refused(with_record<int>(scene, h.tables.triangle_colours, 0, [](int& first) { first = -2; }),
                 "a triangle has colours that are not there");
  DeviceScene fewer = scene;
  --fewer.header.tables.triangle_colours.count;
  expect_refused(fewer, "colours do not match the triangles");
}

TEST(DeviceSceneCheck, FollowsTreesOfMaterials) {
  const DeviceScene scene = build_or_throw(instances());  // with an opacity mask
  const TableSpan span = scene.header.tables.materials;
  const auto materials = table<Material>(scene, span);
  const auto branch = std::size_t(
      std::ranges::find_if(materials, [](const Material& m) { return m.branches != 0; }) - materials.begin());
  ASSERT_LT(branch, materials.size());
  const auto with_material = [&](std::size_t index, auto change) {
    return with_record<Material>(scene, span, index, change);
  };
  EXPECT_TRUE(check_device_scene(scene));
  for (const int child : {int(branch), span.count, INT_MAX}) {
    expect_refused(with_material(branch, [&](Material& m) { m.first = child; }), "does not come before it");
    expect_refused(with_material(branch, [&](Material& m) { m.second = child; }), "does not come before it");
  }
  expect_refused(with_material(0, [](Material& m) { m.branches = 1; }),
                 "the first material, where walks end, holds others");
  for (const int branches : {-1, 2})
    expect_refused(with_material(branch, [&](Material& m) { m.branches = branches; }),
                   "a material of unknown kind");
  for (const float weight : {-0.1f, 1.1f, std::nanf("")})
    expect_refused(with_material(branch, [&](Material& m) { m.weight = weight; }),
                   "a material's weight is not in [0, 1]");
}

TEST(DeviceSceneCheck, FollowsTheHierarchyOfLights) {
  const DeviceScene scene = build_or_throw(lights_in_a_hierarchy());
  const SceneHeader& h = scene.header;
  ASSERT_EQ(h.light_cut, LIGHT_CUT);
  ASSERT_GE(h.light_tree_depth, 1);
  EXPECT_TRUE(check_device_scene(scene));
  const auto with_header = [&](auto change) {
    DeviceScene changed = scene;
    change(changed.header);
    return changed;
  };
  const auto with_node = [&](int index, auto change) {
    return with_record<LightNode>(scene, h.tables.light_nodes, std::size_t(index), change);
  };
  const auto with_child = [&](int index, int child) {
    return with_node(index, [&](LightNode& n) { n.child = child; });
  };
  expect_refused(with_header([](SceneHeader& c) { c.integrator.light_choice = CHOICE_POWER; }),
                 "the choice of lights by their hierarchy and its feature bit go together");
  expect_refused(with_header([](SceneHeader& c) { c.features &= ~std::uint64_t(FEATURE_LIGHT_TREE); }),
                 "the choice of lights by their hierarchy and its feature bit go together");
  expect_refused(with_header([](SceneHeader& c) { c.tables.light_nodes.count = 0; }), "without a root");
  for (const int cut : {0, -1, LIGHT_CUT + 1, h.tables.light_nodes.count + 1})
    expect_refused(with_header([&](SceneHeader& c) { c.light_cut = cut; }), "without a root");
  expect_refused(with_header([](SceneHeader& c) { --c.tables.light_nodes.count; }),
                 "a node of lights names a child that is not there");
  expect_refused(with_header([](SceneHeader& c) { --c.tables.light_trails.count; }),
                 "ways to lights do not match the lights");
  expect_refused(with_header([](SceneHeader& c) { --c.light_tree_depth; }),
                 "a node of lights is deeper than its hierarchy");
  for (const int depth : {-1, 29, INT_MAX})
    expect_refused(with_header([&](SceneHeader& c) { c.light_tree_depth = depth; }),
                   "the hierarchy of lights is too deep");
  const auto nodes = table<LightNode>(scene, h.tables.light_nodes);
  const int inner =
      int(std::ranges::find_if(nodes, [](const LightNode& n) { return n.child > 0; }) - nodes.begin());
  for (const int child : {0, h.tables.light_nodes.count - 1, h.tables.light_nodes.count, INT_MAX})
    expect_refused(with_child(inner, child), "a node of lights names a child that is not there");
  for (const int light : {h.tables.lights.count, INT_MAX})
    expect_refused(with_child(h.tables.light_nodes.count - 1, ~light), "a node names a light");
  expect_refused(with_child(inner, ~0), "a node of lights has no parent");
  expect_refused(with_child(inner == 0 ? 1 : 0, LIGHT_CUT), "a node of lights has two parents");
  for (const float intensity : {-1.0f, std::numeric_limits<float>::infinity(), std::nanf("")})
    expect_refused(with_node(1, [&](LightNode& n) { n.intensity = intensity; }),
                   "a node of lights without an intensity");
  expect_refused(with_node(1, [](LightNode& n) { n.flags = 4; }), "a node of lights of unknown kind");
}

// A light of many lights, which are as one, and another one.
TEST(DeviceSceneCheck, FollowsLeavesOfLights) {
  SceneDescription area_lights = lights_in_a_hierarchy();
  area_lights.emitters.clear();
  for (int k = 0; k < 20; ++k)
    area_lights.emitters.emplace_back(
        PointLight{glm::dvec3(1e-6 * k, 0.2, 0), glm::vec3(0.01f * float(k + 1))});
  area_lights.emitters.emplace_back(PointLight{glm::dvec3(0.3, -0.4, 0.2), glm::vec3(0.1f)});
  const DeviceScene scene = build_or_throw(area_lights);
  const SceneHeader& h = scene.header;
  EXPECT_TRUE(check_device_scene(scene));
  ASSERT_GE(h.light_leaf_steps, 1);
  const auto nodes = table<LightNode>(scene, h.tables.light_nodes);
  const auto leaf = std::size_t(std::ranges::find_if(nodes, [](const LightNode& n) { return n.lights > 1; }) -
                                nodes.begin());
  const auto first = std::size_t(~nodes[leaf].child);
  const auto with_header = [&](auto change) {
    DeviceScene changed = scene;
    change(changed.header);
    return changed;
  };
  const auto with_leaf = [&](auto change) {
    return with_record<LightNode>(scene, h.tables.light_nodes, leaf, change);
  };
  const auto with_member = [&](std::size_t k, auto change) {
    return with_record<LightMember>(scene, h.tables.light_members, first + k, change);
  };
  for (const int turns : {-1, 0, 21})
    expect_refused(with_header([&](SceneHeader& c) { c.light_leaf_steps = turns; }), "no search finds");
  expect_refused(with_header([](SceneHeader& c) { --c.light_leaf_steps; }), "search finds");
  expect_refused(with_header([](SceneHeader& c) { --c.tables.light_numbers.count; }),
                 "shares of lights do not match the lights");
  expect_refused(with_header([](SceneHeader& c) { --c.tables.light_members.count; }),
                 "a leaf of lights names lights that are not there");
  expect_refused(with_leaf([](LightNode& n) { n.lights = INT_MAX; }),
                 "a leaf of lights names lights that are not there");
  for (const int light : {-1, h.tables.lights.count, INT_MAX})
    expect_refused(with_member(1, [&](LightMember& m) { m.light = light; }),
                   "a node names a light that is not there");
  for (const int start : {-1, 0, INT_MAX})
    expect_refused(with_member(1, [&](LightMember& m) { m.start = start; }),
                   "shares of lights in a leaf are not those of all numbers");
  expect_refused(with_member(0, [&](LightMember& m) { m.start = 1; }),
                 "shares of lights in a leaf are not those of all numbers");
}

TEST(DeviceSceneCheck, NamesWhatIsWrongWithLights) {
  const DeviceScene scene = build_or_throw(emitters());
  const SceneHeader& h = scene.header;
  const auto lights = table<Light>(scene, h.tables.lights);
  const auto with_light = [&](auto is_wanted, auto change) {
    const auto found = std::find_if(lights.begin(), lights.end(), is_wanted);
    EXPECT_NE(found, lights.end());
    return with_record<Light>(scene, h.tables.lights, std::size_t(found - lights.begin()), change);
  };
  const auto with_grid = [](const Light& l) { return l.grid >= 0; };
  for (const int kind : {LIGHT_SPOT, LIGHT_PROJECTOR})
    for (const int beam : {-1, h.tables.beams.count})
      expect_refused(
          with_light([&](const Light& l) { return l.kind == kind; }, [&](Light& l) { l.beam = beam; }),
          "a light's beam is not there");
  for (const int texture : {-2, h.tables.textures.count})
    expect_refused(with_light(with_grid, [&](Light& l) { l.texture = texture; }), "a light names a texture");
  for (const int grid : {-2, h.tables.light_grids.count, INT_MAX})
    expect_refused(with_light(with_grid, [&](Light& l) { l.grid = grid; }),
                   "a light's distribution is not there");
  for (const int side : {-1, 0, MOST_LIGHT_GRID_SIDE + 1, INT_MAX})
    expect_refused(with_light(with_grid, [&](Light& l) { l.grid_side = side; }),
                   "a light's distribution is not there");
  expect_refused(with_light(with_grid, [](Light& l) { l.sampling = EMITTER_SOLID_ANGLE; }),
                 "a light that is not sampled by area");
  DeviceScene fewer = scene;
  --fewer.header.tables.light_grids.count;
  expect_refused(fewer, "a light's distribution is not there");
  for (const std::uint64_t feature : {FEATURE_LIGHT_TEXTURES, FEATURE_TEXTURES}) {
    DeviceScene without = scene;
    without.header.features &= ~feature;
    expect_refused(without, "feature bit");
  }
}

TEST(DeviceSceneCheck, NamesWhatIsWrongWithMediaThatAreLights) {
  const DeviceScene scene = build_or_throw(flames());
  const SceneHeader& h = scene.header;
  ASSERT_EQ(h.tables.glows.count, 2);
  const auto lights = table<Light>(scene, h.tables.lights);
  const auto at = std::size_t(std::ranges::find(lights, int(LIGHT_MEDIUM), &Light::kind) - lights.begin());
  const auto with_glow = [&](auto change) { return with_record<Glow>(scene, h.tables.glows, 1, change); };
  const auto with_block = [&](std::size_t k, auto change) {
    return with_record<GlowBlock>(scene, h.tables.glow_blocks, k, change);
  };
  for (const int glow : {-1, 2, INT_MAX})
    expect_refused(with_record<Light>(scene, h.tables.lights, at, [&](Light& l) { l.beam = glow; }),
                   "a medium names a light that is not its own");
  expect_refused(with_record<Light>(scene, h.tables.lights, at, [](Light& l) { l.area = 0; }),
                 "the medium of a light is not there");
  for (const int light : {-2, h.tables.lights.count})
    expect_refused(with_record<Medium>(scene, h.tables.media, 1, [&](Medium& m) { m.light = light; }),
                   "a medium names a light that is not there");
  for (std::size_t k = 0; k < lights.size(); ++k)
    if (lights[k].kind != LIGHT_MEDIUM)
      expect_refused(with_record<Medium>(scene, h.tables.media, 1, [&](Medium& m) { m.light = int(k); }),
                     "a medium names a light that is not its own");
  for (const int medium : {-1, h.tables.media.count})
    expect_refused(with_glow([&](Glow& g) { g.medium = medium; }), "a light names a medium");
  for (const int medium : {0, 1}) expect_refused(with_glow([&](Glow& g) { g.medium = medium; }), "medium");
  for (const int volume : {-1, h.tables.volumes.count})
    expect_refused(with_glow([&](Glow& g) { g.volume = volume; }), "a light names a volume");
  expect_refused(with_glow([](Glow& g) { g.by_area = std::numeric_limits<float>::infinity(); }),
                 "a light of a medium has cells of implausible size");
  for (const int side : {-1, 0, INT_MAX})
    expect_refused(with_glow([&](Glow& g) { g.side = side; }), "blocks that are not there");
  for (const int first : {-1, 1, h.tables.glow_blocks.count, INT_MAX})
    expect_refused(with_glow([&](Glow& g) { g.first_block = first; }), "a light");
  for (const int blocks : {-1, 0, h.tables.glow_blocks.count, INT_MAX})
    expect_refused(with_glow([&](Glow& g) { g.blocks = blocks; }), "blocks that are not there");
  for (const int x : {-1, 3, INT_MAX})
    expect_refused(with_block(0, [&](GlowBlock& b) { b.x = x; }), "outside of its volume");
  for (const float below : {-1.0f, 1.0f, std::numeric_limits<float>::quiet_NaN()})
    expect_refused(with_block(1, [&](GlowBlock& b) { b.below = below; }), "not in order");
  expect_refused(with_block(0, [](GlowBlock& b) { b.below = 0.001f; }), "do not begin at 0");
  DeviceScene without = scene;
  without.header.features &= ~std::uint64_t{FEATURE_EMITTING_MEDIA};
  expect_refused(without, "a medium of implausible emission");
}

TEST(DeviceSceneCheck, EveryTableLiesInsideTheData) {
  for (const NamedScene& named : device_scenes()) {
    const DeviceScene scene = build_or_throw(named.make());
    const auto words = std::uint32_t(scene.words.size());
    for (const SceneTable& each : kSceneTables) {
      const TableSpan span = scene.header.tables.*each.span;
      const auto check = [&](TableSpan wrong) {
        DeviceScene changed = scene;
        changed.header.tables.*each.span = wrong;
        return check_device_scene(changed);
      };
      const auto expect_outside = [&](TableSpan wrong) {
        const auto checked = check(wrong);
        ASSERT_FALSE(checked) << named.name << ": " << each.what;
        EXPECT_NE(checked.error().message.find(fmt::format("'{}' lies outside", each.what)),
                  std::string::npos)
            << checked.error().message;
      };
      const auto record = std::uint32_t(each.record_bytes / 4);
      const std::uint32_t needed = std::uint32_t(std::max(span.count, each.least)) * record;
      EXPECT_TRUE(check(span)) << named.name << ": " << each.what;
      for (const std::uint32_t offset : {words - needed + 1, words + 1, 0x7fffffffu, 0xffffffffu})
        expect_outside({span.count, offset});
      const int too_many = int((words - span.offset) / record) + 1;
      for (const int count : {-1, INT_MIN, too_many, INT_MAX}) expect_outside({count, span.offset});
    }
  }
}

TEST(DeviceSceneCheck, FollowsTheHierarchy) {
  const DeviceScene scene = build_or_throw(everything_in_a_hierarchy());
  const SceneHeader& h = scene.header;
  ASSERT_GT(h.tables.nodes.count, 2);
  const auto with_child = [&](std::size_t node, std::size_t slot, int child) {
    return with_record<BvhNode>(scene, h.tables.nodes, node, [&](BvhNode& n) { n.child[slot] = child; });
  };
  expect_refused(with_child(1, 0, 0), "names a child that is not there");  // a cycle
  expect_refused(with_child(1, 0, 1), "names a child that is not there");
  expect_refused(with_child(0, 0, h.tables.nodes.count), "names a child that is not there");
  for (const int leaf : {h.tables.triangle_leaves.count, FIRST_QUADRIC_LEAF + h.tables.quadric_leaves.count,
                         FIRST_INSTANCE_LEAF + h.tables.instances.count, INT_MAX})
    expect_refused(with_child(0, 7, ~leaf), "names a leaf that is not there");
  expect_refused(with_child(0, 7, 1), "has two parents");
  expect_refused(with_child(0, 0, ~0), "has no parent");
  expect_refused(
      with_record<TriangleLeaf>(scene, h.tables.triangle_leaves, 0,
                                [&](TriangleLeaf& l) { l.primitive[0] = h.tables.triangles.count; }),
      "names a triangle that is not there");
  expect_refused(with_record<QuadricLeaf>(scene, h.tables.quadric_leaves, 0,
                                          [&](QuadricLeaf& l) { l.primitive[0] = 0; }),
                 "names a quadric that is not there");
  DeviceScene rootless = scene;
  rootless.header.tables.nodes.count = 0;
  expect_refused(rootless, "a hierarchy without a root");
}

TEST(DeviceSceneCheck, RefusesOtherVersions) {
  std::vector<std::uint8_t> bytes = build_or_throw(diffuse_box()).serialize();
  std::vector<std::uint8_t> other = bytes;
  other[0] ^= 1;
  EXPECT_NE(DeviceScene::deserialize(other).error().message.find("magic"), std::string::npos);
  other = bytes;
  other[4] ^= 1;
  EXPECT_NE(DeviceScene::deserialize(other).error().message.find("version"), std::string::npos);
  other = bytes;
  other[8] ^= 4;
  EXPECT_NE(DeviceScene::deserialize(other).error().message.find("version"), std::string::npos);
}

TEST(DeviceSceneCheck, CamerasThatAreNotNumbersRenderSomething) {
  // Rays without a direction hit nothing in particular; they must end.
  for (const NamedScene& named : device_scenes()) {
    DeviceScene scene = build_or_throw(named.make());
    for (float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 0.0f}) {
      scene.header.camera.z = make_vec3(bad, bad, bad);
      render_accepted(scene);
      scene.header.camera.origin = make_vec3(bad, 0, 0);
      render_accepted(scene);
    }
  }
}

TEST(DeviceSceneCheck, CurvesThatAreNoneAreRefused) {
  const DeviceScene scene = build_or_throw(curves());
  const TableSpan quadrics = scene.header.tables.quadrics;
  ASSERT_GT(quadrics.count, 0);
  const auto with = [&](auto change) { return with_record<Quadric>(scene, quadrics, 0, change); };
  EXPECT_TRUE(check_device_scene(scene));
  DeviceScene without = scene;
  without.header.features &= ~std::uint64_t(FEATURE_CURVES);
  expect_refused(without, "a quadric of unknown kind");
  expect_refused(with([](Quadric& q) { q.kind = QUADRIC_CYLINDRICAL_RIBBON + 1; }),
                 "a quadric of unknown kind");
  expect_refused(with([](Quadric& q) { q.light = 0; }), "a curve that is a light");
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    expect_refused(with([&](Quadric& q) { q.center.x = bad; }), "whose ends are no points");
    expect_refused(with([&](Quadric& q) { q.x_axis.y = bad; }), "whose ends are no points");
    expect_refused(with([&](Quadric& q) { q.radius = bad; }), "whose radii are no lengths");
    expect_refused(with([&](Quadric& q) { q.normal.z = bad; }), "whose cuts are no planes");
    expect_refused(with([&](Quadric& q) { q.y_axis.z = bad; }), "whose cuts are no planes");
    expect_refused(with([&](Quadric& q) { q.orientation = bad; }), "whose cuts are no planes");
  }
  expect_refused(with([](Quadric& q) { q.x_axis = q.center; }), "whose ends are no points");
  expect_refused(with([](Quadric& q) { q.length = -1; }), "whose radii are no lengths");
  expect_refused(with([](Quadric& q) { q.y_axis = {0, 0, 0}; }), "whose cuts are no planes");
}

}  // namespace
}  // namespace penumbra
