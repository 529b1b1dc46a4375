// Runs every case of the parity data: outputs of the publishers' own programs, to be matched.
// Usage: parity_tests [sources|shared]     default: both
// "sources" are the cases that come with the sources, "shared" those of ../shared/parity and ../shared/parity_new. The
// second ones are skipped where they are missing. With the environment variable ALIGNGS_PARITY_DIR each folder below it
// is a case, and there are no others. Exit status 0: all match. 1: something does not, or there is nothing to run. 77:
// everything was skipped, for want of the data, or of a device for modes that need one.
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
                                            {"loader", {run_loader, false}},
                                            {"da3", {run_da3, true}},
                                            {"da3_metric", {run_da3_metric, true}},
                                            {"da3_nested", {run_da3_nested, true}},
                                            {"da3_camera", {run_da3_camera, false}},
                                            {"da3_raypose", {run_da3_raypose, false}},
                                            {"da3_preprocess", {run_da3_preprocess, false}},
                                            {"eomt", {run_eomt, true}},
                                            {"lingbot_linear", {run_lingbot, true}}};

bool run_case_in_all_modes(const fs::path& folder, ThreadPool& pool) {
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

bool run_case(const fs::path& folder, ThreadPool& pool) {
  try {
    return run_case_in_all_modes(folder, pool);
  } catch (const std::exception& error) {
    std::printf("FAIL %s: %s\n", folder.filename().string().c_str(), error.what());
    return false;
  }
}

/// The folders of one root, which must hold some.
std::vector<fs::path> cases_in(const fs::path& root) {
  std::vector<fs::path> cases;
  if (!fs::is_directory(root)) throw_bad_input(root, "", "there is no such folder of parity cases");
  for (const auto& entry : fs::directory_iterator(root)) {
    if (entry.is_directory()) cases.push_back(entry.path());
  }
  if (cases.empty()) throw_bad_input(root, "", "there are no parity cases in this folder");
  std::sort(cases.begin(), cases.end());
  return cases;
}

/// The folders to look in. `which`: see above; empty: both.
std::vector<fs::path> roots_of(const std::string& which) {
  if (const char* const variable = std::getenv("ALIGNGS_PARITY_DIR")) return {fs::path(variable)};
  if (!which.empty() && which != "sources" && which != "shared")
    throw_usage("unknown cases '" + which + "'", "use sources or shared");
  const fs::path sources = ALIGNGS_SOURCE_DIR;
  std::vector<fs::path> roots;
  if (which != "shared") roots.push_back(sources / "tests/data/parity");
  if (which == "sources") return roots;
  for (const char* const folder : {"../shared/parity", "../shared/parity_new"}) {
    if (fs::is_directory(sources / folder)) {
      roots.push_back(sources / folder);
    } else {
      std::printf("skipped: there are no parity cases in %s\n", folder);
    }
  }
  return roots;
}

int run(const std::string& which) {
  if (modes().empty()) return 77;
  const std::vector<fs::path> roots = roots_of(which);
  if (roots.empty()) return 77;
  ThreadPool pool;
  size_t count = 0;
  int failed = 0;
  for (const fs::path& root : roots) {
    const std::vector<fs::path> cases = cases_in(root);
    std::printf("%zu cases in %s\n", cases.size(), root.lexically_normal().string().c_str());
    for (const fs::path& folder : cases) failed += !run_case(folder, pool);
    count += cases.size();
  }
  std::printf("%zu cases, %d failed\n", count, failed);
  return failed > 0 ? 1 : 0;
}

}  // namespace
}  // namespace aligngs::parity

int main(int argc, char** argv) {
  try {
    return aligngs::parity::run(argc > 1 ? argv[1] : "");
  } catch (const std::exception& error) {
    std::printf("FAIL: %s\n", error.what());
    return 1;
  }
}
