#!/bin/sh
# Tests the job array with a real slurmctld and slurmd on this machine: the merged table must have the bytes of a run without
# shards, also after a task was killed and requeued.
#
#   deploy/slurm/test.sh [PROGRAM]        without PROGRAM: target/release/retarder
#
# Needs the Debian packages slurm-wlm and munge, and root, since the daemons run jobs for a user. All daemons use a
# temporary folder and ports of their own, and end with the test.
# Exit status: 0 pass, 1 fail, 77 skipped.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
program=$(realpath "${1:-$here/../../target/release/retarder}")
rigs=4000
shards=3

skip() {
    echo "skipped: $1"
    exit 77
}
fail() {
    echo "FAIL: $1" >&2
    tail -n 20 "$work"/*.log "$work"/out/*.log >&2 || true
    exit 1
}
for daemon in slurmctld slurmd munged; do
    PATH="$PATH:/usr/sbin" command -v "$daemon" >/dev/null ||
        skip "no $daemon; install slurm-wlm and munge"
done
[ "$(id -u)" = 0 ] || skip "slurmd needs root"
[ -x "$program" ] || skip "no $program; build it with cargo build --release -p retarder"
PATH="$PATH:/usr/sbin"

work=$(mktemp -d)
pids=""
stop() {
    for pid in $pids; do kill "$pid" 2>/dev/null || true; done
    for pid in $pids; do wait "$pid" 2>/dev/null || true; done
    rm -rf "$work"
}
trap stop EXIT
trap 'exit 1' INT TERM
mkdir "$work/state" "$work/spool" "$work/out"
chmod 755 "$work"

# Two machines that test at once use different ports.
port=$((20000 + $$ % 20000))
host=$(hostname -s)
head -c 1024 /dev/urandom >"$work/munge.key"
chmod 400 "$work/munge.key"
# No job needs a control group. Slurm before 23.02 cannot disable them, and the plugin for version 1 then does nothing.
case $(slurmd -V) in
    *" 2"[0-2].*) cgroups=cgroup/v1 ;;
    *) cgroups=disabled ;;
esac
echo "CgroupPlugin=$cgroups" >"$work/cgroup.conf"
cat >"$work/slurm.conf" <<CONFIG
ClusterName=retarder-test
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
SlurmctldPort=$port
SlurmdPort=$((port + 1))
AuthType=auth/munge
AuthInfo=socket=$work/munge.socket,cred_expire=5
CredType=cred/munge
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
ReturnToService=2
MailProg=/bin/true
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=test Nodes=ALL Default=YES MaxTime=10 State=UP
CONFIG
export SLURM_CONF="$work/slurm.conf"

begin() {
    name=$1
    shift
    "$@" >"$work/$name.log" 2>&1 &
    pids="$! $pids"
}
# Waits until a command succeeds.
until_ok() {
    seconds=0
    until "$@" >/dev/null 2>&1; do
        seconds=$((seconds + 1))
        [ "$seconds" -le 60 ] || fail "after 60 s: $*"
        sleep 1
    done
}
begin munged munged --foreground --force --key-file="$work/munge.key" --socket="$work/munge.socket" \
    --pid-file="$work/munged.pid" --log-file="$work/munged-own.log" --seed-file="$work/munge.seed"
until_ok test -S "$work/munge.socket"
begin slurmctld slurmctld -D
until_ok scontrol ping
begin slurmd slurmd -D
is_idle() { sinfo --noheader --format=%T | grep -q idle; }
until_ok is_idle

"$program" control --rigs "$rigs" --rigs-out "$work/whole.parquet" --scenario fill-requirement >"$work/whole.log" 2>&1 ||
    [ $? -eq 1 ] || fail "the run without shards"

RETARDER="$program" "$here/submit.sh" "$rigs" "$shards" "$work/out" --scenario fill-requirement >"$work/submit.log"
cat "$work/submit.log"
array=$(sed 's/shards: job \([0-9]*\),.*/\1/' "$work/submit.log")

# A node failure, as far as a task can see: it is killed while it works, and runs again from its part.
until_ok test -s "$work/out/shard-2-of-$shards.parquet.part"
scontrol requeue "${array}_2" && echo "requeued: shard 2 while it ran" || fail "shard 2 cannot be requeued"

until_ok test -s "$work/out/summary.json"
cmp "$work/whole.parquet" "$work/out/rigs.parquet" || fail "the merged table differs from the one without shards"
left=$(find "$work/out" -name '*.part')
[ -z "$left" ] || fail "left over: $left"
echo "pass: $rigs rigs in $shards shards, $(wc -c <"$work/out/rigs.parquet") bytes, the same as without Slurm ($(slurmctld -V))"
