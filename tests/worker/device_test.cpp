// Devices: a pixel's samples do not depend on how the image is divided into units, on threads, on instruction
// sets or on kernel variants. Scenes that cannot be rendered are refused with a message, and non-finite
// samples are counted.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "kernels/host/block_memory.h"
#include "kernels/host/native_kernels.h"
#include "kernels/host/view.h"
#include "tests/support/extra_families/extra_family_kernels.h"
#include "tests/support/film_layers.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/native_blocks.h"
#include "tests/support/render_scene.h"
#include "tests/worker/device_scenes.h"
#include "worker/device.h"
#include "worker/kernel_unit.h"
#include "worker/native_device.h"
#include "worker/opencl_program.h"

namespace penumbra::device_test {
namespace {

std::unique_ptr<Device> device_or_throw(const DeviceScene& scene, const DeviceOptions& options) {
  auto device = make_device(scene, options);
  if (!device) throw std::runtime_error(device.error().message);
  return std::move(*device);
}

SampleBuffer render(Device& device, const RenderUnit& unit) {
  auto buffer = device.render(unit);
  if (!buffer) throw std::runtime_error(buffer.error().message);
  return std::move(*buffer);
}

DeviceOptions native_options(int threads = 1) {
  DeviceOptions options;
  options.isa = best_isa();
  options.threads = threads;
  return options;
}

DeviceOptions opencl_options(int threads = 1) {
  DeviceOptions options;
  options.backend = Backend::kOpenCl;
  options.threads = threads;
  return options;
}

RenderUnit whole_film(const DeviceScene& scene, std::uint32_t first_sample = 0, std::uint32_t samples = 8) {
  return {0, 0, scene.header.film.width, scene.header.film.height, first_sample, samples};
}

bool same_bytes(const SampleBuffer& a, const SampleBuffer& b) {
  return a.width == b.width && a.height == b.height && a.planes == b.planes &&
         a.sample_count == b.sample_count && a.flagged == b.flagged && a.values.size() == b.values.size() &&
         std::memcmp(a.values.data(), b.values.data(), a.values.size() * sizeof(float)) == 0;
}

/// Planes and pixels in which a part differs from the same pixels of the whole.
int differences(const SampleBuffer& whole, const SampleBuffer& part, int x, int y) {
  int count = 0;
  for (int p = 0; p < whole.planes; ++p)
    for (int j = 0; j < part.height; ++j)
      for (int i = 0; i < part.width; ++i) {
        const float a = whole.plane(p)[std::size_t((y + j) * whole.width + x + i)];
        const float b = part.plane(p)[std::size_t(j * part.width + i)];
        count += std::memcmp(&a, &b, sizeof a) != 0 ? 1 : 0;
      }
  return count;
}

class Devices : public testing::TestWithParam<std::tuple<NamedScene, Backend>> {
 protected:
  void SetUp() override {
    if (backend() == Backend::kOpenCl && list_opencl_devices().empty())
      GTEST_SKIP() << "no OpenCL device on this machine";
  }
  static Backend backend() { return std::get<1>(GetParam()); }
  static DeviceOptions options(int threads = 1) {
    return backend() == Backend::kOpenCl ? opencl_options(threads) : native_options(threads);
  }
  static DeviceScene scene() { return build_or_throw(std::get<0>(GetParam()).make()); }
};

std::string scene_and_backend(const testing::TestParamInfo<std::tuple<NamedScene, Backend>>& tested) {
  return std::get<0>(tested.param).name +
         (std::get<1>(tested.param) == Backend::kOpenCl ? "OpenCl" : "Native");
}
INSTANTIATE_TEST_SUITE_P(All, Devices,
                         testing::Combine(testing::ValuesIn(device_scenes()),
                                          testing::Values(Backend::kNative, Backend::kOpenCl)),
                         scene_and_backend);

TEST_P(Devices, GiveTheSamePixelsWhateverTheUnits) {
  const DeviceScene s = scene();
  const auto device = device_or_throw(s, options());
  const SampleBuffer whole = render(*device, whole_film(s, 3, 5));
  EXPECT_EQ(whole.flagged[BAD_NAN].count, 0u);
  EXPECT_EQ(whole.flagged[BAD_INFINITE].count, 0u);
  EXPECT_GT(*std::ranges::max_element(whole.plane(kMeanG)), 0);
  const int width = s.header.film.width, height = s.header.film.height;
  for (int tile : {7, 16})
    for (int y = 0; y < height; y += tile)
      for (int x = 0; x < width; x += tile) {
        const RenderUnit unit{x, y, std::min(tile, width - x), std::min(tile, height - y), 3, 5};
        EXPECT_EQ(differences(whole, render(*device, unit), x, y), 0) << "tile at " << x << ", " << y;
      }
  // One pixel alone.
  EXPECT_EQ(differences(whole, render(*device, {11, 9, 1, 1, 3, 5}), 11, 9), 0);
}

TEST_P(Devices, GiveTheSameSamplesWhateverTheRange) {
  DeviceScene s = scene();
  s.header.integrator.samples_per_map = 1000;  // all ranges share a photon map
  const auto device = device_or_throw(s, options());
  constexpr std::uint32_t kSamples = 8;
  const SampleBuffer together = render(*device, whole_film(s, 0, kSamples));
  std::vector<double> sum(together.values.size()), squares(together.values.size());
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    const SampleBuffer one = render(*device, whole_film(s, i, 1));
    for (std::size_t k = 0; k < sum.size(); ++k) {
      sum[k] += one.values[k];
      squares[k] += double(one.values[k]) * one.values[k];
    }
  }
  const std::size_t pixels = together.pixels();
  for (int p = 0; p < together.planes; ++p) {
    if (p >= kDeviationR && p <= kDeviationB) continue;
    for (std::size_t i = 0; i < pixels; ++i) {
      const std::size_t at = std::size_t(p) * pixels + i;
      const double mean = sum[at] / kSamples, magnitude = std::sqrt(squares[at] / kSamples);
      ASSERT_NEAR(together.values[at], mean, 4e-7 * magnitude) << "plane " << p << " pixel " << i;
      if (p > kMeanB) continue;
      const double m2 = squares[at] - kSamples * mean * mean, deviation = together.values[at + 3 * pixels];
      ASSERT_NEAR(kSamples * deviation * deviation, m2, 4e-6 * squares[at])
          << "plane " << p << " pixel " << i;
    }
  }
}

TEST_P(Devices, TakeTheNumberOfSamplesFromTheUnit) {
  DeviceScene s = scene();
  RenderUnit unit = whole_film(s, 0, 2);
  unit.spp = 2;
  const SampleBuffer of_unit = render(*device_or_throw(s, options()), unit);
  RenderUnit other = unit;
  other.sequence = 3;
  const SampleBuffer of_other = render(*device_or_throw(s, options()), other);
  EXPECT_TRUE(same_bytes(of_other, render(*device_or_throw(s, native_options()), other)));
  unit.spp = 0;
  s.header.sampler.spp = 2;
  EXPECT_TRUE(same_bytes(of_unit, render(*device_or_throw(s, options()), unit)));
}

/// Correlation of two images' deviations from their mean, over pixels and channels.
double correlation(const SampleBuffer& a, const SampleBuffer& b, const SampleBuffer& mean) {
  double aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < 3 * mean.pixels(); ++i) {
    const double of_a = double(a.values[i]) - mean.values[i], of_b = double(b.values[i]) - mean.values[i];
    aa += of_a * of_a, bb += of_b * of_b, ab += of_a * of_b;
  }
  return ab / std::sqrt(aa * bb);
}

