#include "kernels/host/module.h"

#include <dlfcn.h>

#include <filesystem>
#include <string>

namespace penumbra {

Expected<const void*> load_module(const char* file, const char* object) {
  std::error_code unknown;
  const auto folder = std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path();
  // The build folder, or the installed folder; else where the system looks for libraries.
  std::filesystem::path path = file;
  for (const auto& place : {folder / file, folder.parent_path() / "lib" / "penumbra" / file})
    if (!path.has_parent_path() && std::filesystem::exists(place, unknown)) path = place;
  void* module = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
  const void* found = module != nullptr ? dlsym(module, object) : nullptr;
  if (found == nullptr) return fail(dlerror());
  return found;
}

}  // namespace penumbra
