// Rendering settings of Mitsuba's files, as public scenes have them: integrators, films, filters, samplers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes/names.h"
#include "tests/scenes/scene_text.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class MitsubaRendering : public SceneText {
 protected:
  static std::string plugin(const std::string& tag, const std::string& type, const std::string& inside = "") {
    return "<" + tag + " type='" + type + "'>" + inside + "</" + tag + ">";
  }
  static std::string film(const std::string& type, const std::string& inside = "") {
    return plugin("sensor", "perspective", plugin("film", type, inside));
  }
};

TEST_F(MitsubaRendering, IntegratorsOfMediaAndOfGradients) {
  for (const char* type : {"volpath", "volpath_simple", "volpathmis", "prb", "prb_basic", "prbvolpath"}) {
    const SceneDescription s = good(plugin("integrator", type,
                                           "<integer name='maxDepth' value='7'/><integer name='rrDepth' "
                                           "value='3'/><boolean name='strictNormals' value='true'/>"
                                           "<boolean name='hideEmitters' value='true'/>"));
    const bool media = std::string_view(type).find("vol") != std::string_view::npos;
    EXPECT_EQ(kind_of(s.integrator), media ? IntegratorKind::kVolpath : IntegratorKind::kPath) << type;
    EXPECT_EQ(param::max_depth(s.integrator), 7) << type;
    EXPECT_EQ(param::rr_depth(s.integrator), 3) << type;
    EXPECT_TRUE(s.integrator.hide_emitters) << type;
    EXPECT_THAT(s.warnings, IsEmpty()) << type;
  }
}

TEST_F(MitsubaRendering, PathStandsInForOtherWaysToTheSameImage) {
  for (const char* type : {"bdpt", "ptracer", "pssmlt", "mlt", "erpt", "vpl"}) {
    const SceneDescription s = good(plugin("integrator", type, "<integer name='max_depth' value='9'/>"));
    EXPECT_EQ(kind_of(s.integrator), IntegratorKind::kPath) << type;
    EXPECT_EQ(param::max_depth(s.integrator), 9) << type;
    EXPECT_THAT(s.warnings,
                ElementsAre(HasSubstr(std::string("path stands in for the integrator '") + type)));
  }
  good(plugin("integrator", "bdpt",
              "<boolean name='lightImage' value='true'/><boolean name='sampleDirect' value='false'/>"));
  good(plugin("integrator", "mlt", "<boolean name='manifoldPerturbation' value='true'/>"));
  EXPECT_THAT(
      error(scene(plugin("integrator", "bdpt", "<integer name='photonCount' value='9'/>"))),
      AllOf(HasSubstr("scene.xml:2:"), HasSubstr("integrator 'bdpt' has no parameter 'photon_count'")));
  EXPECT_THAT(error(scene(plugin("integrator", "volpath", "<integer name='max_depth' value='-3'/>"))),
              AllOf(HasSubstr("scene.xml:2:"), HasSubstr("max_depth: '-3' is not in the range")));
}

TEST_F(MitsubaRendering, ThoseThatAddToAnotherAreTheOther) {
  const auto inside = [&](const char* type, const std::string& rest = "") {
    return good(plugin("integrator", type, plugin("integrator", "direct") + rest));
  };
  EXPECT_THAT(inside("adaptive", "<float name='maxError' value='0.05'/>").warnings, IsEmpty());
  EXPECT_THAT(inside("irrcache").warnings, ElementsAre(HasSubstr("direct is rendered without its cache")));
  const SceneDescription several = inside("aov", plugin("integrator", "path", ""));
  EXPECT_EQ(kind_of(several.integrator), IntegratorKind::kDirect);
  EXPECT_THAT(several.warnings, ElementsAre(HasSubstr("the first of 2 integrators is rendered, direct")));
  // Quantities for which there is no layer are named.
  const SceneDescription alone =
      good(plugin("integrator", "aov", "<string name='aovs' value='d:depth, t:dp_du, uv:duv_dx'/>"));
  EXPECT_EQ(kind_of(alone.integrator), IntegratorKind::kDirect);
  EXPECT_THAT(alone.film.layers, IsEmpty());
  EXPECT_THAT(alone.warnings, ElementsAre(HasSubstr("no layer of dp_du, duv_dx"),
                                          HasSubstr("aov has no integrator inside; direct light")));
  EXPECT_THAT(inside("stokes").warnings, ElementsAre(HasSubstr("direct is rendered without polarisation")));
}

TEST_F(MitsubaRendering, AovAsksForLayers) {
  const auto aov = [](const std::string& aovs, const std::string& inside) {
    return plugin("integrator", "aov", "<string name='aovs' value='" + aovs + "'/>" + inside);
  };
  const std::string path = plugin("integrator", "path", "<integer name='max_depth' value='3'/>");
  // Those that every image has are no news; each is there once, in one order.
  const SceneDescription s = good(aov(
      "dd.y:depth, nn:sh_normal, id:shape_index, pos:position, uv:uv, gn:geo_normal, al:albedo, p:position",
      path));
  EXPECT_EQ(param::max_depth(s.integrator), 3);
  EXPECT_THAT(s.film.layers, ElementsAre(AskedLayer::kPosition, AskedLayer::kUv, AskedLayer::kGeometricNormal,
                                         AskedLayer::kShape));
  EXPECT_THAT(s.warnings, IsEmpty());
  EXPECT_THAT(good(aov("u:uv", aov("p:position", path))).film.layers,
              ElementsAre(AskedLayer::kPosition, AskedLayer::kUv));
  EXPECT_THAT(good(path).film.layers, IsEmpty());
  EXPECT_THAT(error(scene(aov("a:albedo, p:positon", path))),
              AllOf(HasSubstr("scene.xml:2:"), HasSubstr("'positon' is not one of: depth, albedo"),
                    HasSubstr("did you mean 'position'")));
}

