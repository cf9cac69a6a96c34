// Conductors and dielectrics of Mitsuba's files: parameters, defaults, sides, and errors.
#include <gmock/gmock.h>

#include <cmath>

#include "tests/scenes/scene_text.h"

namespace penumbra {
namespace {

Material material_alone(const Bsdf& bsdf) {
  std::vector<float> curves;
  MaterialTables tables(curves);
  return material_of(bsdf, tables);
}

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class MitsubaDielectrics : public SceneText {
 protected:
  static std::string bsdf(const std::string& type, const std::string& content = "") {
    return "<bsdf type='" + type + "'>" + content + "</bsdf>";
  }
  static std::string on_sphere(const std::string& content) {
    return "<shape type='sphere'>" + content + "</shape>";
  }
  static std::string number(const std::string& name, const std::string& value) {
    return "<float name='" + name + "' value='" + value + "'/>";
  }
  static std::string text(const std::string& name, const std::string& value) {
    return "<string name='" + name + "' value='" + value + "'/>";
  }
  /// Materials of the two sides; the back's family is black where there is none.
  std::pair<Material, Material> sides(const std::string& content) {
    const SceneDescription s = good(on_sphere(content));
    EXPECT_THAT(s.warnings, IsEmpty());
    const auto side = [&](int index) {
      return index == kBlackBsdf ? material_of_family(FAMILY_BLACK)
                                 : material_alone(s.bsdfs.at(std::size_t(index)));
    };
    return {side(s.shapes.at(0).front_bsdf), side(s.shapes.at(0).back_bsdf)};
  }
  Material front(const std::string& content) { return sides(content).first; }
  std::string refused(const std::string& content) { return error(scene(on_sphere(content))); }
};

TEST_F(MitsubaDielectrics, ConductorsAreMirrorsUnlessTheyAreSaidToBeSomething) {
  const auto [mirror, behind] = sides(bsdf("conductor"));
  EXPECT_EQ(mirror.family, FAMILY_CONDUCTOR);
  EXPECT_EQ(behind.family, FAMILY_BLACK);
  EXPECT_EQ(mirror.eta.y, 0);
  EXPECT_EQ(mirror.k.y, 1);
  EXPECT_EQ(mirror.specular.y, 1);
  EXPECT_EQ(front(bsdf("conductor", text("material", "none"))).k.y, 1);
  // What Mitsuba 3.9 has for it in RGB.
  const Material gold = front(bsdf("conductor", text("material", "Au")));
  EXPECT_FLOAT_EQ(gold.eta.x, 0.143036f);
  EXPECT_FLOAT_EQ(gold.k.z, 1.60336f);
  EXPECT_EQ(front(bsdf("conductor", text("material", "Be_palik"))).eta.x,
            front(bsdf("conductor", text("material", "Be"))).eta.x);
}

TEST_F(MitsubaDielectrics, BeforeVersion2ConductorsAreOfCopper) {
  const auto s =
      read("<scene version='0.6.0'>" + on_sphere(bsdf("conductor")) + "<sensor type='perspective'/></scene>");
  ASSERT_TRUE(s) << s.error().message;
  EXPECT_FLOAT_EQ(material_alone(s->bsdfs.at(0)).eta.y, 0.92375f);
}

TEST_F(MitsubaDielectrics, IndicesMayBeNumbersColoursAndSpectra) {
  const Material grey =
      front(bsdf("conductor", "<spectrum name='eta' value='0.789'/><spectrum name='k' value='6.15'/>"));
  EXPECT_FLOAT_EQ(grey.eta.z, 0.789f);
  EXPECT_FLOAT_EQ(grey.k.x, 6.15f);
  const Material coloured = front(
      bsdf("roughconductor", "<rgb name='eta' value='2.9, 2.1, 1.9'/><rgb name='k' value='3, 2, 1.6'/>"));
  EXPECT_FLOAT_EQ(coloured.eta.x, 2.9f);
  EXPECT_FLOAT_EQ(coloured.k.y, 2);
  // As Mitsuba 3.9 converts it, which is how reflectances are converted, by sums over steps of 5 nm.
  const Material tabulated = front(
      bsdf("conductor", "<spectrum name='eta' value='400:1.6, 500:1, 600:.3, 700:.2'/>" + number("k", "3")));
  EXPECT_NEAR(tabulated.eta.x, 0.126356, 2e-3);
  EXPECT_NEAR(tabulated.eta.y, 0.693393, 2e-3);
  EXPECT_NEAR(tabulated.eta.z, 1.35276, 2e-3);
  EXPECT_EQ(tabulated.k.x, 3);
  // Outside is denser: both are relative.
  const Material wet =
      front(bsdf("conductor", number("eta", "2") + number("k", "4") + text("ext_eta", "water")));
  EXPECT_FLOAT_EQ(wet.eta.x, 2 / 1.333f);
  EXPECT_FLOAT_EQ(wet.k.x, 4 / 1.333f);
}

TEST_F(MitsubaDielectrics, ConductorsThatAreHalfSaidAreRefused) {
  EXPECT_THAT(refused(bsdf("conductor", number("eta", "1.5"))), HasSubstr("needs both, eta and k"));
  EXPECT_THAT(refused(bsdf("conductor", number("k", "1.5"))), HasSubstr("needs both, eta and k"));
  EXPECT_THAT(refused(bsdf("conductor", number("eta", "1") + number("k", "2") + text("material", "Au"))),
              HasSubstr("either a material, or eta and k"));
  EXPECT_THAT(refused(bsdf("conductor", number("eta", "-1") + number("k", "2"))),
              HasSubstr("[0, 10000], not -1"));
  EXPECT_THAT(refused(bsdf("conductor", text("material", "Gold"))),
              HasSubstr("'Gold' is not one of: none, Ag"));
}

TEST_F(MitsubaDielectrics, Roughness) {
  const Material plain = front(bsdf("roughconductor"));
  EXPECT_EQ(plain.family, FAMILY_ROUGHCONDUCTOR_BECKMANN);
  EXPECT_EQ(plain.alpha_u, 0.1f);
  EXPECT_EQ(plain.alpha_v, 0.1f);
  const Material ggx = front(bsdf("roughconductor", text("distribution", "ggx") + number("alpha", ".3")));
  EXPECT_EQ(ggx.family, FAMILY_ROUGHCONDUCTOR_GGX);
  EXPECT_EQ(ggx.alpha_u, 0.3f);
  EXPECT_EQ(ggx.alpha_v, 0.3f);
  const Material brushed =
      front(bsdf("roughconductor", number("alpha_u", ".05") + number("alpha_v", ".4") +
                                       "<boolean name='sample_visible' value='false'/>"));
  EXPECT_EQ(brushed.alpha_u, 0.05f);
  EXPECT_EQ(brushed.alpha_v, 0.4f);
  EXPECT_THAT(refused(bsdf("roughconductor",
                           number("alpha", ".1") + number("alpha_u", ".1") + number("alpha_v", ".1"))),
              HasSubstr("either alpha, or alpha_u and alpha_v"));
  EXPECT_THAT(refused(bsdf("roughdielectric", number("alpha_u", ".1"))),
              HasSubstr("both, alpha_u and alpha_v"));
  EXPECT_THAT(refused(bsdf("roughconductor", number("alpha", "-.1"))), HasSubstr("[0, 100], not -0.1"));
  EXPECT_THAT(refused(bsdf("roughdielectric", text("distribution", "phong"))),
              HasSubstr("'phong' is not one of: beckmann, ggx"));
}

TEST_F(MitsubaDielectrics, RoughnessMayHaveATexture) {
  const std::string checks =
      "<texture name='alpha_u' type='checkerboard'><rgb name='color0' value='.1'/><rgb name='color1' "
      "value='.3'/></texture>";
  const Material m = front(bsdf("roughconductor", checks + number("alpha_v", ".2")));
  EXPECT_EQ(m.alpha_u_texture, 0);
  EXPECT_EQ(m.alpha_v_texture, -1);
  EXPECT_EQ(m.alpha_v, 0.2f);
  EXPECT_THAT(refused(bsdf("roughconductor", checks)), HasSubstr("both, alpha_u and alpha_v"));
}

TEST_F(MitsubaDielectrics, HaveTwoSides) {
  const auto [outside, inside] = sides(bsdf("dielectric"));
  EXPECT_EQ(outside.family, FAMILY_DIELECTRIC);
  EXPECT_EQ(inside.family, FAMILY_DIELECTRIC);
  EXPECT_FLOAT_EQ(outside.ior, 1.504183292f);
  EXPECT_FLOAT_EQ(inside.ior, 1 / 1.504183292f);
  const auto [rough, rough_inside] =
      sides(bsdf("roughdielectric", text("int_ior", "diamond") + number("ext_ior", "1") +
                                        number("alpha", ".2") + text("distribution", "ggx") +
                                        "<rgb name='specular_transmittance' value='.5 .6 .7'/>"));
  EXPECT_EQ(rough.family, FAMILY_ROUGHDIELECTRIC_GGX);
  EXPECT_EQ(rough_inside.family, FAMILY_ROUGHDIELECTRIC_GGX);
  EXPECT_FLOAT_EQ(rough.ior, 2.419f);
  EXPECT_FLOAT_EQ(rough_inside.ior, 1 / 2.419f);
  EXPECT_EQ(rough_inside.alpha_v, 0.2f);
  EXPECT_EQ(rough_inside.transmitted.z, 0.7f);
  const auto [pane, pane_inside] = sides(bsdf("thindielectric"));
  EXPECT_EQ(pane.family, FAMILY_THINDIELECTRIC);
  EXPECT_EQ(pane_inside.family, FAMILY_THINDIELECTRIC);
  EXPECT_EQ(pane.ior, pane_inside.ior);
  EXPECT_THAT(refused(bsdf("twosided", bsdf("dielectric"))),
              HasSubstr("a twosided bsdf cannot hold 'dielectric', which lets light through"));
  EXPECT_THAT(refused(bsdf("twosided", bsdf("diffuse") + bsdf("thindielectric"))),
              HasSubstr("lets light through"));
}

TEST_F(MitsubaDielectrics, NoChannelOfARoughOneHasAnIndexOfOne) {
  // Channels of a strong dispersion lie on both sides of the index of yellow light.
  for (const char* inside : {"1.0011", "1.005", "0.998"})
    for (const char* abbe : {"1", "5", "1000"}) {
      const auto [outside, other] =
          sides(bsdf("roughdielectric", number("int_ior", inside) + number("ext_ior", "1") +
                                            number("abbe", abbe) + text("distribution", "ggx")));
      EXPECT_EQ(outside.family, FAMILY_ROUGHDIELECTRIC_GGX);
      for (const vec3& index : {outside.channel_ior, other.channel_ior})
        for (const double each : {double(index.x), double(index.y), double(index.z)})
          EXPECT_GT(std::abs(std::log(each)), std::log(1.001) - 1e-6) << inside << ' ' << abbe;
      EXPECT_NEAR(double(outside.channel_ior.x * other.channel_ior.x), 1, 1e-6);
    }
}

TEST_F(MitsubaDielectrics, IndicesAreChecked) {
  EXPECT_THAT(refused(bsdf("dielectric", number("int_ior", "0"))),
              HasSubstr("int_ior must be a number in [0.001, 1000]"));
  EXPECT_THAT(refused(bsdf("dielectric", number("ext_ior", "-1.5"))), HasSubstr("not -1.5"));
  EXPECT_THAT(refused(bsdf("dielectric", text("int_ior", "watr"))), HasSubstr("did you mean 'water'?"));
  EXPECT_EQ(front(bsdf("dielectric", text("int_ior", "BK7") + text("ext_ior", "vacuum"))).ior, 1.5046f);
}

TEST_F(MitsubaDielectrics, RoughOnesThatDoNotBendLightPassEverything) {
  const SceneDescription s =
      good(on_sphere(bsdf("roughdielectric", number("int_ior", "1.5") + number("ext_ior", "1.5"))));
  EXPECT_THAT(s.warnings, ElementsAre(HasSubstr("everything passes")));
  for (const Bsdf& side : s.bsdfs) {
    EXPECT_EQ(material_alone(side).family, FAMILY_DIELECTRIC);
    EXPECT_EQ(material_alone(side).ior, 1);
  }
}

}  // namespace
}  // namespace penumbra
