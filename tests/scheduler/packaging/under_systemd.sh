#!/usr/bin/env bash
# under_systemd.sh PREFIX HOME LINE: runs the line in bash beside a systemd of its own (`systemd --user`), with PREFIX in
# the place of /usr/local and a new /run, so that neither this machine's systemd nor its files are touched. As root,
# with util-linux's unshare. Exit code 77, with the reason: it cannot be done here. Units are read from HOME.
set -u

cannot() {
  echo "$*"
  exit 77
}

if [[ -z ${UNDER_SYSTEMD:-} ]]; then
  [[ $EUID == 0 ]] || cannot "namespaces for a systemd need root"
  manager=/lib/systemd/systemd
  [[ -x $manager ]] || cannot "there is no $manager"
  for program in systemctl unshare; do
    command -v "$program" >/dev/null || cannot "there is no $program"
  done
  # Control groups of its own, in which it makes those of its services: one of cgroup2, or two where both versions are
  # mounted.
  groups=()
  for hierarchy in /sys/fs/cgroup /sys/fs/cgroup/unified /sys/fs/cgroup/systemd; do
    [[ -e $hierarchy/cgroup.procs ]] && groups+=("$hierarchy/penumbra-test-$$")
  done
  ((${#groups[@]} > 0)) || cannot "there are no control groups"
  mkdir "${groups[@]}" 2>/dev/null || cannot "no control groups can be made: ${groups[*]}"
  (
    for group in "${groups[@]}"; do
      echo "$BASHPID" 2>/dev/null >"$group/cgroup.procs" || cannot "no process can be moved to $group"
    done
    export UNDER_SYSTEMD=$manager
    # All processes end with the first one of the namespace.
    exec unshare --mount --pid --fork --mount-proc --kill-child "$BASH" "${BASH_SOURCE[0]}" "$@"
  )
  code=$?
  find "${groups[@]}" -depth -type d -exec rmdir {} \; 2>/dev/null
  exit "$code"
fi

prefix=$1 home=$2 line=$3
mount -t tmpfs none /run && mount --bind "$prefix" /usr/local || cannot "no file system can be mounted"
mkdir -p /run/systemd/system /run/user/0 && chmod 700 /run/user/0
export HOME=$home XDG_RUNTIME_DIR=/run/user/0
unset DBUS_SESSION_BUS_ADDRESS XDG_CONFIG_HOME XDG_STATE_HOME XDG_CACHE_HOME
log=$home/systemd.log
"$UNDER_SYSTEMD" --user --log-target=console >"$log" 2>&1 &
for ((i = 0; i < 300; ++i)); do
  state=$(systemctl --user is-system-running 2>/dev/null)
  [[ $state == running || $state == degraded ]] && break
  kill -0 $! 2>/dev/null || cannot "systemd --user ends: $(tail -n 3 "$log")"
  sleep 0.1
done
[[ $state == running || $state == degraded ]] || cannot "systemd --user does not start: $(tail -n 3 "$log")"
bash -c "$line"
