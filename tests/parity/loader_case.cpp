#include "core/error.h"
#include "io/weight_file.h"
#include "parity_case.h"

namespace aligngs::parity {
namespace {

namespace fs = std::filesystem;

/// Every tensor of `file` against the one of that name, without `prefix`, in `expected`.
void compare_files(Case& test, const fs::path& path, const WeightFile& file, const WeightFile& expected,
                   const std::string& prefix) {
  const std::string name = path.filename().string();
  if (file.tensors().size() != expected.tensors().size())
    test.fail(name, std::to_string(file.tensors().size()) + " tensors found");
  for (const auto& [key, info] : expected.tensors()) {
    const auto found = file.tensors().find(prefix + key);
    if (found == file.tensors().end()) {
      test.fail(name, prefix + key + " is missing");
    } else if (found->second.shape != info.shape) {
      test.fail(name, key + " has another shape");
    } else {
      test.judge(name + " " + key, file.read(prefix + key), expected.read(key), 0);
    }
  }
}

/// The prefix that the names of `file` have before those of `expected`.
std::string prefix_of(const WeightFile& file, const WeightFile& expected) {
  const std::string& shorter = expected.tensors().begin()->first;
  for (const auto& tensor : file.tensors()) {
    const size_t at = tensor.first.rfind(shorter);
    if (at != std::string::npos && at + shorter.size() == tensor.first.size()) return tensor.first.substr(0, at);
  }
  return "";
}

}  // namespace

void run_loader(Case& test, nn::Compute&) {
  const std::string kExpected = ".expected.safetensors";
  for (const auto& entry : fs::directory_iterator(test.folder())) {
    const fs::path path = entry.path();
    const std::string name = path.filename().string();
    if (name == "case.json" || name.find(kExpected) != std::string::npos) continue;
    if (name.rfind("reject_", 0) == 0) {
      try {
        const auto file = WeightFile::open(path);
        for (const auto& tensor : file->tensors()) file->read(tensor.first);
        test.fail(name, "accepted");
      } catch (const Error& error) {
        if (error.kind() != ErrorKind::kBadInput) test.fail(name, error.what());
      }
      continue;
    }
    const auto file = WeightFile::open(path);
    // Files without an expectation of their own hold the tensors of the plain state dict; without
    // that one too, they must open and be read.
    const std::string own = path.stem().string() + kExpected, plain = "state_dict" + kExpected;
    if (!test.has(own) && !test.has(plain)) {
      for (const auto& tensor : file->tensors()) file->read(tensor.first);
      continue;
    }
    const auto expected = WeightFile::open(test.folder() / (test.has(own) ? own : plain));
    compare_files(test, path, *file, *expected, prefix_of(*file, *expected));
  }
}

}  // namespace aligngs::parity
