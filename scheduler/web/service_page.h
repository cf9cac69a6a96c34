// What the page in the browser shows of a service.
#pragma once

#include "scheduler/service/job_queue.h"
#include "scheduler/web/job_pictures.h"
#include "scheduler/web/web_content.h"

namespace penumbra {

class ServicePage final : public WebContent {
 public:
  explicit ServicePage(JobQueue& queue) : queue_(queue) {}

  [[nodiscard]] JobPictures& pictures() { return pictures_; }

  [[nodiscard]] nlohmann::ordered_json status() override;
  [[nodiscard]] nlohmann::ordered_json job(JobId job) override;
  [[nodiscard]] std::optional<WebPicture> picture(JobId job, int largest_side) override;
  [[nodiscard]] std::optional<std::filesystem::path> file(JobId job, const std::string& name) override;

 private:
  JobQueue& queue_;
  JobPictures pictures_;
};

}  // namespace penumbra
