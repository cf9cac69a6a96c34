#include "worker/keys/secrets.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <openssl/crypto.h>
#include <sys/prctl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <span>
#include <system_error>

#include "kernels/host/plain_file.h"
#include "kernels/host/process.h"

namespace penumbra {

std::string make_token() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != ssize_t(bytes.size()))
    throw std::system_error(errno, std::generic_category(), "no random numbers for a token");
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

bool are_equal_secrets(std::string_view a, std::string_view b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

void keep_out_of_core_dumps() { prctl(PR_SET_DUMPABLE, 0); }

namespace {

constexpr std::size_t kSecretDigits = 32;  // of make_token()
constexpr std::uint64_t kMostSubmitterBytes = 256;

Expected<std::string> read_submitter(const std::filesystem::path& file) {
  auto text = read_plain_file(file, kMostSubmitterBytes);
  if (!text) return text;
  while (text->ends_with('\n')) text->pop_back();
  if (text->size() == kSecretDigits) return text;
  return fail(
      fmt::format("{} has {} characters and not the {} of a secret, as after a full disk; remove it, and a "
                  "new one is made",
                  file.string(), text->size(), kSecretDigits));
}

std::unexpected<Error> cannot_make(const std::filesystem::path& file, int error) {
  return fail(fmt::format("cannot make {}: {}; make its folder writable, or name another in XDG_STATE_HOME",
                          file.string(), std::strerror(error)));
}

}  // namespace

Expected<std::string> submitter_secret() {
  const std::filesystem::path state = user_folder("XDG_STATE_HOME", ".local/state");
  if (state.empty()) return fail("no folder for the submitter's secret: set HOME or XDG_STATE_HOME");
  const std::filesystem::path file = state / "penumbra" / "submitter";
  std::error_code error;
  if (std::filesystem::exists(file, error)) return read_submitter(file);
  std::filesystem::create_directories(file.parent_path(), error);
  if (error) return cannot_make(file, error.value());
  // Of two processes that make it at once, both then have that of the first.
  const std::string aside = file.string() + "." + make_token(), secret = make_token();
  const int descriptor =
      open(aside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (descriptor < 0) return cannot_make(file, errno);
  const std::string text = secret + "\n";
  const bool is_linked =
      write_whole(descriptor, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size())) &&
      link(aside.c_str(), file.c_str()) == 0;
  const int why = is_linked ? 0 : errno;
  close(descriptor);
  unlink(aside.c_str());
  if (is_linked) return secret;
  return why == EEXIST ? read_submitter(file) : cannot_make(file, why);
}

}  // namespace penumbra
