#include "scheduler/service/end_hook.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <thread>
#include <vector>

#include "kernels/host/console.h"
#include "kernels/host/text.h"
#include "scheduler/farm/child_processes.h"
#include "scheduler/service/group_summary.h"
#include "scheduler/service/status_text.h"

namespace penumbra {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks{50};

std::map<std::string, std::string> fields_of(const JobQueue::Ended& ended) {
  std::map<std::string, std::string> fields{{"job", fmt::to_string(ended.number)}};
  const auto add = [&](std::string kind, JobId group, std::string name, std::string_view state,
                       std::string submitter, std::string error) {
    fields["kind"] = std::move(kind);
    fields["group"] = fmt::to_string(group);
    fields["name"] = std::move(name);
    fields["state"] = state;
    fields["submitter"] = std::move(submitter);
    fields["error"] = std::move(error);
  };
  if (ended.is_group) {
    const GroupSummary group = group_summaries(ended.status).at(0);
    add("group", ended.number, group.group.name(), job_state_name(group.state), group.submitter, "");
  } else {
    const wire::JobStatus& job = ended.status.jobs(0);
    add(job.group() > 0 ? "frame" : "job", job.group(), job.name(), job_state_name(job.state()),
        job.submitter(), job.error());
  }
  return fields;
}

std::vector<std::string> names_of_fields() {
  JobQueue::Ended example;
  example.status.add_jobs();
  std::vector<std::string> names;
  for (const auto& [name, value] : fields_of(example)) names.push_back(name);
  return names;
}

std::string variable_of(std::string name) {
  std::ranges::transform(name, name.begin(), [](char c) { return char(c - 'a' + 'A'); });
  return "PENUMBRA_" + name;
}

}  // namespace

Expected<EndHook> EndHook::make(const std::string& command) {
  const std::vector<std::string> names = names_of_fields();
  std::string script;
  char quote = 0;  // the quotes that the text is in, or 0
  for (std::size_t at = 0; at < command.size(); ++at) {
    const char c = command[at];
    if (c == '{' && (at == 0 || command[at - 1] != '$')) {
      const std::size_t end = command.find_first_not_of("abcdefghijklmnopqrstuvwxyz", at + 1);
      if (end != std::string::npos && command[end] == '}' && end > at + 1) {
        const std::string name = command.substr(at + 1, end - at - 1);
        if (std::ranges::find(names, name) == names.end())
          return fail(fmt::format("'{{{}}}' is no field of a job's end; these are: {{{}}}", name,
                                  fmt::join(names, "}, {")));
        const std::string value = "${" + variable_of(name) + "}";
        script += quote == '"' ? value : quote == '\'' ? "'\"" + value + "\"'" : '"' + value + '"';
        at = end;
        continue;
      }
    }
    if (c == '\\' && quote != '\'' && at + 1 < command.size()) {
      script += c;
      script += command[++at];
      continue;
    }
    if (quote == 0 && (c == '"' || c == '\''))
      quote = c;
    else if (c == quote)
      quote = 0;
    script += c;
  }
  return EndHook(std::move(script));
}

Expected<void> EndHook::call(const JobQueue::Ended& ended, const std::atomic<bool>& stop) const {
  std::vector<std::string> environment;
  for (const auto& [name, value] : fields_of(ended))
    environment.push_back(variable_of(name) + "=" + visible_text(value));
  const auto complain = [&](const std::string& how) {
    return fail(fmt::format("--on-done for {} {}: {}", ended.is_group ? "group" : "job", ended.number, how));
  };
  ChildProcesses shell("/bin/sh", {"-c", script_});
  if (const auto started = shell.start(std::move(environment)); !started)
    return complain(started.error().message);
  const auto begin = std::chrono::steady_clock::now();
  for (;;) {
    for (const ChildExit& exit : shell.reap())
      return exit.code == 0 ? Expected<void>() : complain("it ended with " + exit.how);
    if (stop) return complain("stopped, as this service ends; the next one calls it again");
    if (std::chrono::steady_clock::now() - begin > kLimit)
      return complain(fmt::format("it took more than {} minutes and was killed", kLimit.count()));
    std::this_thread::sleep_for(kBetweenLooks);
  }
}

}  // namespace penumbra
