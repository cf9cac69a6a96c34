#include "scheduler/run/scene_costs.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "kernels/host/native_kernels.h"
#include "scheduler/files/program_path.h"
#include "scheduler/files/run_program.h"
#include "worker/measure_compile.h"
#include "worker/native_device.h"

namespace penumbra {
namespace {

std::optional<NativeCode> native_code(Isa isa) {
  const NativeKernel* kernel = find_native_kernel(isa);
  if (kernel == nullptr) return std::nullopt;
  return NativeCode{std::string(isa_name(isa)), native_code_bytes(*kernel)};
}

/// A temporary file that is removed at the end.
class TemporaryFile {
 public:
  TemporaryFile() {
    path_ = (std::filesystem::temp_directory_path() / "penumbra-scene-XXXXXX").string();
    descriptor_ = mkstemp(path_.data());
  }
  ~TemporaryFile() {
    if (descriptor_ < 0) return;
    close(descriptor_);
    unlink(path_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  [[nodiscard]] bool exists() const { return descriptor_ >= 0; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
  int descriptor_ = -1;
};

}  // namespace

SceneInventory scene_costs(const SceneDescription& description, const DeviceScene& scene, Isa isa,
                           bool thorough) {
  SceneInventory inventory = take_inventory(description, scene, thorough);
  inventory.native = native_code(isa);
  return inventory;
}

Expected<CompileTimes> measure_compile_times(const DeviceScene& scene, const std::string& opencl_device) {
  if (scene.header.intersector == INTERSECTOR_EMBREE)
    return fail(
        "--compile: this scene is rendered with Embree, which OpenCL has not: add --intersector portable");
  const auto worker = find_program("penumbra-worker");
  if (!worker) return std::unexpected(worker.error());
  const TemporaryFile file;
  const std::vector<std::uint8_t> bytes = scene.serialize();
  std::ofstream out(file.path(), std::ios::binary);
  if (file.exists()) out.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  out.close();
  if (!file.exists() || !out) return fail("--compile: cannot write the temporary file " + file.path());

  std::vector<std::string> arguments{kMeasureCompile, file.path()};
  if (!opencl_device.empty()) arguments.push_back(opencl_device);
  const auto end = run_program(worker->string(), std::move(arguments));
  if (!end) return fail("--compile: " + end.error().message);
  if (!end->succeeded) return fail("--compile: nothing was measured; the worker said why");
  const auto json = nlohmann::json::parse(end->output, nullptr, false);
  if (!json.is_object()) return fail("--compile: the worker said '" + end->output + "'");
  return CompileTimes{json.value("device", ""), json.value("own_seconds", 0.0),
                      json.value("everything_seconds", 0.0)};
}

}  // namespace penumbra