TEST(Sequences, AreIndependentOfEachOther) {
  const DeviceScene s = build_or_throw(diffuse_box());
  const auto device = device_or_throw(s, native_options());
  const auto image = [&](std::uint32_t sequence, std::uint32_t spp) {
    RenderUnit unit = whole_film(s, 0, spp);
    unit.sequence = sequence;
    unit.spp = spp;
    return render(*device, unit);
  };
  const SampleBuffer mean = image(1000, kMaxSamplesPerUnit);
  EXPECT_NEAR(correlation(image(1, 1), image(1, 1), mean), 1, 1e-9);
  constexpr int kPairs = 32;
  double sum = 0, squares = 0;
  for (std::uint32_t pair = 0; pair < kPairs; ++pair) {
    const double r = correlation(image(2 * pair, 1), image(2 * pair + 1, 1), mean);
    sum += r, squares += r * r;
  }
  // Student's t with 31 degrees of freedom: two-sided, p = 0.0004.
  EXPECT_LT(std::abs(sum / std::sqrt((squares - sum * sum / kPairs) * kPairs / (kPairs - 1))), 4)
      << sum / kPairs;
}

TEST_P(Devices, GiveTheSameBytesWithMoreThreads) {
  const DeviceScene s = scene();
  const SampleBuffer one = render(*device_or_throw(s, options(1)), whole_film(s));
  EXPECT_TRUE(same_bytes(one, render(*device_or_throw(s, options(2)), whole_film(s))));
  // PoCL divides a CPU into no more parts than it has cores.
  if (backend() == Backend::kOpenCl) return;
  EXPECT_TRUE(same_bytes(one, render(*device_or_throw(s, options(7)), whole_film(s))));
}

