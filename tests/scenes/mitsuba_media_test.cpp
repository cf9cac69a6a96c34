// Conversion of Mitsuba's media, their phase functions and volpath, and the resulting tables.
#include <cstring>

#include "kernels/features.h"
#include "kernels/host/device_scene.h"
#include "scenes/device/device_scene_builder.h"
#include "tests/scenes/mitsuba_text.h"
#include "tests/support/written_scene.h"

namespace penumbra::mitsuba_media_test {
namespace {

const std::string kVolpath = "<integrator type='volpath'/>";
const std::string kNull = "<bsdf type='null'/>";

std::string number(const std::string& name, const std::string& value) {
  return "<float name='" + name + "' value='" + value + "'/>";
}
std::string rgb(const std::string& name, const std::string& value) {
  return "<rgb name='" + name + "' value='" + value + "'/>";
}
std::string medium(const std::string& content, const std::string& attributes = "name='interior'") {
  return "<medium type='homogeneous' " + attributes + ">" + content + "</medium>";
}
std::string hg(const std::string& g) { return in("phase", "hg", number("g", g)); }
std::string blend(const std::string& weight, const std::string& both) {
  return in("phase", "blendphase", number("weight", weight) + both);
}

class MitsubaMedia : public MitsubaPlugins {
 protected:
  ParticipatingMedium read_medium(const std::string& content) {
    const SceneDescription s = good(kVolpath + in("shape", "sphere", kNull + medium(content)));
    EXPECT_THAT(s.warnings, IsEmpty());
    EXPECT_THAT(s.media, SizeIs(1));
    return s.media.empty() ? ParticipatingMedium{} : s.media[0];
  }
  std::string wrong(const std::string& content) {
    return error(scene(kVolpath + in("shape", "sphere", kNull + medium(content))));
  }
  static DeviceScene device(const SceneDescription& scene) {
    auto built = build_device_scene(scene, {});
    EXPECT_TRUE(built) << built.error().message;
    if (!built) return {};
    const auto checked = check_device_scene(*built);
    EXPECT_TRUE(checked) << checked.error().message;
    return std::move(*built);
  }
};

TEST_F(MitsubaMedia, MayEmit) {
  const ParticipatingMedium m = read_medium(rgb("emission", "3 0 70") + number("scale", "2"));
  EXPECT_EQ(m.emission, glm::vec3(3, 0, 70)) << "which the scale does not multiply";
  EXPECT_EQ(m.extinction, glm::vec3(2.0f));
  EXPECT_FALSE(read_medium("").emits());
  // Spectra are those of lights: equal-energy white, not grey.
  const glm::vec3 white = read_medium("<spectrum name='emission' value='1'/>").emission;
  EXPECT_GT(white.x, 1.2f);
  EXPECT_THAT(wrong(rgb("emission", "-1 0 0")), HasSubstr("an emission must be 0 or more"));
  const SceneDescription s = good(kVolpath + in("shape", "sphere", kNull + medium(rgb("emission", "1 2 3"))));
  EXPECT_NE(device(s).header.features & FEATURE_EMITTING_MEDIA, 0u);
  const auto all =
      good_of(read(scene(kVolpath + in("shape", "sphere", kNull + medium(rgb("emission", "1 2 3"))))));
  EXPECT_THAT(warnings(all), Not(HasSubstr("nothing in the scene emits light")));
  const SceneDescription dark = good(kVolpath + in("shape", "sphere", kNull + medium("")));
  EXPECT_EQ(device(dark).header.features & FEATURE_EMITTING_MEDIA, 0u);
}

TEST_F(MitsubaMedia, CoefficientsInEveryForm) {
  const ParticipatingMedium plain = read_medium("");
  EXPECT_EQ(plain.extinction, glm::vec3(1.0f));
  EXPECT_EQ(plain.albedo, glm::vec3(0.75f));
  EXPECT_THAT(plain.phase, ElementsAre(PhaseLobe{PHASE_HG, 0, 1}));
  for (const std::string& content :
       {rgb("sigma_t", "1 2 4") + rgb("albedo", ".5 .25 1") + number("scale", "2"),
        rgb("sigmaT", "1 2 4") + rgb("albedo", ".5 .25 1") + number("scale", "2"),
        rgb("sigma_s", "1 1 8") + rgb("sigma_a", "1 3 0"),
        rgb("sigmaS", ".5 .5 4") + rgb("sigmaA", ".5 1.5 0") + number("scale", "2"),
        "<volume type='constvolume' name='sigma_t'>" + rgb("value", "2 4 8") + "</volume>" +
            "<volume type='constvolume' name='albedo'>" + rgb("value", ".5 .25 1") + "</volume>"}) {
    const ParticipatingMedium read = read_medium(content);
    EXPECT_EQ(read.extinction, glm::vec3(2, 4, 8)) << content;
    EXPECT_EQ(read.albedo, glm::vec3(0.5f, 0.25f, 1)) << content;
  }
  EXPECT_EQ(read_medium("<spectrum name='sigma_t' value='3'/>").extinction, glm::vec3(3));
  EXPECT_EQ(read_medium(number("sigma_t", "0")).extinction, glm::vec3(0));
  EXPECT_EQ(read_medium(rgb("sigma_s", "0") + rgb("sigma_a", "0")).albedo, glm::vec3(0));
}

TEST_F(MitsubaMedia, PhaseFunctionsAreMixturesOfLobes) {
  EXPECT_THAT(read_medium(in("phase", "isotropic")).phase, ElementsAre(PhaseLobe{PHASE_HG, 0, 1}));
  EXPECT_THAT(read_medium(in("phase", "rayleigh")).phase, ElementsAre(PhaseLobe{PHASE_RAYLEIGH, 0, 1}));
  EXPECT_THAT(read_medium(in("phase", "hg")).phase, ElementsAre(PhaseLobe{PHASE_HG, 0.8f, 1}));
  EXPECT_THAT(read_medium(hg("-.5")).phase, ElementsAre(PhaseLobe{PHASE_HG, -0.5f, 1}));
  EXPECT_THAT(read_medium(blend(".25", hg(".5") + in("phase", "rayleigh"))).phase,
              ElementsAre(PhaseLobe{PHASE_HG, 0.5f, 0.75f}, PhaseLobe{PHASE_RAYLEIGH, 0, 0.25f}));
  // Equal ones are one, and a share of 0 is none.
  EXPECT_THAT(read_medium(blend(".5", blend(".5", hg(".5") + hg("0")) + hg(".5"))).phase,
              ElementsAre(PhaseLobe{PHASE_HG, 0.5f, 0.75f}, PhaseLobe{PHASE_HG, 0, 0.25f}));
  EXPECT_THAT(read_medium(blend("1", hg(".5") + hg("0"))).phase, ElementsAre(PhaseLobe{PHASE_HG, 0, 1}));
}

TEST_F(MitsubaMedia, ErrorsSayWhatIsWrong) {
  EXPECT_THAT(wrong(number("sigma_t", "-1")),
              AllOf(HasSubstr("scene.xml:2:"), HasSubstr("sigma_t must be a colour, 0 or more, not -1")));
  EXPECT_THAT(wrong(rgb("albedo", "1.5 .5 .5")), HasSubstr("between 0 and 1, not 1.5"));
  EXPECT_THAT(wrong(number("scale", "-1")), HasSubstr("scale must be a number, 0 or more, not -1"));
  EXPECT_THAT(wrong(number("sigma_t", "1e30") + number("scale", "1e30")), HasSubstr("too large"));
  EXPECT_THAT(wrong(number("sigma_t", "nan")), HasSubstr("scene.xml:2:"));
  EXPECT_THAT(wrong(number("sigma_s", "1") + number("sigma_t", "1")), HasSubstr("either sigma_t and albedo"));
  EXPECT_THAT(wrong(number("sigma_s", "1")), HasSubstr("sigma_s and sigma_a go together"));
  EXPECT_THAT(wrong("<string name='material' value='skin1'/>"), HasSubstr("only files of version 0.x"));
  EXPECT_THAT(wrong(number("density", "1")), HasSubstr("has no parameter 'density'"));
  EXPECT_THAT(wrong(hg("1")), HasSubstr("g must be a number in (-1, 1), not 1"));
  EXPECT_THAT(wrong(hg("0.99999999999")), HasSubstr("in (-1, 1)"));
  EXPECT_THAT(wrong(in("phase", "sggx")),
              AllOf(HasSubstr("phase type 'sggx'"), HasSubstr("isotropic, hg, rayleigh, blendphase")));
  EXPECT_THAT(wrong(hg("0") + hg(".5")), HasSubstr("it takes one"));
  EXPECT_THAT(wrong(blend(".5", hg("0"))), HasSubstr("holds 2 phase functions, not 1"));
  EXPECT_THAT(wrong(blend("1.5", hg("0") + hg(".5"))), HasSubstr("not 1.5"));
  EXPECT_THAT(wrong(in("phase", "blendphase", hg("0") + hg(".5"))), HasSubstr("needs a weight"));
  EXPECT_THAT(
      wrong(blend(
          ".5", blend(".5", blend(".5", hg(".1") + hg(".2")) + blend(".5", hg(".3") + hg(".4"))) + hg(".5"))),
      HasSubstr("a mixture of 5 phase functions that differ; there may be 4"));
  EXPECT_THAT(wrong("<volume type='gridvolume' name='sigma_t'/>"),
              HasSubstr("'sigma_t' of medium 'homogeneous' takes no grid, only a constvolume"));
  EXPECT_THAT(wrong("<volume type='vdb' name='sigma_t'/>"),
              AllOf(HasSubstr("volume type 'vdb'"), HasSubstr("constvolume, gridvolume")));
  EXPECT_THAT(error(scene(kVolpath + in("shape", "sphere", "<medium type='fluorescent' name='interior'/>"))),
              AllOf(HasSubstr("medium type 'fluorescent'"), HasSubstr("homogeneous, heterogeneous")));
  EXPECT_THAT(error(scene(kVolpath + "<phase type='blendphase' id='p'>" + number("weight", ".5") +
                          "<ref id='p'/><ref id='p'/></phase>" + medium("<ref id='p'/>"))),
              HasSubstr("holds itself"));
}

TEST_F(MitsubaMedia, ShapesAndSensorsNameThem) {
  const SceneDescription s =
      good(kVolpath + medium("", "id='fog'") + medium(number("sigma_t", "2"), "id='unused'") +
           "<sensor type='perspective'><ref id='fog'/></sensor>" +
           in("shape", "sphere", kNull + medium(number("sigma_t", "3")) + "<ref name='exterior' id='fog'/>") +
           in("shape", "cube", kNull + "<ref name='interior' id='fog'/>") +
           in("emitter", "point", "<ref id='fog'/>") + in("shape", "cube"));
  EXPECT_THAT(s.warnings, IsEmpty());
  ASSERT_THAT(s.media, SizeIs(2));  // that which nothing names is left out
  EXPECT_EQ(s.media[0].name, "fog");
  EXPECT_EQ(s.media[1].extinction, glm::vec3(3));
  EXPECT_EQ(s.camera_medium, 0);
  EXPECT_EQ(s.shapes[0].interior, 1);
  EXPECT_EQ(s.shapes[0].exterior, 0);
  EXPECT_EQ(s.shapes[1].interior, 0);
  EXPECT_EQ(s.shapes[1].exterior, kNoMedium);
  EXPECT_EQ(s.shapes[2].interior, kNoMedium);
  const SceneDescription odd = good(kVolpath + in("shape", "sphere", medium("", "name='inside'")));
  EXPECT_EQ(odd.shapes[0].interior, kNoMedium);
  EXPECT_THAT(odd.warnings, ElementsAre(HasSubstr("unless it is named 'interior' or 'exterior'")));
}

TEST_F(MitsubaMedia, ABoundaryWithoutABsdfIsDiffuseOrInVersion0Nothing) {
  for (const std::string version : {"0.5.0", "0.6.0", "2.0.0", "3.0.0"}) {
    const auto s = read("<scene version='" + version + "'>" + kVolpath +
                        in("shape", "sphere", medium(number("sigma_t", "1") + number("albedo", ".5"))) +
                        "<sensor type='perspective'/></scene>");
    ASSERT_TRUE(s) << s.error().message;
    const BsdfModel& model = s->bsdfs.at(std::size_t(s->shapes[0].front_bsdf)).model;
    EXPECT_EQ(std::holds_alternative<NullBsdf>(model), version[0] == '0') << version;
  }
}

TEST_F(MitsubaMedia, OldFilesNameMaterials) {
  const auto old = [&](const std::string& content) {
    return "<scene version='0.5.0'>" + kVolpath + in("shape", "sphere", medium(content)) +
           "<sensor type='perspective'/></scene>";
  };
  // The sums of Jensen's coefficients.
  const auto extinction = [&](const std::string& content) {
    return good_of(read(old(content))).media.at(0).extinction;
  };
  EXPECT_EQ(extinction(""), glm::vec3(0.74f + 0.032f, 0.88f + 0.17f, 1.01f + 0.48f));
  const std::string milk = "<string name='material' value='wholeMilk'/>";
  EXPECT_EQ(extinction(milk + number("scale", "2")),
            2.0f * glm::vec3(2.55f + 0.0011f, 3.21f + 0.0024f, 3.77f + 0.014f));
  EXPECT_THAT(error(old(milk + number("sigma_t", "1"))), HasSubstr("either a material, or coefficients"));
  EXPECT_THAT(error(old("<string name='material' value='skin3'/>")),
              AllOf(HasSubstr("the scattering of 'skin3' is not known"), HasSubstr("Skin1")));
}

TEST_F(MitsubaMedia, OtherIntegratorsPassThroughThem) {
  const std::string ball = in("shape", "sphere", kNull + medium(""));
  const SceneDescription s = good("<integrator type='path'/>" + ball);
  EXPECT_THAT(s.warnings, ElementsAre(AllOf(HasSubstr("as if they were not there"), HasSubstr("volpath"))));
  EXPECT_THAT(s.media, SizeIs(1));
  EXPECT_EQ(device(s).header.tables.media.count, 0);
  // What would be an error is none where nothing sees it.
  EXPECT_THAT(good("<integrator type='path'/>" +
                   in("shape", "sphere", "<medium type='fluorescent' name='interior'/>"))
                  .media,
              IsEmpty());
  for (const char* type : {"volpath", "volpath_simple", "volpathmis", "volpath_mats", "prbvolpath"})
    EXPECT_TRUE(good(in("integrator", type) + ball).integrator.is<VolpathIntegrator>()) << type;
  const SceneDescription bdpt = good("<integrator type='bdpt'/>" + ball);
  EXPECT_TRUE(bdpt.integrator.is<VolpathIntegrator>());
  EXPECT_THAT(bdpt.warnings, ElementsAre(HasSubstr("volpath stands in for the integrator 'bdpt'")));
}

TEST_F(MitsubaMedia, VolpathWithoutMediaIsPath) {
  const std::string content =
      in("shape", "sphere") + in("shape", "cube", kNull) + in("shape", "rectangle", in("emitter", "area"));
  for (const auto& [volpath, path] : {std::pair("volpath", "path"), std::pair("volpath_mats", "path_mats"),
                                      std::pair("volpathmis", "path_mis")}) {
    const DeviceScene a = device(good(in("integrator", volpath) + content)),
                      b = device(good(in("integrator", path) + content));
    EXPECT_EQ(std::memcmp(&a.header, &b.header, sizeof(SceneHeader)), 0) << volpath;
    EXPECT_EQ(a.words, b.words);
    EXPECT_EQ(a.header.features & FEATURE_MEDIA, 0u);
  }
}

const std::string kNested =
    kVolpath + medium(hg(".5"), "id='fog'") + medium(number("sigma_t", "2") + hg(".5"), "id='smoke'") +
    "<sensor type='perspective'><ref id='fog'/></sensor>" + in("emitter", "point") +
    in("shape", "rectangle") +
    in("shape", "cube", kNull + "<ref name='interior' id='smoke'/><ref name='exterior' id='fog'/>") +
    in("shape", "sphere", kNull + medium(blend(".5", hg("0") + in("phase", "rayleigh")))) +
    in("shape", "sphere", kNull + "<ref name='exterior' id='fog'/>" + number("radius", "9"));

TEST_F(MitsubaMedia, TablesOfNestedMedia) {
  const DeviceScene d = device(good(kNested));
  const SceneHeader& h = d.header;
  EXPECT_EQ(h.features & (FEATURE_MEDIA | FEATURE_NESTED | FEATURE_TRANSMISSION),
            FEATURE_MEDIA | FEATURE_NESTED);
  EXPECT_NE(h.families & ONLY(PHASE), 0u);
  EXPECT_NE(h.features & FEATURE_MIXED_FAMILIES, 0u);
  EXPECT_EQ(h.camera_medium, 1);
  const auto media = table<Medium>(d, h.tables.media);
  ASSERT_EQ(media.size(), 4u);
  EXPECT_EQ(media[0].extinction.x, 0);
  EXPECT_EQ(media[2].extinction.y, 2);
  EXPECT_EQ(media[1].material, media[2].material);  // one phase function
  EXPECT_NE(media[1].material, media[3].material);
  const auto materials = table<Material>(d, h.tables.materials);
  const auto lobes = table<PhaseLobe>(d, h.tables.phase_lobes);
  ASSERT_EQ(lobes.size(), std::size_t(2 * PHASE_LOBES));
  const Material& m = materials[std::size_t(media[3].material)];
  EXPECT_EQ(m.family, FAMILY_PHASE);
  EXPECT_EQ(m.first_lobe, PHASE_LOBES);
  EXPECT_EQ(lobes[0].g, 0.5f);
  EXPECT_EQ(lobes[1].weight, 0);
  EXPECT_EQ(lobes[PHASE_LOBES + 1].kind, PHASE_RAYLEIGH);
  EXPECT_EQ(lobes[PHASE_LOBES + 1].weight, 0.5f);
  const auto boundaries = table<Boundary>(d, h.tables.boundaries);
  ASSERT_EQ(boundaries.size(), 3u);
  EXPECT_EQ(boundaries[0].interior, 2);
  EXPECT_EQ(boundaries[0].exterior, 1);
  EXPECT_EQ(boundaries[0].shape, 1);
  EXPECT_EQ(boundaries[1].interior, 3);
  EXPECT_EQ(boundaries[1].exterior, -1);
  EXPECT_EQ(boundaries[2].interior, 0);
  EXPECT_EQ(boundaries[2].exterior, 1);
  const auto primitives = table<int>(d, h.tables.primitive_boundaries);
  ASSERT_EQ(primitives.size(), 2u + 12u + 2u);
  EXPECT_EQ(primitives[1], -1);
  for (std::size_t i = 2; i < 14; ++i) EXPECT_EQ(primitives[i], 0);
  EXPECT_EQ(primitives[14], 1);
  EXPECT_EQ(primitives[15], 2);
}

TEST_F(MitsubaMedia, GroupsBoundMediaWhereTheyArePlaced) {
  const std::string group = "<shape type='shapegroup' id='g'>" + in("shape", "rectangle") +
                            in("shape", "cube", kNull + medium("")) + "</shape>";
  const std::string there = in("shape", "instance", "<ref id='g'/>");
  EXPECT_EQ(device(good(kVolpath + group + in("shape", "sphere"))).header.features & FEATURE_MEDIA, 0u);
  const DeviceScene d = device(good(kVolpath + group + there + there));
  const auto boundaries = table<Boundary>(d, d.header.tables.boundaries);
  ASSERT_EQ(boundaries.size(), 1u);
  EXPECT_EQ(boundaries[0].shape, 1);
  const auto primitives = table<int>(d, d.header.tables.primitive_boundaries);
  ASSERT_EQ(primitives.size(), 14u);
  EXPECT_EQ(primitives[0], -1);
  EXPECT_EQ(primitives[13], 0);
}

TEST_F(MitsubaMedia, EqualOnesAreOne) {
  const std::string thick = number("sigma_t", "2"), thin = number("sigma_t", "1");
  const DeviceScene d = device(good(
      kVolpath + in("shape", "cube", kNull + medium(thick)) +
      in("shape", "sphere",
         in("bsdf", "dielectric") + medium(thick, "name='exterior'") + medium(thin, "name='interior'"))));
  EXPECT_EQ(d.header.tables.media.count, 3) << "nothing, and two";
  const auto boundaries = table<Boundary>(d, d.header.tables.boundaries);
  ASSERT_EQ(boundaries.size(), 2u);
  EXPECT_EQ(boundaries[0].interior, boundaries[1].exterior);
  EXPECT_NE(boundaries[0].interior, boundaries[1].interior);
}

TEST_F(MitsubaMedia, NoMoreThanTheirNumbersCanSay) {
  SceneDescription s = good(kVolpath + in("shape", "sphere", kNull + medium("")));
  const auto add_until = [&](std::size_t count) {
    while (s.media.size() < count) {
      s.media.push_back(s.media[0]);
      s.media.back().extinction.x += float(s.media.size());
    }
  };
  add_until(254);
  EXPECT_EQ(device(s).header.tables.media.count, 255);
  s.media.push_back(s.media[7]);  // one that is there already
  EXPECT_EQ(device(s).header.tables.media.count, 255);
  s.media.pop_back();
  add_until(255);
  const auto built = build_device_scene(s, {});
  ASSERT_FALSE(built);
  EXPECT_THAT(built.error().message, HasSubstr("255 media, more than 254 that differ"));
}

TEST_F(MitsubaMedia, TablesThatAreWrongAreRefused) {
  const DeviceScene good_one = device(good(kNested));
  const auto refused = [&](const auto& change) {
    DeviceScene d = good_one;
    change(d);
    const auto checked = check_device_scene(d);
    return checked ? std::string() : checked.error().message;
  };
  const auto at = [](DeviceScene& d, const TableSpan& span, auto record) {
    return reinterpret_cast<decltype(record)*>(d.words.data() + span.offset);
  };
  EXPECT_EQ(refused([](DeviceScene&) {}), "");
  EXPECT_THAT(refused([&](DeviceScene& d) { d.header.camera_medium = 4; }), HasSubstr("the camera is in"));
  EXPECT_THAT(refused([&](DeviceScene& d) { d.header.tables.primitive_boundaries.count--; }),
              HasSubstr("boundaries do not match"));
  EXPECT_THAT(refused([&](DeviceScene& d) { at(d, d.header.tables.primitive_boundaries, int())[3] = 3; }),
              HasSubstr("names a boundary"));
  EXPECT_THAT(refused([&](DeviceScene& d) { at(d, d.header.tables.boundaries, Boundary())[0].interior = 4; }),
              HasSubstr("names a medium"));
  EXPECT_THAT(refused([&](DeviceScene& d) { at(d, d.header.tables.media, Medium())[1].extinction.x = -1; }),
              HasSubstr("extinction"));
  EXPECT_THAT(refused([&](DeviceScene& d) { at(d, d.header.tables.media, Medium())[1].albedo.z = NAN; }),
              HasSubstr("albedo"));
  EXPECT_THAT(refused([&](DeviceScene& d) { at(d, d.header.tables.media, Medium())[1].material = 0; }),
              HasSubstr("without a phase function"));
  EXPECT_THAT(refused([&](DeviceScene& d) { at(d, d.header.tables.phase_lobes, PhaseLobe())[0].g = 1; }),
              HasSubstr("implausible lobes"));
  EXPECT_THAT(refused([&](DeviceScene& d) { d.header.tables.phase_lobes.count--; }),
              HasSubstr("lobes that are not there"));
  EXPECT_THAT(refused([&](DeviceScene& d) { d.header.features &= ~std::uint64_t(FEATURE_MEDIA); }),
              HasSubstr("media without their feature bit"));
}

TEST_F(MitsubaMedia, WrittenAndReadAgainTheyAreTheSame) {
  const SceneDescription s =
      good(kNested +
           in("shape", "disk",
              kNull + medium(rgb("sigma_t", "3 1 .1") + rgb("albedo", ".1 .2 .3") +
                             blend(".25", blend(".5", hg(".5") + hg("-.25")) + in("phase", "isotropic")))));
  const auto written = write_scene(s, folder_ / "written.xml");
  ASSERT_TRUE(written) << written.error().message;
  const auto again = read_scene(folder_ / "written.xml", {});
  ASSERT_TRUE(again) << again.error().message;
  const DeviceScene a = device(s), b = device(*again);
  EXPECT_EQ(std::memcmp(&a.header, &b.header, sizeof(SceneHeader)), 0);
  const std::size_t media = std::size_t(a.header.tables.media.count);
  ASSERT_EQ(std::size_t(b.header.tables.media.count), media);
  ASSERT_EQ(s.media.size(), again->media.size());
  EXPECT_EQ(a.words, b.words);
}

}  // namespace
}  // namespace penumbra::mitsuba_media_test
