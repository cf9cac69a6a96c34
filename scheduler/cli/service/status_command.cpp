// `penumbra status`: shows the state of a service.
#include <fmt/format.h>

#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "scheduler/cli/commands.h"
#include "scheduler/cli/service/chosen_jobs.h"
#include "scheduler/cli/service/service_address.h"
#include "scheduler/cli/service/terminal_screen.h"
#include "scheduler/files/stop_signal.h"
#include "scheduler/service/status_text.h"
#include "worker/cli/help_text.h"

namespace penumbra {
namespace {

constexpr int kBetweenScreens = 500;  // in milliseconds
constexpr int kMostMessages = 5;
constexpr int kLongestLine = 1000;  // if the output is not a terminal

struct StatusOptions {
  ServiceAddress service;
  std::vector<std::string> jobs;
  bool watch = false, json = false, unfolded = false;
};

/// The last messages of the service, at most `most`.
std::vector<std::string> last_messages(const wire::StatusReply& status, int most) {
  const int shown = std::min({status.messages_size(), most, kMostMessages});
  return {status.messages().end() - std::max(0, shown), status.messages().end()};
}

/// Runs until q or Ctrl-C. If the service is away, it waits for it and keeps showing the last state.
ExitCode watch(JobsClient& service, const std::vector<JobId>& jobs, bool unfolded) {
  const std::atomic<bool>& stop = install_stop_signal();
  auto screen = TerminalScreen::open();
  if (!screen) return print_error(screen.error()), kBadInput;
  std::vector<std::string> messages;
  std::optional<wire::StatusReply> last;
  while (!stop) {
    auto status = service.status(jobs);
    if (!status && !service.is_away()) {
      const Error error = status.error();
      { const TerminalScreen closed = std::move(*screen); }
      return print_error(error), kIncomplete;
    }
    if (status) last = std::move(*status);
    const auto [columns, rows] = screen->size();
    std::vector<std::string> lines;
    if (last) {
      lines = status_lines(*last, columns, std::max(1, rows - 4), unfolded);
      const int room = std::max(0, rows - 1 - int(lines.size()));
      for (const std::string& message : last_messages(*last, room))
        lines.push_back(fitted_line(message, columns));
    }
    const std::string keys = unfolded ? "q: quit, f: fold groups" : "q: quit, f: show jobs of groups";
    lines.push_back(fitted_line(status ? keys : keys + "; trying again: " + status.error().message, columns));
    screen->show(lines);
    const int key = screen->key(kBetweenScreens);
    if (key == 'q' || key == 'Q' || key < 0) break;
    if (key == 'f' || key == 'F') unfolded = !unfolded;
  }
  return kAllDone;
}

ExitCode status(const StatusOptions& options) {
  const auto connected = connect_to_service(options.service, KeyRole::kViewer);
  if (!connected) return print_error(connected.error()), kBadInput;
  JobsClient& service = **connected;
  const auto jobs = numbers_of(options.jobs, service);
  if (!jobs) return print_error(jobs.error()), kIncomplete;
  const bool unfolded = options.unfolded || !options.jobs.empty();
  if (options.watch) return watch(service, *jobs, unfolded);
  const auto reply = service.status(*jobs);
  if (!reply) return print_error(reply.error()), kIncomplete;
  if (options.json) {
    print_answer(status_json(*reply).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
    return kAllDone;
  }
  for (const std::string& line :
       status_lines(*reply, kLongestLine, std::numeric_limits<int>::max() / 2, unfolded))
    print_answer(line + "\n");
  if (options.jobs.empty())
    for (const std::string& message : last_messages(*reply, kMostMessages))
      print_answer(fitted_line(message, kLongestLine) + "\n");
  return kAllDone;
}

}  // namespace

void add_status_command(CommandLine& app, Command& chosen) {
  CommandLine* command = app.add_command("status", "Show jobs, workers, rates and time left");
  const auto options = std::make_shared<StatusOptions>();
  add_jobs(*command, options->jobs);
  Option* watched = command->add_flag("--watch", options->watch, "Show a full screen that is kept up to date")
                        ->group(group::kOutput);
  command->add_flag("--jobs", options->unfolded, "List the jobs of groups too, as if the groups were named")
      ->group(group::kOutput);
  command->add_flag("--json", options->json, "Print JSON")->excludes(watched)->group(group::kOutput);
  add_service_address(*command, options->service);
  command->footer(
      "`penumbra view --connect ADDRESS` shows the image that is being rendered.\n\n"
      "Examples:\n"
      "  penumbra status --to unix:/tmp/farm.socket\n"
      "  penumbra status 12 --json --to unix:/tmp/farm.socket");
  command->callback([options, &chosen] { chosen = [options] { return status(*options); }; });
}

}  // namespace penumbra
