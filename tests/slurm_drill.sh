#!/usr/bin/env bash
# Twelve rooms on a Slurm of two nodes on this machine, through everything that goes wrong on a cluster.
# Usage: tests/slurm_drill.sh PROGRAM [FOLDER]     77 without slurm-wlm, munge or root; FOLDER keeps all logs
#
# One node is killed in the middle, one task is preempted, the controller is killed and started again, and one room is
# broken. All other rooms must end with the bytes of a batch without any of it, and none may be done twice.
set -euo pipefail
case "${1:-}" in -h|--help|"") sed -n '2,6p' "$0" | cut -c3-; exit 0 ;; esac
program=$(realpath "$1")
for tool in slurmctld slurmd munged sbatch; do
  command -v "$tool" >/dev/null || { echo "skipped: $tool is missing (apt-get install slurm-wlm munge)"; exit 77; }
done
[ "$(id -u)" -eq 0 ] || { echo "skipped: daemons of Slurm start jobs as root here"; exit 77; }

work=${2:-$(mktemp -d)}
mkdir -p "$work"/{state,log,munge,bin,jobs}
work=$(realpath "$work")
chmod 700 "$work/munge"
ln -sf "$program" "$work/bin/aligngs"
export PATH="$work/bin:$PATH" SLURM_CONF="$work/slurm.conf"
declare -A daemon=()