TEST_P(Devices, GiveTheSameBytesEveryTime) {
  const DeviceScene s = scene();
  const auto device = device_or_throw(s, options(2));
  const SampleBuffer first = render(*device, whole_film(s));
  render(*device, {0, 0, 3, 3, 100, 50});  // another unit between leaves nothing behind
  EXPECT_TRUE(same_bytes(first, render(*device, whole_film(s))));
}

TEST_P(Devices, RefuseUnitsThatCannotBeRendered) {
  const DeviceScene s = scene();
  const auto device = device_or_throw(s, options());
  for (const RenderUnit& unit :
       {RenderUnit{0, 0, 4, 4, 0, 0}, RenderUnit{0, 0, 4, 4, 0, kMaxSamplesPerUnit + 1},
        RenderUnit{0, 0, 0, 4, 0, 1}, RenderUnit{0, 0, 4, -1, 0, 1}}) {
    const auto refused = device->render(unit);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("samples go from 1 to 4096"), std::string::npos)
        << refused.error().message;
  }
  EXPECT_TRUE(device->render({0, 0, 1, 1, 0, kMaxSamplesPerUnit}));
  EXPECT_TRUE(device->render({0, 0, 1, 1, std::numeric_limits<std::uint32_t>::max(), 1}));
}

TEST_P(Devices, CountSamplesThatAreNotNumbers) {
  // The camera sees the environment in every sample; one device after another for each kind of bad number.
  SceneDescription description = environment_alone();
  const float infinity = std::numeric_limits<float>::infinity(),
              nan = std::numeric_limits<float>::quiet_NaN();
  for (float bad : {infinity, -infinity, nan}) {
    std::get<ConstantEnvironment>(description.emitters.back()).radiance = glm::vec3(1, bad, 1);
    const DeviceScene s = build_or_throw(description);
    const auto device = device_or_throw(s, options());
    const std::uint64_t samples =
        std::uint64_t(s.header.film.width) * std::uint64_t(s.header.film.height) * 8;
    for (int repeat = 0; repeat < 2; ++repeat) {  // counters start at 0 again
      const SampleBuffer buffer = render(*device, whole_film(s));
      EXPECT_EQ(buffer.flagged[BAD_NAN].count, std::isnan(bad) ? samples : 0);
      EXPECT_EQ(buffer.flagged[BAD_INFINITE].count, std::isnan(bad) ? 0 : samples);
      const FlaggedSamples first{
          .count = samples, .x = 0, .y = 0, .sample = 0, .source = {SOURCE_EMISSION, 0}};
      EXPECT_EQ(std::isnan(bad) ? buffer.flagged[BAD_NAN] : buffer.flagged[BAD_INFINITE], first);
      // They count as no light at all, in every channel.
      EXPECT_EQ(*std::ranges::max_element(buffer.plane(kMeanR)), 0);
      EXPECT_TRUE(std::ranges::all_of(buffer.values, [](float v) { return std::isfinite(v); }));
    }
  }
}

