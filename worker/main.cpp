// penumbra-worker: renders for a scheduler.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "kernels/host/console.h"
#include "kernels/host/text.h"
#include "worker/cli/access_options.h"
#include "worker/cli/command_line.h"
#include "worker/cli/command_reference.h"
#include "worker/cli/help_text.h"
#include "worker/device.h"
#include "worker/keys/client_access.h"
#include "worker/measure_compile.h"
#include "worker/native_device.h"
#include "worker/opencl_devices.h"
#include "worker/protocol/grpc_log.h"
#include "worker/protocol/message_memory.h"
#include "worker/protocol/token.h"
#include "worker/worker_client.h"

namespace {

constexpr int kFailed = 1;
constexpr int kBadUsage = 2;

/// Instruction sets that this machine supports but the build lacks.
std::string isas_left_out() {
  using namespace penumbra;
  std::vector<Isa> left_out;
  for (const Isa isa : kIsas)
    if (machine_has(isa) && find_native_kernel(isa) == nullptr) left_out.push_back(isa);
  return left_out.empty() ? "" : fmt::format(" (not built, see PENUMBRA_ISA: {})", isa_list(left_out));
}

void list_devices() {
  using namespace penumbra;
  const std::vector<OpenClDeviceInfo> devices = list_opencl_devices();
  print_answer(fmt::format("native: {}{}; {}\nOpenCL:{}{}\n", isa_list(usable_isas()), isas_left_out(),
                           counted(std::thread::hardware_concurrency(), "core"),
                           devices.empty() ? " no device" : "\n", opencl_device_table(devices)));
}

/// The cores that this process may use: those that a job queue assigned to the task, else those that it is
/// bound to.
int cores_of_this_process() {
  int given = 0;
  if (const char* text = std::getenv("SLURM_CPUS_PER_TASK"))
    std::from_chars(text, text + std::strlen(text), given);
  return std::clamp(given > 0 ? given : int(std::thread::hardware_concurrency()), 1, penumbra::kMaxThreads);
}

int end_pipe[2];

void on_end_signal(int) {
  std::signal(SIGTERM, SIG_DFL);
  std::signal(SIGINT, SIG_DFL);
  [[maybe_unused]] const auto written = write(end_pipe[1], "", 1);
}

/// Handles SIGTERM (from a queue that reclaims the machine and waits briefly) and SIGINT (from a terminal):
/// the worker tells its scheduler, which then need not wait for the unit, and ends.
std::stop_token stop_by_signal() {
  std::stop_source source;
  if (pipe2(end_pipe, O_CLOEXEC) != 0) return {};
  struct sigaction action {};
  action.sa_handler = on_end_signal;
  action.sa_flags = SA_RESTART;
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
  std::thread([source]() mutable {
    char byte;
    while (read(end_pipe[0], &byte, 1) != 1) {
    }
    source.request_stop();
    std::_Exit(EXIT_SUCCESS);
  }).detach();
  return source.get_token();
}

int run(int argc, char** argv) {
  using namespace penumbra;
  if (argc > 1 && std::string_view(argv[1]) == kMeasureCompile) return measure_compile(argc - 2, argv + 2);
  WorkerClientOptions options;
  std::string backend, isa, opencl_device, keys, threads;

  CommandLine app{
      "Render work units for a Penumbra scheduler. `penumbra render` starts its workers itself; start one by "
      "hand only to join a scheduler that runs elsewhere",
      "penumbra-worker"};
  app.add_version([] { return "penumbra-worker " PENUMBRA_VERSION; });
  app.default_group(group::kNetwork);
  app.add_option("--connect", options.address,
                 "Address of the scheduler: unix:/path, or HOST:PORT with --keys, or with the token that it "
                 "printed in PENUMBRA_TOKEN. file:PATH: what a scheduler with --address-file PATH writes "
                 "there; it is read again when the scheduler moves")
      ->type_name("ADDRESS")
      ->required();
  add_client_access_options(app, keys);
  app.add_option(
         "--retry-for", options.retry_for,
         "Time to wait for a scheduler that is not there yet, or no longer, with pauses of up to 15 s; inf: "
         "for ever. After that the exit code is 1")
      ->type_name("SECONDS")
      ->check({[](const std::string& text) {
                 char* end = nullptr;
                 const double seconds = std::strtod(text.c_str(), &end);  // takes "inf", too
                 const bool is_number = !text.empty() && *end == '\0' && !std::isnan(seconds);
                 return is_number && seconds >= 0 ? std::string()
                                                  : "'" + text + "' is not a number from 0 up, or inf";
               },
               "0 or above"})
      ->capture_default_str();
  app.default_group(group::kWorkers);
  const auto* backend_option = app.add_option("--backend", backend, "Backend, whatever the job says")
                                   ->type_name("NAME")
                                   ->check(one_of({"native", "opencl", "auto"}));
  const auto* threads_option =
      app.add_option("--threads", threads, "Threads, whatever the job says; auto: as many as it has cores")
          ->type_name("N")
          ->check(whole_number_or(1, kMaxThreads, "auto"));
  const auto* isa_option = app.add_option(
      "--isa", isa, "Instruction set of the native backend, whatever the job says: sse2, avx2 or avx512");
  const auto* opencl_option =
      app.add_option("--opencl-device,--device", opencl_device,
                     "OpenCL device: its number, or part of its name or its platform's");
  app.option("--isa")->type_name("NAME");
  app.option("--device")->type_name("NAME");
  app.default_group("Scene cache");
  std::string cache;
  app.add_option("--cache", cache,
                 "Folder that keeps scenes for the next start; workers may share it. off: none (default: "
                 "~/.cache/penumbra/scenes with a scheduler at HOST:PORT; a local disk is better where home "
                 "is on a network). Also PENUMBRA_CACHE")
      ->type_name("FOLDER");
  app.add_option("--cache-size", options.cache_bytes, "Most that the folder may hold, as in 20G")
      ->type_name("SIZE")
      ->transform(size_in_bytes())
      // Checked before the transformation above: they run in the opposite order.
      ->transform({[](std::string& text) { return text.starts_with('-') ? "it is below 0" : ""; }})
      ->default_str("4G");
  app.add_action_flag("--list-devices", list_devices, "List instruction sets and OpenCL devices, and end")
      ->group(group::kGeneral);
  if (const auto answered = answer_about(app, {argv + 1, argv + argc})) return *answered;
  if (const auto ended = app.parse(argc, argv)) return *ended;

  if (backend_option->is_given()) {
    if (const auto used = check_backend_options(backends_in_use(backend), opencl_device, isa); !used) {
      print_error(used.error());
      return kBadUsage;
    }
  }
  options.cache = cache.empty() ? default_piece_cache(options.address) : std::filesystem::path(cache);
  if (cache == "off") options.cache.clear();
  options.isas = usable_isas();
  if (backend_option->is_given()) options.backend = backend_from_name(backend);
  if (threads_option->is_given())
    options.threads = threads == "auto" ? cores_of_this_process() : std::stoi(threads);
  if (opencl_option->is_given()) {
    const Expected<OpenClDeviceInfo> found = find_opencl_device(opencl_device);
    if (!found) {
      print_error(found.error());
      return kBadUsage;
    }
    options.opencl_device = opencl_device;
  }
  if (isa_option->is_given()) {
    const Expected<Isa> named = usable_isa(isa);
    if (!named) {
      print_error(named.error());
      return kBadUsage;
    }
    options.isa = *named;
    options.isas = {*named};  // otherwise an Embree job might rely on a set that is not used
  }
  auto access = client_access(options.address, keys, KeyRole::kWorker);
  if (!access) {
    print_error(access.error());
    return kBadUsage;
  }
  options.token = access->token;
  options.keys = access->keys;
  options.reconnects = std::getenv(kWorkerKeyVariable) == nullptr;
  if (options.reconnects) options.on_waiting = [](const std::string& text) { print_message(text); };
  options.make_device = make_device;
  options.leave = stop_by_signal();
  options.leave_reason = "it was told to end by a signal";
  options.on_connection_lost = [](const Error& error) {
    print_error(error);
    std::_Exit(kFailed);  // the current unit cannot be interrupted, and its result is no longer needed
  };

  if (const Expected<void> worked = run_worker(options); !worked) {
    print_error(worked.error());
    return kFailed;
  }
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  penumbra::begin_program("penumbra-worker");
  penumbra::keep_message_memory();
  penumbra::route_grpc_log();
  try {
    return penumbra::end_program(run(argc, argv));
  } catch (const std::exception& error) {
    penumbra::print_error({fmt::format("internal error: {}", error.what())});
  }
  return kFailed;
}
