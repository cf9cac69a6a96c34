// Nested BSDFs of Mitsuba's files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scenes/scene_text.h"

namespace penumbra::mitsuba_nested_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::string bsdf(const std::string& type, const std::string& inside = "") {
  return "<bsdf type='" + type + "'>" + inside + "</bsdf>";
}
std::string on_sphere(const std::string& inside) { return "<shape type='sphere'>" + inside + "</shape>"; }
std::string number(const std::string& name, const std::string& value) {
  return "<float name='" + name + "' value='" + value + "'/>";
}
std::string board(const std::string& name = "") {
  return "<texture type='checkerboard'" + (name.empty() ? "" : " name='" + name + "'") + "/>";
}

class MitsubaNested : public SceneText {
 protected:
  SceneDescription material(const std::string& text) { return good(on_sphere(text)); }
  std::string material_error(const std::string& text) { return error(scene(on_sphere(text))); }
};

template <typename Model>
const Model& model(const SceneDescription& scene, int index) {
  return std::get<Model>(scene.bsdfs.at(std::size_t(index)).model);
}

TEST_F(MitsubaNested, AMaskLetsThroughOnBothSides) {
  const SceneDescription s = material(bsdf("mask", number("opacity", "0.3") + bsdf("diffuse")));
  const auto& front = model<MaskBsdf>(s, s.shapes.at(0).front_bsdf);
  const auto& back = model<MaskBsdf>(s, s.shapes[0].back_bsdf);
  EXPECT_EQ(front.opacity.value, 0.3f);
  EXPECT_EQ(back.opacity.value, 0.3f);
  EXPECT_TRUE(std::holds_alternative<DiffuseBsdf>(s.bsdfs.at(std::size_t(front.inside)).model));
  EXPECT_EQ(back.inside, kBlackBsdf) << "a diffuse surface is black from behind";
  EXPECT_LT(front.inside, s.shapes[0].front_bsdf);
  const SceneDescription both = material(bsdf("mask", board("opacity") + bsdf("twosided", bsdf("diffuse"))));
  EXPECT_EQ(both.shapes.at(0).front_bsdf, both.shapes[0].back_bsdf);
  EXPECT_EQ(model<MaskBsdf>(both, both.shapes[0].front_bsdf).opacity.texture, 0);
  EXPECT_THAT(both.bsdfs, SizeIs(2));
}

TEST_F(MitsubaNested, NullIsNothing) {
  const SceneDescription s = material(bsdf("null"));
  EXPECT_EQ(s.shapes.at(0).front_bsdf, s.shapes[0].back_bsdf);
  EXPECT_TRUE(std::holds_alternative<NullBsdf>(s.bsdfs.at(0).model));
  const SceneDescription inside =
      material(bsdf("blendbsdf", number("weight", "0.2") + bsdf("null") + bsdf("diffuse")));
  EXPECT_EQ(model<BlendBsdf>(inside, inside.shapes.at(0).front_bsdf).first, kNoBsdf);
  EXPECT_EQ(model<BlendBsdf>(inside, inside.shapes[0].back_bsdf).second, kBlackBsdf);
}

TEST_F(MitsubaNested, Blends) {
  const SceneDescription s =
      material(bsdf("blendbsdf", number("weight", "0.2") + bsdf("phong") + bsdf("diffuse")));
  const auto& blend = model<BlendBsdf>(s, s.shapes.at(0).front_bsdf);
  EXPECT_EQ(blend.weight.value, 0.2f);
  EXPECT_TRUE(std::holds_alternative<PhongBsdf>(s.bsdfs.at(std::size_t(blend.first)).model));
  EXPECT_TRUE(std::holds_alternative<DiffuseBsdf>(s.bsdfs.at(std::size_t(blend.second)).model));
  EXPECT_EQ(s.shapes[0].back_bsdf, kBlackBsdf);
}

