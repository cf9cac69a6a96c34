// Polygon lights in Mitsuba XML: their integrators, the parameters of each, and the sampling of emitters.
#include <gmock/gmock.h>

#include "scenes/settings.h"
#include "tests/scenes/scene_text.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using enum IntegratorKind;

class MitsubaPolygonLights : public SceneText {
 protected:
  static std::string text(std::string_view type, std::string_view inside) {
    return "<integrator type='" + std::string(type) + "'>\n" + std::string(inside) + "</integrator>";
  }
  IntegratorSettings integrator(std::string_view type, std::string_view inside = "") {
    return good(text(type, inside)).integrator;
  }
  std::string wrong(std::string_view type, std::string_view inside) {
    return error(scene(text(type, inside)));
  }
  static std::string square(std::string_view emitter) {
    return "<shape type='rectangle'>\n" + std::string(emitter) + "</shape>";
  }
};

std::string parameter(const std::string& tag, const std::string& name, const std::string& value) {
  return "<" + tag + " name='" + name + "' value='" + value + "'/>";
}
std::string emitter(const std::string& inside) { return "<emitter type='area'>" + inside + "</emitter>"; }

// --- integrators

/// "max_depth=3 …".
std::string print_parameters(const IntegratorSettings& integrator) {
  RenderSettings settings;
  settings.integrator = integrator;
  std::string text;
  for (const Setting& each : all_settings())
    if (each.key.starts_with("integrator.") && each.print && each.belongs_to(settings))
      text += each.name() + "=" + each.print(settings) + " ";
  return text;
}

TEST_F(MitsubaPolygonLights, Defaults) {
  const std::pair<const char*, IntegratorKind> kinds[] = {{"polygon_analytic", kPolygonAnalytic},
                                                          {"polygon_area", kPolygonArea},
                                                          {"polygon_cv", kPolygonCv},
                                                          {"path", kPath},
                                                          {"direct", kDirect}};
  for (const auto& [name, kind] : kinds) {
    const IntegratorSettings settings = integrator(name);
    EXPECT_EQ(kind_of(settings), kind);
    IntegratorSettings defaults = integrator_of(kind);
    defaults.hidden_emitters = HiddenEmitters::kLookedThrough;  // as files of version 3 have it
    EXPECT_EQ(print_parameters(settings), print_parameters(defaults)) << name;
  }
}

TEST_F(MitsubaPolygonLights, EveryParameterArrives) {
  EXPECT_TRUE(integrator("polygon_analytic", parameter("boolean", "hide_emitters", "true")).hide_emitters);

  const IntegratorSettings area = integrator(
      "polygon_area",
      parameter("integer", "emitter_samples", "6") + parameter("string", "emitter_sampling", "projected") +
          parameter("string", "light_choice", "analytic") + parameter("boolean", "trace_shadows", "false") +
          parameter("boolean", "hide_emitters", "true"));
  EXPECT_EQ(kind_of(area), kPolygonArea);
  EXPECT_EQ(param::emitter_samples(area), 6);
  EXPECT_EQ(param::emitter_sampling(area), EmitterSampling::kProjected);
  EXPECT_EQ(param::light_choice(area), LightChoice::kAnalytic);
  EXPECT_FALSE(param::trace_shadows(area));
  EXPECT_TRUE(area.hide_emitters);

  const IntegratorSettings cv = integrator(
      "polygon_cv", parameter("float", "alpha", "0.75") + parameter("integer", "vis_samples", "9") +
                        parameter("string", "emitter_sampling", "solid_angle") +
                        parameter("string", "light_choice", "power"));
  EXPECT_EQ(kind_of(cv), kPolygonCv);
  EXPECT_EQ(param::alpha(cv), 0.75f);
  EXPECT_EQ(param::vis_samples(cv), 9);
  EXPECT_EQ(param::emitter_sampling(cv), EmitterSampling::kSolidAngle);
  EXPECT_EQ(param::light_choice(cv), LightChoice::kPower);

  for (const char* type : {"path", "path_ems", "path_mis"}) {
    const IntegratorSettings path =
        integrator(type, parameter("string", "nee", "cv") + parameter("float", "alpha", "-0.5") +
                             parameter("string", "light_choice", "auto"));
    EXPECT_EQ(kind_of(path), kPath);
    EXPECT_EQ(param::next_event(path), NextEvent::kCv) << type;
    EXPECT_EQ(param::alpha(path), -0.5f);
    EXPECT_EQ(param::next_event(integrator(type, parameter("string", "nee", "sample"))), NextEvent::kSample);
  }
  const IntegratorSettings direct = integrator("direct", parameter("integer", "bsdf_samples", "0") +
                                                             parameter("string", "light_choice", "analytic") +
                                                             parameter("boolean", "trace_shadows", "false"));
  EXPECT_EQ(param::light_choice(direct), LightChoice::kAnalytic);
  EXPECT_FALSE(param::trace_shadows(direct));
}

