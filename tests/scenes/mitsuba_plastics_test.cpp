// Conversion of Mitsuba's plastics, and of Ward's, Blinn's and Nori's BSDFs.
#include <gmock/gmock.h>

#include "kernels/host/device_scene.h"
#include "scenes/device/device_scene_builder.h"
#include "tests/scenes/scene_text.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class MitsubaPlastics : public SceneText {
 protected:
  static std::string sphere(const std::string& type, const std::string& parameters = "") {
    return "<shape type='sphere'><bsdf type='" + type + "'>" + parameters + "</bsdf></shape>";
  }
  template <typename Bsdf>
  Bsdf bsdf(const std::string& parameters = "") {
    const SceneDescription s = good(sphere(Bsdf::kPlugin, parameters));
    EXPECT_THAT(s.warnings, IsEmpty());
    return std::get<Bsdf>(s.bsdfs.at(0).model);
  }
  std::string bad(const std::string& type, const std::string& parameters) {
    return error(scene(sphere(type, parameters)));
  }
};

TEST_F(MitsubaPlastics, Defaults) {
  const auto plastic = bsdf<PlasticBsdf>();
  EXPECT_EQ(plastic.int_ior, 1.49f);
  EXPECT_EQ(plastic.ext_ior, 1.000277f);
  EXPECT_EQ(plastic.diffuse, glm::vec3(0.5f));
  EXPECT_EQ(plastic.specular, glm::vec3(1));
  EXPECT_FALSE(plastic.nonlinear);
  const auto rough = bsdf<RoughPlasticBsdf>();
  EXPECT_EQ(rough.alpha, TexturedNumber(0.1f));
  EXPECT_EQ(rough.distribution, DISTRIBUTION_BECKMANN);
  EXPECT_EQ(rough.int_ior, 1.49f);
  const auto ward = bsdf<WardBsdf>();
  EXPECT_EQ(ward.variant, WARD_BALANCED);
  EXPECT_EQ(ward.alpha_u, 0.1f);
  EXPECT_EQ(ward.specular, glm::vec3(0.2f));
  EXPECT_EQ(bsdf<BlinnPhongBsdf>().exponent, 30.0f);
  const auto nori = bsdf<MicrofacetDiffuseBsdf>();
  EXPECT_EQ(nori.int_ior, 1.5046f);
  EXPECT_EQ(nori.alpha, 0.1f);
}

TEST_F(MitsubaPlastics, TangentsAreForSurfacesThatAreRougherOneWayAlone) {
  const auto wants_uv = [&](const std::string& type, const std::string& parameters = "") {
    const auto built = build_device_scene(good(sphere(type, parameters)), {});
    return built && (built->header.features & FEATURE_UV) != 0u;
  };
  for (const char* type : {"diffuse", "plastic", "roughplastic", "roughconductor", "roughdielectric", "ward",
                           "blinnphong", "principled"})
    EXPECT_FALSE(wants_uv(type)) << type;
  const std::string stretched = "<float name='alpha_u' value='.1'/><float name='alpha_v' value='.2'/>";
  for (const char* type : {"roughconductor", "roughdielectric", "ward"})
    EXPECT_TRUE(wants_uv(type, stretched)) << type;
  EXPECT_TRUE(wants_uv("principled", "<float name='anisotropic' value='.5'/>"));
}

