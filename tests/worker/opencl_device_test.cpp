// OpenCL devices give the same bytes as native code, however the image is divided into units, whichever form
// their kernels have, and whether these are compiled or loaded. Errors are reported.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "tests/support/render_scene.h"
#include "tests/support/temporary_folder.h"
#include "tests/worker/device_scenes.h"
#include "worker/device.h"
#include "worker/opencl_program.h"

namespace penumbra::opencl_device_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

template <typename T>
T value_or_throw(Expected<T> value) {
  if (!value) throw std::runtime_error(value.error().message);
  return std::move(*value);
}

DeviceOptions native_options() {
  DeviceOptions options;
  options.isa = best_isa();
  return options;
}

DeviceOptions opencl_options(OpenClTuning tuning) {
  DeviceOptions options;
  options.backend = Backend::kOpenCl;
  options.threads = 2;
  options.opencl_tuning = std::move(tuning);
  return options;
}

RenderUnit whole_film(const DeviceScene& scene, std::uint32_t samples = 6) {
  return {0, 0, scene.header.film.width, scene.header.film.height, 2, samples};
}

SampleBuffer render(const DeviceScene& scene, const DeviceOptions& options, const RenderUnit& unit) {
  return value_or_throw(value_or_throw(make_device(scene, options))->render(unit));
}

bool same_bytes(const SampleBuffer& a, const SampleBuffer& b) {
  return a.flagged == b.flagged && a.values.size() == b.values.size() &&
         std::memcmp(a.values.data(), b.values.data(), a.values.size() * sizeof(float)) == 0;
}

