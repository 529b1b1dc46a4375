#include "priors/model_identity.h"

#include <map>

#include "core/error.h"
#include "io/weight_file.h"

namespace aligngs {
namespace {

using Tensors = std::map<std::string, WeightInfo>;

const WeightInfo* probe_of(const Tensors& tensors, const ModelFile& file) {
  for (const std::string& name : {file.probe, file.other_probe}) {
    const auto found = tensors.find(name);
    if (found != tensors.end()) return &found->second;
  }
  return nullptr;
}

/// As other_model_in() of tensors that have been read.
std::string other_model_of(const Tensors& tensors, const ModelFile& file) {
  const WeightInfo* const probe = probe_of(tensors, file);
  if (file.probe_columns == 0 || !probe || probe->shape.empty() || probe->shape.back() == file.probe_columns) return "";
  for (const PublishedModel& model : published_models()) {
    for (const ModelFile& other : model.files) {
      if (other.probe == file.probe && other.probe_columns == probe->shape.back()) return model.name;
    }
  }
  return "";
}

}  // namespace

std::string other_model_in(const std::filesystem::path& path, const ModelFile& file) {
  if (file.probe_columns == 0) return "";
  try {
    return other_model_of(WeightFile::open(path)->tensors(), file);
  } catch (const Error&) {
    return "";  // whoever reads the weights tells what is wrong with them
  }
}

IdentityProblem identity_problem(const std::filesystem::path& path, const ModelFile& file) {
  try {
    const Tensors tensors = WeightFile::open(path)->tensors();
    if (!probe_of(tensors, file))
      return {"it holds no tensor \"" + file.probe + "\"",
              "check which model the file belongs to with `aligngs models list`"};
    const std::string other = other_model_of(tensors, file);
    if (!other.empty())
      return {"it holds \"" + other + "\", by the width of " + file.probe,
              "import it under its own name: aligngs models import " + other + " FILE"};
    return {};
  } catch (const Error& error) {
    return {error.details().message, "copy or download the whole file again"};
  }
}

}  // namespace aligngs
