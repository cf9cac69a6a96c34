#include "scheduler/web/web_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "scheduler/service/status_text.h"
#include "scheduler/web/web_access.h"

namespace penumbra {
namespace {

constexpr int kMostJobs = 500;

JobInterest interest(const wire::JobStatus& job) {
  return job_interest(job.state(), job.priority(), job.ended(), job.job());
}

}  // namespace

Expected<WebPage> web_page_of(const std::string& address, const std::string& folder) {
  if (address.empty()) return WebPage{};
  if (const auto checked = check_web_address(address, !folder.empty()); !checked)
    return fail("--web: " + checked.error().message);
  if (!is_encrypted_at(address)) return WebPage{address};
  auto keys = read_keys(folder, KeyRole::kScheduler);
  if (!keys) return fail("--keys: " + keys.error().message);
  return WebPage{address, std::move(*keys)};
}

Expected<std::unique_ptr<WebServer>> open_web_page(const WebPage& page, const std::string& token,
                                                   bool comes_back, WebContent& content) {
  WebOptions options{.address = page.address, .tokens = {token}, .keys = page.keys, .comes_back = comes_back};
  if (page.keys) options.tokens = {page.keys->tokens.watch};
  auto server = WebServer::listen(options, content);
  if (!server) return fail("--web: " + server.error().message);
  return server;
}

std::string web_page_notice(const WebServer& server, const WebPage& page) {
  if (!page.keys) return "in a browser: " + server.url_with_token();
  return fmt::format("in a browser: {}?token=… with the contents of {} of the keys for {} ('{}')",
                     server.url(), key_files::token("watch"), info(KeyRole::kViewer).who,
                     info(KeyRole::kViewer).folder);
}

nlohmann::ordered_json web_page_status(wire::StatusReply status) {
  const int all = status.jobs_size();
  nlohmann::ordered_json groups = groups_json(status);  // also of jobs that are left out
  if (all > kMostJobs) {
    auto& jobs = *status.mutable_jobs();
    std::partial_sort(jobs.begin(), jobs.begin() + kMostJobs, jobs.end(),
                      [](const auto& a, const auto& b) { return interest(a) < interest(b); });
    for (nlohmann::ordered_json& group : groups) {
      nlohmann::ordered_json& left_out = group["frames_left_out"] = nlohmann::ordered_json::array();
      for (int i = kMostJobs; i < all; ++i)
        if (const wire::JobStatus& job = jobs[i]; job.has_frame() && job.group() == group["group"])
          left_out.push_back({{"job", job.job()},
                              {"name", job.name()},
                              {"state", job_state_name(job.state())},
                              {"frame", job.frame()}});
    }
    jobs.DeleteSubrange(kMostJobs, all - kMostJobs);
  }
  nlohmann::ordered_json json = status_json(status);
  json["groups"] = std::move(groups);
  json["jobs_left_out"] = all - status.jobs_size();
  return json;
}

}  // namespace penumbra
