# For scripts that check an installation in a clean system. Sourced, not run:
#   clean_root_or_skip         77 with a reason where root or debootstrap is missing
#   make_clean_root [SUITE]    a minimal Debian 12, or jammy or noble of Ubuntu, in a temporary folder, named by $root;
#                              removed when the script ends
#   inside COMMAND...          runs a command in it
# shellcheck shell=bash

clean_root_or_skip() {
  if [ "$(id -u)" -ne 0 ] || ! command -v debootstrap >/dev/null; then
    echo "skipped: a clean Debian needs root and debootstrap (apt-get install debootstrap)"
    exit 77
  fi
}

make_clean_root() {
  local suite=${1:-bookworm} mirror=
  local -a extra=()
  # The mirror of this machine, in either form of apt's lists; debootstrap's own without one, and for Ubuntu.
  [ "$suite" != bookworm ] || mirror=$(cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list /etc/apt/sources.list.d/*.sources 2>/dev/null |
    sed -n 's/^URIs: *//p; s/^deb \(\[[^]]*\] \)\?\(http[^ ]*\) .*/\2/p' | grep -v security | grep debian | head -n 1 || true)
  # Ubuntu's script is one for all releases; Debian's debootstrap may not know the newest by name.
  local script=
  [ "$suite" = bookworm ] || script=/usr/share/debootstrap/scripts/gutsy
  if [ -n "$script" ]; then
    mirror=http://archive.ubuntu.com/ubuntu
    [ -f /usr/share/keyrings/ubuntu-archive-keyring.gpg ] || { echo "skipped: the keys of Ubuntu's archive are missing"; exit 77; }
    extra=(--keyring=/usr/share/keyrings/ubuntu-archive-keyring.gpg)
  fi
  root=$(mktemp -d)
  chmod 755 "$root"
  trap 'umount "$root/proc" 2>/dev/null || true; rm -rf "$root"' EXIT
  debootstrap --variant=minbase "${extra[@]}" "$suite" "$root" ${mirror:+"$mirror"} ${script:+"$script"} >"$root.log" 2>&1 || { tail "$root.log" >&2; exit 5; }
  rm -f "$root.log"
  apt-config dump | grep '^Acquire::' >"$root/etc/apt/apt.conf.d/90host" || true  # proxies and the like, as they are here
  echo 'APT::Sandbox::User "root";' >>"$root/etc/apt/apt.conf.d/90host"
  mount -t proc proc "$root/proc"
}

inside() { LC_ALL=C chroot "$root" "$@"; }
