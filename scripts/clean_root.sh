# For scripts that check an installation in a clean system. Sourced, not run:
#   package_in_dist PATTERN SCRIPT [FILE]
#                              prints FILE, or else the newest of that name in dist/; 3 without one, which SCRIPT makes
#   clean_root_or_skip         77 with a reason where root or debootstrap is missing
#   make_clean_root [SUITE]    a minimal Debian 12, or jammy or noble of Ubuntu, in a temporary folder, named by $root;
#                              removed when the script ends. It is kept for a week in ~/.cache/aligngs for the next one.
#                              77 with a reason where it cannot be made, which says nothing about a package.
#   inside COMMAND...          runs a command in it
# shellcheck shell=bash

package_in_dist() {
  local file
  # shellcheck disable=SC2086
  file=${3:-$(ls -t dist/$1 2>/dev/null | head -n 1 || true)}
  [ -f "$file" ] || { echo "$(basename "$0"): there is no ${3:-dist/$1}: run scripts/$2 first" >&2; return 3; }
  echo "$file"
}

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
  trap 'umount "$root/proc" 2>/dev/null || true; rm -rf "$root" "$root.log"' EXIT
  local kept=${XDG_CACHE_HOME:-$HOME/.cache}/aligngs/clean-$suite.tar
  if [ -n "$(find "$kept" -mtime -7 2>/dev/null)" ]; then
    tar -C "$root" -xpf "$kept"
  else
    if ! debootstrap --variant=minbase "${extra[@]}" "$suite" "$root" ${mirror:+"$mirror"} ${script:+"$script"} >"$root.log" 2>&1; then
      echo "skipped: debootstrap cannot make a clean $suite here: $(tail -n 1 "$root.log")"
      exit 77
    fi
    mkdir -p "$(dirname "$kept")"
    tar -C "$root" -cf "$kept.part" . && mv "$kept.part" "$kept"
  fi
  apt-config dump | grep '^Acquire::' >"$root/etc/apt/apt.conf.d/90host" || true  # proxies and the like, as they are here
  echo 'APT::Sandbox::User "root";' >>"$root/etc/apt/apt.conf.d/90host"
  if ! mount -t proc proc "$root/proc" 2>"$root.log"; then
    echo "skipped: a clean system needs /proc, and mount fails here: $(cat "$root.log")"
    exit 77
  fi
}

inside() { LC_ALL=C chroot "$root" "$@"; }
