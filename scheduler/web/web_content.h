// What the page in the browser shows. A service and a render each provide it.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "worker/work_unit.h"

namespace penumbra {

/// A picture for a browser.
struct WebPicture {
  std::shared_ptr<const std::string> png;
  std::string tag;  ///< differs between pictures of the same address that differ
};

/// Called from several threads at once, which hold no locks.
class WebContent {
 public:
  virtual ~WebContent() = default;

  /// The state of everything, as `penumbra status --json` prints it.
  [[nodiscard]] virtual nlohmann::ordered_json status() = 0;
  /// The state of one job with its problems; null if there is no such job.
  [[nodiscard]] virtual nlohmann::ordered_json job(JobId job) = 0;
  /// The job's image as far as it is rendered, at most `largest_side` pixels wide and high. Nothing if there
  /// is none (yet).
  [[nodiscard]] virtual std::optional<WebPicture> picture(JobId job, int largest_side) = 0;
  /// The path of one of the job's files. Nothing if it has no such file.
  [[nodiscard]] virtual std::optional<std::filesystem::path> file(JobId job, const std::string& name) = 0;
};

}  // namespace penumbra
