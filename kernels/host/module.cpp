#include "kernels/host/module.h"

#include <dlfcn.h>

#include <filesystem>
#include <string>

namespace penumbra {

Expected<const void*> load_module(const char* file, const char* object) {
  std::error_code unknown;
  const auto beside = std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path() / file;
  const bool installed = !std::filesystem::exists(beside, unknown);
  void* module = dlopen(installed ? file : beside.c_str(), RTLD_LAZY | RTLD_LOCAL);
  const void* found = module != nullptr ? dlsym(module, object) : nullptr;
  if (found == nullptr) return fail(dlerror());
  return found;
}

}  // namespace penumbra
