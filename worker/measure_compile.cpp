#include "worker/measure_compile.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "kernels/host/console.h"
#include "kernels/host/kernel_needs.h"
#include "kernels/host/plain_file.h"
#include "kernels/host/process.h"
#include "worker/device.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

/// A temporary empty folder.
class EmptyFolder {
 public:
  EmptyFolder() {
    std::string name = (fs::temp_directory_path() / "penumbra-compile-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~EmptyFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  EmptyFolder(const EmptyFolder&) = delete;
  EmptyFolder& operator=(const EmptyFolder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

struct Measurement {
  std::string device;
  double seconds = 0;
};

/// Time from the start to the first result, minus the time of a second result: drivers may do a part of their
/// work at the first launch.
Expected<Measurement> measure(const DeviceScene& scene, const DeviceOptions& options) {
  using Clock = std::chrono::steady_clock;
  const RenderUnit unit{.width = 1, .height = 1, .first_sample = 0, .sample_count = 1};
  const auto start = Clock::now();
  const auto device = make_device(scene, options);
  if (!device) return std::unexpected(device.error());
  if (const auto first = (*device)->render(unit); !first) return std::unexpected(first.error());
  const double all = seconds_since(start);
  const auto again = Clock::now();
  if (const auto second = (*device)->render(unit); !second) return std::unexpected(second.error());
  return Measurement{(*device)->description(), all - seconds_since(again)};
}

Expected<void> run(int count, char** arguments) {
  if (count < 1 || count > 2)
    return fail("a device scene's file and perhaps an OpenCL device's name are wanted");
  constexpr std::uint64_t kMaxSceneBytes = std::uint64_t{64} << 30;
  const Expected<std::string> text = read_plain_file(arguments[0], kMaxSceneBytes);
  if (!text) return std::unexpected(text.error());
  Expected<DeviceScene> scene =
      DeviceScene::deserialize({reinterpret_cast<const std::uint8_t*>(text->data()), text->size()});
  if (!scene) return std::unexpected(scene.error());

  const EmptyFolder cache;
  if (cache.path().empty()) return fail("no temporary folder can be made");
  // Disables the drivers' own caches, before the first driver is loaded.
  setenv("POCL_CACHE_DIR", cache.path().c_str(), 1);
  setenv("CUDA_CACHE_DISABLE", "1", 1);
  DeviceOptions options;
  options.backend = Backend::kOpenCl;
  if (count > 1) options.opencl_device = arguments[1];
  options.opencl_tuning.kernel_cache = fs::path();

  const auto own = measure(*scene, options);
  if (!own) return std::unexpected(own.error());
  const KernelNeeds every = every_need(scene->header);
  scene->header.features = every.features;
  scene->header.families = every.families;
  scene->header.light_kinds = every.light_kinds;
  scene->header.texture_kinds = every.texture_kinds;
  const auto everything = measure(*scene, options);
  if (!everything) return std::unexpected(everything.error());
  std::string device = own->device.substr(0, own->device.find(", features"));
  for (char& c : device)
    if (c == '"' || c == '\\' || static_cast<unsigned char>(c) < ' ') c = ' ';
  print_answer(
      fmt::format("{{\"device\": \"{}\", \"own_seconds\": {:.4f}, \"everything_seconds\": {:.4f}}}\n", device,
                  own->seconds, everything->seconds));
  return {};
}

}  // namespace

int measure_compile(int count, char** arguments) {
  if (const Expected<void> done = run(count, arguments); !done) {
    print_error({fmt::format("{}: {}", kMeasureCompile, done.error().message)});
    return 1;
  }
  return 0;
}

}  // namespace penumbra