TEST_F(MitsubaPolygonLights, CamelCaseIsTheSame) {
  const IntegratorSettings cv = integrator(
      "polygon_cv", parameter("integer", "visSamples", "3") + parameter("string", "lightChoice", "power"));
  EXPECT_EQ(param::vis_samples(cv), 3);
  EXPECT_EQ(param::light_choice(cv), LightChoice::kPower);
  EXPECT_FALSE(
      param::trace_shadows(integrator("polygon_area", parameter("boolean", "traceShadows", "false"))));
}

TEST_F(MitsubaPolygonLights, AlphaIsANumberOfAnyTagOrAuto) {
  const std::pair<std::string, std::optional<float>> values[] = {
      {parameter("float", "alpha", "1"), 1.0f},
      {parameter("float", "alpha", "1e6"), 1e6f},
      {parameter("integer", "alpha", "-3"), -3.0f},
      {parameter("string", "alpha", "0.5"), 0.5f},
      {parameter("string", "alpha", "auto"), std::nullopt}};
  for (const auto& [inside, alpha] : values)
    EXPECT_EQ(param::alpha(integrator("polygon_cv", inside)), alpha) << inside;
}

TEST_F(MitsubaPolygonLights, DefinesReachTheirParameters) {
  const std::string content =
      "<default name='a' value='auto'/><default name='n' value='2'/>" +
      text("polygon_cv", parameter("string", "alpha", "$a") + parameter("integer", "vis_samples", "$n"));
  EXPECT_EQ(param::alpha(good(content).integrator), std::nullopt);
  const SceneDescription changed = good(content, {.defines = {{"a", "0.25"}, {"n", "8"}}});
  EXPECT_EQ(param::alpha(changed.integrator), 0.25f);
  EXPECT_EQ(param::vis_samples(changed.integrator), 8);
}

struct WrongParameter {
  const char *type, *tag, *name, *value, *message;
};

TEST_F(MitsubaPolygonLights, WrongValuesSayWhereAndWhatWouldBeRight) {
  const WrongParameter cases[] = {
      {"polygon_cv", "float", "alpha", "1000001", "alpha: 1000001 is not between -1000000 and 1000000"},
      {"polygon_cv", "string", "alpha", "automatic", "nor is it 'auto'"},
      {"polygon_cv", "string", "alpha", "", "nor is it 'auto'"},
      {"polygon_cv", "boolean", "alpha", "true",
       "the parameter 'alpha' of integrator 'polygon_cv' must be a <float> or <string>, not a <boolean>"},
      {"polygon_cv", "integer", "vis_samples", "0", "vis_samples: '0' is not in the range from 1 to 65536"},
      {"polygon_cv", "integer", "vis_samples", "65537", "from 1 to 65536"},
      {"polygon_cv", "float", "vis_samples", "2", "must be a <integer>, not a <float>"},
      {"polygon_cv", "string", "light_choice", "analytical",
       "light_choice: 'analytical' is not one of: auto, power, analytic, tree; did you mean 'analytic'?"},
      {"polygon_cv", "string", "emitter_sampling", "cosine",
       "emitter_sampling: 'cosine' is not one of: auto, area, solid_angle, projected"},
      {"polygon_area", "boolean", "trace_shadows", "1", "'1' is neither true nor false"},
      {"polygon_area", "string", "trace_shadows", "true", "must be a <boolean>, not a <string>"},
      {"polygon_area", "integer", "emitter_samples", "0", "integrator 'polygon_area' needs emitter_samples"},
      {"polygon_area", "integer", "emitter_samples", "-1", "emitter_samples: '-1' is not in the range"},
      {"path", "string", "nee", "control", "nee: 'control' is not one of: sample, cv"},
      {"path_mats", "string", "nee", "cv",
       "integrator 'path' with nee = cv samples emitters, which direct_sampling = mats forbids"}};
  for (const WrongParameter& tested : cases) {
    const std::string message = wrong(tested.type, parameter(tested.tag, tested.name, tested.value));
    EXPECT_THAT(message, AllOf(StartsWith("scene.xml:"), HasSubstr("error: "), HasSubstr(tested.message)));
  }
  // The place is that of the value.
  EXPECT_THAT(wrong("polygon_cv", "\n  " + parameter("string", "light_choice", "x")),
              StartsWith("scene.xml:4:38: error: light_choice: 'x' is not one of"));
}

