// Published weights in a file, told by its tensors.
#pragma once

#include <filesystem>
#include <string>

#include "priors/model_registry.h"

namespace aligngs {

/// Name of another published model whose weights the file holds, by the width of its probe tensor. Empty where it holds
/// weights of this model or of an unknown size, or cannot be read. A wrong name would show a wrong licence.
std::string other_model_in(const std::filesystem::path& path, const ModelFile& file);

/// Why a file holds no weights of a model, and what helps; empty where it holds them.
struct IdentityProblem {
  std::string message, remedy;
};

/// The file must be one of tensors, whole, with the tensor that tells it from others, and of no other published model.
IdentityProblem identity_problem(const std::filesystem::path& path, const ModelFile& file);

}  // namespace aligngs
