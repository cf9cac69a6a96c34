#include "scheduler/web/service_page.h"

#include "scheduler/service/status_text.h"
#include "scheduler/web/web_page.h"

namespace penumbra {

nlohmann::ordered_json ServicePage::status() {
  auto status = queue_.status({});
  return status ? web_page_status(std::move(*status)) : nlohmann::ordered_json();
}

nlohmann::ordered_json ServicePage::job(JobId job) {
  const auto status = queue_.status({job});
  return status ? status_json(*status)["jobs"][0] : nlohmann::ordered_json();
}

std::optional<WebPicture> ServicePage::picture(JobId job, int largest_side) {
  const auto status = queue_.status({job});
  if (!status) return {};
  if (!is_over(status->jobs(0))) return pictures_.of_film(job, largest_side);
  // A PNG is read faster than an EXR with all its layers, and shows the same.
  for (const char* extension : {".png", ".exr"})
    for (const wire::StoredFile& stored : status->jobs(0).files())
      if (stored.name().ends_with(extension))
        if (const auto path = queue_.file(job, stored.name()))
          return pictures_.of_file(job, *path, largest_side);
  return {};
}

std::optional<std::filesystem::path> ServicePage::file(JobId job, const std::string& name) {
  const auto path = queue_.file(job, name);
  return path ? std::optional(*path) : std::nullopt;
}

}  // namespace penumbra
