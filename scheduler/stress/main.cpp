// penumbra-stress: tests numerically hard cases against high-precision results.
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "kernels/host/atomic_file.h"
#include "kernels/host/console.h"
#include "kernels/host/parallel.h"
#include "kernels/host/process.h"
#include "scenes/diagnostic.h"
#include "scheduler/files/output_check.h"
#include "scheduler/record/version.h"
#include "scheduler/render/option_checks.h"
#include "scheduler/stress/backend.h"
#include "scheduler/stress/run.h"
#include "scheduler/stress/selection.h"
#include "scheduler/stress/table.h"
#include "worker/cli/command_line.h"
#include "worker/cli/command_reference.h"
#include "worker/cli/exit_code.h"
#include "worker/cli/help_text.h"
#include "worker/device.h"

namespace penumbra::stress {
namespace {

struct Options {
  std::vector<std::string> cases;
  std::string json, html, backend = "both", opencl_device;
  int threads = int(core_count());
  bool list = false;
};

constexpr const char* kFooter =
    "Exit code: 0 all cases that could run pass, 1 a case fails, 2 bad usage.\n\n"
    "Examples:\n"
    "  penumbra stress\n"
    "  penumbra stress --case polygon/ --case '*phong*1e5*'\n"
    "  penumbra stress --backend native --json stress.json --html stress.html";

void add_options(CommandLine& app, Options& options) {
  app.default_group("Cases");
  app.add_option("--case", options.cases,
                 "Only cases whose name contains this, or matches it with * and ?; repeatable")
      ->type_name("NAME")
      ->repeatable();
  app.add_flag("--list", options.list, "Show the cases instead of running them");
  app.default_group(group::kWorkers);
  app.add_option("--backend", options.backend, "What computes")
      ->check(one_of({"native", "opencl", "both"}))
      ->type_name("NAME")
      ->capture_default_str();
  app.add_option("--opencl-device", options.opencl_device,
                 "Part of the name of an OpenCL device or its platform")
      ->type_name("NAME");
  app.add_option("--threads", options.threads, "Threads of renders")
      ->type_name("N")
      ->check(whole_number(1, kMaxThreads))
      ->capture_default_str();
  app.default_group(group::kOutput);
  app.add_option("--json", options.json, "Also write the table as JSON")->type_name("FILE");
  app.add_option("--html", options.html, "Also write the table as a page")->type_name("FILE");
  app.footer(kFooter);
}

std::vector<Backend> make_backends(const Options& options) {
  std::vector<Backend> backends;
  if (options.backend != "opencl") backends = native_backends(options.threads);
  if (options.backend != "native") backends.push_back(opencl_backend(options.threads, options.opencl_device));
  return backends;
}

std::string describe(const Backend& backend) {
  if (!backend.skipped.empty()) return backend.name + ": skipped: " + backend.skipped;
  if (!backend.broken.empty()) return backend.description + ": BROKEN: " + backend.broken;
  return backend.description;
}

/// Shows the current case on a terminal.
void show_progress(const Case& c) { redraw_line(c.name); }

ExitCode run(const Options& options) {
  Expected<std::vector<Case>> cases = select(all_cases(), options.cases);
  if (!cases) return print_error(cases.error()), kBadInput;
  if (options.list) return print_answer(list_text(*cases)), kAllDone;
  std::vector<std::filesystem::path> outputs;
  for (const std::string& file : {options.json, options.html})
    if (!file.empty()) outputs.emplace_back(file);
  if (const auto checked = check_outputs(outputs, {}); !checked)
    return print_error(checked.error()), kBadInput;
  if (const auto used = check_backend_options(backends_in_use(options.backend), options.opencl_device, "");
      !used)
    return print_error(used.error()), kBadInput;
  const auto start = std::chrono::steady_clock::now();
  std::vector<Backend> backends = make_backends(options);
  TableContext context;
  context.host = host_name();
  context.date = utc_now();
  context.version = kVersion;
  for (const Backend& backend : backends) context.backends.push_back(describe(backend));
  const bool terminal = isatty(STDERR_FILENO) != 0;
  const std::vector<CaseResult> results =
      run_cases(*cases, backends, [&](const Case& c) { terminal ? show_progress(c) : void(); });
  clear_line();
  context.seconds = seconds_since(start);
  print_answer(table_text(results, context));
  if (!options.json.empty()) {
    if (const auto done = write_output(options.json, bytes_of(table_json(results, context).dump(1) + "\n"));
        !done)
      return print_error(done.error()), kIncomplete;
  }
  if (!options.html.empty()) {
    if (const auto done = write_output(options.html, bytes_of(table_html(results, context))); !done)
      return print_error(done.error()), kIncomplete;
  }
  return all_pass(count(results)) ? kAllDone : kIncomplete;
}

}  // namespace
}  // namespace penumbra::stress

int main(int argc, char** argv) {
  using namespace penumbra;
  begin_program("penumbra stress");
  CommandLine app("Check stiff and extreme cases against high-precision references, on every backend",
                  "penumbra stress");
  stress::Options options;
  stress::add_options(app, options);
  if (const auto answered = answer_about(app, {argv + 1, argv + argc})) return end_program(*answered);
  if (const auto ended = app.parse(argc, argv)) return end_program(*ended);
  try {
    return end_program(stress::run(options));
  } catch (const std::exception& error) {
    print_error({fmt::format("internal error: {}", error.what())});
  }
  return kIncomplete;
}
