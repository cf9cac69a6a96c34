// Spectra in Mitsuba's files: tables from files and plugins, black bodies, and colours in place of numbers.
// Expected colours are Mitsuba 3.9's (scalar_rgb).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scenes/scene_text.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class MitsubaSpectra : public SceneText {
 protected:
  static std::string sphere(const std::string& inside) {
    return "<shape type='sphere'>" + inside + "</shape>";
  }
  static std::string diffuse(const std::string& inside) {
    return sphere("<bsdf type='diffuse'>" + inside + "</bsdf>");
  }
  static std::string area_light(const std::string& inside) {
    return sphere("<emitter type='area'>" + inside + "</emitter>");
  }
  glm::vec3 reflectance(const std::string& inside) {
    return std::get<DiffuseBsdf>(good(diffuse(inside)).bsdfs.at(0).model).reflectance.value;
  }
  glm::vec3 radiance(const std::string& inside) { return *good(area_light(inside)).shapes.at(0).radiance; }
  void expect_near(glm::vec3 found, glm::vec3 wanted, float relative) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], wanted[i], relative * wanted[i]) << "channel " << i;
  }
};

const std::string kTable = "<spectrum name='reflectance' value='400:.1, 500:.2, 700:.3'/>";

TEST_F(MitsubaSpectra, TablesOfFiles) {
  write("a.spd", "# wavelength, value\n400 0.1\n\n500\t.2 # green\n700, .3\n");
  const glm::vec3 table = reflectance(kTable);
  expect_near(table, {0.268502f, 0.223359f, 0.143877f}, 3e-3f);
  EXPECT_EQ(reflectance("<spectrum name='reflectance' filename='a.spd'/>"), table);
  expect_near(radiance("<spectrum name='radiance' filename='a.spd'/>"), {0.319458f, 0.212586f, 0.12816f},
              3e-3f);
}

TEST_F(MitsubaSpectra, WhatIsWrongWithAFile) {
  const auto message = [&](const std::string& text) {
    write("a.spd", text);
    return error(scene(diffuse("<spectrum name='reflectance' filename='a.spd'/>")));
  };
  EXPECT_THAT(message("400 .1\n500 x\n"), AllOf(HasSubstr("a.spd:2:1"), HasSubstr("'x' is not a number")));
  EXPECT_THAT(message("400 .1 3\n"), AllOf(HasSubstr("a.spd:1:1"), HasSubstr("not 3 numbers")));
  EXPECT_THAT(message("400 .1\n  300 .2\n"),
              AllOf(HasSubstr("a.spd:2:3"), HasSubstr("must ascend; 300 follows 400")));
  EXPECT_THAT(message("# none\n400 .1\n"), AllOf(HasSubstr("a.spd"), HasSubstr("at least two wavelengths")));
  EXPECT_THAT(message("400 .1\n500 2\n"),
              AllOf(HasSubstr("scene.xml:2:"), HasSubstr("2 at 500 nm is not between")));
  EXPECT_THAT(message("400 .1\n500 nan\n"), HasSubstr("named at"));
  EXPECT_THAT(error(scene(diffuse("<spectrum name='reflectance' filename='none.spd'/>"))),
              AllOf(HasSubstr("scene.xml:2:"), HasSubstr("no file 'none.spd'")));
  EXPECT_THAT(error(scene(diffuse("<spectrum name='reflectance' value='1' filename='a.spd'/>"))),
              HasSubstr("a value or a filename, not both"));
}

TEST_F(MitsubaSpectra, PluginsAreTablesAndColours) {
  const auto plugin = [](const std::string& type, const std::string& inside) {
    return "<spectrum type='" + type + "' name='reflectance'>" + inside + "</spectrum>";
  };
  const glm::vec3 table = reflectance(kTable);
  EXPECT_EQ(reflectance(plugin("irregular",
                               "<string name='wavelengths' value='400, 500, 700'/>"
                               "<string name='values' value='.1, .2, .3'/>")),
            table);
  EXPECT_EQ(reflectance(plugin("regular",
                               "<float name='wavelength_min' value='400'/><float name='wavelength_max' "
                               "value='700'/><string name='values' value='.1 .2 .3'/>")),
            reflectance("<spectrum name='reflectance' value='400:.1, 550:.2, 700:.3'/>"));
  EXPECT_EQ(reflectance(plugin("uniform", "<float name='value' value='.25'/>")), glm::vec3(0.25f));
  EXPECT_EQ(reflectance(plugin("srgb", "<rgb name='color' value='.1 .2 .3'/>")), glm::vec3(0.1f, 0.2f, 0.3f));
  // Light that is uniform, or D65's, is white in Mitsuba's RGB modes.
  EXPECT_EQ(radiance("<spectrum type='d65' name='radiance'/>"), glm::vec3(1.0f));
  EXPECT_EQ(radiance("<spectrum type='d65' name='radiance'><rgb name='color' value='1 2 3'/>"
                     "<float name='scale' value='2'/></spectrum>"),
            glm::vec3(2.0f, 4.0f, 6.0f));
  EXPECT_EQ(radiance("<spectrum type='uniform' name='radiance'><float name='value' value='3'/></spectrum>"),
            glm::vec3(3.0f));
}

