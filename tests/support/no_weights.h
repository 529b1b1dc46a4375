// A machine on which no weights of networks are found.
#pragma once

#include <cstdlib>
#include <filesystem>

namespace aligngs::testing_support {

/// While it lives, every place where weights are looked for lies below `folder` and is empty.
class NoWeights {
 public:
  explicit NoWeights(const std::filesystem::path& folder) {
    setenv("ALIGNGS_MODELS", (folder / "models").c_str(), 1);
    setenv("HF_HUB_CACHE", (folder / "hub").c_str(), 1);
    setenv("TORCH_HOME", (folder / "torch").c_str(), 1);
  }
  ~NoWeights() {
    for (const char* name : {"ALIGNGS_MODELS", "HF_HUB_CACHE", "TORCH_HOME"}) unsetenv(name);
  }
  NoWeights(const NoWeights&) = delete;
  NoWeights& operator=(const NoWeights&) = delete;
};

}  // namespace aligngs::testing_support
