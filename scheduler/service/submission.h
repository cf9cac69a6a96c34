// A render that is given to a service: all that it and its files depend on but the scene's data, which goes
// by its content hash.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "jobs.pb.h"
#include "kernels/host/error.h"
#include "scenes/matte_names.h"
#include "scheduler/protocol/wire.h"
#include "scheduler/record/render_record.h"
#include "worker/device.h"

namespace penumbra {

struct Submission {
  std::string name;   ///< for people
  std::string scene;  ///< hash of the device scene, see AssetManifest
  int priority = 0;
  RenderRecord record;
  DeviceOptions device;  ///< threads: the service's own number counts
  std::optional<double> time_budget = {};
  double verify = 0;               ///< share of the units that two workers do
  std::array<double, 3> center{};  ///< of the scene in world space
  std::vector<std::string> warnings = {};
  std::vector<std::pair<std::string, std::string>> needs = {}, left_out = {};  ///< see SceneSummary
  double build_seconds = 0;
  std::vector<std::string> command_line = {};  ///< as typed
  bool strict_numerics = false;
  std::vector<std::string> files = {};  ///< names without folders
  MatteNames mattes = {};               ///< of the scene, for Cryptomatte
};

/// Whether a service may keep a file of that name in a job's folder, and a client write it into a folder of
/// its own: a plain name that ends in .exr, .png or .json and is not hidden.
bool is_result_name(std::string_view name);

wire::Submission encode(const Submission& submission);
/// Errors, in words for people: a setting that does not exist or takes no such value,
/// names of files that are none or occur twice, numbers that are not finite.
Expected<Submission> decode(const wire::Submission& message);

}  // namespace penumbra