TEST_P(Devices, FindTheFirstSampleThatIsNoNumber) {
  // Intensity by the square of a small distance is more than a float holds, for a part of the image.
  SceneDescription description = diffuse_box();
  description.emitters.emplace_back(PointLight{glm::dvec3(0.1, -0.9, 0.05), glm::vec3(1e38f)});
  const DeviceScene s = build_or_throw(description);
  const auto device = device_or_throw(s, options(2));
  const RenderUnit film = whole_film(s, 3, 2);
  const SampleBuffer buffer = render(*device, film);
  ASSERT_GT(buffer.flagged[BAD_INFINITE].count, 0u);
  ASSERT_LT(buffer.flagged[BAD_INFINITE].count, buffer.pixels() * film.sample_count);
  FlaggedSamples expected;
  for (int y = 0; y < film.height; ++y)
    for (int x = 0; x < film.width; ++x)
      for (std::uint32_t sample = 3; sample < 5; ++sample) {
        const FlaggedSamples one = render(*device, {x, y, 1, 1, sample, 1}).flagged[BAD_INFINITE];
        if (one.count > 0 && expected.count == 0) expected = one;
      }
  expected.count = buffer.flagged[BAD_INFINITE].count;
  EXPECT_EQ(buffer.flagged[BAD_INFINITE], expected);
  EXPECT_EQ(expected.source.where, SOURCE_LIGHT);
}

TEST_P(Devices, AnotherViewGivesTheBytesOfADeviceThatWasMadeWithIt) {
  DeviceScene s = scene();
  const auto device = device_or_throw(s, options(2));
  const SampleBuffer before = render(*device, whole_film(s));
  const View first = view_of(s.header);
  // A little to the side and turned; another alpha, which only control variates look at.
  View second = first;
  second.camera.origin =
      make_vec3(first.camera.origin.x + 0.1f, first.camera.origin.y - 0.05f, first.camera.origin.z + 0.02f);
  const float c = std::cos(0.3f), sine = std::sin(0.3f);
  second.camera.x = make_vec3(c * first.camera.x.x + sine * first.camera.y.x,
                              c * first.camera.x.y + sine * first.camera.y.y,
                              c * first.camera.x.z + sine * first.camera.y.z);
  second.camera.y = make_vec3(c * first.camera.y.x - sine * first.camera.x.x,
                              c * first.camera.y.y - sine * first.camera.x.y,
                              c * first.camera.y.z - sine * first.camera.x.z);
  second.adjustable.alpha = 0.25f;
  View third = first;
  third.adjustable.alpha = 0.4f;
  for (const View& view : {second, third, first}) {
    apply_view(view, s.header);
    ASSERT_TRUE(device->take_view());
    const DeviceScene fresh_scene = s;
    const SampleBuffer fresh = render(*device_or_throw(fresh_scene, options(2)), whole_film(s));
    EXPECT_TRUE(same_bytes(render(*device, whole_film(s)), fresh));
  }
  EXPECT_TRUE(same_bytes(render(*device, whole_film(s)), before)) << "there and back";
  apply_view(second, s.header);
  ASSERT_TRUE(device->take_view());
  const bool sees_shapes = std::get<0>(GetParam()).name != "EnvironmentAlone";
  EXPECT_EQ(same_bytes(render(*device, whole_film(s)), before), !sees_shapes) << "it is another picture";
  if (std::get<0>(GetParam()).name != "PolygonLights") return;
  apply_view(third, s.header);
  ASSERT_TRUE(device->take_view());
  EXPECT_FALSE(same_bytes(render(*device, whole_film(s)), before)) << "alpha alone is seen";
}

TEST_P(Devices, DescribeThemselves) {
  const DeviceScene s = scene();
  const std::string text = device_or_throw(s, options(2))->description();
  EXPECT_NE(text.find(backend() == Backend::kOpenCl ? "OpenCL" : "native"), std::string::npos) << text;
}

class NativeVariants : public testing::TestWithParam<NamedScene> {};
INSTANTIATE_TEST_SUITE_P(All, NativeVariants, testing::ValuesIn(device_scenes()),
                         [](const auto& tested) { return tested.param.name; });

