#!/usr/bin/env bash
# Builds the Debian package of this machine's release. Usage: scripts/package.sh [BUILD-FOLDER]     result: dist/*.deb
# The build folder is build unless another is given; what is built there already is not built again.
set -euo pipefail
cd "$(dirname "$0")/.."
case "${1:-}" in -h|--help) sed -n '2,3p' "$0" | cut -c3-; exit 0 ;; esac
folder=${1:-build}
scripts/setup.sh
command -v dpkg-shlibdeps >/dev/null || { echo "package.sh: dpkg-shlibdeps is missing: apt-get install dpkg-dev" >&2; exit 5; }
if [ ! -x "$folder/aligngs" ]; then
  scripts/build.sh "$folder" -DCMAKE_BUILD_TYPE=Release -DALIGNGS_BUILD_TESTS=OFF -DALIGNGS_BUILD_BENCHMARKS=OFF
fi
mkdir -p dist
(cd "$folder" && cpack -G DEB -B "$OLDPWD/dist" >/dev/null)
rm -rf dist/_CPack_Packages
ls -l dist/*.deb
