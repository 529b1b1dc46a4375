// `aligngs batch`, the commands below it, and what they share.
#pragma once

#include <vector>

#include "batch/batch_folder.h"
#include "cli/command.h"

namespace aligngs {

struct BatchWorkOptions {
  int jobs = 0;                 ///< rooms at a time; 0: not given
  double memory_gigabytes = 0;  ///< 0: a share of the free memory
  double stale_seconds = 60;    ///< of a lease (batch/lease.h)
};

/// Adds --jobs, --memory and --stale; `options` must outlive the command.
void add_batch_work_options(CLI::App& command, BatchWorkOptions& options);

/// Works on the rooms and prints how they ended. Error{kFailed} when rooms failed, Error{kInterrupted} when a signal
/// stopped the work.
void work_and_report(const BatchFolder& folder, const Batch& batch, const std::vector<RoomEntry>& rooms,
                     const BatchWorkOptions& options, const CommandContext& context);

void add_batch_command(CLI::App& program, CommandContext& context);
void add_batch_status_command(CLI::App& batch, CommandContext& context);
void add_batch_collect_command(CLI::App& batch, CommandContext& context);
void add_batch_retry_command(CLI::App& batch, CommandContext& context);

}  // namespace aligngs