TEST_F(MitsubaNested, CoatingsAreBlendsWithAMirror) {
  SceneDescription s = material(bsdf("coating", number("int_ior", "1.5") + number("ext_ior", "1") +
                                                    number("thickness", "1") + bsdf("diffuse")));
  const auto& blend = model<BlendBsdf>(s, s.shapes.at(0).front_bsdf);
  EXPECT_NEAR(blend.weight.value, 0.0918f, 0.002f) << "the mean of Fresnel's equations";
  EXPECT_TRUE(std::holds_alternative<DiffuseBsdf>(s.bsdfs.at(std::size_t(blend.first)).model));
  EXPECT_EQ(model<ConductorBsdf>(s, blend.second).eta.value, glm::vec3(0.0f));
  EXPECT_EQ(s.shapes[0].back_bsdf, kBlackBsdf);
  ASSERT_THAT(s.warnings, SizeIs(1));
  EXPECT_THAT(s.warnings[0], HasSubstr("the coating is approximated"));

  s = material(
      bsdf("twosided", bsdf("roughcoating", number("alpha", "0.3") + bsdf("twosided", bsdf("conductor")))));
  const auto& rough = model<BlendBsdf>(s, s.shapes.at(0).front_bsdf);
  EXPECT_EQ(model<RoughConductorBsdf>(s, rough.second).alpha_u.value, 0.3f);
  EXPECT_EQ(s.shapes[0].back_bsdf, s.shapes[0].front_bsdf);

  EXPECT_THAT(material_error(bsdf("coating")), HasSubstr("holds one bsdf"));
  EXPECT_THAT(material_error(bsdf("coating", number("int_ior", "9") + bsdf("diffuse"))),
              HasSubstr("may differ by a factor"));
}

TEST_F(MitsubaNested, MixturesAreBlendsOfBlends) {
  const SceneDescription s =
      material(bsdf("mixturebsdf", "<string name='weights' value='0.2, 0.5 0.1'/>" + bsdf("diffuse") +
                                       bsdf("phong") + bsdf("diffuse")));
  // The share of each leaf: what is left of all before it, times its weight.
  int at = s.shapes.at(0).front_bsdf;
  double left = 1;
  for (const double share : {0.2, 0.5, 0.1}) {
    const auto& blend = model<BlendBsdf>(s, at);
    EXPECT_NEAR(left * blend.weight.value, share, 1e-6);
    EXPECT_NE(blend.second, kBlackBsdf);
    left *= 1 - blend.weight.value;
    at = blend.first;
  }
  EXPECT_EQ(at, kBlackBsdf);
  EXPECT_NEAR(left, 0.2, 1e-6);
}

TEST_F(MitsubaNested, MapsBendLeaves) {
  const SceneDescription s =
      material(bsdf("normalmap", board("normalmap") + bsdf("mask", bsdf("twosided", bsdf("diffuse")))));
  const auto& front = model<MaskBsdf>(s, s.shapes.at(0).front_bsdf);
  const auto& back = model<MaskBsdf>(s, s.shapes[0].back_bsdf);
  EXPECT_EQ(s.bsdfs.at(std::size_t(front.inside)).bend, (SurfaceBend{BendKind::kNormalMap, 0, 1}));
  EXPECT_EQ(s.bsdfs.at(std::size_t(back.inside)).bend, (SurfaceBend{BendKind::kNormalMap, 0, -1}));
  const SceneDescription bump =
      material(bsdf("twosided", bsdf("bumpmap", board() + number("scale", "2.5") + bsdf("diffuse"))));
  EXPECT_EQ(bump.shapes.at(0).front_bsdf, bump.shapes[0].back_bsdf);
  EXPECT_EQ(bump.bsdfs.at(0).bend, (SurfaceBend{BendKind::kBumpMap, 0, 2.5f}));
  EXPECT_THAT(bump.warnings, IsEmpty());
}

