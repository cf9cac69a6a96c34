// penumbra-worker: renders what a scheduler asks for.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <exception>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "kernels/host/console.h"
#include "kernels/host/words.h"
#include "scheduler/cli/command_line.h"
#include "scheduler/cli/command_reference.h"
#include "scheduler/keys/client_access.h"
#include "scheduler/protocol/grpc_log.h"
#include "scheduler/protocol/message_memory.h"
#include "scheduler/protocol/token.h"
#include "worker/device.h"
#include "worker/measure_compile.h"
#include "worker/opencl_devices.h"
#include "worker/worker_client.h"

namespace {

constexpr int kFailed = 1;
constexpr int kBadUsage = 2;

/// Ends the parse, as --help does.
void list_devices() {
  using namespace penumbra;
  std::string isas;
  for (int i = 0; i <= int(best_isa()); ++i) isas += fmt::format("{}{}", i > 0 ? ", " : "", isa_name(Isa(i)));
  const std::vector<OpenClDeviceInfo> devices = list_opencl_devices();
  print_answer(fmt::format("native: {}; {}\nOpenCL:{}{}\n", isas,
                           counted(std::thread::hardware_concurrency(), "core"),
                           devices.empty() ? " no device" : "\n", opencl_device_table(devices)));
  throw CLI::Success();
}

int run(int argc, char** argv) {
  using namespace penumbra;
  if (argc > 1 && std::string_view(argv[1]) == kMeasureCompile) return measure_compile(argc - 2, argv + 2);
  WorkerClientOptions options;
  std::string backend, isa, opencl_device, keys;
  int threads = 0;

  CLI::App app{
      "Renders work units for a penumbra scheduler. `penumbra render` starts workers by itself; start one by "
      "hand only to join a scheduler that runs elsewhere.",
      "penumbra-worker"};
  app.set_version_flag("--version", "penumbra-worker " PENUMBRA_VERSION);
  app.add_option("--connect", options.address,
                 "The scheduler: unix:/path or host:port, the latter with --keys or with the token that it "
                 "printed in PENUMBRA_TOKEN")
      ->required();
  add_client_access_options(app, keys);
  app.add_option(
         "--retry-for", options.retry_for,
         "How many seconds to look for a scheduler that is not there yet or no more, with pauses that "
         "grow to 15 s; inf: for ever")
      ->type_name("SECONDS")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  const auto* backend_option =
      app.add_option("--backend", backend,
                     "Compute with this instead of what the job says: native, opencl or auto")
          ->check(CLI::IsMember({"native", "opencl", "auto"}));
  const auto* threads_option =
      app.add_option("--threads", threads, "Use so many threads, whatever the job says")
          ->check(CLI::Range(1, kMaxThreads));
  const auto* isa_option = app.add_option(
      "--isa", isa, "native: use this instruction set, whatever the job says: sse2, avx2 or avx512");
  const auto* opencl_option = app.add_option(
      "--opencl-device,--device", opencl_device,
      "opencl: the device of this number in the list, or whose or whose platform's name contains "
      "this");
  app.add_flag_callback("--list-devices", list_devices, "List what can compute here, and end")
      ->trigger_on_parse();
  if (const auto answered = answer_about(app, {argv + 1, argv + argc})) return *answered;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return end_of_parse(app, error);
  }

  if (*backend_option) {
    if (const auto used = check_backend_options(backends_in_use(backend), opencl_device, isa); !used) {
      print_error(used.error());
      return kBadUsage;
    }
  }
  const Isa best = best_isa();
  for (int i = 0; i <= int(best); ++i) options.isas.push_back(Isa(i));
  if (*backend_option) options.backend = backend_from_name(backend);
  if (*threads_option) options.threads = threads;
  if (*opencl_option) {
    const Expected<OpenClDeviceInfo> found = find_opencl_device(opencl_device);
    if (!found) {
      print_error(found.error());
      return kBadUsage;
    }
    options.opencl_device = opencl_device;
  }
  if (*isa_option) {
    const Expected<Isa> named = isa_from_name(isa);
    if (!named || *named > best) {
      print_error(named ? Error{fmt::format("--isa {}: this machine goes up to {}", isa, isa_name(best))}
                        : named.error());
      return kBadUsage;
    }
    options.isa = *named;
    options.isas = {*named};  // what it will not use it does not have, or an Embree job would rely on it
  }
  auto access = client_access(options.address, keys, KeyRole::kWorker);
  if (!access) {
    print_error(access.error());
    return kBadUsage;
  }
  options.token = access->token;
  options.keys = access->keys;
  options.reconnects = std::getenv(kWorkerKeyVariable) == nullptr;
  if (options.reconnects)
    options.on_waiting = [](const std::string& why) { print_message("waiting: " + why); };
  options.make_device = make_device;
  options.on_connection_lost = [](const Error& error) {
    print_error(error);
    std::_Exit(kFailed);  // the unit in hand cannot be interrupted, and its result is no longer needed
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
