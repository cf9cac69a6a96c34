#include "tests/differential/mitsuba_process.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include "scheduler/image/image.h"

namespace penumbra::differential {

MitsubaProcess::MitsubaProcess() {
  const char* name = std::getenv("PENUMBRA_MITSUBA_PYTHON");
  named_ = name != nullptr && *name != '\0';
  std::string python = named_ ? name : "python3",
              script = PENUMBRA_SOURCE_DIR "/tests/differential/render_with_mitsuba.py";
  std::array<char*, 3> argv = {python.data(), script.data(), nullptr};
  std::array<int, 2> jobs{}, answers{};
  if (pipe(jobs.data()) != 0 || pipe(answers.data()) != 0) throw std::runtime_error("pipe failed");
  // One that ended is noticed by its missing answer.
  std::signal(SIGPIPE, SIG_IGN);
  pid_ = fork();
  if (pid_ < 0) throw std::runtime_error("fork failed");
  if (pid_ == 0) {
    dup2(jobs[0], STDIN_FILENO);
    dup2(answers[1], STDOUT_FILENO);
    for (const int end : {jobs[0], jobs[1], answers[0], answers[1]}) close(end);
    execvp(argv[0], argv.data());
    _exit(127);
  }
  close(jobs[0]);
  close(answers[1]);
  to_ = fdopen(jobs[1], "w");
  from_ = fdopen(answers[0], "r");
  const std::string first = line();
  if (!first.starts_with("ready")) {
    ready_ = fail(
        fmt::format("Mitsuba 3 is not there: {} cannot load it (what it says is above). To have it: python3 "
                    "-m venv mi && mi/bin/pip install mitsuba, and PENUMBRA_MITSUBA_PYTHON=mi/bin/python",
                    python));
  }
}

MitsubaProcess::~MitsubaProcess() {
  std::fclose(to_);
  std::fclose(from_);
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

std::string MitsubaProcess::line() {
  std::string result;
  for (int c = std::fgetc(from_); c != EOF && c != '\n'; c = std::fgetc(from_)) result += char(c);
  return result;
}

void MitsubaProcess::start(const MitsubaJob& job) {
  fmt::print(to_, "{}\t{}\t{}\t{}\t{}\n", job.scene.string(), job.image.string(), job.batches, job.spp,
             job.first_seed);
  std::fflush(to_);
}

Expected<std::vector<statistics::Image>> MitsubaProcess::finish(const MitsubaJob& job) {
  const std::string answer = line();
  if (answer != "done") return fail(fmt::format("Mitsuba: {}", answer.empty() ? "it ended" : answer));
  const auto image = read_image(job.image);
  if (!image) return std::unexpected(image.error());
  const auto channels = image->beauty_channels();
  if (!channels || image->data.height % job.batches != 0)
    return fail("Mitsuba's image is no stack of batches");
  const int height = image->data.height / job.batches;
  std::vector<statistics::Image> batches;
  for (int batch = 0; batch < job.batches; ++batch) {
    statistics::Image& each = batches.emplace_back(image->data.width, height, 3);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < each.width; ++x)
        for (int c = 0; c < 3; ++c)
          each.at(x, y, c) = double(image->at(x, batch * height + y, (*channels)[std::size_t(c)]));
  }
  return batches;
}

}  // namespace penumbra::differential
