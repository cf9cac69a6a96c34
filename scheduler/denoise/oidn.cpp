#include "scheduler/denoise/oidn.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "kernels/denoise/denoise_task.h"

namespace penumbra {
namespace {

// Of OpenImageDenoise/oidn.h, versions 1 and 2.
constexpr int kDefaultDevice = 0, kFloat3 = 3;

struct Api {
  void* (*new_device)(int type);
  void (*commit_device)(void* device);
  void (*release_device)(void* device);
  int (*device_error)(void* device, const char** message);
  void* (*new_filter)(void* device, const char* type);
  void (*set_image)(void* filter, const char* name, void* data, int format, std::size_t width,
                    std::size_t height, std::size_t offset, std::size_t pixel_stride, std::size_t row_stride);
  void (*set_bool)(void* filter, const char* name, bool value);
  void (*commit_filter)(void* filter);
  void (*execute)(void* filter);
  void (*release_filter)(void* filter);
};

Expected<void*> load_library() {
  const char* wanted = std::getenv("PENUMBRA_OIDN");
  const char* const names[] = {"libOpenImageDenoise.so.2", "libOpenImageDenoise.so.1",
                               "libOpenImageDenoise.so.0", "libOpenImageDenoise.so"};
  std::string problem;
  for (const char* name : names) {
    if (void* library = dlopen(wanted != nullptr ? wanted : name, RTLD_NOW | RTLD_LOCAL)) return library;
    problem = dlerror();
    if (wanted != nullptr) break;
  }
  return fail(
      fmt::format("Open Image Denoise is not there ({}): install it, or set PENUMBRA_OIDN to its "
                  "libOpenImageDenoise.so; --method nfor needs no library",
                  problem));
}

template <typename Function>
bool find(void* library, const char* name, Function*& function) {
  function = reinterpret_cast<Function*>(dlsym(library, name));
  return function != nullptr;
}

Expected<Api> load_api() {
  const Expected<void*> loaded = load_library();
  if (!loaded) return std::unexpected(loaded.error());
  void* library = *loaded;
  Api api{};
  const bool complete =
      find(library, "oidnNewDevice", api.new_device) &&
      find(library, "oidnCommitDevice", api.commit_device) &&
      find(library, "oidnReleaseDevice", api.release_device) &&
      find(library, "oidnGetDeviceError", api.device_error) &&
      find(library, "oidnNewFilter", api.new_filter) &&
      find(library, "oidnSetSharedFilterImage", api.set_image) &&
      (find(library, "oidnSetFilterBool", api.set_bool) || find(library, "oidnSetFilter1b", api.set_bool)) &&
      find(library, "oidnCommitFilter", api.commit_filter) &&
      find(library, "oidnExecuteFilter", api.execute) &&
      find(library, "oidnReleaseFilter", api.release_filter);
  if (!complete) return fail("the library of Open Image Denoise lacks functions of versions 1 and 2");
  return api;
}

/// Three planes as the library takes them: pixel by pixel.
std::vector<float> interleaved(const Planes& planes, int first) {
  std::vector<float> pixels(3 * planes.pixels());
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < planes.pixels(); ++i)
      pixels[3 * i + std::size_t(c)] = planes.plane(first + c)[i];
  return pixels;
}

bool is_empty(std::span<const float> values) {
  return std::ranges::all_of(values, [](float v) { return v == 0; });
}

class Denoiser {
 public:
  Denoiser(const Api& api, int width, int height)
      : api_(api),
        width_(width),
        height_(height),
        device_(api.new_device(kDefaultDevice), api.release_device) {
    if (device_) api_.commit_device(device_.get());
  }

  using Images = std::vector<std::pair<const char*, std::vector<float>*>>;
  /// Filters `image` in place, with the help of others.
  Expected<void> run(const char* name, std::vector<float>& image, const Images& others, bool hdr) {
    if (!device_) return fail("Open Image Denoise finds no device");
    const std::unique_ptr<void, void (*)(void*)> filter(api_.new_filter(device_.get(), "RT"),
                                                        api_.release_filter);
    if (!filter) return error();
    std::vector<float> out(image.size());
    const auto set = [&](const char* of, std::vector<float>& values) {
      api_.set_image(filter.get(), of, values.data(), kFloat3, std::size_t(width_), std::size_t(height_), 0,
                     0, 0);
    };
    set(name, image);
    for (const auto& [of, values] : others) set(of, *values);
    set("output", out);
    if (hdr) {
      api_.set_bool(filter.get(), "hdr", true);
      api_.set_bool(filter.get(), "cleanAux", !others.empty());
    }
    api_.commit_filter(filter.get());
    api_.execute(filter.get());
    if (auto done = error(); !done) return done;
    image = std::move(out);
    return {};
  }

 private:
  Expected<void> error() {
    const char* message = nullptr;
    if (api_.device_error(device_.get(), &message) == 0) return {};
    return fail(fmt::format("Open Image Denoise: {}", message != nullptr ? message : "it failed"));
  }

  Api api_;
  int width_, height_;
  std::unique_ptr<void, void (*)(void*)> device_;
};

}  // namespace

Expected<void> check_oidn() {
  const Expected<Api> api = load_api();
  return api ? Expected<void>() : std::unexpected(api.error());
}

Expected<DenoisedImage> oidn(const DenoiseInput& input) {
  const Expected<Api> api = load_api();
  if (!api) return std::unexpected(api.error());
  Denoiser denoiser(*api, input.color.width, input.color.height);
  std::vector<float> color = interleaved(input.color, 0), albedo = interleaved(input.features, 0),
                     normal = interleaved(input.features, 3);
  // The library takes a normal only together with an albedo.
  Denoiser::Images features;
  if (!is_empty(albedo)) features.emplace_back("albedo", &albedo);
  if (!is_empty(albedo) && !is_empty(normal)) features.emplace_back("normal", &normal);
  for (auto& [name, image] : features)
    if (auto done = denoiser.run(name, *image, {}, false); !done) return std::unexpected(done.error());
  if (auto done = denoiser.run("color", color, features, true); !done) return std::unexpected(done.error());
  DenoisedImage result{.color = Planes(input.color.width, input.color.height, 3), .residual_variance = {}};
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < result.color.pixels(); ++i)
      result.color.plane(c)[i] = color[3 * i + std::size_t(c)];
  return result;
}

}  // namespace penumbra
