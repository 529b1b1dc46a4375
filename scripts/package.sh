#!/usr/bin/env bash
# Builds the Debian packages of this machine's release: aligngs, and python3-aligngs, which is Python alone.
# Usage: scripts/package.sh [BUILD-FOLDER]     result: dist/*.deb
# The build folder is build unless another is given; what is built there already is not built again.
set -euo pipefail
cd "$(dirname "$0")/.."
case "${1:-}" in -h|--help) sed -n '2,4p' "$0" | cut -c3-; exit 0 ;; esac
folder=${1:-build}
scripts/setup.sh
command -v dpkg-shlibdeps >/dev/null || { echo "package.sh: dpkg-shlibdeps is missing: apt-get install dpkg-dev" >&2; exit 5; }
if [ ! -x "$folder/aligngs" ]; then
  scripts/build.sh "$folder" -DCMAKE_BUILD_TYPE=Release -DALIGNGS_BUILD_TESTS=OFF -DALIGNGS_BUILD_BENCHMARKS=OFF -DALIGNGS_UNITY_BUILD=ON
fi
mkdir -p dist
(cd "$folder" && cpack -G DEB -B "$OLDPWD/dist" >/dev/null)
rm -rf dist/_CPack_Packages

# The Python package: three files of text for dpkg, and the folder as it is.
version=$("$folder/aligngs" --version | awk '{print $2}')
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
chmod 755 "$tree"
install -d "$tree/DEBIAN" "$tree/usr/lib/python3/dist-packages/aligngs" "$tree/usr/share/doc/python3-aligngs/examples"
install -m 644 python/aligngs/*.py python/aligngs/py.typed "$tree/usr/lib/python3/dist-packages/aligngs/"
install -m 644 python/examples/*.py "$tree/usr/share/doc/python3-aligngs/examples/"
install -m 644 LICENSE "$tree/usr/share/doc/python3-aligngs/copyright"
cat >"$tree/DEBIAN/control" <<END
Package: python3-aligngs
Version: $version
Architecture: all
Section: python
Maintainer: The aligngs maintainers <maintainers@aligngs.invalid>
Depends: python3 (>= 3.9), python3-numpy
Recommends: aligngs
Suggests: python3-matplotlib
Description: Runs and scenes of aligngs as numpy arrays
END
dpkg-deb --root-owner-group --build "$tree" "dist/python3-aligngs_${version}_all.deb" >/dev/null
ls -l dist/*.deb
