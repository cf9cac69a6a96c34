// Blender's glTF exports against Cycles' renders. PENUMBRA_BLENDER_PYTHON names a Python that has bpy:
// `python3.11 -m venv blender && blender/bin/pip install bpy`.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <ostream>
#include <string>
#include <variant>
#include <vector>

#include "scenes/bsdfs.h"
#include "scenes/settings.h"
#include "scheduler/image/image.h"
#include "tests/support/render_scene.h"
#include "tests/support/statistics.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::differential {
namespace {

using statistics::Image;
using statistics::Sample;

/// Cycles' renders of each scene, of other seeds, and samples per pixel of each.
constexpr int kBatches = 8, kSpp = 32;
/// Means may differ by this, and by noise that a scene of equal means exceeds once in a hundred times.
constexpr double kTolerance = 0.02, kSignificance = 0.01;

/// Why there is nothing to compare with; empty: there is. `scenes`: an argument of render_with_blender.py.
std::string make_scenes(const std::filesystem::path& folder, const std::string& scenes) {
  const char* python = std::getenv("PENUMBRA_BLENDER_PYTHON");
  if (python == nullptr || *python == '\0')
    return "PENUMBRA_BLENDER_PYTHON does not name a Python that has Blender (pip install bpy)";
  const std::string command =
      fmt::format("'{}' '{}/tests/differential/render_with_blender.py' '{}' '{}' {} {} > '{}/log' 2>&1",
                  python, PENUMBRA_SOURCE_DIR, folder.string(), scenes, kBatches, kSpp, folder.string());
  if (std::system(command.c_str()) != 0) ADD_FAILURE() << file_contents(folder / "log");
  return "";
}

std::vector<Image> cycles_images(const std::filesystem::path& folder, int scene) {
  std::vector<Image> batches;
  for (int batch = 0; batch < kBatches; ++batch) {
    const auto image = read_image(folder / fmt::format("{}.{}.exr", scene, batch));
    if (!image) throw std::runtime_error(image.error().message);
    const auto channels = image->beauty_channels();
    if (!channels) throw std::runtime_error("Cycles' image has no R, G, B");
    Image& each = batches.emplace_back(image->data.width, image->data.height, 3);
    for (int y = 0; y < each.height; ++y)
      for (int x = 0; x < each.width; ++x)
        for (int c = 0; c < 3; ++c) each.at(x, y, c) = double(image->at(x, y, (*channels)[std::size_t(c)]));
  }
  return batches;
}

/// The scene as it is read, but for what glTF does not say.
SceneDescription exported(const std::filesystem::path& folder, int scene, const Image& like) {
  SceneDescription description = read_or_throw(folder / fmt::format("{}.glb", scene));
  resize_film(description, like.width, like.height);
  description.film.filter = FilterKind::kBox;
  description.film.filter_radius = 0.5f;
  description.sampler.spp = kBatches * kSpp;
  EXPECT_TRUE(apply_setting(description, "integrator.max_depth", "65"));
  return description;
}

/// Bounds of our mean over Cycles'.
struct Ratios {
  double lowest = 1, highest = 1;
};

/// A part of the picture: where `contains` says so, of a picture 2 high whose middle is 0.
struct Part {
  const char* name;
  bool (*contains)(double across, double up);
  Ratios ratios{};
};

struct Pixel {
  int x, y;
};
std::vector<Pixel> pixels_of(const Part& part, int width, int height) {
  std::vector<Pixel> pixels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (part.contains((2 * x + 1.0 - width) / height, (height - 1.0 - 2 * y) / height))
        pixels.push_back({x, y});
  return pixels;
}

/// Our mean of these pixels, which are independent.
Sample our_mean(const FilmAccumulator& film, const std::vector<Pixel>& pixels, int channel) {
  const double count = double(pixels.size()), values = count * kBatches * kSpp;
  double mean = 0, variance = 0;
  for (const Pixel& at : pixels) {
    const Sample pixel = pixel_sample(film, film.x() + at.x, film.y() + at.y, channel);
    mean += pixel.mean() / count;
    variance += std::pow(pixel.standard_error() / count, 2);
  }
  return {std::uint64_t(values), mean, variance * values * (values - 1)};
}

/// Cycles' mean, by its batches.
Sample cycles_mean(const std::vector<Image>& batches, const std::vector<Pixel>& pixels, int channel) {
  Sample means;
  for (const Image& batch : batches) {
    double mean = 0;
    for (const Pixel& at : pixels) mean += batch.at(at.x, at.y, channel) / double(pixels.size());
    means.add(mean);
  }
  return means;
}

/// Whether the parts' means, over Cycles', are within their bounds, up to kTolerance and noise. `tests`: how
/// many means share kSignificance.
void expect_means(const SceneDescription& scene, const std::vector<Image>& theirs,
                  const std::vector<Part>& parts, std::size_t tests) {
  const FilmAccumulator film = render_or_throw(scene);
  for (const Part& part : parts)
    for (int channel = 0; channel < 3; ++channel) {
      const auto pixels = pixels_of(part, film.width(), film.height());
      const Sample a = our_mean(film, pixels, channel), b = cycles_mean(theirs, pixels, channel);
      const double ratio = a.mean() / b.mean();
      const double nearest = std::clamp(ratio, part.ratios.lowest, part.ratios.highest);
      const Sample bound(b.count(), nearest * b.mean(),
                         nearest * nearest * b.variance() * double(b.count() - 1));
      EXPECT_GT(statistics::welch_t_test(a, bound, kTolerance * bound.mean()).p,
                statistics::sidak_significance(kSignificance, tests))
          << fmt::format("{}, channel {}: {:.4f} of Cycles' mean; standard errors of {:.4f} and {:.4f}",
                         part.name, channel, ratio, a.standard_error() / a.mean(),
                         b.standard_error() / b.mean());
    }
}

const std::vector<Part> kQuarters = {{"left above", [](double x, double y) { return x < 0 && y > 0; }},
                                     {"right above", [](double x, double y) { return x > 0 && y > 0; }},
                                     {"left below", [](double x, double y) { return x < 0 && y < 0; }},
                                     {"right below", [](double x, double y) { return x > 0 && y < 0; }}};

TEST(Blender, PlasticsAreAsBright) {
  const TemporaryFolder folder;
  if (const std::string why = make_scenes(folder.path(), "plastics"); !why.empty()) GTEST_SKIP() << why;
  const std::vector<Image> theirs = cycles_images(folder.path(), 0);
  expect_means(exported(folder.path(), 0, theirs.front()), theirs, kQuarters, 3 * kQuarters.size());
}

using Value = std::array<double, 3>;  ///< a colour, or a number thrice

/// Inputs of the Principled BSDF of a sphere and a plane, one of which takes on five values.
struct PrincipledInput {
  const char* name;
  const char* others;  ///< the other inputs, in JSON, see render_with_blender.py
  std::vector<Value> values;
  /// Why what Blender's file says is not what Cycles renders.
  const char* reason = "";
  /// Makes our surface what Cycles renders.
  void (*as_cycles)(OpenPbrBsdf&, SurfaceBend&, const Value&) = nullptr;
  /// Otherwise what the reason makes of the means.
  Ratios sphere{}, plane{};
};

void PrintTo(const PrincipledInput& input, std::ostream* out) { *out << input.name << ' ' << input.others; }

std::vector<Value> numbers(const std::array<double, 5>& values) {
  std::vector<Value> result;
  for (const double value : values) result.push_back({value, value, value});
  return result;
}
const std::vector<Value> kShares = numbers({0, 0.25, 0.5, 0.75, 1});
const std::vector<Value> kColours{
    {0.01, 0.01, 0.01}, {1, 0.2, 0.1}, {0.2, 0.5, 0.9}, {0.7, 0.7, 0.7}, {1, 1, 1}};

/// The scene's inputs, in JSON. Names of colours that end so have a fourth number.
std::string inputs_of(const PrincipledInput& input, const Value& value) {
  const std::string name = input.name, others = input.others;
  const bool colour = name.ends_with("Color") || name.ends_with("Tint");
  return fmt::format(
      R"({{"{}": {}{}{}}})", name,
      colour ? fmt::format("[{}, {}, {}, 1]", value[0], value[1], value[2]) : fmt::format("{}", value[0]),
      others.empty() ? "" : ", ", others);
}

// Files are those of Cycles, in intern/cycles/kernel of Blender. Bounds that are not derived were measured.
constexpr const char* kMasks =
    "Cycles scales a metal's lobe by what it loses, and masks both directions together "
    "(closure/bsdf_microfacet.h); we mask each, as appendix B.3.2 of glTF, and add a wide lobe (Kulla and "
    "Conty 2017). By quadrature of both over the plane that is 1.033 in red, at a roughness of 1";
constexpr const char* kOpenGlass =
    "all behind the plane is inside the glass, where radiance is divided by the squared index when seen from "
    "outside, except in Cycles. Rough facets are masked as those of metals";
constexpr const char* kSheen =
    "Cycles' sheen is that of Zeltner, Burley and Chiang 2022 (closure/bsdf_sheen.h), as ours without glTF's "
    "flag; KHR_materials_sheen is that of Estevez and Kulla 2017; and Blender exports no weight but 0";

const std::vector<PrincipledInput> kInputs{
    {"Base Color", "", kColours},
    {"Metallic", "", kShares},
    {"Roughness", "", numbers({0.1, 0.25, 0.5, 0.75, 1})},
    {"Roughness",
     R"("Metallic": 1)",
     numbers({0.1, 0.25, 0.5, 0.75, 1}),
     kMasks,
     nullptr,
     {0.97, 1},
     {1, 1.033}},
    {"IOR", "", numbers({1.1, 1.33, 1.5, 1.8, 2.5}),
     "Blender exports it with KHR_materials_specular or _transmission alone",
     [](OpenPbrBsdf& b, SurfaceBend&, const Value& value) { b.specular_ior = float(value[0]); }},
    {"Alpha", "", kShares},
    {"Specular IOR Level", "", kShares},
    {"Specular Tint", "", kColours},
    {"Specular Tint", R"("Metallic": 1)", kColours, "glTF's metals have no such tint",
     [](OpenPbrBsdf& b, SurfaceBend&, const Value& value) {
       b.specular_color.value = glm::vec3(value[0], value[1], value[2]);
     }},
    {"Anisotropic",
     R"("Metallic": 1, "Tangent": "UV")",
     kShares,
     "glTF's number makes other roughnesses than Cycles' (svm/closure.h), and Cycles takes what "
     "facets lose from a roughness in between, which is less",
     [](OpenPbrBsdf& b, SurfaceBend&, const Value& value) {
       const double alpha = 0.16, aspect = std::sqrt(1 - 0.9 * value[0]);
       const OpenPbrRoughness both = along_and_across(alpha / aspect, alpha * aspect);
       b.gltf = false;
       b.specular_roughness.value = both.roughness;
       b.specular_anisotropy = both.anisotropy;
     },
     {1, 1.1}},
    {"Anisotropic Rotation",
     R"("Metallic": 1, "Anisotropic": 0.8, "Tangent": "UV")",
     numbers({0, 0.1, 0.25, 0.4, 0.5}),
     "as above",
     [](OpenPbrBsdf& b, SurfaceBend&, const Value&) {
       const double alpha = 0.16, aspect = std::sqrt(1 - 0.9 * 0.8);
       const OpenPbrRoughness both = along_and_across(alpha / aspect, alpha * aspect);
       b.gltf = false;
       b.specular_roughness.value = both.roughness;
       b.specular_anisotropy = both.anisotropy;
     },
     {1, 1.1},
     {1, 1.1}},
    {"Transmission Weight",
     R"("Base Color": [0.9, 0.9, 0.9, 1], "Thickness": 1)",
     kShares,
     "Cycles meets the opaque share from inside, too; OpenPBR's inside only transmits",
     nullptr,
     {0.78, 1},
     {1 / 2.25, 1}},
    {"Roughness",
     R"("Transmission Weight": 1, "Base Color": [1, 1, 1, 1], "Thickness": 1)",
     numbers({0.05, 0.2, 0.4, 0.7, 1}),
     kOpenGlass,
     nullptr,
     {0.9, 1},
     {1 / 2.25, 1}},
    {"IOR",
     R"("Transmission Weight": 1, "Base Color": [1, 1, 1, 1], "Thickness": 1)",
     numbers({1.1, 1.33, 1.5, 1.8, 2.5}),
     kOpenGlass,
     nullptr,
     {1, 1},
     {1 / 6.25, 1}},
    {"Coat Weight", R"("Roughness": 0.6, "Coat Roughness": 0.1)", kShares},
    {"Coat Weight", R"("Metallic": 1, "Coat Roughness": 0.1)", kShares},
    {"Coat Roughness",
     R"("Coat Weight": 1)",
     numbers({0.05, 0.2, 0.4, 0.7, 1}),
     "Blender 4.2 gives less to what is below a rough coat: 0.97 of Blender 5.0",
     nullptr,
     {1, 1.03},
     {1, 1.03}},
    {"Sheen Weight", R"("Sheen Roughness": 0.5)", kShares, kSheen,
     [](OpenPbrBsdf& b, SurfaceBend&, const Value& value) {
       b.gltf = false;
       b.fuzz_weight.value = float(value[0]);
     }},
    {"Sheen Roughness", R"("Sheen Weight": 1)", numbers({0.1, 0.3, 0.5, 0.7, 1}), kSheen,
     [](OpenPbrBsdf& b, SurfaceBend&, const Value&) { b.gltf = false; }},
    {"Sheen Tint", R"("Sheen Weight": 1)", kColours, kSheen,
     [](OpenPbrBsdf& b, SurfaceBend&, const Value&) { b.gltf = false; }},
    {"Emission Color", R"("Emission Strength": 1)", kColours},
    {"Emission Strength", R"("Emission Color": [0.2, 0.5, 0.9, 1])", numbers({0, 0.1, 0.5, 1, 5})},
    {"Normal Strength",
     "",
     kShares,
     "Cycles lets bumps shade what is diffuse (closure/bsdf.h), Blender 4.2 more than later ones; glTF does "
     "not",
     [](OpenPbrBsdf&, SurfaceBend& bend, const Value&) { bend.shadows = true; },
     {1, 1.06}},
    {"Normal Strength",
     R"("Metallic": 1)",
     kShares,
     "glTF scales two components of the normal, Cycles goes from one normal to the other (svm/tex_coord.h)",
     nullptr,
     {1, 1},
     {0.97, 1.026}},
};

class PrincipledInputs : public testing::TestWithParam<PrincipledInput> {};

TEST_P(PrincipledInputs, GiveTheMeansOfCycles) {
  const PrincipledInput& input = GetParam();
  std::string scenes;
  for (const Value& value : input.values) scenes += (scenes.empty() ? "" : ", ") + inputs_of(input, value);
  const TemporaryFolder folder;
  if (const std::string why = make_scenes(folder.path(), "[" + scenes + "]"); !why.empty())
    GTEST_SKIP() << why;
  const std::vector<Part> parts = {
      {"sphere", [](double x, double y) { return std::hypot(x + 1, y) < 0.7; }, input.sphere},
      {"plane", [](double x, double y) { return std::abs(x - 1) < 0.65 && std::abs(y) < 0.33; },
       input.plane}};
  for (std::size_t i = 0; i < input.values.size(); ++i) {
    SCOPED_TRACE(inputs_of(input, input.values[i]) + " " + input.reason);
    const std::vector<Image> theirs = cycles_images(folder.path(), int(i));
    SceneDescription scene = exported(folder.path(), int(i), theirs.front());
    for (Bsdf& bsdf : scene.bsdfs)
      if (auto* surface = std::get_if<OpenPbrBsdf>(&bsdf.model);
          surface != nullptr && input.as_cycles != nullptr && bsdf.name.find("both") != std::string::npos)
        input.as_cycles(*surface, bsdf.bend, input.values[i]);
    expect_means(scene, theirs, parts, 3 * parts.size() * input.values.size());
  }
}

INSTANTIATE_TEST_SUITE_P(All, PrincipledInputs, testing::ValuesIn(kInputs), [](const auto& row) {
  std::string name = fmt::format("{}{}", row.index, row.param.name);
  std::erase(name, ' ');
  return name;
});

}  // namespace
}  // namespace penumbra::differential