TEST_F(MitsubaPlastics, AreReadAsOldFilesSpellThem) {
  const auto plastic = bsdf<RoughPlasticBsdf>(
      "<float name='alpha' value='0.4'/><string name='distribution' value='ggx'/>"
      "<string name='intIOR' value='bk7'/><float name='extIOR' value='1'/>"
      "<boolean name='nonlinear' value='true'/><boolean name='sampleVisible' value='false'/>"
      "<rgb name='diffuseReflectance' value='.1 .2 .3'/><rgb name='specularReflectance' value='.4'/>");
  EXPECT_EQ(plastic.alpha, TexturedNumber(0.4f));
  EXPECT_EQ(plastic.distribution, DISTRIBUTION_GGX);
  EXPECT_EQ(plastic.int_ior, 1.5046f);
  EXPECT_EQ(plastic.ext_ior, 1.0f);
  EXPECT_TRUE(plastic.nonlinear);
  EXPECT_EQ(plastic.diffuse, glm::vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(plastic.specular, glm::vec3(0.4f));
  const auto ward = bsdf<WardBsdf>(
      "<string name='variant' value='ward-duer'/><float name='alphaU' value='0.3'/>"
      "<float name='alphaV' value='0.2'/>");
  EXPECT_EQ(ward.variant, WARD_DUER);
  EXPECT_EQ(ward.alpha_u, 0.3f);
  EXPECT_EQ(ward.alpha_v, 0.2f);
}

TEST_F(MitsubaPlastics, BadValuesAreNamed) {
  EXPECT_THAT(bad("roughplastic", "<float name='alpha' value='-0.1'/>"),
              AllOf(HasSubstr("alpha must be a number in [0, 100], not -0.1"), HasSubstr("^")));
  EXPECT_THAT(bad("roughplastic", "<string name='distribution' value='phong'/>"), HasSubstr("beckmann, ggx"));
  EXPECT_THAT(bad("roughplastic", "<float name='int_ior' value='1.5'/><float name='ext_ior' value='1.5'/>"),
              HasSubstr("int_ior and ext_ior must differ"));
  for (const char* type : {"plastic", "roughplastic"}) {
    EXPECT_THAT(bad(type, "<float name='int_ior' value='9'/>"), HasSubstr("by a factor of 3.5 at most"));
    EXPECT_THAT(bad(type, "<float name='int_ior' value='0'/>"), HasSubstr("int_ior"));
    EXPECT_THAT(bad(type, "<string name='int_ior' value='bk8'/>"), HasSubstr("bk7"));
  }
  EXPECT_THAT(bad("ward", "<string name='variant' value='duer'/>"), HasSubstr("ward-duer"));
  EXPECT_THAT(bad("blinnphong", "<float name='exponent' value='-1'/>"), HasSubstr("0 or more, not -1"));
  EXPECT_THAT(bad("microfacet", "<rgb name='kd' value='1.5'/>"), HasSubstr("between 0 and 1"));
}

TEST_F(MitsubaPlastics, EqualBoundariesShareACurve) {
  const std::string rough = "<float name='alpha' value='0.2'/>";
  const SceneDescription s =
      good(sphere("roughplastic", rough) +
           sphere("roughplastic", rough + "<rgb name='diffuse_reflectance' value='.1'/>") +
           sphere("roughplastic", "<string name='distribution' value='ggx'/>" + rough) + sphere("plastic"));
  const auto device = build_device_scene(s, {});
  ASSERT_TRUE(device) << device.error().message;
  EXPECT_EQ(device->header.tables.curves.count, 2 * CURVE_STRIDE);
  const auto materials = table<Material>(*device, device->header.tables.materials);
  EXPECT_EQ(materials[1].curve, materials[2].curve);
  EXPECT_NE(materials[1].curve, materials[3].curve);
}

TEST_F(MitsubaPlastics, TexturedRoughnessHasRowsOfCurves) {
  const std::string textured = "<texture type='checkerboard' name='alpha'/>";
  const SceneDescription s =
      good(sphere("roughplastic", textured) + sphere("roughplastic", textured) + sphere("roughplastic"));
  const auto device = build_device_scene(s, {});
  ASSERT_TRUE(device) << device.error().message;
  EXPECT_EQ(device->header.tables.curves.count, (CURVE_ROWS + 1) * CURVE_STRIDE);
  const auto materials = table<Material>(*device, device->header.tables.materials);
  EXPECT_EQ(materials[1].curve_rows, CURVE_ROWS);
  EXPECT_EQ(materials[1].curve, materials[2].curve);
  EXPECT_EQ(materials[1].alpha_u_texture, 0);
  EXPECT_EQ(materials[3].curve_rows, 1);
}

}  // namespace
}  // namespace penumbra
