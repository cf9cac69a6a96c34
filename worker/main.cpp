// penumbra-worker: renders what a scheduler asks for.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "scheduler/protocol/message_memory.h"
#include "worker/device.h"
#include "worker/worker_client.h"

namespace {

constexpr int kFailed = 1;
constexpr int kBadUsage = 2;

void complain(const std::string& message) { fmt::print(stderr, "penumbra-worker: {}\n", message); }

}  // namespace

int main(int argc, char** argv) {
  using namespace penumbra;
  keep_message_memory();
  WorkerClientOptions options;
  std::string backend, isa, opencl_device;
  int threads = 0;

  CLI::App app{
      "Renders work units for a penumbra scheduler. `penumbra render` starts workers by itself; start one by "
      "hand only to join a scheduler that runs elsewhere.",
      "penumbra-worker"};
  app.set_version_flag("--version", "penumbra-worker " PENUMBRA_VERSION);
  app.add_option("--connect", options.address, "The scheduler: unix:/path or host:port")->required();
  const auto* backend_option =
      app.add_option("--backend", backend, "Compute with this instead of what the job says: native or opencl")
          ->check(CLI::IsMember({"native", "opencl"}));
  const auto* threads_option =
      app.add_option("--threads", threads, "Use so many threads, whatever the job says")
          ->check(CLI::Range(1, 4096));
  const auto* isa_option = app.add_option(
      "--isa", isa, "native: use this instruction set, whatever the job says: sse2, avx2 or avx512");
  const auto* opencl_option = app.add_option(
      "--opencl-device", opencl_device, "opencl: the device whose name, or platform's name, contains this");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? EXIT_SUCCESS : kBadUsage;
  }

  const Isa best = best_isa();
  for (int i = 0; i <= int(best); ++i) options.isas.push_back(Isa(i));
  if (*backend_option) options.backend = backend == "opencl" ? Backend::kOpenCl : Backend::kNative;
  if (*threads_option) options.threads = threads;
  if (*opencl_option) options.opencl_device = opencl_device;
  if (*isa_option) {
    const Expected<Isa> named = isa_from_name(isa);
    if (!named || *named > best) {
      complain(named ? fmt::format("--isa {}: this machine goes up to {}", isa, isa_name(best))
                     : named.error().message);
      return kBadUsage;
    }
    options.isa = *named;
  }
  options.make_device = make_device;
  options.on_connection_lost = [](const Error& error) {
    complain(error.message);
    std::_Exit(kFailed);  // the unit in hand cannot be interrupted, and nobody waits for it
  };

  if (const Expected<void> worked = run_worker(options); !worked) {
    complain(worked.error().message);
    return kFailed;
  }
  return EXIT_SUCCESS;
}
