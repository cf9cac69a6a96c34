#include "scheduler/files/program_path.h"

#include <fmt/format.h>
#include <unistd.h>
#include <xxhash.h>

#include <cstdlib>
#include <sstream>

#include "kernels/host/plain_file.h"
#include "kernels/host/text.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

bool is_executable(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) && access(path.c_str(), X_OK) == 0;
}

}  // namespace

Expected<fs::path> find_program(const std::string& name) {
  std::error_code failed;
  const fs::path self = fs::read_symlink("/proc/self/exe", failed);
  const fs::path beside = self.parent_path() / name;
  if (!failed && is_executable(beside)) return beside;
  const char* search_path = std::getenv("PATH");
  std::istringstream folders(search_path != nullptr ? search_path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path candidate = fs::path(folder.empty() ? "." : folder) / name;
    if (is_executable(candidate)) return fs::absolute(candidate);
  }
  return fail(fmt::format("cannot find the program {}: it is neither in {} nor in PATH", name,
                          self.parent_path().string()));
}

std::string program_hash(const fs::path& program) {
  constexpr std::uint64_t kMaxProgramBytes = std::uint64_t{4} << 30;
  const std::string bytes = read_plain_file(program, kMaxProgramBytes).value_or("");
  return hash_text(XXH3_64bits(bytes.data(), bytes.size()));
}

}  // namespace penumbra