stop_all() {
  scancel --quiet --user=root 2>/dev/null || true
  for node in n1 n2; do kill_jobs_of "$node"; done  # while the controller still knows them
  for name in n1 n2 slurmctld munged; do
    [ -z "${daemon[$name]:-}" ] || { kill -9 "${daemon[$name]}" && wait "${daemon[$name]}"; } 2>/dev/null || true
  done
  [ -n "${keep:-}" ] || rm -rf "$work"
}
[ $# -lt 2 ] || keep=1
trap stop_all EXIT

say() { echo "$(date -u +%H:%M:%S) $*" | tee -a "$work/drill.log"; }
fail() { say "FAILED: $*"; tail -n 5 "$work"/log/*.log "$work"/jobs/*.log 2>/dev/null || true; exit 1; }
wait_for() {  # wait_for SECONDS WORDS OF A TEST...
  local until=$((SECONDS + $1)) && shift
  while ! "$@" 2>/dev/null; do
    [ $SECONDS -lt $until ] || return 1
    sleep 0.2
  done
}

# --- A cluster of two nodes, which are two daemons.
cat >"$SLURM_CONF" <<END
ClusterName=drill
SlurmctldHost=$(hostname -s)(127.0.0.1)
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket
CryptoType=crypto/munge
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
ReturnToService=2
SlurmUser=root
SlurmdUser=root
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd_%n.pid
SlurmctldPort=16827
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool_%n
SlurmctldLogFile=$work/log/slurmctld.log
SlurmdLogFile=$work/log/%n.log
SchedulerType=sched/backfill
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
SwitchType=switch/none
PreemptType=preempt/partition_prio
PreemptMode=REQUEUE
# Seconds: a real cluster waits longer before it gives a node up.
SlurmdTimeout=10
KillWait=10
MinJobAge=300
NodeName=n[1-2] NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=[17011-17012] CPUs=1 RealMemory=2000 State=UNKNOWN
PartitionName=rooms Nodes=n[1-2] Default=YES MaxTime=60 State=UP PriorityTier=1 GraceTime=20
PartitionName=urgent Nodes=n[1-2] MaxTime=60 State=UP PriorityTier=2 PreemptMode=OFF
END

start_munged() {
  dd if=/dev/urandom of="$work/munge/key" bs=64 count=1 status=none
  chmod 600 "$work/munge/key"
  chmod 711 "$work/munge"
  munged --foreground --force --socket="$work/munge/socket" --key-file="$work/munge/key" --pid-file="$work/munge/pid" \
    --seed-file="$work/munge/seed" --log-file="$work/munge/log" >"$work/log/munged.log" 2>&1 &
  daemon[munged]=$!
  wait_for 10 test -S "$work/munge/socket" || fail "munged does not start"
}
start_controller() {
  slurmctld -D "$@" >"$work/log/slurmctld.out" 2>&1 &
  daemon[slurmctld]=$!
  wait_for 20 sinfo --noheader >"$work/log/sinfo.out" || fail "slurmctld does not start"
}
start_node() {
  mkdir -p "$work/spool_$1"
  slurmd -D -N "$1" >"$work/log/$1.out" 2>&1 &
  daemon[$1]=$!
}
state_of() { sinfo --noheader --nodes="$1" --format=%T --partition=rooms; }
is_up() { [[ "$(state_of "$1")" =~ ^(idle|mixed|allocated|completing)$ ]]; }

descendants() {
  local child
  for child in $(pgrep -P "$1" || true); do descendants "$child"; done
  echo "$1"
}
# Everything that the daemon of a node has started: step daemons name their job, and the jobs of a node are known.
kill_jobs_of() {
  local job pid
  for job in $(squeue --noheader --nodelist="$1" --states=running,completing --format=%A 2>/dev/null); do
    for pid in $(pgrep -f "slurmstepd: \[$job\." || true); do
      # shellcheck disable=SC2046
      kill -9 $(descendants "$pid") 2>/dev/null || true
    done
  done
}

# --- Twelve rooms, the seventh of which is broken, and a batch of them without a cluster. They share one scene and differ
# in the seed of the training. Without the truth nothing is compared with it, which would take longer than all the rest.
aligngs synth "$work/scene" --size 64x48 --views 8 --test-views 2 -q >/dev/null
rm -rf "$work/scene/truth"
for i in 01 02 03 04 05 06 07 08 09 10 11 12; do
  source=scene
  [ $i != 07 ] || source=nowhere
  printf 'room%s\t%s\t--seed %d -n 400 --no-refine --set checkpoint.every=50\n' $i $source $((10#$i))
done >"$work/rooms.tsv"
say "a batch of twelve rooms without a cluster"
status=0
aligngs batch "$work/rooms.tsv" -o "$work/plain" --threads 1 >"$work/log/plain.log" 2>&1 || status=$?
[ $status -eq 1 ] || fail "the plain batch ends with status $status, not 1"

say "two nodes come up"
start_munged
start_controller -c
start_node n1
start_node n2
wait_for 30 is_up n1 || fail "node n1 does not come up"
wait_for 30 is_up n2 || fail "node n2 does not come up"

aligngs batch "$work/rooms.tsv" -o "$work/shared" --print slurm --jobs 2 >"$work/job.sh"
job=$(sbatch --parsable --chdir="$work/jobs" --cpus-per-task=1 --mem=0 --time=30 "$work/job.sh")
say "array $job of twelve tasks is submitted"

task_on() { squeue --noheader --nodelist="$1" --states=running --format=%i | head -n 1; }
room_of() { printf 'room%02d' $((${1#*_} + 1)); }
in_the_middle() {  # a task trains on the node, and has a checkpoint
  task=$(task_on "$1")
  [[ "$task" == *_* ]] && compgen -G "$work/shared/rooms/$(room_of "$task")/checkpoints/*" >/dev/null
}

wait_for 120 in_the_middle n1 || fail "no room on n1 gets to a checkpoint"
say "n1 is killed while it trains $(room_of "$task"): its daemon and all of its processes, with SIGKILL"
kill -9 "${daemon[n1]}"
wait "${daemon[n1]}" 2>/dev/null || true
kill_jobs_of n1
is_down() { [[ "$(state_of n1)" == down* ]]; }

wait_for 120 in_the_middle n2 || fail "no room on n2 gets to a checkpoint"
preempted=$task
urgent=$(sbatch --parsable --partition=urgent --nodelist=n2 --chdir="$work/jobs" --wrap 'sleep 3')
say "the urgent job $urgent preempts task $preempted, which trains $(room_of "$preempted") on n2"
wait_for 120 is_down || fail "the controller does not notice that n1 is gone"
say "the controller gives n1 up, and its task back to the queue; n1 comes back"
start_node n1
wait_for 60 is_up n1 || fail "node n1 does not come back"

say "the controller is killed and started again"
kill -9 "${daemon[slurmctld]}"
wait "${daemon[slurmctld]}" 2>/dev/null || true
start_controller

all_ended() { [ -z "$(squeue --noheader)" ]; }
wait_for 600 all_ended || fail "tasks are left after ten minutes: $(squeue --noheader)"
say "the queue is empty"

# --- What must hold now.
aligngs batch status "$work/shared" | tee -a "$work/drill.log"
done_rooms=0
for i in 01 02 03 04 05 06 08 09 10 11 12; do
  cmp "$work/plain/rooms/room$i/scene.ply" "$work/shared/rooms/room$i/scene.ply" || fail "room$i differs from the plain batch"
  times=$(cat "$work"/jobs/aligngs-*.log | grep -c "room$i: done in" || true)
  [ "$times" -eq 1 ] || fail "room$i was done $times times"
  done_rooms=$((done_rooms + 1))
done
aligngs batch status "$work/shared" --json >"$work/status.json"
grep -q '"message": "there is no such folder"' "$work/status.json" || fail "the broken room has no message"
grep -q '"retry": "aligngs batch retry ' "$work/status.json" || fail "the broken room has no command that tries again"
grep -q 'its worker on .* is gone' "$work"/jobs/aligngs-*.log || fail "no lease of a killed worker was taken over"
grep -q 'SIGTERM was heard' "$work"/jobs/aligngs-*.log || fail "the preempted task did not hear of it"
[ -z "$(ls "$work/shared/leases")" ] || fail "leases are left"
aligngs batch collect "$work/shared" >/dev/null
say "$done_rooms rooms are byte-identical to the batch without a cluster, each done once; room07 is reported with its remedy"
