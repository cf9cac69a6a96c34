#include "scheduler/keys/submitter_secret.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <optional>
#include <span>

#include "kernels/host/plain_file.h"
#include "kernels/host/process.h"
#include "scheduler/keys/secrets.h"

namespace penumbra {
namespace {

constexpr std::uint64_t kMostSubmitterBytes = 256;

std::optional<std::string> read_submitter(const std::filesystem::path& file) {
  auto text = read_plain_file(file, kMostSubmitterBytes);
  if (!text) return std::nullopt;
  while (text->ends_with('\n')) text->pop_back();
  return *text;
}

}  // namespace

std::string submitter_secret() {
  const std::filesystem::path state = user_folder("XDG_STATE_HOME", ".local/state");
  if (state.empty()) return {};
  const std::filesystem::path file = state / "penumbra" / "submitter";
  if (const auto known = read_submitter(file)) return *known;
  std::error_code ignored;
  std::filesystem::create_directories(file.parent_path(), ignored);
  // Of two processes that make it at once, both then have that of the first.
  const std::string aside = file.string() + "." + make_token(), secret = make_token();
  const int descriptor =
      open(aside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (descriptor < 0) return {};
  const std::string text = secret + "\n";
  const bool is_written =
      write_whole(descriptor, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
  close(descriptor);
  const bool is_linked = is_written && link(aside.c_str(), file.c_str()) == 0;
  unlink(aside.c_str());
  return is_linked ? secret : read_submitter(file).value_or("");
}

}  // namespace penumbra