TEST_F(MitsubaRendering, HowFilesAreWrittenIsNoMatter) {
  const std::string size = "<integer name='width' value='20'/><integer name='height' value='10'/>";
  for (const char* type : {"hdrfilm", "ldrfilm", "mfilm", "tiledhdrfilm"}) {
    const SceneDescription s = good(film(type, size));
    EXPECT_EQ(s.film.width, 20) << type;
    EXPECT_THAT(s.warnings, IsEmpty()) << type;
  }
  good(film("mfilm", size + "<string name='variable' value='a'/><integer name='digits' value='4'/>"
                            "<string name='fileFormat' value='numpy'/><string name='filename' value='b'/>"));
  EXPECT_THAT(error(scene(film("specfilm"))),
              AllOf(HasSubstr("scene.xml:2:"), HasSubstr("film type 'specfilm' is not one")));
}

TEST_F(MitsubaRendering, FormatsOfPixels) {
  const auto read = [&](const char* pixel, const char* component) {
    return good(film("hdrfilm", std::string("<string name='pixel_format' value='") + pixel +
                                    "'/><string name='componentFormat' value='" + component + "'/>"));
  };
  for (const auto& [format, alpha] : {std::pair{"rgb", false},
                                      {"rgba", true},
                                      {"luminance_alpha", true},
                                      {"xyz", false},
                                      {"xyza", true},
                                      {"RGB", false},
                                      {"RGBA", true},
                                      {"spectrumAlpha", true}}) {
    const SceneDescription s = read(format, "float32");
    EXPECT_EQ(s.film.alpha, alpha) << format;
    EXPECT_FALSE(s.film.half);
    if (to_lower_case(format).starts_with("rgb"))
      EXPECT_THAT(s.warnings, IsEmpty()) << format;
    else
      EXPECT_THAT(s.warnings, ElementsAre(AllOf(HasSubstr(format), HasSubstr("is written as rgb"))))
          << format;
  }
  EXPECT_TRUE(read("rgb", "float16").film.half);
  EXPECT_THAT(error(scene(film("hdrfilm", "<string name='pixel_format' value='cmyk'/>"))),
              AllOf(HasSubstr("scene.xml:2:"), HasSubstr("pixel_format"), HasSubstr("rgba")));
}

TEST_F(MitsubaRendering, Filters) {
  const auto filter = [&](const std::string& text) { return good(film("hdrfilm", text)).film; };
  const Film catmull = filter(plugin("rfilter", "catmullrom"));
  EXPECT_EQ(catmull.filter, FilterKind::kMitchell);
  EXPECT_EQ(catmull.filter_b, 0.0f);
  EXPECT_EQ(catmull.filter_c, 0.5f);
  EXPECT_EQ(catmull.filter_radius, 2.0f);
  const Film lanczos = filter(plugin("rfilter", "lanczos"));
  EXPECT_EQ(lanczos.filter, FilterKind::kLanczos);
  EXPECT_EQ(lanczos.filter_radius, 3.0f);
  EXPECT_EQ(filter(plugin("rfilter", "lanczos", "<integer name='lobes' value='2'/>")).filter_radius, 2.0f);
  EXPECT_EQ(filter(plugin("rfilter", "box", "<float name='radius' value='1'/>")).filter_radius, 1.0f);
  for (const char* lobes : {"0", "65"})
    EXPECT_THAT(
        error(scene(film("hdrfilm", plugin("rfilter", "lanczos",
                                           std::string("<integer name='lobes' value='") + lobes + "'/>")))),
        AllOf(HasSubstr("scene.xml:2:"), HasSubstr("lobes must be a")));
}

TEST_F(MitsubaRendering, PartsOfTheSensorMayBeReferredTo) {
  const SceneDescription s = good(
      "<sampler type='independent' id='s'><integer name='sample_count' value='8'/></sampler>"
      "<film type='hdrfilm' id='f'><integer name='width' value='30'/><ref id='r'/></film>"
      "<rfilter type='box' id='r'/><sensor type='perspective'><ref id='s'/><ref id='f'/></sensor>");
  EXPECT_EQ(s.sampler.spp, 8u);
  EXPECT_EQ(s.film.width, 30);
  EXPECT_EQ(s.film.filter, FilterKind::kBox);
}

TEST_F(MitsubaRendering, OfSeveralSensorsTheFirstIsRendered) {
  const SceneDescription s = good(
      "<sensor type='perspective'><float name='fov' value='20'/></sensor>"
      "<sensor type='spherical'/>");
  EXPECT_EQ(s.camera.fov, 20.0);
  EXPECT_THAT(s.warnings, ElementsAre(HasSubstr("the scene has 2 sensors; the first is rendered")));
}

TEST_F(MitsubaRendering, SamplesAreSpreadOverPixels) {
  EXPECT_THAT(good("<sensor type='perspective'><boolean name='jitter' value='true'/>"
                   "<float name='cone_scale' value='1'/></sensor>")
                  .warnings,
              IsEmpty());
  EXPECT_THAT(good("<sensor type='perspective'><boolean name='jitter' value='false'/></sensor>").warnings,
              ElementsAre(HasSubstr("spread over their pixels all the same")));
}

}  // namespace
}  // namespace penumbra