class OpenClShapes : public testing::TestWithParam<NamedScene> {
 protected:
  void SetUp() override {
    if (list_opencl_devices().empty()) GTEST_SKIP() << "no OpenCL device on this machine";
  }
};
INSTANTIATE_TEST_SUITE_P(All, OpenClShapes, testing::ValuesIn(device_scenes()),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(OpenClShapes, GiveTheSameBytesHoweverLaunchesAreCut) {
  const DeviceScene scene = build_or_throw(GetParam().make());
  const RenderUnit unit = whole_film(scene);
  const SampleBuffer expected = render(scene, native_options(), unit);
  for (const bool path_per_item : {false, true})
    // 0: as large as may be; 5: less than the samples of a pixel; 1001: not all of a unit.
    for (const int launch_paths : {0, 5, 1001}) {
      const DeviceOptions options =
          opencl_options({.path_per_item = path_per_item, .launch_paths = launch_paths});
      EXPECT_TRUE(same_bytes(expected, render(scene, options, unit)))
          << (path_per_item ? "a path a work item" : "blocks") << ", launches of " << launch_paths;
    }
}

TEST_P(OpenClShapes, GiveTheSameBytesWithLaunchesOfAMoment) {
  const DeviceScene scene = build_or_throw(GetParam().make());
  // Large enough that launches shrink from their first size, and differ from one time to the next.
  const RenderUnit unit = whole_film(scene, 60);
  const SampleBuffer expected = render(scene, native_options(), unit);
  for (const bool path_per_item : {false, true})
    EXPECT_TRUE(same_bytes(
        expected,
        render(scene, opencl_options({.path_per_item = path_per_item, .launch_seconds = 1e-3}), unit)));
}

TEST_P(OpenClShapes, GiveTheSameBytesInLittleMemory) {
  const DeviceScene scene = build_or_throw(GetParam().make());
  const RenderUnit unit = whole_film(scene);
  const SampleBuffer expected = render(scene, native_options(), unit);
  const std::uint64_t scene_bytes = sizeof scene.header + scene.words.size() * 4;
  for (const bool path_per_item : {false, true})
    for (const std::uint64_t room : {20000, 200000}) {
      // So little that the unit is rendered in parts of some rows, or of less.
      const DeviceOptions options = opencl_options({.path_per_item = path_per_item,
                                                    .memory_bytes = scene_bytes + room,
                                                    .allocation_bytes = scene_bytes + room / 3});
      const auto device = value_or_throw(make_device(scene, options));
      EXPECT_TRUE(same_bytes(expected, value_or_throw(device->render(unit))))
          << (path_per_item ? "a path a work item" : "blocks") << ", " << room << " bytes";
      // Units of other sizes between leave nothing behind.
      value_or_throw(device->render({3, 2, 5, 1, 0, 9}));
      EXPECT_TRUE(same_bytes(expected, value_or_throw(device->render(unit))));
    }
}

class OpenClDevices : public testing::Test {
 protected:
  void SetUp() override {
    if (list_opencl_devices().empty()) GTEST_SKIP() << "no OpenCL device on this machine";
  }
  const DeviceScene scene_ = build_or_throw(diffuse_box());
  const SampleBuffer expected_ = render(scene_, native_options(), whole_film(scene_));
  const TemporaryFolder folder_;
  const CheckedCache cache_ = kernel_cache(folder_.path());

  DevicePreparation prepare_and_check(DeviceOptions options, std::string* compiled = nullptr) {
    if (compiled != nullptr) options.on_compile = [compiled](const std::string& name) { *compiled += name; };
    const auto device = value_or_throw(make_device(scene_, options));
    EXPECT_TRUE(same_bytes(expected_, value_or_throw(device->render(whole_film(scene_)))));
    return device->preparation();
  }
};

TEST_F(OpenClDevices, CompileOnceForAFolder) {
  for (const bool path_per_item : {false, true}) {
    const DeviceOptions options =
        opencl_options({.path_per_item = path_per_item, .kernel_cache = folder_.path()});
    std::string compiled;
    const DevicePreparation first = prepare_and_check(options, &compiled);
    EXPECT_EQ(compiled, find_opencl_device("")->name);
    ASSERT_TRUE(first.kernels);
    EXPECT_FALSE(first.kernels->cached);
    EXPECT_GT(first.kernels->seconds, 0);
    EXPECT_THAT(first.kernels->note, IsEmpty());
    EXPECT_THAT(folder_.names(), SizeIs(path_per_item ? 2 : 1));
    compiled.clear();
    const DevicePreparation second = prepare_and_check(options, &compiled);
    EXPECT_THAT(compiled, IsEmpty());
    ASSERT_TRUE(second.kernels);
    EXPECT_TRUE(second.kernels->cached);
    EXPECT_THAT(second.kernels->note, IsEmpty());
  }
}

TEST_F(OpenClDevices, GiveTheSameBytesByKernelsOfOneFunction) {
  prepare_and_check(opencl_options(
      {.path_per_item = true, .kernel_cache = folder_.path(), .build_options = "-DINLINE_STAGES"}));
}

TEST_F(OpenClDevices, KeepNothingWhereThereIsNoFolder) {
  const DeviceOptions off = opencl_options({.kernel_cache = std::filesystem::path()});
  const DevicePreparation prepared = prepare_and_check(off);
  EXPECT_FALSE(prepared.kernels->cached);
  EXPECT_THAT(prepared.kernels->note, IsEmpty());
  write_text(folder_ / "file", "in the way");
  const DevicePreparation refused = prepare_and_check(opencl_options({.kernel_cache = folder_ / "file"}));
  EXPECT_FALSE(refused.kernels->cached);
  EXPECT_THAT(refused.kernels->note, HasSubstr("not kept"));
}

TEST_F(OpenClDevices, CompileAnewWhatTheDeviceRefusesOrTheDiskDamaged) {
  const DeviceOptions options = opencl_options({.kernel_cache = folder_.path()});
  const OpenClDeviceInfo info = *find_opencl_device("");
  const std::string key =
      kernel_cache_key(info, opencl_source(info, "kernels/opencl.cl", {}, needs_of(scene_.header), 16));
  // Whole by the cache's measure, but no program.
  const std::vector<unsigned char> nonsense(1000, 0x5a);
  ASSERT_TRUE(cache_.keep(key, nonsense));
  DevicePreparation prepared = prepare_and_check(options);
  EXPECT_FALSE(prepared.kernels->cached);
  EXPECT_THAT(prepared.kernels->note, HasSubstr("removed"));
  ASSERT_TRUE(cache_.find(key).bytes) << "another key than the device's";
  EXPECT_NE(cache_.find(key).bytes, nonsense);

  std::string damaged = file_contents(cache_.file_of(key));
  damaged[damaged.size() / 2] ^= 1;
  write_text(cache_.file_of(key), damaged);
  prepared = prepare_and_check(options);
  EXPECT_FALSE(prepared.kernels->cached);
  EXPECT_THAT(prepared.kernels->note, HasSubstr("is damaged and was removed"));
  EXPECT_TRUE(prepare_and_check(options).kernels->cached);
}

TEST_F(OpenClDevices, KeysChangeWithAllThatAProgramDependsOn) {
  OpenClDeviceInfo info = *find_opencl_device("");
  const OpenClSource source = opencl_source(info, "kernels/opencl.cl", {}, {FEATURE_PATH}, 16);
  EXPECT_THAT(source.options, HasSubstr("-cl-std=CL1.2"));
  const std::string key = kernel_cache_key(info, source);
  EXPECT_EQ(key, kernel_cache_key(info, source));
  EXPECT_NE(key, kernel_cache_key(info, opencl_source(info, "kernels/opencl.cl", {}, {FEATURE_PATH}, 1)));
  EXPECT_NE(key, kernel_cache_key(info, opencl_source(info, "kernels/opencl.cl", {}, {FEATURE_DIRECT}, 16)));
  for (const KernelNeeds& needs : {KernelNeeds{.features = FEATURE_PATH, .families = ONLY(DIFFUSE)},
                                   KernelNeeds{.features = FEATURE_PATH, .light_kinds = 1u << LIGHT_POINT}})
    EXPECT_NE(key, kernel_cache_key(info, opencl_source(info, "kernels/opencl.cl", {}, needs, 16)));
  OpenClSource changed = source;
  changed.text += " ";
  EXPECT_NE(key, kernel_cache_key(info, changed));
  info.compiler_identity += "a newer driver";
  EXPECT_NE(key, kernel_cache_key(info, source));
}

TEST_F(OpenClDevices, AFailedCompileIsAnErrorWithTheLog) {
  const OpenClTuning broken{.kernel_cache = folder_.path(), .build_options = "-DFEATURES=0"};
  const auto device = make_device(scene_, opencl_options(broken));
  ASSERT_FALSE(device);
  EXPECT_THAT(device.error().message, HasSubstr("does not compile on " + find_opencl_device("")->name));
  EXPECT_THAT(device.error().message, HasSubstr("FEATURES is 0"));
  EXPECT_GT(std::ranges::count(device.error().message, '\n'), 2) << "no log";
  EXPECT_THAT(folder_.names(), IsEmpty());
}

TEST_F(OpenClDevices, AFailedCompileIsAWarningWhereTheMachineChose) {
  DeviceOptions options = opencl_options({.kernel_cache = folder_.path(), .build_options = "-DFEATURES=0"});
  options.backend = Backend::kAuto;
  options.isa = best_isa();
  options.opencl_device = "0";
  const DevicePreparation prepared = prepare_and_check(options);
  EXPECT_FALSE(prepared.kernels);
  ASSERT_THAT(prepared.warnings, SizeIs(1));
  EXPECT_THAT(prepared.warnings[0], HasSubstr("native code renders"));
  EXPECT_THAT(prepared.warnings[0], HasSubstr("FEATURES is 0"));
  options.opencl_tuning.build_options.clear();
  EXPECT_TRUE(prepare_and_check(options).kernels) << "the device that was named";
}

TEST_F(OpenClDevices, AreNotChosenForCpusOrEmbree) {
  DeviceOptions options = native_options();
  options.backend = Backend::kAuto;
  if (suitable_opencl_devices(scene_.header.features).empty()) {
    EXPECT_FALSE(prepare_and_check(options).kernels);
  }
  options.opencl_device = "0";
  const DeviceScene embree = build_or_throw(diffuse_box(), true);
  EXPECT_FALSE(value_or_throw(make_device(embree, options))->preparation().kernels);
  for (const OpenClDeviceInfo& device : suitable_opencl_devices(FEATURE_POLYGONS)) {
    EXPECT_FALSE(device.is_cpu);
    EXPECT_TRUE(device.has_double);
    EXPECT_TRUE(device.is_exact);
  }
}

TEST_F(OpenClDevices, ASceneBeyondTheirMemoryIsNamedWithBothNumbers) {
  const std::uint64_t bytes = sizeof scene_.header + scene_.words.size() * 4;
  const auto device = make_device(scene_, opencl_options({.allocation_bytes = bytes - 1}));
  ASSERT_FALSE(device);
  EXPECT_THAT(device.error().message, HasSubstr(std::to_string(bytes)));
  EXPECT_THAT(device.error().message, HasSubstr(std::to_string(bytes - 1)));
  // What fits, but not with so many samples, fails with the unit.
  const auto small = value_or_throw(make_device(scene_, opencl_options({.memory_bytes = bytes + 20000})));
  EXPECT_TRUE(small->render({0, 0, 4, 4, 0, 16}));
  const auto refused = small->render({0, 0, 4, 4, 0, kMaxSamplesPerUnit});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("--pass"));
}

TEST_F(OpenClDevices, AreFoundByNumberAndPartOfAName) {
  const std::vector<OpenClDeviceInfo> all = list_opencl_devices();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto found = find_opencl_device(std::to_string(i));
    ASSERT_TRUE(found);
    EXPECT_EQ(found->id, all[i].id);
    EXPECT_THAT(opencl_device_table(all), HasSubstr(std::to_string(i) + "  " + all[i].platform));
  }
  EXPECT_FALSE(find_opencl_device("999999"));
  EXPECT_FALSE(find_opencl_device("0x"));
}

TEST_F(OpenClDevices, WithoutDoublePrecisionAreNamedWhereItIsNeeded) {
  OpenClDeviceInfo info = *find_opencl_device("");
  info.has_double = false;
  EXPECT_THAT(lacking_for(info, FEATURE_PATH | FEATURE_POLYGONS), HasSubstr("cl_khr_fp64"));
  EXPECT_THAT(lacking_for(info, FEATURE_DIRECT | FEATURE_PROJECTED), HasSubstr(info.name));
  EXPECT_THAT(lacking_for(info, FEATURE_PATH), IsEmpty());
}

}  // namespace
}  // namespace penumbra::opencl_device_test
