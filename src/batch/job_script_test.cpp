#include "batch/job_script.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "core/error.h"
#include "core/testing/shell.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::output_of;
using testing_support::runs;

ScriptOptions options() {
  ScriptOptions o;
  o.list = "/shared/my rooms.tsv";
  o.folder = "/shared/batch";
  o.tasks = 12;
  o.at_a_time = 3;
  o.memory_gigabytes = 5.2;
  return o;
}

fs::path written(const std::string& name, const std::string& text) {
  const fs::path file = fs::path(testing::TempDir()) / "job_script" / name;
  write_file_atomically(file, text);
  return file;
}

TEST(JobScript, SlurmAsksForAnArrayThatComesBack) {
  const std::string script = slurm_script(options());
  EXPECT_THAT(script, HasSubstr("\n#SBATCH --array=0-11%3\n"));
  EXPECT_THAT(script, HasSubstr("\n#SBATCH --mem=6G\n"));
  EXPECT_THAT(script, HasSubstr("\n#SBATCH --requeue\n"));
  EXPECT_THAT(script, HasSubstr("\n#SBATCH --signal=B:USR1@120\n"));
  EXPECT_THAT(script, HasSubstr("aligngs batch '/shared/my rooms.tsv' -o /shared/batch --shards 12 "));
  EXPECT_TRUE(runs("bash -n '" + written("slurm.sh", script).string() + "'"));
}

/// The script itself, with a worker that ends with status 75 when it hears SIGUSR1, and programs in the place of
/// Slurm's.
TEST(JobScript, AStoppedTaskGoesBackIntoTheQueueUnlessItWasCancelled) {
  const fs::path script = written("notice/slurm.sh", slurm_script(options()));
  const fs::path folder = script.parent_path();
  written("notice/aligngs",
          "#!/bin/bash\ntrap 'exit 75' USR1\ntouch ready\nfor i in $(seq 500); do sleep 0.02; done\n");
  written("notice/srun", "#!/bin/bash\nshift 2\nexec \"$@\"\n");
  written(
      "notice/scontrol",
      "#!/bin/bash\nif [ $1 = show ]; then echo \"  JobState=$STATE Reason=None\"; else echo \"scontrol $*\"; fi\n");
  for (const char* name : {"aligngs", "srun", "scontrol"}) fs::permissions(folder / name, fs::perms::owner_all);
  const auto heard = [&](const std::string& state) {
    return output_of(
        "cd '" + folder.string() + "'; rm -f ready; export STATE=" + state +
        " PATH=\"$PWD:$PATH\" SLURM_ARRAY_JOB_ID=8 SLURM_ARRAY_TASK_ID=3 SLURM_CPUS_PER_TASK=4; bash slurm.sh & "
        "job=$!; "
        "for i in $(seq 500); do [ -e ready ] && break; sleep 0.02; done; kill -USR1 $job; wait $job; echo status $?");
  };
  EXPECT_EQ(heard("RUNNING"), "scontrol requeue 8_3\nstatus 75\n");
  EXPECT_EQ(heard("CANCELLED"), "status 75\n");
}

TEST(JobScript, ParallelStartsEveryPart) {
  const std::string script = parallel_script(options());
  EXPECT_THAT(script, HasSubstr("parallel --jobs 3 "));
  EXPECT_THAT(script, HasSubstr("-o /shared/batch --shard {}/12 ::: $(seq 12)\n"));
  EXPECT_TRUE(runs("bash -n '" + written("parallel.sh", script).string() + "'"));
}

TEST(JobScript, KubernetesIgnoresStatus75) {
  const std::string manifest = kubernetes_manifest(options());
  EXPECT_THAT(manifest, HasSubstr("  completions: 12\n  parallelism: 3\n"));
  EXPECT_THAT(manifest, HasSubstr("- action: Ignore\n        onExitCodes:\n          containerName: aligngs\n          "
                                  "operator: In\n          values: [75]\n"));
  EXPECT_THAT(manifest,
              HasSubstr("args: [\"batch\", \"/data/my rooms.tsv\", \"-o\", \"/data/batch\", \"--shards\", \"12\"]"));
}

TEST(JobScript, APathWithALineBreakIsRefused) {
  ScriptOptions o = options();
  o.list = "/shared/a\nrm -r x";
  EXPECT_THROW(slurm_script(o), Error);
}

}  // namespace
}  // namespace aligngs
