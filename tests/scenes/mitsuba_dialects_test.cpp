// Renderers that read Mitsuba 0.5's XML with plugins of their own: lajolla and EARS.
#include <cmath>

#include "scenes/settings.h"
#include "tests/scenes/mitsuba_text.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

std::string number(const std::string& name, double value) {
  return fmt::format("<float name='{}' value='{}'/>", name, value);
}

class MitsubaDialects : public MitsubaPlugins {
 protected:
  static std::string old(const std::string& content) {
    return "<scene version='0.5.0'>" + content + "<sensor type='perspective'/></scene>";
  }
  static std::string shown(const std::string& bsdf) { return old(in("shape", "sphere", bsdf)); }
  template <typename Model>
  Model model_of(const std::string& bsdf) {
    const SceneDescription s = good_of(read(shown(bsdf)));
    if (s.shapes.empty()) return Model{};
    const auto* model = std::get_if<Model>(&s.bsdfs.at(std::size_t(s.shapes[0].front_bsdf)).model);
    EXPECT_NE(model, nullptr) << bsdf;
    return model != nullptr ? *model : Model{};
  }
};

TEST_F(MitsubaDialects, LajollasLobesAreThoseOfDisneysBsdf) {
  const auto diffuse = model_of<DisneyBsdf>(in("bsdf", "disneydiffuse", number("subsurface", 0.25)));
  EXPECT_EQ(diffuse.base_color.value, glm::vec3(0.5f));
  EXPECT_EQ(diffuse.roughness.value, 0.5f);
  EXPECT_EQ(diffuse.subsurface.value, 0.25f);
  EXPECT_FALSE(diffuse.microfacets);
  const auto metal = model_of<DisneyBsdf>(in("bsdf", "disneymetal", number("anisotropic", 0.5)));
  EXPECT_EQ(metal.metallic.value, 1.0f);
  EXPECT_TRUE(metal.microfacets);
  const auto coat = model_of<DisneyBsdf>(in("bsdf", "disneyclearcoat", number("clearcoatGloss", 0.25)));
  EXPECT_EQ(coat.clearcoat.value, 4.0f) << "a quarter of it counts";
  EXPECT_EQ(coat.clearcoat_gloss.value, 0.25f);
  EXPECT_EQ(coat.diffuse_weight, 0.0f);
  const auto sheen = model_of<DisneyBsdf>(in("bsdf", "disneysheen", number("eta", 1.5)));
  EXPECT_EQ(sheen.sheen.value, 1.0f);
  EXPECT_TRUE(sheen.luminance_tint);
}

TEST_F(MitsubaDialects, LajollasGlassIsRoughAndColoured) {
  const auto glass = model_of<RoughDielectricBsdf>(
      in("bsdf", "disneyglass",
         "<rgb name='baseColor' value='.25 .5 1'/>" + number("roughness", 0.5) + number("anisotropic", 0.4)));
  const float aspect = std::sqrt(1 - 0.9f * 0.4f);
  EXPECT_FLOAT_EQ(glass.alpha_u.value, 0.25f / aspect);
  EXPECT_FLOAT_EQ(glass.alpha_v.value, 0.25f * aspect);
  EXPECT_EQ(glass.int_ior / glass.ext_ior, 1.5f);
  EXPECT_EQ(glass.specular_reflectance.value, glm::vec3(0.25f, 0.5f, 1));
  EXPECT_EQ(glass.specular_transmittance.value, glm::sqrt(glm::vec3(0.25f, 0.5f, 1)));
}

