// Shapes as large, as small and as far away as single precision can trace: what can be rendered is correct,
// the rest is an error with its file position.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "scenes/device/device_scene_builder.h"
#include "tests/acceptance/media_pieces.h"
#include "tests/scenes/scene_text.h"

namespace penumbra::extreme_sizes_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Seen from outside under a sky of radiance 1, a convex diffuse surface of reflectance 0.5.
class ExtremeSizes : public SceneText {
 protected:
  static std::string shape(const std::string& type, const std::string& to_world) {
    return fmt::format(
        "<shape type='{}'><transform name='to_world'>{}</transform><bsdf type='twosided'><bsdf "
        "type='diffuse'>"
        "<rgb name='reflectance' value='0.5'/></bsdf></bsdf></shape>",
        type, to_world);
  }
  static std::string scaled(const std::string& type, double size) {
    return shape(type, fmt::format("<rotate x='1' y='0.3' angle='30'/><scale value='{}'/>", size));
  }
  /// Looking at the origin from five sizes away.
  static std::string view(double size, const std::string& more) {
    return fmt::format(
               "<integrator type='path'><integer name='max_depth' value='3'/></integrator>"
               "<sensor type='perspective'><float name='fov' value='2'/><float name='near_clip' value='{}'/>"
               "<float name='far_clip' value='3e38'/><transform name='to_world'>"
               "<lookat origin='0,0,{}' target='0,0,0' up='0,1,0'/></transform><sampler type='independent'>"
               "<integer name='sample_count' value='4096'/></sampler><film type='hdrfilm'><integer "
               "name='width' value='1'/>"
               "<integer name='height' value='1'/></film></sensor><emitter type='constant'/>",
               size * 1e-3, 5 * size) +
           more;
  }
  void expect_half(const std::string& content) { media::expect_colour(good(content), glm::dvec3(0.5), 1e-5); }
  std::string refusal(const std::string& content) {
    const auto read_scene = read(scene(content));
    if (!read_scene) return read_scene.error().message;
    const auto built = build_device_scene(*read_scene, {});
    return built ? "" : built.error().message;
  }
};

TEST_F(ExtremeSizes, AreRight) {
  for (const char* type : {"cube", "rectangle", "sphere", "disk"})
    for (const double size : {1e-9, 1e-6, 1.0, 1e6, 1e9}) {
      SCOPED_TRACE(::testing::Message() << type << " " << size);
      expect_half(view(size, scaled(type, size)));
    }
  for (const char* type : {"sphere", "disk"}) {
    SCOPED_TRACE(type);
    expect_half(view(1e17, scaled(type, 1e17)));
  }
}

TEST_F(ExtremeSizes, BeyondThemAreErrorsWithTheirPlace) {
  for (const char* type : {"cube", "rectangle"}) {
    EXPECT_THAT(refusal(view(1, scaled(type, 1e10))),
                AllOf(HasSubstr("scene.xml:2:"), HasSubstr("is too large for single precision")));
    EXPECT_THAT(refusal(view(1, scaled(type, 1e-12))),
                AllOf(HasSubstr("scene.xml:2:"), HasSubstr("is too small for single precision")));
    EXPECT_THAT(refusal(view(1, shape(type, "<translate x='1e13'/>"))),
                AllOf(HasSubstr("scene.xml:2:"), HasSubstr("is too far away for single precision")));
  }
  for (const char* type : {"sphere", "disk", "cylinder"}) {
    EXPECT_THAT(refusal(view(1, scaled(type, 1e19))),
                AllOf(HasSubstr("scene.xml:2:"), HasSubstr("is too far away or too large")));
    EXPECT_THAT(refusal(view(1, scaled(type, 1e-25))),
                AllOf(HasSubstr("scene.xml:2:"), HasSubstr("is too small for single precision")));
  }
  write("m.obj", "v 0 0 0\nv 1e-15 0 0\nv 0 1e-15 0\nf 1 2 3\n");
  EXPECT_THAT(refusal(view(1, "<shape type='obj'><string name='filename' value='m.obj'/></shape>")),
              AllOf(HasSubstr("scene.xml:2:"), HasSubstr("the mesh is too small")));
  // Of something larger it is a sliver, which is left out.
  write("m.obj", "v 0 0 0\nv 1e-15 0 0\nv 0 1e-15 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 4 5\n");
  const SceneDescription some =
      good(view(1, "<shape type='obj'><string name='filename' value='m.obj'/></shape>"));
  EXPECT_EQ(std::get<Mesh>(some.shapes.at(0).geometry).triangles.size(), 1u);
  EXPECT_THAT(some.warnings, ::testing::ElementsAre(HasSubstr("left out 1 triangle without area")));
}

// Whose boxes a library's builder would be given.
TEST_F(ExtremeSizes, InstancesBeyondThemAreErrors) {
  for (const char* far : {"1e13", "1e20", "1e38", "3e38"}) {
    const std::string instances = fmt::format(
        "<shape type='shapegroup' id='g'><shape type='cube'/></shape>"
        "<shape type='instance' id='near'><ref id='g'/></shape>"
        "<shape type='instance' id='far'><ref id='g'/><transform name='to_world'><translate "
        "x='{}'/></transform>"
        "</shape><shape type='instance' id='other'><ref id='g'/><transform name='to_world'>"
        "<translate y='-{}'/></transform></shape>",
        far, far);
    EXPECT_THAT(refusal(view(1, instances)), AllOf(HasSubstr("far"), HasSubstr("single precision reaches")))
        << far;
  }
}

}  // namespace
}  // namespace penumbra::extreme_sizes_test
