// What a page shows in tests.
#pragma once

#include <map>
#include <mutex>
#include <string>

#include "scheduler/web/web_content.h"

namespace penumbra {

class SomeContent final : public WebContent {
 public:
  nlohmann::ordered_json status() override {
    const std::lock_guard lock(mutex_);
    ++asked_;
    return {{"penumbra", "1"},
            {"now", asked_},
            {"jobs", {{{"job", 3}, {"name", name_}}}},
            {"workers", nlohmann::json::array()}};
  }
  nlohmann::ordered_json job(JobId job) override {
    const std::lock_guard lock(mutex_);
    if (job != 3) return {};
    return {{"job", 3}, {"name", name_}, {"problems", {"a worker was lost"}}};
  }
  std::optional<WebPicture> picture(JobId job, int largest_side) override {
    if (job != 3) return {};
    return WebPicture{std::make_shared<const std::string>("picture of " + std::to_string(largest_side)),
                      "v1"};
  }
  std::optional<std::filesystem::path> file(JobId job, const std::string& name) override {
    const auto found = files.find(name);
    return job == 3 && found != files.end() ? std::optional(found->second) : std::nullopt;
  }

  void rename(const std::string& name) {
    const std::lock_guard lock(mutex_);
    name_ = name;
  }
  [[nodiscard]] int asked() {
    const std::lock_guard lock(mutex_);
    return asked_;
  }

  std::map<std::string, std::filesystem::path> files;

 private:
  std::mutex mutex_;
  std::string name_ = "box.xml";
  int asked_ = 0;
};

}  // namespace penumbra