TEST_F(MitsubaDialects, LajollasSumIsABlendWhereItTransmits) {
  const auto opaque = model_of<DisneyBsdf>(in("bsdf", "disneybsdf", number("eta", 2)));
  EXPECT_FLOAT_EQ(0.08f * opaque.specular.value, 0.5f / 9) << "half of what the index reflects";
  EXPECT_EQ(opaque.diffuse_weight, 1.0f);
  EXPECT_FALSE(std::isnan(
      model_of<RoughDielectricBsdf>(in("bsdf", "disneybsdf", number("specularTransmission", 1))).int_ior));
  const SceneDescription half = good_of(
      read(shown(in("bsdf", "disneybsdf", number("specularTransmission", 0.5) + number("metallic", 0.5)))));
  const auto& blend = std::get<BlendBsdf>(half.bsdfs.at(std::size_t(half.shapes.at(0).front_bsdf)).model);
  EXPECT_EQ(blend.weight.value, 0.25f);
  EXPECT_EQ(std::get<DisneyBsdf>(half.bsdfs.at(std::size_t(blend.first)).model).diffuse_weight, 0.5f / 0.75f);
  const SceneDescription coated = good_of(
      read(shown(in("bsdf", "disneybsdf", number("specularTransmission", 1) + number("clearcoat", 1)))));
  EXPECT_THAT(warnings(coated), HasSubstr("under a sheen or a clearcoat at most 0.984375 of it transmits"));
  EXPECT_THAT(error(shown(in(
                  "bsdf", "disneybsdf",
                  number("specularTransmission", 0.5) + "<texture type='checkerboard' name='baseColor'/>"))),
              HasSubstr("base_color of a disneyglass, or of a disneybsdf that transmits, takes no texture"));
  EXPECT_THAT(error(shown(in("bsdf", "disneybsdf", "<texture type='checkerboard' name='specular'/>"))),
              HasSubstr("specular of a disneybsdf takes a number here"));
  EXPECT_THAT(error(shown(in("bsdf", "disneybsdf", number("eta", 0.9)))), HasSubstr("eta must be"));
  EXPECT_THAT(error(shown(in("bsdf", "disneytransmission"))), HasSubstr("'disneyglass' took its place"));
}

TEST_F(MitsubaDialects, LajollasRoughnessIsTheRootOfAlpha) {
  const auto plastic = model_of<RoughPlasticBsdf>(in("bsdf", "roughplastic", number("roughness", 0.5)));
  EXPECT_EQ(plastic.alpha.value, 0.25f);
  EXPECT_EQ(plastic.distribution, DISTRIBUTION_GGX);
  EXPECT_EQ(
      model_of<RoughDielectricBsdf>(in("bsdf", "roughdielectric", number("roughness", 0.3))).distribution,
      DISTRIBUTION_GGX);
  EXPECT_EQ(model_of<RoughPlasticBsdf>(
                in("bsdf", "roughplastic", number("roughness", 0.5) + number("alpha", 0.125)))
                .alpha.value,
            0.125f)
      << "Mitsuba's";
  EXPECT_THAT(error(shown(in("bsdf", "roughplastic", number("roughness", 2)))),
              HasSubstr("roughness must be in [0, 1], not 2"));
  EXPECT_THAT(error(scene(in("shape", "sphere", in("bsdf", "roughplastic", number("roughness", 0.5))))),
              HasSubstr("has no parameter 'roughness'"))
      << "Mitsuba 3 has none";
}

TEST_F(MitsubaDialects, LajollasFirstVersionsOfVolpathScatterLess) {
  const auto depth = [&](const std::string& version, const std::string& more = "") {
    const SceneDescription s =
        good_of(read(old(in("integrator", "volpath",
                            "<integer name='version' value='" + version +
                                "'/><integer name='maxNullCollisions' value='9'/>" + more))));
    EXPECT_EQ(warnings(s).contains("surfaces scatter no light"), version == "2") << version;
    return param::max_depth(s.integrator);
  };
  EXPECT_EQ(depth("1"), 1);
  EXPECT_EQ(depth("2"), 2);
  EXPECT_EQ(depth("6"), -1);
  EXPECT_EQ(depth("0"), -1);
  EXPECT_EQ(depth("99999999999"), -1);
  EXPECT_EQ(depth("2", "<integer name='maxDepth' value='1'/>"), 1);
}

TEST_F(MitsubaDialects, LajollasOtherImagesAreNotMade) {
  EXPECT_THAT(error(old(in("integrator", "depth"))), HasSubstr("every other integrator has a layer 'depth'"));
  EXPECT_THAT(error(old(in("integrator", "mipmapLevel"))), HasSubstr("textures have no levels here"));
}

