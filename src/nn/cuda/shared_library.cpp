#include "nn/cuda/shared_library.h"

#include <dlfcn.h>

#include <utility>

namespace aligngs::cuda {

std::unique_ptr<SharedLibrary> SharedLibrary::open(const std::string& name, std::string& reason) {
  void* const loaded = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (loaded == nullptr) {
    const char* const text = dlerror();
    reason = text != nullptr ? text : name + " cannot be loaded";
    return nullptr;
  }
  return std::unique_ptr<SharedLibrary>(new SharedLibrary(loaded, name));
}

SharedLibrary::~SharedLibrary() { (void)dlclose(loaded_); }

void* SharedLibrary::symbol(const char* name) const { return dlsym(loaded_, name); }

LibrarySearch find_library(const std::vector<std::string>& names,
                           const std::function<std::string(const SharedLibrary&)>& refusal) {
  LibrarySearch search;
  for (const std::string& name : names) {
    std::string reason;
    std::unique_ptr<SharedLibrary> library = SharedLibrary::open(name, reason);
    if (library != nullptr) {
      reason = refusal(*library);
      if (reason.empty()) return {std::move(library), {}};
      reason = name + ": " + reason;
    }
    search.reason += (search.reason.empty() ? "" : "; ") + reason;
  }
  return search;
}

std::string version_refusal(size_t library_version, int header_major) {
  const size_t major = library_version / 10000, minor = library_version / 100 % 100;
  if (major == size_t(header_major)) return {};
  return "it is version " + std::to_string(major) + "." + std::to_string(minor) + ", and this program needs " +
         std::to_string(header_major);
}

}  // namespace aligngs::cuda