TEST_F(MitsubaPolygonLights, ParametersOfOthersAreErrors) {
  const std::pair<const char*, std::string> cases[] = {
      {"polygon_analytic", parameter("float", "alpha", "1")},
      {"polygon_analytic", parameter("integer", "vis_samples", "1")},
      {"polygon_analytic", parameter("boolean", "trace_shadows", "false")},
      {"polygon_area", parameter("float", "alpha", "1")},
      {"polygon_area", parameter("integer", "vis_samples", "1")},
      {"polygon_area", parameter("string", "nee", "cv")},
      {"polygon_cv", parameter("integer", "emitter_samples", "1")},
      {"polygon_cv", parameter("integer", "bsdf_samples", "1")},
      {"polygon_cv", parameter("boolean", "trace_shadows", "false")},
      {"polygon_cv", parameter("string", "nee", "cv")},
      {"polygon_cv", parameter("integer", "max_depth", "3")},
      {"direct", parameter("float", "alpha", "1")},
      {"direct", parameter("string", "nee", "cv")},
      {"path", parameter("integer", "vis_samples", "1")},
      {"path", parameter("boolean", "trace_shadows", "false")}};
  for (const auto& [type, inside] : cases) {
    EXPECT_THAT(wrong(type, inside),
                AllOf(StartsWith("scene.xml:3:"), HasSubstr("integrator '" + std::string(type) + "' has no "),
                      HasSubstr("It has: "), HasSubstr("hide_emitters")))
        << inside;
  }
  EXPECT_THAT(wrong("polygon_cvs", ""), AllOf(HasSubstr("did you mean 'polygon_cv'?"),
                                              HasSubstr("polygon_analytic, polygon_area, polygon_cv")));
}

// --- emitters

TEST_F(MitsubaPolygonLights, HowAnEmitterIsSampled) {
  const std::pair<const char*, EmitterSampling> samplings[] = {{"auto", EmitterSampling::kAuto},
                                                               {"area", EmitterSampling::kArea},
                                                               {"solid_angle", EmitterSampling::kSolidAngle},
                                                               {"projected", EmitterSampling::kProjected}};
  EXPECT_EQ(good(square(emitter(""))).shapes.at(0).sampling, EmitterSampling::kAuto);
  for (const auto& [name, sampling] : samplings)
    EXPECT_EQ(good(square(emitter(parameter("string", "sampling", name)))).shapes.at(0).sampling, sampling);
  EXPECT_THAT(error(scene(square(emitter(parameter("string", "sampling", "solidangle"))))),
              AllOf(StartsWith("scene.xml:3:"),
                    HasSubstr("'solidangle' is not one of: auto, area, solid_angle, projected"),
                    HasSubstr("did you mean 'solid_angle'?")));
  EXPECT_THAT(error(scene(square(emitter(parameter("integer", "sampling", "1"))))),
              HasSubstr("must be a <string>, not a <integer>"));
}

TEST_F(MitsubaPolygonLights, TwoSides) {
  const std::string both = emitter(parameter("boolean", "two_sided", "true"));
  EXPECT_FALSE(good(square(emitter(""))).shapes.at(0).two_sided_emission);
  EXPECT_TRUE(good(square(both)).shapes.at(0).two_sided_emission);
  EXPECT_TRUE(
      good(square(emitter(parameter("boolean", "twoSided", "true")))).shapes.at(0).two_sided_emission);
  EXPECT_TRUE(good("<shape type='disk'>" + both + "</shape>").shapes.at(0).two_sided_emission);
  EXPECT_THAT(error(scene("\n<shape type='sphere'>" + both + "</shape>")),
              AllOf(StartsWith("scene.xml:3:"), HasSubstr("a sphere emits to one side")));
  EXPECT_THAT(error(scene(square(emitter(parameter("boolean", "two_sided", "both"))))),
              AllOf(StartsWith("scene.xml:3:"), HasSubstr("'both' is neither true nor false")));
  EXPECT_THAT(error(scene(square(emitter(parameter("boolean", "both_sides", "true"))))),
              AllOf(HasSubstr("emitter 'area' has no parameter 'both_sides'"), HasSubstr("two_sided"),
                    HasSubstr("sampling"), Not(HasSubstr("did you mean 'radiance'"))));
}

}  // namespace
}  // namespace penumbra