TEST_F(MitsubaDialects, EarsIsAPathTracer) {
  const SceneDescription s = good_of(read(old(
      "<default name='budget' value='60'/>" +
      in("integrator", "recursive_path",
         "<integer name='maxDepth' value='40'/><integer name='rrDepth' value='1'/><string name='rrsStrategy' "
         "value='EARS'/><float name='budget' value='$budget'/><boolean name='strictNormals' "
         "value='true'/>"))));
  EXPECT_EQ(print_setting(s, "integrator.type"), "path_mis");
  EXPECT_EQ(param::max_depth(s.integrator), 40);
  EXPECT_THAT(warnings(s), HasSubstr("path stands in for the integrator 'recursive_path'"));
  EXPECT_THAT(warnings(s), ::testing::Not(HasSubstr("no parameter")));
  EXPECT_THAT(error(shown(in("bsdf", "torrance"))),
              HasSubstr("a 'roughplastic' of the same parameters is nearest"));
}

TEST_F(MitsubaDialects, OpenPbrHasAThinFilm) {
  const auto film = model_of<OpenPbrBsdf>(in(
      "bsdf", "openpbr",
      number("thin_film_weight", 0.5) + number("thin_film_thickness", 0.3) + number("thin_film_ior", 1.6)));
  EXPECT_EQ(film.film_weight.value, 0.5f);
  EXPECT_EQ(film.film().nanometres, 1e3 * double(0.3f));
  EXPECT_EQ(film.film().index, double(1.6f));
  std::vector<float> curves;
  MaterialTables tables(curves);
  EXPECT_EQ(material_of(film, tables).family, FAMILY_OPENPBR_FILM);
  EXPECT_FALSE(model_of<OpenPbrBsdf>(in("bsdf", "openpbr", number("thin_film_ior", 1.6))).filmed());
}

TEST_F(MitsubaDialects, StandardSurfaceIsAnOpenPbr) {
  // Expected values: MaterialX's translation graph, by hand.
  const auto plain = model_of<OpenPbrBsdf>(in("bsdf", "standard_surface"));
  EXPECT_EQ(plain.base_color.value, glm::vec3(0.8f));
  EXPECT_EQ(plain.specular_roughness.value, 0.2f);
  EXPECT_FALSE(plain.filmed());
  const auto other =
      model_of<OpenPbrBsdf>(in("bsdf", "standard_surface",
                               number("base", 0.5) + number("specular", 0.4) + number("specular_IOR", 1.7) +
                                   number("coat", 0.5) + "<rgb name='coat_color' value='.2 .4 .6'/>" +
                                   number("sheen", 0.3) + number("sheen_roughness", 0.5) +
                                   number("thin_film_thickness", 300) + number("thin_film_IOR", 1.3)));
  EXPECT_EQ(other.base_weight.value, 0.5f);
  EXPECT_EQ(other.specular_weight.value, 0.4f);
  EXPECT_EQ(other.specular_ior, 1.7f);
  EXPECT_EQ(other.coat_weight.value, 0.5f);
  EXPECT_NEAR(other.base_color.value.x, 0.8 * 0.6, 1e-6) << "half of it is below the coat";
  EXPECT_NEAR(other.fuzz_roughness.value, std::pow(0.5, 0.4), 1e-6);
  EXPECT_EQ(other.film_weight.value, 1.0f);
  EXPECT_FLOAT_EQ(other.film_thickness.value, 0.3f);
  const auto metal = model_of<OpenPbrBsdf>(
      in("bsdf", "standard_surface", number("metalness", 1) + number("specular", 0.4) + number("coat", 1)));
  EXPECT_EQ(metal.specular_weight.value, 1.0f);
  EXPECT_EQ(metal.coat_weight.value, 0.0f);
  EXPECT_TRUE(model_of<OpenPbrBsdf>(in("bsdf", "standard_surface",
                                       number("transmission", 1) + number("transmission_dispersion", 30)))
                  .disperses());
}

}  // namespace
}  // namespace penumbra
