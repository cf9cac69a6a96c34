// The features, BSDF families and kinds of lights that a device scene declares are just those that it needs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <string>
#include <vector>

#include "tests/acceptance/scene_pieces.h"
#include "tests/support/integrator_parameters.h"
#include "tests/worker/built_scenes.h"
#include "tests/worker/device_scenes.h"
#include "worker/search_choice.h"

namespace penumbra {
namespace {

using glm::dvec3;

/// With points on lights by area: what is best for a scene is emitter_sampling_test's.
SceneDescription by_area(SceneDescription scene) {
  param::emitter_sampling(scene.integrator) = EmitterSampling::kArea;
  return scene;
}

TEST(LightKinds, AreThoseOfTheLights) {
  const auto with = [](auto change) {
    SceneDescription scene = by_area(diffuse_box());
    change(scene);
    return build(scene).header.light_kinds;
  };
  // The box has a light of two triangles: one rectangle, but two triangles by projected solid angle.
  constexpr std::uint32_t kAreaLight = 1u << LIGHT_RECTANGLE, kPoints = 1u << LIGHT_POINT;
  EXPECT_EQ(with([](auto&) {}), kAreaLight);
  EXPECT_EQ(with([](auto& s) { param::emitter_sampling(s.integrator) = EmitterSampling::kProjected; }),
            1u << LIGHT_TRIANGLE);
  EXPECT_EQ(build(environment_alone()).header.light_kinds, 1u << LIGHT_ENVIRONMENT);
  EXPECT_EQ(with([](auto& s) { s.emitters.emplace_back(PointLight{}); }), kAreaLight | kPoints);
  // What is black is none.
  EXPECT_EQ(with([](auto& s) { s.emitters.emplace_back(PointLight{dvec3(0), glm::vec3(0)}); }), kAreaLight);
  EXPECT_EQ(with([](auto& s) { s.emitters.emplace_back(ConstantEnvironment{glm::vec3(0)}); }), kAreaLight);
}

TEST(Features, AreJustTheNeeded) {
  // The ceiling of the box is of two triangles, which are as one; the camera sees its edges.
  const std::uint64_t box = FEATURE_PATH | FEATURE_LAYERS | FEATURE_LIGHT_EDGES;
  EXPECT_EQ(build(by_area(diffuse_box())).header.features, box);
  EXPECT_EQ(build(by_area(diffuse_box()), false).header.features, box & ~std::uint64_t(FEATURE_LAYERS));
  EXPECT_EQ(build(by_area(many_triangles())).header.features, box | FEATURE_BVH);
  EXPECT_EQ(build(by_area(many_triangles()), true, IntersectorChoice::kEmbree).header.features, box);
  EXPECT_EQ(build(environment_alone()).header.features, std::uint64_t(FEATURE_PATH | FEATURE_LAYERS));
  EXPECT_EQ(
      build(everything()).header.features,
      std::uint64_t(FEATURE_DIRECT | FEATURE_LAYERS | FEATURE_SHADING_NORMALS | FEATURE_QUADRICS |
                    FEATURE_SOLID_ANGLE | FEATURE_MIXED_FAMILIES | FEATURE_LIGHT_TREE | FEATURE_LIGHT_EDGES));

  const auto with = [](auto change) {
    SceneDescription scene = by_area(diffuse_box());
    change(scene);
    return build(scene).header.features;
  };
  EXPECT_EQ(with([](auto& s) { use(s.integrator, IntegratorKind::kDirect); }),
            std::uint64_t(FEATURE_DIRECT | FEATURE_LAYERS | FEATURE_LIGHT_EDGES));
  EXPECT_EQ(with([](auto& s) { s.film.closed_light_edges = false; }),
            std::uint64_t(FEATURE_PATH | FEATURE_LAYERS));
  EXPECT_EQ(with([](auto& s) { s.sampler.kind = SamplerKind::kIndependent; }), box | FEATURE_SAMPLERS);
  EXPECT_EQ(with([](auto& s) { param::emitter_sampling(s.integrator) = EmitterSampling::kSolidAngle; }),
            box | FEATURE_SOLID_ANGLE);
  EXPECT_EQ(with([](auto& s) { param::emitter_sampling(s.integrator) = EmitterSampling::kProjected; }),
            box | FEATURE_PROJECTED);
  EXPECT_EQ(with([](auto& s) { s.emitters.emplace_back(PointLight{}); }), box | FEATURE_LIGHT_TREE);
  EXPECT_EQ(with([](auto& s) {
              s.bsdfs[0].model = PhongBsdf{glm::vec3(0.5f), glm::vec3(0.1f), 30};
            }),
            box | FEATURE_MIXED_FAMILIES);
  // What is black or unused needs nothing.
  EXPECT_EQ(with([](auto& s) { s.emitters.emplace_back(PointLight{dvec3(0), glm::vec3(0)}); }), box);
  EXPECT_EQ(with([](auto& s) { s.bsdfs[0].model = PhongBsdf{glm::vec3(0.5f), glm::vec3(0), 30}; }), box);
  EXPECT_EQ(with([](auto& s) { s.emitters.emplace_back(ConstantEnvironment{glm::vec3(0)}); }), box);
}

TEST(Families, AreThoseOfTheMaterials) {
  const auto families = [](const BsdfModel& model) {
    SceneDescription scene = diffuse_box();
    for (Bsdf& bsdf : scene.bsdfs) bsdf.model = model;
    return build(scene).header.families;
  };
  EXPECT_EQ(families(DiffuseBsdf{}), ONLY(DIFFUSE));
  EXPECT_EQ(families(PhongBsdf{glm::vec3(0.5f), glm::vec3(0), 30}), ONLY(DIFFUSE));
  EXPECT_EQ(families(PhongBsdf{glm::vec3(0.5f), glm::vec3(0.1f), 30}), ONLY(PHONG));
  EXPECT_EQ(build(everything()).header.families, ONLY(DIFFUSE) | ONLY(PHONG));
}

TEST(Features, AllAreThoseOfTheList) {
  std::uint64_t listed = 0;
#define CHECK_FEATURE(name, description)                           \
  EXPECT_TRUE(std::has_single_bit(std::uint64_t(FEATURE_##name))); \
  EXPECT_EQ(listed& FEATURE_##name, 0u) << #name;                  \
  listed |= FEATURE_##name;
  PENUMBRA_FEATURES(CHECK_FEATURE)
#undef CHECK_FEATURE
  EXPECT_EQ(listed, std::uint64_t(FEATURE_ALL));
  EXPECT_LT(FEATURE_COUNT, 64) << "the highest bit is that of ALL_OF";
}

TEST(Families, HaveTheNumbersOfTheList) {
#define CHECK_FAMILY(name, NAME, number, properties, description) EXPECT_EQ(number, FAMILY_##NAME);
  BSDF_FAMILIES(CHECK_FAMILY)
#undef CHECK_FAMILY
}

TEST(Features, SizesChooseTheSearch) {
  const auto automatic = [](const SceneDescription& scene) {
    return build(scene, true, IntersectorChoice::kAuto).header;
  };
  EXPECT_EQ(automatic(diffuse_box()).intersector, INTERSECTOR_PORTABLE);
  EXPECT_EQ(automatic(many_triangles()).intersector, INTERSECTOR_PORTABLE);
  EXPECT_EQ(intersector_for(4'000'000), INTERSECTOR_PORTABLE);
  EXPECT_EQ(intersector_for(4'000'001), INTERSECTOR_EMBREE);
  const SceneHeader small = build(diffuse_box()).header, large = build(many_triangles()).header;
  EXPECT_GT(small.tables.corners.count, 0);
  EXPECT_EQ(small.tables.nodes.count, 0);
  EXPECT_EQ(large.tables.corners.count, 0);
  EXPECT_EQ(large.tables.vertices.count, 0);
  EXPECT_GT(large.tables.nodes.count, 0);
  const SceneHeader either = build(some_triangles()).header;
  EXPECT_EQ(either.tables.corners.count, either.tables.triangles.count);
  EXPECT_GT(either.tables.nodes.count, 0);
  EXPECT_NE(either.features & FEATURE_BVH, 0u);
  const SceneHeader embree = build(many_triangles(), true, IntersectorChoice::kEmbree).header;
  EXPECT_EQ(embree.tables.nodes.count + embree.tables.corners.count, 0);
}

TEST(Features, RoomsAreTestedWholeUpToMoreTrianglesThanPlains) {
  const auto whole = [&](const SceneDescription& scene) {
    const DeviceScene built = build(scene);
    EXPECT_GT(built.header.tables.corners.count, 0);
    EXPECT_GT(built.header.tables.nodes.count, 0);
    std::vector<bool> by_set;
    for (const Isa isa : kIsas) by_set.push_back(tests_every_primitive(isa, built));
    return by_set;
  };
  // 72 triangles on the floor of a room; and on a plain, where few rays come near.
  const SceneDescription room = some_triangles();
  EXPECT_THAT(whole(room), testing::ElementsAre(false, true, true));
  SceneDescription plain = room;
  plain.shapes = {parallelogram(dvec3(-20, -1, 20), dvec3(40, 0, 0), dvec3(0, 0, -40), 0), room.shapes.at(5),
                  room.shapes.at(6)};
  EXPECT_THAT(whole(plain), testing::Each(false));
}

TEST(Summary, SaysWhatIsNeededAndWhatIsLeftOut) {
  const SceneSummary summary = summarize(build(diffuse_box()));
  const auto has = [](const auto& list, const std::string& text) {
    return std::ranges::any_of(
        list, [&](const auto& entry) { return entry.second.find(text) != std::string::npos; });
  };
  EXPECT_TRUE(has(summary.needs, "path integrator"));
  EXPECT_TRUE(has(summary.needs, "diffuse BSDF"));
  EXPECT_FALSE(has(summary.needs, "Phong BSDF"));
  EXPECT_TRUE(has(summary.left_out, "Phong BSDF"));
  EXPECT_FALSE(has(summary.left_out, "path integrator"));
}

}  // namespace
}  // namespace penumbra
