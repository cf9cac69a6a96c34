// A name service that never answers for one host name; all other look-ups work as usual. Only one file of a
// test program may include this.
#pragma once

#include <dlfcn.h>
#include <netdb.h>

#include <condition_variable>
#include <cstring>
#include <mutex>

namespace penumbra {

inline constexpr const char* kSilentHost = "host.of.a.silent.name.service";

/// While it lives, look-ups of kSilentHost wait.
class SilentNameService {
 public:
  SilentNameService() { is_silent(true); }
  SilentNameService(const SilentNameService&) = delete;
  ~SilentNameService() { is_silent(false); }

  static void wait() {
    std::unique_lock lock(mutex());
    changed().wait(lock, [] { return !silent(); });
  }

 private:
  static void is_silent(bool value) {
    {
      const std::lock_guard lock(mutex());
      silent() = value;
    }
    changed().notify_all();
  }
  // Never destroyed: threads that look a host up may outlive the tests.
  static std::mutex& mutex() {
    static auto* one = new std::mutex;
    return *one;
  }
  static std::condition_variable& changed() {
    static auto* one = new std::condition_variable;
    return *one;
  }
  static bool& silent() {
    static bool one = false;
    return one;
  }
};

}  // namespace penumbra

extern "C" int getaddrinfo(const char* name, const char* service, const addrinfo* hints, addrinfo** result) {
  if (name != nullptr && std::strcmp(name, penumbra::kSilentHost) == 0) {
    penumbra::SilentNameService::wait();
    return EAI_AGAIN;
  }
  using Original = int (*)(const char*, const char*, const addrinfo*, addrinfo**);
  static const auto original = reinterpret_cast<Original>(dlsym(RTLD_NEXT, "getaddrinfo"));
  return original(name, service, hints, result);
}
