// Cost of loading a scene lit by a large environment map, stage by stage: time, and bytes per texel. The map
// is a sky in half precision with a sun of a few texels, written as a temporary EXR file.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "scenes/device/device_scene_builder.h"
#include "scenes/scene_reader.h"
#include "tests/benchmarks/load_stages.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

/// Row by row, so that it is never there as a whole. False if it cannot be written.
bool write_sky(const std::filesystem::path& path, int width) {
  const int height = width / 2, sun_x = width / 3, sun_y = height / 4;
  auto output = OIIO::ImageOutput::create(path.string());
  OIIO::ImageSpec spec(width, height, 3, OIIO::TypeHalf);
  spec.attribute("compression", "zip");
  if (!output || !output->open(path.string(), spec)) return false;
  std::vector<float> row(std::size_t(width) * 3);
  for (int y = 0; y < height; ++y) {
    const auto up = float(std::cos(std::numbers::pi * y / height));
    for (int x = 0; x < width; ++x) {
      const bool sun = std::abs(x - sun_x) < 2 && std::abs(y - sun_y) < 2;
      const float cloud = 1 + 0.2f * float(std::sin(0.05 * x) * std::sin(0.03 * y));
      const float sky = (up > 0 ? 0.2f + up : 0.1f) * cloud;
      float* texel = row.data() + std::size_t(x) * 3;
      texel[0] = sun ? 6e4f : 0.5f * sky;
      texel[1] = sun ? 5e4f : 0.7f * sky;
      texel[2] = sun ? 4e4f : sky;
    }
    if (!output->write_scanline(y, 0, OIIO::TypeFloat, row.data())) return false;
  }
  return output->close();
}

}  // namespace
}  // namespace penumbra

// envmap_benchmark [WIDTH [FOLDER]]: the files stay in the folder, if one is given.
int main(int argc, char** argv) {
  using namespace penumbra;
  const int width = argc > 1 ? std::max(std::atoi(argv[1]), 4) : 16384;
  const TemporaryFolder temporary;
  const std::filesystem::path folder = argc > 2 ? std::filesystem::path(argv[2]) : temporary.path();
  if (!write_sky(folder / "sky.exr", width)) return fmt::print(stderr, "cannot write the map\n"), 1;
  write_text(folder / "sky.xml", R"(<scene version="3.0.0">
    <integrator type="path"/>
    <sensor type="perspective"><transform name="to_world">
      <lookat origin="0, 2, 8" target="0, 0.5, 0" up="0, 1, 0"/></transform>
      <film type="hdrfilm"><integer name="width" value="128"/><integer name="height" value="128"/></film></sensor>
    <emitter type="envmap"><string name="filename" value="sky.exr"/></emitter>
    <shape type="sphere"/>
    <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="10"/>
      <translate y="-1"/></transform></shape></scene>)");
  const double texels = double(width) * (width / 2);
  print_stage_heading("texel");
  SceneDescription description;
  DeviceScene built, shipped;
  std::vector<std::uint8_t> bytes;
  show_stage("scene", texels, [&] { description = value_or_exit(read_scene(folder / "sky.xml", {})); });
  show_stage("device scene", texels, [&] { built = value_or_exit(build_device_scene(description, {})); });
  description = {};
  fmt::print("  {:.1f} bytes a texel in tables\n", double(built.words.size()) * 4 / texels);
  show_stage("serialised", texels, [&] { bytes = built.serialize(); });
  built = {};
  show_stage("deserialised and checked", texels,
             [&] { shipped = value_or_exit(DeviceScene::deserialize(bytes)); });
}
