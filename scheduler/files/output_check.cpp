#include "scheduler/files/output_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <vector>

#include "kernels/host/atomic_file.h"
#include "kernels/host/file_target.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

FileIdentity identity_of(const fs::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) == 0) return {status.st_dev, status.st_ino, {}};
  std::error_code error;
  const fs::path normal = fs::weakly_canonical(fs::absolute(path, error), error);
  return {0, 0, error ? fs::absolute(path, error).lexically_normal() : normal};
}

}  // namespace

std::optional<FileIdentity> identity_of_output(const fs::path& output) {
  const auto target = find_target(output);
  if (target && target->kind != FileTarget::Kind::kFile) return std::nullopt;
  if (target) return identity_of(target->path);
  std::error_code error;
  return FileIdentity{0, 0, fs::absolute(output, error).lexically_normal()};
}

Expected<void> check_outputs(std::span<const fs::path> outputs, std::span<const fs::path> inputs) {
  std::vector<FileIdentity> read, written;
  for (const fs::path& input : inputs) read.push_back(identity_of(input));
  for (const fs::path& output : outputs) {
    const auto target = find_target(output);
    if (!target) return std::unexpected(target.error());
    const FileIdentity identity = identity_of(target->path);
    for (const FileIdentity& input : read)
      if (input == identity)
        return fail(fmt::format("{} is an input of this command; it is not overwritten", output.string()));
    if (target->kind == FileTarget::Kind::kFile) {  // several outputs may go to the same device or pipe
      for (const FileIdentity& other : written)
        if (other == identity) return fail(fmt::format("two outputs in one file: {}", output.string()));
      written.push_back(identity);
    }
    if (const auto writable = check_writable(output); !writable) return writable;
  }
  return {};
}

bool is_among(const fs::path& output, std::span<const fs::path> inputs) {
  const auto identity = identity_of_output(output);
  return identity && std::ranges::find(inputs, *identity, identity_of) != inputs.end();
}

}  // namespace penumbra
