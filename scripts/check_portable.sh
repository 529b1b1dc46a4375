#!/usr/bin/env bash
# Unpacks the portable tar.gz of dist/ in a clean Debian 12 and runs it there as an ordinary user.
# Usage: scripts/check_portable.sh [jammy|noble]     these take Ubuntu 22.04 and 24.04, and want the keys of Ubuntu's archive
# Needs root and debootstrap; 77 where either is missing.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/clean_root.sh
case "${1:-}" in -h|--help) sed -n '2,4p' "$0" | cut -c3-; exit 0 ;; esac
archive=$(package_in_dist 'aligngs-*-linux-*.tar.gz' portable.sh)
clean_root_or_skip
make_clean_root "${1:-bookworm}"
inside useradd --create-home visitor
cp "$archive" "$root/tmp/aligngs.tar.gz"
as_visitor() { inside su visitor -c "cd && $*"; }
as_visitor tar -xzf /tmp/aligngs.tar.gz
as_visitor ln -s "aligngs-*/bin/aligngs" aligngs
as_visitor ./aligngs --version
as_visitor ./aligngs doctor >/dev/null
as_visitor ./aligngs demo -q -n 30 --views 8 --size 64x48 -o run
printf 'one\tdemo\t-n 10 --views 8 --size 64x48\n' >"$root/home/visitor/rooms.tsv"
as_visitor ./aligngs batch rooms.tsv -o rooms -q # the program starts itself
[ -s "$root/home/visitor/run/report.html" ] || { echo "check_portable.sh: there is no report" >&2; exit 1; }
echo "check_portable.sh: $(basename "$archive") runs in ${1:-bookworm} without an installation"