TEST_F(MitsubaSpectra, WhatIsWrongWithPlugins) {
  const auto message = [&](const std::string& type, const std::string& inside) {
    return error(
        scene(diffuse("<spectrum type='" + type + "' name='reflectance'>" + inside + "</spectrum>")));
  };
  const std::string waves = "<string name='wavelengths' value='400, 500'/>";
  EXPECT_THAT(message("irregular", waves), AllOf(HasSubstr("scene.xml:2:"), HasSubstr("\"values\"")));
  EXPECT_THAT(message("irregular", waves + "<string name='values' value='.1'/>"),
              HasSubstr("at least two numbers"));
  EXPECT_THAT(message("irregular", waves + "<string name='values' value='.1 .2 .3'/>"),
              HasSubstr("2 wavelengths and 3 values"));
  EXPECT_THAT(message("irregular", waves + "<string name='values' value='.1 2'/>"),
              AllOf(HasSubstr("scene.xml:2:"), HasSubstr("2 at 500 nm is not between 0 and 1")));
  EXPECT_THAT(
      message("irregular", "<string name='wavelengths' value='500 400'/><string name='values' value='0 0'/>"),
      HasSubstr("must ascend"));
  EXPECT_THAT(
      message("regular", "<float name='wavelength_min' value='900'/><string name='values' value='0 0'/>"),
      HasSubstr("wavelength_max must be more"));
  EXPECT_THAT(message("uniform", "<float name='value' value='2'/>"), HasSubstr("between 0 and 1, not 2"));
  EXPECT_THAT(message("uniform", "<float name='size' value='2'/>"), HasSubstr("has no parameter 'size'"));
  EXPECT_THAT(message("blackbody", "<float name='temperature' value='5000'/>"), HasSubstr("no reflectance"));
  EXPECT_THAT(message("measured", ""), HasSubstr("spectrum type 'measured' is not one that Penumbra reads"));
}

TEST_F(MitsubaSpectra, BlackBodies) {
  const glm::vec3 sun = radiance("<blackbody name='radiance' temperature='5000K'/>");
  EXPECT_EQ(radiance("<blackbody name='radiance' temperature='5000'/>"), sun);
  EXPECT_EQ(
      radiance(
          "<spectrum type='blackbody' name='radiance'><float name='temperature' value='5000'/></spectrum>"),
      sun);
  EXPECT_EQ(radiance("<blackbody name='radiance' temperature='5000' scale='0.5'/>"), 0.5f * sun);
  const auto message = [&](const std::string& attributes) {
    return error(scene(area_light("<blackbody name='radiance' " + attributes + "/>")));
  };
  EXPECT_THAT(message("temperature='hot'"),
              AllOf(HasSubstr("scene.xml:2:"), HasSubstr("'hot' is not a temperature")));
  EXPECT_THAT(message("temperature='-5'"), HasSubstr("'-5' is not a temperature"));
  EXPECT_THAT(message("scale='1'"), HasSubstr("a black body needs a temperature"));
  EXPECT_THAT(message("temperature='5000' scale='much'"), HasSubstr("must be a <float>"));
}

TEST_F(MitsubaSpectra, AColourForANumberIsItsMean) {
  const auto mask = [&](const std::string& opacity) {
    return std::get<MaskBsdf>(good(sphere("<bsdf type='mask'>" + opacity + "<bsdf type='diffuse'/></bsdf>"))
                                  .bsdfs.back()
                                  .model)
        .opacity.value;
  };
  EXPECT_NEAR(mask("<rgb name='opacity' value='.2 .5 .9'/>"), 1.6f / 3, 1e-6f);
  EXPECT_EQ(mask("<spectrum name='opacity' value='0.5'/>"), 0.5f);
  EXPECT_EQ(mask("<spectrum type='uniform' name='opacity'><float name='value' value='.75'/></spectrum>"),
            0.75f);
  const SceneDescription blender =
      good(sphere("<bsdf type='principled'><rgb name='spec_tint' value='1 1 1'/></bsdf>"));
  EXPECT_EQ(std::get<PrincipledBsdf>(blender.bsdfs.at(0).model).spec_tint.value, 1.0f);
  EXPECT_THAT(
      error(scene(sphere("<bsdf type='mask'><rgb name='opacity' value='2'/><bsdf type='diffuse'/></bsdf>"))),
      AllOf(HasSubstr("scene.xml:2:"), HasSubstr("not 2")));
  EXPECT_THAT(error(scene(sphere("<bsdf type='plastic'><rgb name='int_ior' value='2'/></bsdf>"))),
              HasSubstr("must be a <float>"));
}

TEST_F(MitsubaSpectra, IntentsAreOfNoMatter) {
  EXPECT_EQ(reflectance("<rgb name='reflectance' intent='reflectance' value='.1,.2,.3'/>"),
            glm::vec3(0.1f, 0.2f, 0.3f));
}

}  // namespace
}  // namespace penumbra
