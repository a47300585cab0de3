#!/usr/bin/env bash
# service_exposure.sh UNIT: the unit is exposed by at most 3.0 (systemd-analyze security), and still may do what
# furculad does. Status 77 where there is no systemd-analyze.
set -euo pipefail
unit=$1
shift
fail() { echo "$unit: $*" >&2; exit 1; }
command -v systemd-analyze >/dev/null || { echo "systemd-analyze is not there (Debian's package systemd)"; exit 77; }

said=$(systemd-analyze security --offline=true --no-pager --threshold=30 "$unit") || fail "exposed by more than 3.0: ${said##*→}"
echo "${said##*→ }"

# What furculad cannot do without, and what is there on no Debian before somebody makes it.
has() { grep -qxE "$1" "$unit" || fail "no line '$1'"; }
has 'DeviceAllow=char-gpiochip rw'
has 'RestrictAddressFamilies=.*AF_CAN.*'
has 'LimitRTPRIO=[0-9]+'
has 'LimitMEMLOCK=infinity'
has 'StateDirectory=furcula'
has 'User=furcula'
if grep -qE '^(SupplementaryGroups|Group)=' "$unit"; then fail "names a group, which not every computer has"; fi
for forbids in RestrictRealtime PrivateDevices PrivateNetwork; do
  if grep -qE "^$forbids=(yes|true|1|on)" "$unit"; then fail "$forbids= would stop furculad"; fi
done

# The filter as systemd builds it: groups added and taken away, line by line.
declare -A groups=() allowed=()
group=
while IFS= read -r line; do
  read -r word _ <<<"$line" || true
  case $line in
    @*) group=$word ;;
    ' '*[a-z]*) if [[ $word != '#'* ]]; then groups[$group]+=" $word"; fi ;;
  esac
done < <(systemd-analyze syscall-filter --no-pager 2>/dev/null)
members() {
  local m
  case $1 in
    @*) for m in ${groups[$1]-}; do members "$m"; done ;;
    *) echo "$1" ;;
  esac
}
while IFS= read -r value; do
  take=true
  [ "${value:0:1}" = '~' ] && { take=false; value=${value:1}; }
  for word in $value; do
    for call in $(members "$word"); do
      if $take; then allowed[$call]=1; else unset "allowed[$call]"; fi
    done
  done
done < <(sed -n 's/^SystemCallFilter=//p' "$unit")
[ ${#allowed[@]} -gt 50 ] || fail "its filter could not be read"
# As strace shows them on scripts/hil's machine, from the start to a save and SIGTERM; and unlink, of a save that fails.
for call in accept4 access arch_prctl bind brk clock_nanosleep clone3 close connect eventfd2 execve exit exit_group fchmod fcntl fsync \
  futex getdents64 getpid getrandom getrusage getsockname ioctl listen madvise mlockall mmap mprotect munmap newfstatat openat poll \
  pread64 prlimit64 pselect6 read readlink recvfrom recvmmsg rename rseq rt_sigaction rt_sigprocmask rt_sigtimedwait \
  sched_setscheduler sendmmsg sendto set_robust_list set_tid_address setsockopt socket umask unlink write; do
  [ -n "${allowed[$call]-}" ] || fail "SystemCallFilter= forbids $call"
done
for call in ptrace mount reboot init_module setuid chown kexec_load clock_settime setpriority; do
  [ -z "${allowed[$call]-}" ] || fail "SystemCallFilter= allows $call"
done
