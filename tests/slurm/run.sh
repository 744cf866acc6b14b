#!/usr/bin/env bash
# A pipeline on a real Slurm of one node, with a job killed while it works, and once with its driver
# as a job too (pipelines/cluster/driver.sbatch): results must be those of a serial run, byte for byte.
#
#   tests/slurm/run.sh [PANOKIT]       PANOKIT: the command, `panokit` if not given
#
# Needs root and Debian's slurmctld, slurmd, slurm-client and munge. Everything it starts runs
# from a temporary folder, on ports of its own, and is ended at the end; a Slurm that this
# machine may have is neither read nor touched. Exit code 77: skipped.
set -euo pipefail

panokit=${1:-panokit}
here=$(cd "$(dirname "$0")/../.." && pwd)

for program in slurmctld slurmd sbatch munged; do
    if ! PATH=$PATH:/usr/sbin:/sbin command -v "$program" > /dev/null; then
        echo "skipped: there is no $program. On Debian or Ubuntu, as root:"
        echo "  apt-get install --no-install-recommends slurmctld slurmd slurm-client munge"
        exit 77
    fi
done
if [ "$(id -u)" -ne 0 ]; then
    echo "skipped: slurmd and munged are started as root, and this is not root."
    exit 77
fi
export PATH=$PATH:/usr/sbin:/sbin

work=$(mktemp -d /tmp/panokit-slurm.XXXXXX)
chmod 755 "$work"
export SLURM_CONF=$work/slurm.conf
host=$(hostname -s)
daemons=()

finish() {
    code=$?
    set +e
    trap - EXIT
    [ -n "${driver:-}" ] && kill "$driver" 2> /dev/null
    scancel --user=root 2> /dev/null
    sleep 1
    for pid in "${daemons[@]}"; do kill "$pid" 2> /dev/null; done
    wait 2> /dev/null
    if [ "$code" -eq 0 ]; then rm -rf "$work"; else echo "failed; all logs are in $work"; fi
    exit "$code"
}
trap finish EXIT
trap 'exit 143' INT TERM

mkdir "$work/state" "$work/spool"
dd if=/dev/urandom of="$work/munge.key" bs=1 count=1024 status=none
chmod 400 "$work/munge.key"
# Plug-ins that need neither cgroups nor a database, so that it runs in a container, too.
cat > "$SLURM_CONF" << END
ClusterName=panokit
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
SlurmctldPort=16817
SlurmdPort=16818
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$work/munge.socket
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SlurmdParameters=config_overrides
ReturnToService=2
KillWait=5
NodeName=$host NodeAddr=127.0.0.1 CPUs=4 RealMemory=16000 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END
# From 23.11 on, slurmd looks for cgroups unless told otherwise; before, it does not know the word.
version=$(slurmd -V | awk '{print $2}')
if [ "$(printf '%s\n' 23.11 "$version" | sort --version-sort | head -n 1)" = 23.11 ]; then
    echo "CgroupPlugin=disabled" > "$work/cgroup.conf"
fi

munged --foreground --force --key-file="$work/munge.key" --socket="$work/munge.socket" \
    --pid-file="$work/munged.pid" --seed-file="$work/munged.seed" \
    --log-file="$work/munged.log" > "$work/munged.out" 2>&1 &
daemons+=($!)
until [ -S "$work/munge.socket" ]; do sleep 0.2; done
slurmctld -D -i > "$work/slurmctld.log" 2>&1 &
daemons+=($!)
slurmd -D > "$work/slurmd.log" 2>&1 &
daemons+=($!)
for _ in $(seq 100); do
    sinfo --noheader --format=%T 2> /dev/null | grep -q idle && break
    sleep 0.3
done
sinfo --noheader --format="Slurm %v, node %N: %T" 2> /dev/null | grep idle || exit 1

cd "$work"
# Records say where a picture was fetched from, so both runs serve them at the same place.
demo=("$here/pipelines/demo.toml" --set serve_port=18217 --set fetch.width_px=1024)
demo+=(--set expand.width_px=512)
echo "a serial run"
"$panokit" run "${demo[@]}" --out "$work/serial" > "$work/serial.txt" 2>&1

echo "the same on Slurm, with two jobs"
"$panokit" run "${demo[@]}" --out "$work/slurm" --engine slurm --workers 2 \
    --set cluster.memory_gb=2 --set cluster.slurm.interface=lo > "$work/slurm.txt" 2>&1 &
driver=$!
# The first panorama that a job has made is the sign that both are at work.
until grep -q '"stage": "stitch"' "$work/slurm/log.jsonl" 2> /dev/null; do
    kill -0 "$driver" || { cat "$work/slurm.txt"; exit 1; }
    sleep 0.1
done
job=$(squeue --noheader --states=RUNNING --format=%i | head -n 1)
echo "job $job is killed"
scancel --signal=KILL --full "$job"
wait "$driver" || { cat "$work/slurm.txt"; exit 1; }
driver=
cat "$work/slurm.txt"

jobs=$(find "$work/slurm-logs" -name 'panokit-*.err' | wc -l)
echo "$jobs jobs ran in all"
[ "$jobs" -ge 3 ] || { echo "the killed job was not replaced"; exit 1; }
[ -z "$(squeue --noheader)" ] || { sleep 5; [ -z "$(squeue --noheader)" ]; } ||
    { echo "jobs are left in the queue"; squeue; exit 1; }

for folder in panoramas filled probes; do
    diff -r "$work/serial/$folder" "$work/slurm/$folder"
done
diff "$work/serial/manifest.jsonl" "$work/slurm/manifest.jsonl"
[ -n "$(ls "$work/slurm/probes")" ]
echo "the same $(find "$work/slurm/probes" -name '*.exr' | wc -l) maps as the serial run, byte for byte"

echo "the driver as a job, too, as far as stitch"
venv=$(dirname "$(dirname "$(command -v "$panokit")")")
PANOKIT_VENV=$venv WORKERS=1 sbatch --quiet --wait --output="$work/driver.txt" \
    "$here/pipelines/cluster/driver.sbatch" "${demo[@]}" --out "$work/driver" --stop-after stitch \
    --set cluster.memory_gb=2 --set cluster.slurm.interface=lo ||
    { cat "$work/driver.txt"; exit 1; }
diff -r "$work/serial/panoramas" "$work/driver/panoramas"
echo "the same $(find "$work/driver/panoramas" -name '*.jpg' | wc -l) panoramas"
