#include "batch/job_script.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "batch/option_words.h"
#include "core/error.h"

namespace aligngs {
namespace {

/// Seconds before a cluster ends a task: a checkpoint of some millions of Gaussians takes a few.
constexpr int kNoticeSeconds = 120;
constexpr int kCores = 4;  // of a task: a room gains little beyond

int whole_gigabytes(double gigabytes) { return std::max(2, static_cast<int>(std::ceil(gigabytes))); }

constexpr const char* kSlurm = R"(#!/bin/bash
# The rooms of {list} as a Slurm array of {tasks} tasks. Submit it with: sbatch FILE
# Some of them again: sbatch --array=3,7 FILE
#SBATCH --job-name=aligngs
# Tasks, and how many of them run at a time.
#SBATCH --array=0-{last}%{at_a_time}
# Of one task. For a GPU, remove one "#" from the line with gres.
#SBATCH --cpus-per-task={cores}
#SBATCH --mem={memory}G
#SBATCH --time=04:00:00
##SBATCH --gres=gpu:1
# Back into the queue after a preemption or the failure of a node. The room goes on from its checkpoint.
#SBATCH --requeue
# This script hears SIGUSR1 {notice} seconds before the time is over.
#SBATCH --signal=B:USR1@{notice}
#SBATCH --output=aligngs-%A_%a.log
#SBATCH --open-mode=append

# The signal may come before the step has a number, and ends this script where no trap is set yet.
step= heard=
trap 'heard=1; [ -z "$step" ] || kill -USR1 "$step" 2>/dev/null' USR1
# A step of its own hears what Slurm sends before it preempts or cancels the task.
srun --ntasks=1 --cpus-per-task="$SLURM_CPUS_PER_TASK" \
  {program} batch {list} -o {folder} --shards {tasks} --threads "$SLURM_CPUS_PER_TASK" &
step=$!
[ -z "$heard" ] || kill -USR1 "$step" 2>/dev/null
wait "$step"
status=$?
while kill -0 "$step" 2>/dev/null; do  # a signal ended the wait, not the step
  wait "$step"
  status=$?
done
# Stopped with checkpoints: back into the queue, unless somebody cancelled the task.
task="${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}"
if [ "$status" -eq 75 ] && scontrol show job "$task" | grep -q JobState=RUNNING; then
  scontrol requeue "$task"
fi
exit "$status"
)";

constexpr const char* kKubernetes =
    R"(# The rooms of {list} as a Kubernetes Indexed Job of {tasks} pods. Start it with: kubectl apply -f FILE
# Needed: an image with the program, and a volume that all pods can write to. It holds the list, the sources and the batch.
apiVersion: batch/v1
kind: Job
metadata:
  name: aligngs
spec:
  completionMode: Indexed
  completions: {tasks}
  parallelism: {at_a_time}
  # A pod that fails for another reason than its room is tried again, each index on its own.
  backoffLimitPerIndex: 2
  podFailurePolicy:
    rules:
      # Status 75: stopped by a signal with a checkpoint. The pod is replaced, and this does not count as a failure.
      - action: Ignore
        onExitCodes:
          containerName: aligngs
          operator: In
          values: [75]
      # The node was drained, or the pod was preempted.
      - action: Ignore
        onPodConditions:
          - type: DisruptionTarget
            status: "True"
      # A room failed, or the command line is wrong: trying again would not help. `aligngs batch collect` names the room.
      - action: FailIndex
        onExitCodes:
          containerName: aligngs
          operator: In
          values: [1, 2, 3, 4]
  template:
    spec:
      restartPolicy: Never
      # From SIGTERM to the end: the rooms write their checkpoints meanwhile.
      terminationGracePeriodSeconds: {notice}
      securityContext:
        runAsNonRoot: true
        runAsUser: 1000
        fsGroup: 1000
      containers:
        - name: aligngs
          image: aligngs:latest
          # The part of each pod comes from JOB_COMPLETION_INDEX, which Kubernetes sets.
          args: ["batch", {list_in_pod}, "-o", {folder_in_pod}, "--shards", "{tasks}"]
          securityContext:
            allowPrivilegeEscalation: false
            readOnlyRootFilesystem: true
          resources:
            requests:
              cpu: "{cores}"
              memory: {memory}Gi
            limits:
              memory: {memory}Gi
          volumeMounts:
            - name: rooms
              mountPath: /data
            - name: scratch
              mountPath: /tmp
      volumes:
        - name: rooms
          persistentVolumeClaim:
            claimName: rooms
        - name: scratch
          emptyDir: {{}}
)";

constexpr const char* kParallel = R"(#!/bin/bash
# The rooms of {list} in {tasks} parts by GNU parallel. Start it with: bash FILE
# More machines that share the folder: add --sshloginfile FILE, one machine a line.
# TERM lets the rooms write their checkpoints; the same script then goes on.
exec parallel --jobs {at_a_time} --halt never --line-buffer --tag \
  --termseq TERM,{notice}000,KILL,1000 \
  {program} batch {list} -o {folder} --shard {{}}/{tasks} ::: $(seq {tasks})
)";

std::string filled(const char* form, const ScriptOptions& o) {
  using fmt::arg;
  for (const std::string& path : {o.list.string(), o.folder.string()}) {
    // In a comment a line break would begin a command.
    if (path.find_first_of("\n\r") != std::string::npos)
      throw_usage("a path with a line break cannot be in a script: " + path, "rename the folder");
  }
  const auto in_pod = [](const std::filesystem::path& path) {
    std::string text = "\"/data/";
    for (const char c : path.filename().string())
      text += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    return text + "\"";
  };
  return fmt::format(fmt::runtime(form), arg("program", "aligngs"), arg("list", quote_word(o.list.string())),
                     arg("folder", quote_word(o.folder.string())), arg("list_in_pod", in_pod(o.list)),
                     arg("folder_in_pod", in_pod(o.folder)), arg("tasks", o.tasks), arg("last", o.tasks - 1),
                     arg("at_a_time", std::min(o.at_a_time, o.tasks)),
                     arg("memory", whole_gigabytes(o.memory_gigabytes)), arg("cores", kCores),
                     arg("notice", kNoticeSeconds));
}

}  // namespace

std::string slurm_script(const ScriptOptions& options) { return filled(kSlurm, options); }
std::string kubernetes_manifest(const ScriptOptions& options) { return filled(kKubernetes, options); }
std::string parallel_script(const ScriptOptions& options) { return filled(kParallel, options); }

}  // namespace aligngs
