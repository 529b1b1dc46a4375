// Scripts that run a batch on a cluster. They are text for people to read and to change; nothing is submitted.
// All: Error{kUsage} for paths with line breaks.
#pragma once

#include <filesystem>
#include <string>

namespace aligngs {

struct ScriptOptions {
  std::filesystem::path list, folder;  ///< LIST and the folder of the batch, absolute
  int tasks = 1;                       ///< of the array
  int at_a_time = 1;                   ///< tasks
  double memory_gigabytes = 0;         ///< of the largest task, predicted
};

/// An array for `sbatch`: put back into the queue after a preemption or the failure of a node, with a signal before its
/// time ends.
std::string slurm_script(const ScriptOptions& options);
/// A manifest for `kubectl apply`: an Indexed Job. LIST and the folder are looked for by their last names on one shared
/// volume.
std::string kubernetes_manifest(const ScriptOptions& options);
/// A script that starts GNU parallel on this machine or, by a file of names, on others that share the folder.
std::string parallel_script(const ScriptOptions& options);

}  // namespace aligngs
