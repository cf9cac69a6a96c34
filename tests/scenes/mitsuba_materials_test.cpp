// Conversion of Mitsuba's BSDFs.
#include "tests/scenes/mitsuba_text.h"

namespace penumbra {
namespace {

TEST_F(MitsubaPlugins, DiffuseIsOneSidedAndTheDefault) {
  const SceneDescription s =
      good(in("shape", "sphere") + in("shape", "cube") +
           in("shape", "cube", in("bsdf", "diffuse", "<rgb name='reflectance' value='.1 .2 .3'/>")));
  ASSERT_THAT(s.shapes, SizeIs(3));
  EXPECT_EQ(s.shapes[0].front_bsdf, s.shapes[1].front_bsdf);
  EXPECT_EQ(std::get<DiffuseBsdf>(s.bsdfs.at(std::size_t(s.shapes[0].front_bsdf)).model).reflectance,
            glm::vec3(0.5f));
  EXPECT_EQ(std::get<DiffuseBsdf>(s.bsdfs.at(std::size_t(s.shapes[2].front_bsdf)).model).reflectance,
            glm::vec3(0.1f, 0.2f, 0.3f));
  for (const Shape& shape : s.shapes) EXPECT_EQ(shape.back_bsdf, kBlackBsdf);
}

TEST_F(MitsubaPlugins, AnAreaLightWithoutABsdfIsBlack) {
  for (const std::string version : {"0.5.0", "0.6.0", "2.0.0", "3.0.0"}) {
    const std::string content =
        in("shape", "cube", in("emitter", "area")) + in("shape", "cube") +
        in("shape", "cube", in("emitter", "area", "<rgb name='radiance' value='0'/>")) +
        in("shape", "cube", in("bsdf", "diffuse") + in("emitter", "area"));
    const auto s =
        read("<scene version='" + version + "'>" + content + "<sensor type='perspective'/></scene>");
    ASSERT_TRUE(s) << s.error().message;
    ASSERT_THAT(s->shapes, SizeIs(4));
    for (const std::size_t area_light : {0u, 2u}) {
      EXPECT_EQ(s->shapes[area_light].front_bsdf, kBlackBsdf);
      EXPECT_EQ(s->shapes[area_light].back_bsdf, kBlackBsdf);
    }
    EXPECT_NE(s->shapes[1].front_bsdf, kBlackBsdf);
    EXPECT_NE(s->shapes[3].front_bsdf, kBlackBsdf);
  }
}

TEST_F(MitsubaPlugins, HairAbsorbsByPigmentsACoefficientOrAColour) {
  const auto material = [&](const std::string& parameters) {
    const SceneDescription s = good(in("shape", "sphere", in("bsdf", "hair", parameters)));
    EXPECT_EQ(s.shapes.at(0).front_bsdf, s.shapes.at(0).back_bsdf);
    return material_of(std::get<HairBsdf>(s.bsdfs.at(0).model));
  };
  const Material plain = material("");
  EXPECT_FLOAT_EQ(plain.ior, 1.55f / 1.000277f);
  EXPECT_EQ(plain.alpha_u, 0.3f);
  EXPECT_EQ(plain.alpha_v, 0.3f);
  EXPECT_FLOAT_EQ(plain.tilt, float(2.0 / 360));
  EXPECT_EQ(plain.variant, HAIR_ALONG_V);
  // 1.3 of eumelanin, 0.2 of pheomelanin.
  EXPECT_NEAR(plain.transmitted.x, 1.3 * 0.419 + 0.2 * 0.187, 1e-5);
  EXPECT_NEAR(plain.transmitted.z, 1.3 * 1.37 + 0.2 * 1.05, 1e-5);
  const Material absorbing = material("<rgb name='sigma_a' value='1 2 3'/><float name='scale' value='.5'/>");
  EXPECT_EQ(absorbing.transmitted.y, 1);
  const Material coloured = material("<rgb name='reflectance' value='.1 .2 .3'/>");
  EXPECT_EQ(coloured.variant, HAIR_ALONG_V | HAIR_OF_COLOUR);
  EXPECT_EQ(coloured.diffuse.y, 0.2f);
  EXPECT_THAT(error(scene(in(
                  "shape", "sphere",
                  in("bsdf", "hair", "<float name='eumelanin' value='1'/><rgb name='sigma_a' value='1'/>")))),
              HasSubstr("give either pigments"));
}

TEST_F(MitsubaPlugins, HairLeavesATubeOfTrianglesWhereItEnteredIt) {
  write("c.txt", "-1 0 0 .1\n0 0 0 .1\n1 0 0 .1\n2 0 0 .1\n");
  const std::string file = "<string name='filename' value='c.txt'/>";
  const SceneDescription s =
      good(in("shape", "bsplinecurve", file + in("bsdf", "hair") + in("emitter", "area")) +
           in("shape", "bsplinecurve", file + in("bsdf", "twosided", in("bsdf", "diffuse"))));
  const auto model = [&](int bsdf) { return s.bsdfs.at(std::size_t(bsdf)).model; };
  EXPECT_TRUE(std::holds_alternative<HairBsdf>(model(s.shapes.at(0).front_bsdf)));
  EXPECT_TRUE(std::holds_alternative<NullBsdf>(model(s.shapes.at(0).back_bsdf)));
  EXPECT_EQ(s.shapes.at(1).front_bsdf, s.shapes.at(1).back_bsdf);
}

TEST_F(MitsubaPlugins, PhongDefaults) {
  const SceneDescription s = good(in("shape", "sphere", in("bsdf", "phong")));
  const PhongBsdf& phong = std::get<PhongBsdf>(s.bsdfs.at(0).model);
  EXPECT_EQ(phong.exponent, 30.0f);
  EXPECT_EQ(phong.diffuse, glm::vec3(0.5f));
  EXPECT_EQ(phong.specular, glm::vec3(0.2f));
  EXPECT_THAT(error(scene(in("bsdf", "phong", "<float name='exponent' value='-1'/>"))),
              HasSubstr("0 or more, not -1"));
}

TEST_F(MitsubaPlugins, APhongThatGivesMoreThanItGetsIsAWarning) {
  const std::string more =
      "<rgb name='diffuse_reflectance' value='.5'/><rgb name='specular_reflectance' value='.2 .6 .2'/>";
  EXPECT_THAT(good(in("shape", "sphere", in("bsdf", "phong", more))).warnings,
              ElementsAre(HasSubstr("bsdf 'phong': diffuse and specular")));
}

TEST_F(MitsubaPlugins, PrincipledByIndexOrBySpecular) {
  const auto read_one = [&](std::string_view content) {
    return std::get<PrincipledBsdf>(
        good(in("shape", "sphere", in("bsdf", "principled", content))).bsdfs.at(0).model);
  };
  EXPECT_NEAR(read_one("").eta, 1.5f, 1e-6f);  // specular 0.5
  EXPECT_NEAR(read_one("<float name='specular' value='1'/>").eta, 1.788789f, 1e-6f);
  EXPECT_EQ(read_one("<float name='specular' value='0'/>").eta, 1.0f);
  EXPECT_EQ(read_one("<float name='eta' value='1'/>").eta, 1.0f);
  EXPECT_EQ(read_one("<float name='eta' value='0.8'/>").eta, 0.8f);
  // Where it transmits, an index of 1 would refract each direction into itself.
  const std::string transmits = "<float name='spec_trans' value='0.3'/>";
  EXPECT_GT(read_one(transmits + "<float name='specular' value='0'/>").eta, 1.0f);
  EXPECT_GT(read_one(transmits + "<float name='eta' value='1'/>").eta, 1.0f);
  EXPECT_THAT(error(scene(in("bsdf", "principled",
                             "<float name='eta' value='1.3'/><float name='specular' value='0.5'/>"))),
              HasSubstr("specular is another name for eta"));
  EXPECT_THAT(error(scene(in("bsdf", "principled", "<float name='eta' value='0'/>"))),
              HasSubstr("number above 0, not 0"));
  EXPECT_THAT(error(scene(in("bsdf", "principled", "<float name='metallic' value='1.5'/>"))),
              HasSubstr("metallic must be a number in [0, 1], not 1.5"));
  EXPECT_THAT(error(scene(in("bsdf", "principledthin", "<float name='diff_trans' value='2.5'/>"))),
              HasSubstr("[0, 2]"));
}

TEST_F(MitsubaPlugins, PrincipledIsSeenFromInsideWhereItTransmits) {
  const SceneDescription opaque = good(in("shape", "sphere", in("bsdf", "principled")));
  EXPECT_EQ(opaque.shapes.at(0).back_bsdf, kBlackBsdf);
  const SceneDescription glass = good(
      in("shape", "sphere",
         in("bsdf", "principled", "<float name='spec_trans' value='1'/><float name='eta' value='1.6'/>")));
  const auto side = [&](int bsdf) {
    return material_of(std::get<PrincipledBsdf>(glass.bsdfs.at(std::size_t(bsdf)).model));
  };
  const Material front = side(glass.shapes.at(0).front_bsdf), back = side(glass.shapes.at(0).back_bsdf);
  EXPECT_EQ(front.ior, 1.6f);
  EXPECT_EQ(back.ior, 1 / 1.6f);
  EXPECT_NE(front.variant, back.variant);
  const SceneDescription thin = good(in("shape", "sphere", in("bsdf", "principledthin")));
  EXPECT_EQ(thin.shapes.at(0).front_bsdf, thin.shapes.at(0).back_bsdf);
  // Both sides of an opaque one are what twosided is for.
  EXPECT_EQ(good(in("shape", "sphere", in("bsdf", "twosided", in("bsdf", "principled")))).bsdfs.size(), 1u);
  EXPECT_THAT(error(scene(in("bsdf", "twosided", in("bsdf", "principledthin")))),
              HasSubstr("lets light through"));
}

TEST_F(MitsubaPlugins, ALobeThatIsNeverSampledIsAWarning) {
  const auto warnings = [&](std::string_view type, std::string_view content) {
    return good(in("shape", "sphere", in("bsdf", type, content))).warnings;
  };
  EXPECT_THAT(warnings("principled", "<float name='diffuse_reflectance_sampling_rate' value='0'/>"),
              ElementsAre(HasSubstr("diffuse_reflectance_sampling_rate is 0")));
  EXPECT_THAT(warnings("principled", "<float name='clearcoat_sampling_rate' value='0'/>"), IsEmpty());
  EXPECT_THAT(warnings("principledthin", "<float name='specular_transmittance_sampling_rate' value='0'/>"),
              IsEmpty());
  EXPECT_THAT(warnings("principledthin",
                       "<float name='spec_trans' value='1'/><float "
                       "name='specular_transmittance_sampling_rate' value='0'/>"),
              ElementsAre(HasSubstr("never sampled")));
}

TEST_F(MitsubaPlugins, DisneyByTheNamesOfItsAuthors) {
  const SceneDescription s =
      good(in("shape", "sphere",
              in("bsdf", "disney",
                 "<rgb name='baseColor' value='.2 .4 .6'/><float name='clearcoatGloss' value='.3'/><float "
                 "name='specularTint' value='.25'/><float name='subsurface' value='.75'/>")));
  const Material m = material_of(std::get<DisneyBsdf>(s.bsdfs.at(0).model));
  EXPECT_EQ(m.diffuse.z, 0.6f);
  EXPECT_EQ(m.clearcoat_gloss, 0.3f);
  EXPECT_EQ(m.spec_tint, 0.25f);
  EXPECT_EQ(m.flatness, 0.75f);
  EXPECT_EQ(m.specular_level, 0.5f);
  EXPECT_EQ(s.shapes.at(0).back_bsdf, kBlackBsdf);
}

TEST_F(MitsubaPlugins, TwoSided) {
  const SceneDescription s =
      good(in("shape", "sphere", in("bsdf", "twosided", in("bsdf", "diffuse"))) +
           in("shape", "cube", in("bsdf", "twosided", in("bsdf", "diffuse") + in("bsdf", "phong"))));
  EXPECT_EQ(s.shapes.at(0).front_bsdf, s.shapes.at(0).back_bsdf);
  EXPECT_TRUE(std::holds_alternative<DiffuseBsdf>(s.bsdfs.at(std::size_t(s.shapes.at(1).front_bsdf)).model));
  EXPECT_TRUE(std::holds_alternative<PhongBsdf>(s.bsdfs.at(std::size_t(s.shapes.at(1).back_bsdf)).model));
  EXPECT_THAT(error(scene(in("bsdf", "twosided"))), HasSubstr("one bsdf (for both sides) or two, not 0"));
}

TEST_F(MitsubaPlugins, ReflectancesAreChecked) {
  for (const char* value : {"1.1", "-0.1", "0 0 2"}) {
    EXPECT_THAT(
        error(scene(in("bsdf", "diffuse", "<rgb name='reflectance' value='" + std::string(value) + "'/>"))),
        HasSubstr("a reflectance must be between 0 and 1"))
        << value;
  }
}

TEST_F(MitsubaPlugins, UnknownParametersListTheKnown) {
  EXPECT_EQ(error(scene(in("bsdf", "diffuse", "<rgb name='reflectence' value='1'/>"))),
            "scene.xml:2:23: error: bsdf 'diffuse' has no parameter 'reflectence'; did you mean "
            "'reflectance'? It has: "
            "reflectance\n  <bsdf type='diffuse'><rgb name='reflectence' value='1'/></bsdf>\n"
            "                        ^");
  EXPECT_THAT(error(scene(in("shape", "sphere", "<integer name='shape_index' value='1'/>"))),
              HasSubstr("shape 'sphere' has no parameter 'shape_index'"));
  EXPECT_THAT(error(scene(in("shape", "sphere", in("sensor", "perspective")))),
              HasSubstr("shape 'sphere' cannot hold a <sensor>"));
  EXPECT_THAT(error(scene(in("shape", "sphere", "<string name='radius' value='1'/>"))),
              HasSubstr("the parameter 'radius' of shape 'sphere' must be a <float>, not a <string>"));
  EXPECT_THAT(error(scene(in("shape", "sphere", in("bsdf", "diffuse") + in("bsdf", "phong")))),
              HasSubstr("shape 'sphere' has 2 of <bsdf>; it takes one"));
}

}  // namespace
}  // namespace penumbra