/// The whole film by one variant, without a device.
SampleBuffer render_by(const NativeKernel& kernel, const DeviceScene& scene, int capacity) {
  const RenderUnit unit = whole_film(scene, 0, 4);
  SampleBuffer buffer;
  buffer.width = unit.width;
  buffer.height = unit.height;
  buffer.planes = kPolygonLayers.planes();
  buffer.sample_count = unit.sample_count;
  buffer.values.resize(std::size_t(buffer.planes) * buffer.pixels());
  const int pixels = int(buffer.pixels()), slots = pixels * int(unit.sample_count) + kernel.lanes - 1;
  BlockMemory memory(scene.header.features, capacity, slots);
  const Block block = memory.block();
  BadSamples bad[BAD_KINDS] = {};
  const Unit whole = kernel_unit(unit);
  const AlignedVector<std::uint32_t> photons = native_photon_maps(kernel, scene, block, 0);
  kernel.render_block(scene.header, scene.words.data(), photons.data(), Tracer{}, whole, 0, pixels, block,
                      buffer.values.data(), bad);
  buffer.flagged[BAD_NAN] = flagged_samples(whole, bad[BAD_NAN]);
  buffer.flagged[BAD_INFINITE] = flagged_samples(whole, bad[BAD_INFINITE]);
  return buffer;
}

TEST_P(NativeVariants, AllGiveTheSameBytes) {
  const DeviceScene scene = build_or_throw(GetParam().make());
  const SampleBuffer reference = render_by(extra_family_kernel(true), scene, 512);
  EXPECT_GT(*std::ranges::max_element(reference.plane(kMeanG)), 0);
  int compared = 0;
  for (const NativeKernel& kernel : one_lane_and_native_kernels()) {
    ++compared;
    for (int capacity : {kernel.lanes, 16 * kernel.lanes, 2048})
      EXPECT_TRUE(same_bytes(reference, render_by(kernel, scene, capacity)))
          << isa_name(kernel.isa) << ", " << kernel.lanes << " lanes, blocks of " << capacity;
  }
  EXPECT_GE(compared, 2);
}

TEST(NativeSearches, GiveTheSameBytes) {
  for (const auto kind : {IntegratorKind::kPath, IntegratorKind::kDirect}) {
    SceneDescription description = some_triangles();
    use(description.integrator, kind);
    const DeviceScene scene = build_or_throw(description);
    DeviceScene whole = scene;
    whole.header.features &= ~std::uint64_t(FEATURE_BVH);
    ASSERT_NE(whole.header.features, scene.header.features);
    ASSERT_GT(scene.header.tables.corners.count, 64);
    ASSERT_GT(scene.header.tables.nodes.count, 0);
    const SampleBuffer reference = render_by(extra_family_kernel(true), scene, 512);
    EXPECT_GT(*std::ranges::max_element(reference.plane(kMeanG)), 0);
    int compared = 0;
    for (const NativeKernel& kernel : one_lane_and_native_kernels()) {
      ++compared;
      EXPECT_TRUE(same_bytes(reference, render_by(kernel, scene, 512)))
          << "hierarchy, " << isa_name(kernel.isa) << ", " << kernel.lanes << " lanes";
      EXPECT_TRUE(same_bytes(reference, render_by(kernel, whole, 512)))
          << "whole, " << isa_name(kernel.isa) << ", " << kernel.lanes << " lanes";
    }
    EXPECT_GE(compared, 2);
  }
}

TEST_P(NativeVariants, ABlockOfOneGivesTheSameBytes) {
  const DeviceScene scene = build_or_throw(GetParam().make());
  DeviceOptions one = native_options();
  one.block_of_one = true;
  EXPECT_TRUE(same_bytes(render(*device_or_throw(scene, native_options()), whole_film(scene)),
                         render(*device_or_throw(scene, one), whole_film(scene))));
}

TEST(DeviceErrors, AnUnknownOpenClDeviceListsTheKnown) {
  const std::vector<OpenClDeviceInfo> known = list_opencl_devices();
  if (known.empty()) GTEST_SKIP() << "no OpenCL device on this machine";
  const DeviceScene scene = build_or_throw(diffuse_box());
  DeviceOptions options = opencl_options();
  options.opencl_device = "abacus";
  const auto device = make_device(scene, options);
  ASSERT_FALSE(device);
  EXPECT_NE(device.error().message.find("'abacus'"), std::string::npos);
  for (const OpenClDeviceInfo& info : known)
    EXPECT_NE(device.error().message.find(info.name), std::string::npos) << device.error().message;
  // Part of a name in any case finds it.
  options.opencl_device = known.front().platform.substr(0, 4);
  std::ranges::transform(options.opencl_device, options.opencl_device.begin(),
                         [](unsigned char c) { return char(std::toupper(c)); });
  EXPECT_TRUE(find_opencl_device(options.opencl_device));
}

