// A worker process with the real client and a fake device.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/support/fake_device.h"
#include "worker/keys/client_access.h"
#include "worker/worker_client.h"

int main(int argc, char** argv) {
  using namespace penumbra;
  if (argc != 3 || std::string(argv[1]) != "--connect") return 2;
  const FakeBehaviour behaviour = FakeBehaviour::from_environment();
  if (behaviour.die_at_start != 0) return 3;
  WorkerClientOptions options;
  options.address = argv[2];
  if (const char* token = std::getenv(kTokenVariable)) options.token = token;
  for (int i = 0; i < behaviour.isas; ++i) options.isas.push_back(Isa(i));
  options.make_device = [&](const DeviceScene& scene, const DeviceOptions& device) {
    return make_fake_device(scene, device, behaviour);
  };
  options.on_connection_lost = [](const Error&) { std::_Exit(1); };
  const Expected<void> worked = run_worker(options);
  if (!worked) std::fprintf(stderr, "fake worker: %s\n", worked.error().message.c_str());
  return worked ? EXIT_SUCCESS : EXIT_FAILURE;
}
