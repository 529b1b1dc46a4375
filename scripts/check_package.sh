#!/usr/bin/env bash
# Installs the packages of dist/ in a clean Debian 12 and runs them there as an ordinary user.
# Usage: scripts/check_package.sh [DEB]     needs root and debootstrap; 77 where either is missing
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/clean_root.sh
case "${1:-}" in -h|--help) sed -n '2,3p' "$0" | cut -c3-; exit 0 ;; esac
deb=$(package_in_dist 'aligngs_*.deb' package.sh "${1:-}")
clean_root_or_skip
make_clean_root
python=$(package_in_dist 'python3-aligngs_*.deb' package.sh 2>/dev/null || true)
cp "$deb" "$root/tmp/aligngs.deb"
[ -z "$python" ] || cp "$python" "$root/tmp/python3-aligngs.deb"
inside apt-get update -qq
inside env DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends /tmp/aligngs.deb >/dev/null
inside useradd --create-home visitor
as_visitor() { inside su visitor -c "cd && $*"; }
as_visitor aligngs --version
as_visitor aligngs doctor >/dev/null
as_visitor aligngs demo -q -n 30 --views 8 --size 64x48 -o run
for file in home/visitor/run/report.html home/visitor/run/mesh/mesh.ply usr/share/man/man1/aligngs-run.1.gz \
            usr/share/bash-completion/completions/aligngs usr/share/zsh/vendor-completions/_aligngs \
            usr/share/fish/vendor_completions.d/aligngs.fish; do
  [ -s "$root/$file" ] || { echo "check_package.sh: /$file is missing after the install" >&2; exit 1; }
done
if [ -n "$python" ]; then
  inside env DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends /tmp/python3-aligngs.deb >/dev/null
  as_visitor "python3 -c 'import aligngs; print(len(aligngs.Run(\"run\").gaussians), \"splats in Python\")'"
  inside apt-get remove -qq -y python3-aligngs >/dev/null
fi
inside apt-get remove -qq -y aligngs >/dev/null
[ ! -e "$root/usr/bin/aligngs" ] || { echo "check_package.sh: the program stays after its removal" >&2; exit 1; }
echo "check_package.sh: $(basename "$deb") installs, runs its demo and goes again"
