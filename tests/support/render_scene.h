// Renders a scene in this process on one device, in the same way as the scheduler: in passes that are merged
// in order. Every error is thrown as std::runtime_error; the test then fails with its message.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kernels/host/device_scene.h"
#include "scenes/scene_description.h"
#include "scheduler/plan/film_accumulator.h"
#include "tests/support/image_test.h"
#include "tests/support/statistics.h"
#include "worker/device.h"

namespace penumbra {

/// A file of the project, e.g. "scenes/furnace/furnace.xml".
std::filesystem::path project_file(const std::string& name);

/// Reads a scene file; `defines` are names and values, as for -D.
SceneDescription read_or_throw(const std::filesystem::path& file,
                               const std::vector<std::pair<std::string, std::string>>& defines = {});

DeviceScene build_or_throw(const SceneDescription& description, bool embree = false);

/// Gives the whole film a new size, without a crop.
void resize_film(SceneDescription& description, int width, int height);

/// How to render: all of the film, `sampler.spp` samples a pixel.
struct TestDevice {
  DeviceOptions options;
  std::uint32_t samples_per_pass = 16;
  bool embree = false;  ///< trace with Embree where the scene is a description
};

/// A native device with the widest instruction set and both cores.
TestDevice native_device();
TestDevice opencl_device();

/// Lets every scene say that it needs what any of them does, so that OpenCL compiles once for all of those
/// with a hierarchy, and once for the others. Their films get the layers of all; those of mattes, shapes and
/// motion must be of every scene or of none.
void share_needs(std::span<DeviceScene> scenes);

FilmAccumulator render_or_throw(const DeviceScene& scene, const TestDevice& device = native_device());
FilmAccumulator render_or_throw(const SceneDescription& description,
                                const TestDevice& device = native_device());

/// The samples of one pixel's channel.
statistics::Sample pixel_sample(const FilmAccumulator& film, int x, int y, int channel);

/// The samples of all pixels together, of one channel: for films on which every pixel has the same
/// distribution.
statistics::Sample film_sample(const FilmAccumulator& film, int channel);

/// Mean radiance, three channels.
statistics::Image mean_image(const FilmAccumulator& film);

/// Mean over the pixels of the variance of one sample, averaged over the channels.
double mean_variance(const FilmAccumulator& film);

/// Renders `batches` times with seeds first_seed, first_seed + 1, ..., and averages blocks of pixels.
statistics::Estimate block_estimate(SceneDescription description, int batches, std::uint32_t first_seed,
                                    int block, const TestDevice& device = native_device());

}  // namespace penumbra
