// A render submitted to a service: everything on which it and its files depend, except the scene's data,
// which is referred to by its content hash.
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
#include "scheduler/record/render_record.h"
#include "worker/protocol/wire.h"
#include "worker/work_unit.h"

namespace penumbra {

/// The jobs of one `penumbra submit` of several renders.
struct SubmittedGroup {
  JobId number = 0;  ///< 0: a new group, whose first job this is
  std::string name;
  std::uint32_t size = 0;  ///< how many jobs it will have
};

/// How a frame is denoised with the samples of others, see ShotDenoiser.
struct NumbersBeside {
  std::uint32_t shot = 0;        ///< its number in the group
  std::vector<int> frames = {};  ///< of that shot, ascending, at most kMostTimeRadius away
};

struct Submission {
  std::string name;   ///< for display
  std::string scene;  ///< content hash of the device scene; see AssetManifest
  int priority = 0;
  RenderRecord record;             ///< the number of threads is ignored; the service has its own
  std::array<double, 3> center{};  ///< the scene's centre in world space
  std::vector<std::string> warnings = {};
  std::vector<std::pair<std::string, std::string>> needs = {}, left_out = {};  ///< see SceneSummary
  double build_seconds = 0;
  std::vector<std::string> command_line = {};  ///< as typed
  std::vector<std::string> files = {};         ///< file names without folders
  MatteNames mattes = {};                      ///< mattes of the scene, for Cryptomatte
  std::string folder =
      {};  ///< of its files, below the folder to which a client fetches; see is_result_folder
  std::string submitter = {};  ///< USER@HOST, as the client says
  std::optional<SubmittedGroup> group = {};
  std::vector<JobId> after = {};  ///< jobs or groups that must be done before it begins
  std::optional<int> frame = {};  ///< of a shot
  std::optional<NumbersBeside> beside =
      {};                   ///< only of a frame with a denoised EXR; nothing: denoised by itself
  std::string choice = {};  ///< what `--integrator auto` has chosen, for users; empty: it was not asked
};

/// Whether a service may store a file of that name in a job's folder, and a client may write it to a folder:
/// a plain name that ends in .exr, .png or .json and is not hidden.
bool is_result_name(std::string_view name);
/// Whether a client may put results there, below the folder that its user chose: "" or a relative path
/// without
/// "..", hidden names and control characters.
bool is_result_folder(std::string_view folder);

wire::Submission encode(const Submission& submission);
/// Errors, in plain words: a setting that does not exist or an invalid value, file names that are invalid or
/// occur twice, numbers that are not finite.
Expected<Submission> decode(const wire::Submission& message);

}  // namespace penumbra
