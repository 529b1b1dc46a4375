// Libraries that are loaded while the program runs, so that it starts where they are not installed.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace aligngs::cuda {

/// A loaded library. Its code stays in memory when the object is gone: a device may still run what it started.
class SharedLibrary {
 public:
  /// `name` as the system's loader takes it. Null, with the loader's words in `reason`, when it cannot be loaded.
  static std::unique_ptr<SharedLibrary> open(const std::string& name, std::string& reason);
  ~SharedLibrary();
  SharedLibrary(const SharedLibrary&) = delete;
  SharedLibrary& operator=(const SharedLibrary&) = delete;

  const std::string& name() const { return name_; }
  /// Null when the library has no such symbol.
  void* symbol(const char* name) const;
  /// Sets `function` to the library's; false when there is none of that name.
  template <class F>
  bool find(const char* name, F*& function) const {
    function = reinterpret_cast<F*>(symbol(name));
    return function != nullptr;
  }

 private:
  SharedLibrary(void* loaded, std::string name) : loaded_(loaded), name_(std::move(name)) {}
  void* loaded_;
  std::string name_;
};

struct LibrarySearch {
  std::unique_ptr<SharedLibrary> loaded;
  std::string reason;  ///< why no name served, for each of them; empty when one did
};

/// The first of `names` that can be loaded and that `refusal` says nothing against.
LibrarySearch find_library(const std::vector<std::string>& names,
                           const std::function<std::string(const SharedLibrary&)>& refusal);

/// Why a library of this version does not fit a program compiled with headers of `header_major`; empty when it does.
/// Versions are 10000 major + 100 minor + patch, as cuBLAS counts from 12 on.
std::string version_refusal(size_t library_version, int header_major);

}  // namespace aligngs::cuda
