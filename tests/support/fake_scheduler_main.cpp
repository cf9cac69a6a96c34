// A process that renders with fake workers until a test kills it. Usage: fake_scheduler WORKER_EXECUTABLE
// [LISTEN_ADDRESS].
#include <atomic>

#include "tests/support/fake_device.h"
#include "tests/support/local_render.h"

int main(int argc, char** argv) {
  using namespace penumbra;
  if (argc != 2 && argc != 3) return 2;
  LocalRender job;
  job.scene = fake_scene(256, 256, false);
  job.width = job.height = 256;
  job.request.plan.tile = 16;
  job.spp = 1000;
  job.request.plan.samples_per_pass = 1;
  job.workers = 3;
  job.worker_executable = argv[1];
  if (argc == 3) job.listen = argv[2];
  const std::atomic<bool> stop = false;
  return run_render(job, stop, {}) ? 0 : 1;
}
