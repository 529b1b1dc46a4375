// Runs every case of the parity data: outputs of the publishers' own programs, to be matched.
// The folder is that of the environment variable ALIGNGS_PARITY_DIR, else ../shared/parity. Exit
// status 0: all match, 1: something does not, 77: no variable and no folder.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "core/error.h"
#include "parity_case.h"

namespace aligngs::parity {
namespace {

namespace fs = std::filesystem;

struct Kind {
  void (*run)(Case&, nn::Compute&);
  bool network;  ///< all modes, not float32 alone
};

const std::map<std::string, Kind> kKinds = {{"dinov2_vit", {run_vit, true}},
                                            {"vggt", {run_vggt, true}},
                                            {"seg_bnhead", {run_segmentation, true}},
                                            {"depth_dpt", {run_depth, true}},
                                            {"depth_linear", {run_depth, true}},
                                            {"m2f", {run_mask2former, true}},
                                            {"msdeform", {run_deformable_attention, true}},
                                            {"ops", {run_ops, true}},
                                            {"preprocess", {run_preprocess, false}},
                                            {"loader", {run_loader, false}}};

std::vector<Mode> modes() {
  const Mode exact{"float32", {}, 2e-5, 2e-5, 0};
  Mode portable = exact;
  portable.name = "float32 portable";
  portable.options.onednn = false;
  const Mode half{"bfloat16", {nn::Precision::kBfloat16, true, true}, 6e-2, 2e-2, 0.03};
  Mode half_portable = half;
  half_portable.name = "bfloat16 portable";
  half_portable.options.onednn = half_portable.options.amx = false;
  return {exact, portable, half, half_portable};
}

bool run_case(const fs::path& folder, ThreadPool& pool) {
  bool good = true;
  for (const Mode& mode : modes()) {
    Case test(folder, mode);
    const std::string kind = value_or<std::string>(test.config(), "kind", "");
    const auto found = kKinds.find(kind);
    if (found == kKinds.end()) {
      std::printf("FAIL %s: unknown kind '%s'\n", folder.filename().string().c_str(), kind.c_str());
      return false;
    }
    try {
      nn::Compute compute(pool, mode.options);
      found->second.run(test, compute);
    } catch (const std::exception& error) {
      test.fail("error", error.what());
    }
    good = test.finish() && good;
    if (!found->second.network) break;
  }
  return good;
}

int run() {
  const char* const variable = std::getenv("ALIGNGS_PARITY_DIR");
  const fs::path root =
      variable ? fs::path(variable) : fs::path(ALIGNGS_SOURCE_DIR) / "../shared/parity";
  if (!variable && !fs::is_directory(root)) {
    constexpr int kSkipped = 77;
    std::printf("skipped: no parity data at %s; set ALIGNGS_PARITY_DIR\n", root.string().c_str());
    return kSkipped;
  }
  std::vector<fs::path> cases;
  if (fs::is_directory(root)) {
    for (const auto& entry : fs::directory_iterator(root)) {
      if (entry.is_directory()) cases.push_back(entry.path());
    }
  }
  std::sort(cases.begin(), cases.end());
  if (cases.empty()) {
    std::printf("FAIL: no parity cases in %s\n", root.string().c_str());
    return 1;
  }
  ThreadPool pool;
  int failed = 0;
  for (const fs::path& folder : cases) failed += !run_case(folder, pool);
  std::printf("%zu cases, %d failed\n", cases.size(), failed);
  return failed > 0 ? 1 : 0;
}

}  // namespace
}  // namespace aligngs::parity

int main() {
  try {
    return aligngs::parity::run();
  } catch (const std::exception& error) {
    std::printf("FAIL: %s\n", error.what());
    return 1;
  }
}