TEST(DeviceErrors, OpenClRefusesEmbree) {
  const DeviceScene scene = build_or_throw(diffuse_box(), true);
  const auto device = make_device(scene, opencl_options());
  ASSERT_FALSE(device);
  EXPECT_NE(device.error().message.find("--intersector portable"), std::string::npos)
      << device.error().message;
}

/// This process gets no more than so many bytes of addresses beyond what it has, until the end.
class AddressLimit {
 public:
  explicit AddressLimit(rlim_t more) {
    getrlimit(RLIMIT_AS, &before_);
    std::ifstream status("/proc/self/statm");
    rlim_t pages = 0;
    status >> pages;
    const rlimit limit{pages * rlim_t(sysconf(_SC_PAGESIZE)) + more, before_.rlim_max};
    setrlimit(RLIMIT_AS, &limit);
  }
  ~AddressLimit() { setrlimit(RLIMIT_AS, &before_); }
  AddressLimit(const AddressLimit&) = delete;
  AddressLimit& operator=(const AddressLimit&) = delete;

 private:
  rlimit before_{};
};

TEST(Threads, AreAsManyAsTheSystemGivesAndThatIsSaid) {
#if defined(__has_feature)
  #if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
  GTEST_SKIP() << "sanitizers end the process where a thread cannot be started";
  #endif
#endif
  const DeviceScene scene = build_or_throw(diffuse_box());
  const SampleBuffer reference = render(*device_or_throw(scene, native_options(1)), whole_film(scene));
  std::unique_ptr<Device> device;
  {
    const AddressLimit limit(rlim_t{256} << 20);  // a stack takes 8 MB
    device = device_or_throw(scene, native_options(kMaxThreads));
  }
  ASSERT_EQ(device->preparation().warnings.size(), 1u);
  EXPECT_TRUE(device->preparation().warnings[0].contains("of 1024 threads"))
      << device->preparation().warnings[0];
  EXPECT_TRUE(same_bytes(render(*device, whole_film(scene)), reference));
  EXPECT_TRUE(device_or_throw(scene, native_options(2))->preparation().warnings.empty());
}

TEST(DeviceErrors, AnInstructionSetThatIsNotThereIsNamed) {
  const DeviceScene scene = build_or_throw(diffuse_box());
  for (const Isa isa : kIsas) {
    DeviceOptions options = native_options();
    options.isa = isa;
    const auto device = make_device(scene, options);
    const std::vector<Isa> built_sets = built_isas();
    const bool here = machine_has(isa);
    const bool built = std::ranges::find(built_sets, isa) != built_sets.end();
    EXPECT_EQ(bool(device), here && built) << isa_name(isa);
    if (device) continue;
    const std::string why = device.error().message;
    EXPECT_TRUE(why.contains(isa_name(isa)) && why.contains(isa_list(here ? built_sets : usable_isas())))
        << why;
    EXPECT_TRUE(why.contains(here ? "-DPENUMBRA_ISA=all" : "this machine lacks it")) << why;
  }
}

TEST(InstructionSets, HaveNames) {
  for (const Isa isa : kIsas) {
    ASSERT_TRUE(isa_from_name(isa_name(isa)));
    EXPECT_EQ(*isa_from_name(isa_name(isa)), isa);
  }
  const auto unknown = isa_from_name("avx1024");
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().message.find("sse2, avx2, avx512"), std::string::npos);
}

TEST(Embree, GivesTheSamePixelsWhateverTheUnits) {
  const DeviceScene scene = build_or_throw(everything_in_a_hierarchy(), true);
  const auto device = device_or_throw(scene, native_options(2));
  const SampleBuffer whole = render(*device, whole_film(scene));
  for (int y = 0; y < scene.header.film.height; y += 9)
    for (int x = 0; x < scene.header.film.width; x += 8)
      EXPECT_EQ(differences(whole, render(*device, {x, y, 8, 9, 0, 8}), x, y), 0);
}

}  // namespace
}  // namespace penumbra::device_test