TEST_F(MitsubaNested, MapsBendLayersOfOpenPbr) {
  const auto map = [](const std::string& layers, const std::string& inside, const std::string& scale = "1") {
    return bsdf("bumpmap",
                board() + number("scale", scale) + "<string name='layers' value='" + layers + "'/>" + inside);
  };
  const std::string coated = bsdf("openpbr", number("coat_weight", "1"));
  const auto leaf = [&](const std::string& text) { return material(text).bsdfs.at(0); };
  const SurfaceBend two{BendKind::kBumpMap, 0, 2};
  const Bsdf base = leaf(map("base", coated, "2")), coat = leaf(map("coat", coated, "2")),
             all = leaf(map("all", coated, "2"));
  EXPECT_EQ(base.bend, two);
  EXPECT_EQ(base.coat_bend, SurfaceBend{}) << "it stays smooth";
  EXPECT_EQ(coat.bend, SurfaceBend{});
  EXPECT_EQ(coat.coat_bend, two);
  EXPECT_EQ(all.bend, two);
  EXPECT_EQ(all.coat_bend, std::nullopt);
  for (const Bsdf& both :
       {leaf(map("coat", map("base", coated, "2"), "3")), leaf(map("base", map("coat", coated, "3"), "2"))}) {
    EXPECT_EQ(both.bend.scale, 2);
    ASSERT_TRUE(both.coat_bend);
    EXPECT_EQ(both.coat_bend->scale, 3);
  }
  EXPECT_EQ(leaf(map("base", bsdf("diffuse"))).coat_bend, std::nullopt);
  EXPECT_THAT(material_error(map("coat", bsdf("diffuse"))), HasSubstr("holds no openpbr"));
  for (const std::string& inner : {"coat", "all"})
    EXPECT_THAT(material_error(map("coat", map(inner, coated))),
                HasSubstr("cannot hold another normalmap or bumpmap of the same layer"));
  for (const std::string& inner : {"coat", "base", "all"})
    EXPECT_THAT(material_error(map("all", map(inner, coated))), HasSubstr("cannot hold another"));
  EXPECT_THAT(material_error(map("base", map("all", coated))), HasSubstr("cannot hold another"));
}

TEST_F(MitsubaNested, WhatIsWrongIsSaid) {
  const std::string diffuse = bsdf("diffuse");
  EXPECT_THAT(material_error(bsdf("mask")), HasSubstr("bsdf 'mask' holds one bsdf, not 0"));
  EXPECT_THAT(material_error(bsdf("mask", number("opacity", "1.5") + diffuse)),
              HasSubstr("opacity must be a number in [0, 1], not 1.5"));
  EXPECT_THAT(material_error(bsdf("blendbsdf", number("weight", "-0.1") + diffuse + diffuse)),
              HasSubstr("weight must be a number in [0, 1], not -0.1"));
  EXPECT_THAT(material_error(bsdf("blendbsdf", diffuse)), HasSubstr("bsdf 'blendbsdf' holds 2 bsdfs, not 1"));
  const auto mixture = [&](const std::string& weights) {
    return material_error(
        bsdf("mixturebsdf", "<string name='weights' value='" + weights + "'/>" + diffuse + diffuse));
  };
  EXPECT_THAT(mixture("0.5"), HasSubstr("bsdf 'mixturebsdf' holds one bsdf, not 2"));
  EXPECT_THAT(mixture("0.5, 0.6"), HasSubstr("weights add up to 1.1, more than 1"));
  EXPECT_THAT(mixture("0.5, -0.1"), HasSubstr("weights must be in [0, 1], not -0.1"));
  EXPECT_THAT(mixture("0.5, some"), HasSubstr("weights: "));
  EXPECT_THAT(material_error(bsdf("mixturebsdf", diffuse)), HasSubstr("needs weights"));
  for (const std::string& open :
       {bsdf("null"), bsdf("mask", diffuse), bsdf("blendbsdf", bsdf("null") + diffuse)})
    EXPECT_THAT(material_error(bsdf("twosided", open)), HasSubstr("lets light through"));
  EXPECT_THAT(material_error(bsdf("normalmap", diffuse)),
              HasSubstr("bsdf 'normalmap' holds one texture, not 0"));
  EXPECT_THAT(material_error(bsdf("bumpmap", board() + board() + diffuse)),
              HasSubstr("bsdf 'bumpmap' holds one texture, not 2"));
  EXPECT_THAT(material_error(bsdf("bumpmap", board() + bsdf("normalmap", board() + diffuse))),
              HasSubstr("cannot hold another normalmap or bumpmap"));
  EXPECT_THAT(material_error(bsdf("twosided", bsdf("normalmap", board() + bsdf("twosided", diffuse)))),
              HasSubstr("lets light through or has two sides already"));
  EXPECT_THAT(
      error(scene(
          "<bsdf type='mask' id='a'><ref id='b'/></bsdf><bsdf type='mask' id='b'><ref id='a'/></bsdf>")),
      HasSubstr("holds itself, through its references"));
}

}  // namespace
}  // namespace penumbra::mitsuba_nested_test
