#!/bin/sh
# Submits a Monte Carlo run as a job array and the merge that follows it; prints both job numbers.
#
#   submit.sh RIGS SHARDS OUT [OPTION OF `retarder control`]...
#
# Options of sbatch (account, partition, time limit) come from SBATCH_... variables, as for any job.
set -eu

[ $# -ge 3 ] || {
    sed -n '2,/^set/{/^#/s/^# \{0,1\}//p;}' "$0" >&2
    exit 2
}
here=$(cd "$(dirname "$0")" && pwd)
rigs=$1 shards=$2
mkdir -p "$3"
out=$(cd "$3" && pwd)
shift 3

array=$(RIGS="$rigs" OUT="$out" sbatch --parsable --export=ALL --array="1-$shards" \
    --output="$out/shard-%a.log" "$here/shard.sbatch" "$@")
array=${array%%;*}
merge=$(SHARDS="$shards" OUT="$out" sbatch --parsable --export=ALL --dependency="afterok:$array" \
    --kill-on-invalid-dep=yes --output="$out/merge.log" "$here/merge.sbatch")
echo "shards: job $array, merge: job ${merge%%;*}, result: $out/rigs.parquet"
